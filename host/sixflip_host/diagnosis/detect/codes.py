"""Which codes a sensor gives, how likely that would be if it gave all of them, and the findings
that give way where it leaves some out."""
import math
from dataclasses import replace

import numpy as np
from scipy import fft, ndimage, special

from ...capture.registers import (
    LOW_BITS,
    RAIL,
    SENSORS,
    codes,
    number_of_runs,
    of_counts,
    spacing,
    steps,
)
from . import lattice
from .detection import RANGE, odd_axes, present

STEPS_TRIED = 1 << LOW_BITS
# Codes to either side that say how often one is read: as many as the usual difference of two
# samples, whose median is a tenth below the peak of normal noise, at most as many as wide steps.
# Of a smaller difference whole numbers tell by a tenth and worse how wide the noise is.
FEWEST_AROUND, MOST_AROUND = 5, 16
# Where most codes are left out, so many usual differences: 1.9 standard deviations. Of two rests
# as far apart as twice that the code halfway is read a third as often as the commonest.
REACH = 2.0
FINER = 4  # values of a spectrum in the width of a line: the highest is off by a fortieth at most
FLANK = 8  # of the way from one line of the bits to the next, the flank of one at most
EXPECTED = 20.0  # readings of a code: chance leaves RARE of them once in a million
# Of the usual number: no converter's steps differ so much that has none missing (differential
# nonlinearity of more than 0.9 of a step, which IEEE Std 1241 calls a missing code).
RARE, FREQUENT = 0.1, 4.0
# Share of the samples that are too many or missing at such codes: a tenth are in a recording of a
# sensor that is sold calibrated, whose converter or arithmetic leaves single codes out.
MANY = 0.15
# Times as often as any other code, and as a hundredth of all samples: in noise of one count a rest
# reads its commonest code in four of ten samples, and the next one in a quarter.
ALONE, SELDOM = 10.0, 0.01


def step_nats(counts, sizes):
    """(3,) log likelihood ratio (nats) of every code lying on a grid of steps of sizes (3,):
    without one each code that appears lies there with a chance of one in the width of a step."""
    nats = []
    for column, step in zip(counts.T, sizes):
        values = codes(column)
        number = int((np.abs(values) < RAIL).sum())
        nats.append((number - 1) * math.log(step) - math.log(STEPS_TRIED) if step > 1 else 0.0)
    return np.array(nats)


def distinct(counts):
    """(3,) number of codes that appear."""
    return np.array([len(np.unique(column)) for column in counts.T])


def zeros(counts):
    """(3,) number of runs of readings that are 0."""
    return np.array([number_of_runs(column == 0) for column in counts.T])


def band_nats(counts):
    """(3,) log likelihood ratio (nats) of readings near 0 being 0: how often the readings just
    outside of the band would have gone inside (Poisson), and how much more often 0 is read than
    a code beside it; nothing where no code is missing. A run of samples counts once."""
    nats = []
    for column in counts.T:
        size = np.abs(column.astype(np.int64))
        least = int(size[size > 0].min()) if size.any() else 0
        step = max(1, steps(column[:, None])[0], spacing(size, least)) if least else 1
        if least <= step:
            nats.append(0.0)
            continue
        beside = number_of_runs((size > 0) & (size < 2 * least))
        missed = beside * (1.0 - step / least)
        expected, zeros = max(beside * step / least, 1e-3), number_of_runs(size == 0)
        piled = zeros * math.log(max(zeros / expected, 1.0)) - max(zeros - expected, 0.0)
        nats.append(missed + piled - math.log(len(codes(size))) if zeros else 0.0)
    return np.array(nats)


def uneven_nats(columns, held=1):
    """Log likelihood ratio (nats) of codes at rest that are read RARE times as often as those
    around them or less, or FREQUENT times and more, Poisson, where MANY are. Around codes of which
    most are left out it is the rarer of the commonest within their reach on either side that
    says how often noise of one peak would have them read. Nothing is said where the noise is
    narrow, of codes up to `held` to either side of 0, which a dead band may hold, nor where all
    that are ever read lie equally far apart, to a count, as in a file that counts in other steps
    than the chip. columns: list of (n,) whole numbers, one a rest."""
    columns = [c.astype(np.int64) for c in columns if len(c) > 1]
    if not columns:
        return 0.0
    noise = np.median(np.abs(np.concatenate([np.diff(c) for c in columns])))
    every = np.concatenate(columns)
    every = every[np.abs(every) < RAIL - 1]
    if noise < 1 or not len(every):
        return 0.0
    nats = 0.0
    if noise >= FEWEST_AROUND:
        nats = (_of_single_codes(every, noise, held) or _of_low_bits(every, int(noise), held)
                or _of_runs(every, noise, held))
    return nats or lattice.swallowed_nats(every[np.abs(every) > held])


def _of_single_codes(every, noise, held):
    """Nats of uneven_nats() by each code of every (n,); noise: the usual difference of two."""
    times = np.bincount(every - every.min()).astype(float)
    middle = ndimage.median_filter(times, 2 * min(int(noise), MOST_AROUND) + 1, mode="constant")
    usual = np.where(middle > 0.0, middle, _commonest(times, int(REACH * noise)))
    asked = (usual >= EXPECTED) & (np.abs(np.arange(len(times)) + every.min()) > held)
    seldom = times <= RARE * usual
    odd = asked & (seldom | (middle > 0.0) & (times >= FREQUENT * usual))
    off = np.abs(times - usual)[odd].sum()
    known = usual >= EXPECTED
    unknown = np.cumsum(~known)  # between two rests so little is read that nothing is left out
    places = np.flatnonzero(known & ~seldom)
    apart = np.diff(places)[np.diff(unknown[places]) == 0]
    if off < MANY * len(every) or times[odd].sum() < RARE * off and _even(apart):
        return 0.0
    return _poisson(times, usual, odd)


def _of_low_bits(every, noise, held):
    """Nats of uneven_nats() by the low bits of every (n,) alone, which noise of as many codes has
    all alike: each of them is read often where a single code is not yet. Steps that no power of
    two is a multiple of, as of a file in other counts than the chip's, are no matter of bits: then
    how often each code is read has a line in its spectrum that is none of the bits', and as
    high."""
    apart = np.diff(np.unique(every))
    every = every[np.abs(every) > held]
    number = 1 << min(noise.bit_length() - 1, LOW_BITS)
    times = np.bincount(every & (number - 1), minlength=number).astype(float)
    usual = np.full(number, len(every) / number)
    seldom = times <= RARE * usual
    places = np.flatnonzero(~seldom)
    if usual[0] < EXPECTED or usual[seldom].sum() < MANY * len(every) or _even(
            np.diff(places, append=places[0] + number)) or _even(apart[apart <= REACH * noise]):
        return 0.0
    codes_read = np.bincount(every - every.min())
    lines = FINER * (len(codes_read) // number + 1)  # from one multiple of 1 / number to the next
    spectrum = np.abs(fft.rfft(codes_read, lines * number))
    spectrum[:lines] = 0.0
    slowest = int(np.argmax(spectrum >= (1.0 - RARE) * spectrum.max()))
    # A rest of a few hundred codes makes each line wider than all codes that are read would.
    slowest += int(np.argmax(spectrum[slowest:slowest + lines // FLANK]))
    return 0.0 if slowest % lines else _poisson(times, usual, seldom)


def _of_runs(every, noise, held):
    """Nats of uneven_nats() by runs of two low bits and more that every (n,) never reads, by those
    around: what scales readings leaves single codes out, and in no power of two."""
    codes_read, most = np.arange(every.min(), every.max() + 1), 1 << LOW_BITS
    times = np.bincount(every - codes_read[0]).astype(float)
    usual = (np.abs(codes_read) > held) * ndimage.median_filter(
        times, 2 * min(int(noise), MOST_AROUND) + 1, mode="constant")
    read, asked = (np.bincount(codes_read & (most - 1), np.where(usual > 0.0, number, 0.0), most)
                   for number in (times, usual))
    scores = [0.0]
    for bits in range(2, LOW_BITS + 1):
        have, want = (number.reshape(-1, 1 << bits).sum(axis=0) for number in (read, asked))
        seldom = (want >= EXPECTED) & (have <= RARE * want)
        seldom &= np.roll(seldom, 1) | np.roll(seldom, -1)
        scores.append(_poisson(have, want, seldom) - math.log(LOW_BITS))
    return max(scores)


def _poisson(times, usual, odd):
    """Nats of how often the odd codes are read, over the usual."""
    nats = special.xlogy(times, times / np.maximum(usual, 1.0)) - (times - usual)
    return float(nats[odd].sum()) - math.log(len(times))


def _commonest(times, reach):
    """(n,) the rarer of how often the commonest code is read of `reach` before each, and of those
    after it."""
    before, after = (ndimage.maximum_filter1d(times, reach, mode="constant", origin=shift)
                     for shift in ((reach - 1) // 2, -(reach // 2)))
    return np.minimum(np.append(0.0, before[:-1]), np.append(after[1:], 0.0))


def _even(apart):
    """True when codes lie one step apart, but for what whole numbers make of it and for a RARE
    part of the way; apart (n,): from each to the next, where all between are known."""
    return not len(apart) or max(
        apart[(apart == step) | (apart == step + 1)].sum() for step in set(apart.tolist())
    ) >= (1.0 - RARE) * apart.sum()


def uneven(sessions, findings, stuck):
    """(findings that stay, [(sensor, axis letter, nats)] whose codes are uneven) of Sessions;
    stuck: sensors with a bit that is, which leaves codes out."""
    odd = _uneven(sessions, findings, stuck)
    return [f for f in (_full_grids(f, odd) for f in findings) if f], odd


def _uneven(sessions, findings, stuck):
    """Axes whose codes at rest, counted in the steps that were found, are by far not as frequent
    as those around them."""
    uneven = []
    sizes = {(f.effect, f.sensor, axis): f.value[axis] for f in findings
             if f.effect in ("quantisation", "dead_band") for axis in f.axes}
    for sensor in (kind for kind in SENSORS if kind not in stuck):
        read = [s for s in of_counts(sessions, sensor)
                if getattr(s.capture, sensor) is not None]
        for k, axis in enumerate("xyz"):
            step = sizes.get(("quantisation", sensor, axis), 1)
            band = sizes.get(("dead_band", sensor, axis), 0)
            rests = []
            for session in read:
                column = getattr(session.capture, sensor)[:, k].astype(np.int32)
                about = resting(column) if band else 0
                rests += [(column[run.first:run.end] - about) // step for run in session.runs]
            nats = uneven_nats(rests, 1 + band // step)
            if present(nats):
                uneven.append((sensor, axis, nats))
    return uneven


def _full_grids(finding, uneven):
    """The Finding without axes whose codes are `uneven`: steps that are not all there are none,
    codes that are missing near 0 as elsewhere are no dead band, and where a sensor leaves codes
    out many peaks end at one below its rail, and many low bytes are that of the sample before.
    None where none is left."""
    odd = odd_axes(finding, uneven)
    if any(sensor == finding.sensor for sensor, *_ in uneven):
        if finding.effect == "torn_reads":
            return None
        if finding.effect == "saturation":
            odd = {axis for axis, limit in finding.limits.items() if limit != RANGE}
    if finding.effect not in ("quantisation", "dead_band", "saturation") or not odd:
        return finding
    axes = [axis for axis in finding.axes if axis not in odd]
    return replace(finding, axes=axes, place=None, **{
        name: {a: size for a, size in getattr(finding, name).items() if a in axes}
        for name in ("value", "interval", "limits", "levels")},
        **{name: getattr(finding, name) * len(axes) / len(finding.axes)
           for name in ("score", "number")}) if axes else None


def resting(column):
    """The code that a column (n,) of whole numbers reads whenever it would read one near it, where
    there is one: it is read far more often than any other. 0 where there is none."""
    values, times = np.unique(column, return_counts=True)
    others = np.partition(times, -2)[-2] if len(times) > 1 else 0
    k = int(times.argmax())
    held = times[k] > ALONE * max(others, SELDOM * len(column)) and abs(values[k]) < RAIL - 1
    return int(values[k]) if held else 0
