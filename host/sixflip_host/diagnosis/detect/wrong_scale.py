"""A full scale that is not the one the header states: gravity at rest is not 1 g, the gyro does
not turn as far as gravity does, or as far as a flip of half a circle.

Three hypotheses about one factor: a sound part, whose scale and offset err by a few percent; a
range that is off by a power of two; and any factor at all, which has no name.
"""
import math

import numpy as np

from sixflip.poses import faces

from ...capture.find_poses import NO_GRAVITY
from ...capture.imports import gravity
from .detection import Damage, present

SOUND_ACCEL = 0.1  # of |a|: ±80 mg of offset and 3 % of scale [MPU-6000 PS rev 3.4, table 6.2]
SOUND_GYRO = 0.05  # ±3 % of scale [table 6.1], and a misaligned axis
MOVING = 3.0  # times that, where a hand or wheels pull at the accelerometer, or the gyro is late
# Full scales of a chip are octaves apart, and there are up to five.
RANGES = (0.0625, 0.125, 0.25, 0.5, 2.0, 4.0, 8.0, 16.0)
# Any factor without a name lies within that and its inverse: degrees for radians (57.3), m/s2 for
# g.
WIDEST = 64.0
SMALLEST = 1e-3  # a factor that is less is that: of gravity, what is left where it is taken off
# Correlation of gravity's turning and the gyro's that tells a factor: with less a third of the
# turning is something else, which draws the factor towards 0.
ALIKE = 0.8
HAND_DEG = 12.0  # of a half turn by hand, at worst; with care 0.4 (METHOD section 2)
MOST_HALVES = 5  # half circles of a flip: a box may have been turned once or twice more
PARTS = 8  # of a recording, whose factors give the error of the whole, to a quarter


def findings(sessions):
    """[Damage] of the accelerometer, then of the gyro."""
    if any(s.capture.accel is None for s in sessions):
        return []
    damages = [accelerometer(sessions)]
    if not damages[0] and all(s.capture.gyro is not None for s in sessions):
        damages.append(gyro(sessions))
    return [damage for damage in damages if damage]


def accelerometer(sessions):
    """Damage where |a| is not gravity, or None."""
    sizes = [seen for seen in map(at_rest, sessions) if seen]
    if not sizes:
        return None
    size = float(np.median([size for size, _ in sizes]))
    width = SOUND_ACCEL * (1.0 if all(rests for _, rests in sizes) else MOVING)
    factor, nats = competed([size], [width])
    if not present(nats):
        return None
    if factor:
        words = ("the accelerometer reads %g times gravity: its full scale is not the one the "
                 "header states" % factor)
    elif size < NO_GRAVITY:
        words = ("|a| is %.2g g at rest: gravity has been taken off the accelerometer's readings, "
                 "as off a phone's linear acceleration" % size)
    else:
        words = "|a| is %.3g g at rest: the accelerometer's scale is not that of the header" % size
    return Damage("full_scale" if factor else "gravity", "accel", (), "amplitude", words, nats,
                  {"factor": round(size, 4)})


def at_rest(session):
    """(|a| in g, whether it rests) of a session, or None."""
    lsb = session.capture.meta["accel_lsb_per_g"]
    if session.runs:
        return float(np.median([np.linalg.norm(session.capture.accel[a:b].mean(axis=0))
                                for _, a, b in session.runs])) / lsb, True
    seen = gravity.seen(session.capture.accel)
    return (seen.size / lsb, seen.rests) if seen else None


def competed(factors, widths):
    """(the range that factors are off by, or None where none is likelier than any factor at all;
    nats of one of both over 1). factors, widths (n,): relative standard deviations."""
    factors, widths = np.maximum(factors, SMALLEST), np.array(widths)

    def log_density(times):
        return -float((0.5 * ((factors / times - 1.0) / widths) ** 2
                       + np.log(widths * times)).sum())
    sound = log_density(1.0)
    ranges = {times: log_density(times) - math.log(len(RANGES)) for times in RANGES}
    best = max(ranges, key=ranges.get)
    middle = float(np.average(factors, weights=1.0 / widths ** 2))
    narrow = math.log(math.sqrt(2.0 * math.pi) / math.sqrt(float((1.0 / widths ** 2).sum()))
                      / (2.0 * math.log(WIDEST)))
    nameless = log_density(middle) + narrow
    if max(ranges[best], nameless) <= sound:
        return None, 0.0
    if ranges[best] > nameless:
        return best, ranges[best] - sound
    return None, nameless - sound


def gyro(sessions):
    """Damage where the gyro turns farther or less far than gravity and flips do, or None."""
    factors, widths = [], []
    for session in sessions:
        for factor, width in (*_by_gravity(session), *_by_flips(session)):
            factors.append(factor)
            widths.append(width)
    if not factors:
        return None
    factor, nats = competed(factors, widths)
    if not present(nats):
        return None
    size = float(np.average(factors, weights=1.0 / np.square(widths)))
    words = "the gyro turns %.3g times as far as %s" % (
        size, "gravity and half a circle tell: its full scale is not the one the header states"
        if factor else "gravity tells: its scale is not that of the header")
    return Damage("full_scale", "gyro", (), "amplitude", words, nats, {"factor": round(size, 4)})


def _by_gravity(session):
    """[(factor, relative width)] by which the gyro reads more than gravity turns."""
    meta, capture = session.capture.meta, session.capture
    known = 1.0 / meta["gyro_lsb_per_dps"]
    whole = gravity.turn_factor(capture.accel, capture.gyro, known, session.rate)
    if whole is None or whole[1] < ALIKE or whole[0] <= 0.0:
        return []
    m, parts = len(capture.accel) // PARTS, []
    for k in range(PARTS):
        part = gravity.turn_factor(capture.accel[k * m:(k + 1) * m],
                                   capture.gyro[k * m:(k + 1) * m], known, session.rate)
        if part is not None and part[1] >= ALIKE and part[0] > 0.0:
            parts.append(1.0 / part[0])
    size = float(np.median(parts)) if parts else 1.0 / whole[0]
    spread = float(np.std(parts)) / size / math.sqrt(len(parts)) if len(parts) > 2 else 0.0
    return [(size, math.hypot(MOVING * SOUND_GYRO, spread))]


def _by_flips(session):
    """[(factor, relative width)] of half turns about a face's axis that labels tell; with whole
    circles more they are an odd number of halves, which no range makes of one."""
    factors, capture = [], session.capture
    if not session.labelled:
        return []
    rates = capture.gyro / capture.meta["gyro_lsb_per_dps"]
    for before, after in zip(session.runs, session.runs[1:]):
        face = faces.face_of_code(before.code)
        if face < 0 or face != faces.face_of_code(after.code) or before.code == after.code:
            continue
        bias = 0.5 * (rates[before.first:before.end].mean(axis=0)
                      + rates[after.first:after.end].mean(axis=0))
        middle = slice((before.first + before.end) // 2, (after.first + after.end) // 2)
        turned = np.trapezoid((rates[middle] - bias)[:, faces.AXIS[face]], session.t_s[middle])
        factors.append(_factor(abs(float(turned))))
    return factors


def _factor(turned):
    """(factor, relative width) of a flip in which the gyro turned by so many degrees: by the odd
    number of half circles that it comes near to, or else of one."""
    for halves in range(1, MOST_HALVES + 1, 2):
        factor, width = (turned / (180.0 * halves),
                         math.hypot(SOUND_GYRO, HAND_DEG / (180.0 * halves)))
        if abs(factor - 1.0) < 2.0 * width:
            return factor, width
    return turned / 180.0, math.hypot(SOUND_GYRO, HAND_DEG / 180.0)
