"""Samples at the end of a chip's range (on a rail), and peaks that are cut off below it.

What counts is how much likelier the samples at one level are if everything beyond it reads that
level than if the readings thin out towards their largest one as they do everywhere.
"""
import math
from typing import NamedTuple

import numpy as np
from scipy import ndimage, special

from ...capture import chip_scales, registers
from ...capture.registers import FEWEST_VALUES, RAIL, RAIL_CODES, fixed_bits, number_of_runs, steps
from .detection import BELOW, LEVEL, RANGE, Finding, present

# s of a peak's flanks that are looked at, and samples at least: judged, a hand turns a box half
# round in half a second or more, and comes up to its rate in a third of that.
FLANK_S, FLANK = 0.04, 2
LOOKED_AT = 6  # ends of a sensor's three axes, each of which could be cut off
# Chance that a log comes to its largest reading again and again and stays there: a motor does at
# its steady rate, a robot in its pose, a hand does not.
STEADY = 0.01
# Share of the span of the readings just inside their largest one, in which peaks that are not cut
# off end as well: less holds too few of them, in more they thin out by themselves.
SPREAD_SHARE = 0.02
ONE_LENGTH = 0.005  # of a reading, by which the lengths of all differ that are gravity alone


def saturation(sessions, sensor, columns):
    """Samples on a rail, or many that share the largest value and few near it."""
    value, words, limits, levels, score, number = {}, {}, {}, {}, 0.0, 0
    for i in range(3):
        for session, counts in zip(sessions, columns):
            x = counts[:, i].astype(np.int64)
            on_rail = np.abs(x) >= _range_rail(session, sensor)
            span = _span(x)
            if on_rail.any():
                span = _span(np.abs(x))
                level = np.abs(x), on_rail
                nats = level_nats(*level, RAIL_CODES, span)
                said = "%d samples of the %s axis sit on the rail" % (on_rail.sum(), "xyz"[i])
                size, limit = int(np.abs(x).max()), RANGE
            else:
                nats, level = max(((cut_off_nats(y, span), (y, y == y.max()))
                                   for y in (x, -x)), key=lambda pair: pair[0])
                size = int(np.abs(level[0].max()))
                if sensor == "accel" and _all_of_it(counts, size):
                    continue
                limit, said = _cut_off(session, sensor, "xyz"[i], size)
            if present(nats):
                value["xyz"[i]] = max(value.get("xyz"[i], 0), size)
                number += peaks(*level, span)[0]
                score += nats
                words.setdefault("xyz"[i], said)
                limits.setdefault("xyz"[i], limit)
                if not registers.end_known(session.capture.meta, sensor):
                    levels["xyz"[i]] = max(levels.get("xyz"[i], 0.0), size / _lsb(session, sensor))
    if not value:
        return []
    return [Finding("saturation", sensor, sorted(value), value, "counts", score, "amplitude",
                    "; ".join(words[axis] for axis in sorted(words)),
                    {k: (v, v) for k, v in value.items()},
                    share=1.0, number=number, limits=limits,
                    levels=levels)]  # a peak that ends inside is sound


def _all_of_it(counts, size):
    """Whether all readings (n, 3) are of one length, and the largest of an axis as long: gravity
    in a log of attitudes alone, of which an upright axis reads all. Where an axis is cut off the
    reading is shorter."""
    length = np.linalg.norm(counts.astype(float), axis=1)
    return np.ptp(length) <= ONE_LENGTH * size and size >= (1.0 - ONE_LENGTH) * length.max()


def _cut_off(session, sensor, axis, size):
    """(limit, what is said) of peaks of so many counts that end before the last codes. Where a
    log does not tell its converter's end, a usual full scale is the chip's."""
    lsb, unit = _lsb(session, sensor), registers.UNITS[sensor]
    at = "%d counts (%.4g %s)" % (size, size / lsb, unit)
    if registers.end_known(session.capture.meta, sensor):
        return BELOW, ("peaks of the %s axis are cut off at %s, below the rail of %.4g %s: a range"
                       " that was set otherwise, a filter's or a simulator's limit" % (
                           axis, at, registers.rail(session.capture, sensor) / lsb, unit))
    if chip_scales.is_full_scale(sensor, size / lsb):
        return RANGE, "peaks of the %s axis end at %s, where a usual range does" % (axis, at)
    return LEVEL, ("peaks of the %s axis level off at %s; where the range of its chip ends, the "
                   "log does not say" % (axis, at))


def _lsb(session, sensor):
    return session.capture.meta[registers.SCALES[sensor]]


def railed(session, sensor="accel"):
    """(n,) True where a sample sits on a rail or on a level that peaks are cut off at."""
    counts = getattr(session.capture, sensor)
    rail = _range_rail(session, sensor)
    at_end = np.zeros(len(counts), bool)
    for column in counts.T.astype(np.int64):
        at_end |= np.abs(column) >= rail
        span = _span(column)
        for sign in (1, -1):
            if present(cut_off_nats(sign * column, span)):
                at_end |= sign * column == (sign * column).max()
    return at_end


def lost_at_peaks(rates, dt, level):
    """(n, 3) deg/s by which rates (n, 3), dt (n,) s apart, are less than the flanks of their peaks
    above a level (3,) deg/s foretell: than Hermite's cubic, which leaves the level and comes back
    to it as steeply as they do. Next to nothing of a round peak that is whole; much of one that is
    flat because the box turned so; of one whose flanks are not all there, nothing."""
    less = np.zeros_like(rates)
    width = max(FLANK, round(FLANK_S / float(np.median(dt))))
    at = np.cumsum(dt) - 0.5 * dt
    for axis in np.flatnonzero((rates > level).any(axis=0)):
        column = rates[:, axis]
        above = ndimage.binary_closing(column > level[axis], np.ones(width))
        for run, in ndimage.find_objects(ndimage.label(above)[0]):
            if run.start < width or run.stop > len(column) - width:
                continue
            flanks = slice(run.start - width, run.start), slice(run.stop, run.stop + width)
            up, down = (np.polyfit(at[flank] - at[flank][0], column[flank], 1)[0]
                        for flank in flanks)
            length = dt[run].sum()
            way = (at[run] - at[run][0] + 0.5 * dt[run][0]) / length
            course = level[axis] + length * way * (1.0 - way) * (up * (1.0 - way) - down * way)
            less[run, axis] = np.maximum(course - column[run], 0.0)
    return less


def _range_rail(session, sensor):
    """The first of the last counts of a sensor's range, or of its register."""
    return registers.rail(session.capture, sensor) - RAIL_CODES


def cut_off_nats(x, span=None):
    """level_nats of the largest value of x, against peaks that end anywhere or at one steady
    reading again and again; the one sample that is the largest anyhow is no evidence, and the
    largest values that were looked at are taken off. span: of x, where it is known already."""
    at = x == x.max()
    if _different(x) < FEWEST_VALUES:
        return 0.0
    span = span or _span(x)
    nats = level_nats(x, at, 1, span, 1) - math.log(LOOKED_AT)
    return -float(np.logaddexp(-nats, math.log(STEADY) - _piled_up_nats(x, span.step)))


def _different(x):
    """How many readings x has that differ: two that lie far closer than all do on average are one,
    which decimals rounded to either side. In noise of a few codes the last is read often, and
    what is cut off has more of them below it."""
    values = np.unique(x)
    return 1 + int((2 * np.diff(values) * (len(values) - 1) >= np.ptp(values)).sum()) if len(
        values) > 1 else 1


def _piled_up_nats(x, step):
    """Log likelihood ratio (nats) of the largest code being read oftener than those below it that
    noise makes of one reading, as where what would be larger reads it, against more rarely, as in
    the noise of one steady reading; the one sample that is the largest anyhow is no evidence.
    Either share has all values alike."""
    at = x == x.max()
    below = max(1, round(_noise(x, at, step)))
    hits = int(at.sum()) - 1
    misses = int((x >= x.max() - below * step).sum()) - hits - 1
    even = 1.0 / (below + 1.0)
    more, fewer = (math.log(max(float(part(hits + 1.0, misses + 1.0, even)), 1e-300) / share)
                   for part, share in ((special.betaincc, 1.0 - even), (special.betainc, even)))
    return more - fewer


def _noise(x, at, step):
    """Standard deviation of a sample in steps, by the bends of the samples that are not `at`."""
    bends = np.abs(np.diff(x[~at], n=2)) if (~at).sum() > 3 else np.zeros(1)
    return 1.4826 / math.sqrt(6.0) * float(np.median(bends)) / step


def level_nats(x, at, width, span, free=0):
    """Log likelihood ratio (nats) of readings x being held at their largest `width` codes, where
    `at` is True, against readings whose peaks end anywhere in the last part of their span. That
    the next sample stays at the level counts for as much as it does so more often than noise and
    the other readings let it. span: of x; free: peaks that end there anyhow."""
    reached, inside = peaks(x, at, span)
    runs = max(reached - free, 0)
    # A rail is known beforehand: what jumps there alone could have jumped anywhere.
    known = not free and not inside
    share = width / float(RAIL + 1) if known else width * span.step / span.last
    return _oftener(runs, inside, share) + _held_nats(x, at, span.step)


def _held_nats(x, at, step):
    """Nats of the next sample's staying at the level where `at` is True."""
    among, stays = at[:-1], at[1:] & at[:-1]
    by_noise = 1.0 / max(math.sqrt(2.0 * math.pi) * _noise(x, at, step), 1.0)
    others = ~among
    repeats = (int((x[1:] == x[:-1])[others].sum()) + 1.0) / (int(others.sum()) + 2.0)
    return _oftener(int(stays.sum()), int(among.sum() - stays.sum()), max(by_noise, repeats))


def _oftener(hits, misses, chance):
    """Nats of hits being more frequent than `chance`, by any amount alike; nil where they are
    not [Jeffreys, Theory of Probability (1961), section 5.1]."""
    if hits <= chance * (hits + misses) or chance >= 1.0:
        return 0.0
    more = special.betaincc(hits + 1.0, misses + 1.0, chance) / (1.0 - chance)
    return max(0.0, math.log(more) + float(special.betaln(hits + 1.0, misses + 1.0))
               - hits * math.log(chance) - misses * math.log1p(-chance))


def peaks(x, at, span):
    """(peaks that end at the level where `at` is True, those that end just inside of it)."""
    near = x >= x[at].min() - span.last
    reached = _reached(near, at & near)
    return reached, number_of_runs(near) - reached


class Span(NamedTuple):
    """step of the counts, and width of the last part of their span; of x as of -x."""

    step: int
    last: float


def _span(x):
    """Span of counts x (n,). Where a bit sticks, of x or of what x is the negative of, what is on
    either side of it reads alike: a step of two weights."""
    stuck = fixed_bits(x) + fixed_bits(-x)
    step = max([int(steps(x[:, None])[0]), *(2 << bit for bit, _ in stuck)])
    return Span(step, max(4.0, 3.0 * step, SPREAD_SHARE * float(np.ptp(x))))


def _reached(near, at):
    """Number of runs of `near` that hold a sample of `at`."""
    number = np.cumsum(np.concatenate([near[:1], near[1:] & ~near[:-1]]))
    return len(np.unique(number[at]))
