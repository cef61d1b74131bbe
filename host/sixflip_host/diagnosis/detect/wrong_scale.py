"""A full scale that is not the one the header states: gravity at rest is not 1 g, the gyro does
not turn as far as gravity does, or as far as a flip of half a circle.

Three hypotheses about one factor: a sound part, whose scale and offset err by a few percent; a
range that is off by a power of two; and any factor at all, which has no name. That a gyro is in
rad/s where the header says deg/s shows as it does at import.
"""
import math

import numpy as np

from sixflip.poses import faces

from ...capture import attitude
from ...capture.find_poses import NO_GRAVITY
from ...capture.imports import gravity, gyro_unit
from . import saturation
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
# Pauses: their length, g of noise within one, share of the fastest turning, which 2 % of all
# windows have; s of a move; cosine of 20 deg that gravity turns; usual steps that a hole is.
PAUSE_S, PAUSE_G, PAUSED, FASTEST = 0.5, 0.03, 0.05, 0.98
LONGEST_S, TURNED, HOLE = 30.0, math.cos(math.radians(20.0)), 5.0
# Moves that tell a factor, of which each half does so again, and are enough; rad by which a sound
# gyro misses (2 deg in public logs), and chance that a move is none that it follows.
FEWEST_MOVES, MOST_MOVES, PLACED, KNOCKED = 4, 40, 0.05, 0.1
TRIED = np.linspace(-3.0, 3.0, 121)  # logarithms of factors: 20 and its inverse, 5 % apart
TURNS_HZ = 50.0  # of the turns that are multiplied: a hand's are slower by far
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
    size, moving = float(np.median([size for size, _ in sizes])), not any(s.runs for s in sessions)
    width = SOUND_ACCEL * (1.0 if all(rests for _, rests in sizes) else MOVING)
    factor, nats = competed([size], [width])
    if not present(nats) or not factor and moving and size > NO_GRAVITY and (
            gravity.may_be_thrust(size, min(s.t_s[-1] - s.t_s[0] for s in sessions))):
        return None
    if factor:
        words = ("the accelerometer reads %g times gravity: its full scale is not the one the "
                 "header states" % factor)
    elif size < NO_GRAVITY:
        words = ("|a| is %.2g g at rest: gravity has been taken off the accelerometer's readings, "
                 "as off a phone's linear acceleration" % size)
    else:
        words = "|a| is %.3g g%s: the accelerometer's scale is not that of the header" % (
            size, "" if moving else " at rest")
    return Damage("full_scale" if factor else "gravity", "accel", (), "amplitude", words, nats,
                  {"factor": round(size, 4)})


def at_rest(session):
    """(|a| in g, whether it rests) of a session, or None."""
    lsb = session.capture.meta["accel_lsb_per_g"]
    if session.runs:
        return float(np.median([np.linalg.norm(session.capture.accel[a:b].mean(axis=0))
                                for _, a, b in session.runs])) / lsb, True
    seen = gravity.seen(session.capture.accel, (lsb,))
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
    factor, nats = competed(factors, widths) if factors else (None, 0.0)
    if not present(nats):
        nats, words = gyro_unit.of_captures([s.capture for s in sessions])
        return Damage("full_scale", "gyro", (), "amplitude", words, nats, {
            "factor": round(math.radians(1.0), 4)}) if present(nats) else None
    size = float(np.average(factors, weights=1.0 / np.square(widths)))
    words = "the gyro turns %.3g times as far as %s" % (
        size, "gravity and half a circle tell: its full scale is not the one the header states"
        if factor else "gravity tells: its scale is not that of the header")
    return Damage("full_scale", "gyro", (), "amplitude", words, nats, {"factor": round(size, 4)})


def _by_gravity(session):
    """[(factor, relative width)] by which the gyro reads more than gravity turns from one pause to
    the next, where nothing moves the sensor, or else while it moves."""
    moves = _between_pauses(session)
    left = np.array([_left(*move, np.exp(TRIED)) for move in moves])
    halves = [_of_all(moves[k::2], left[k::2]) for k in (0, 1)]
    factor = _of_all(moves, left) if len(moves) >= FEWEST_MOVES and all(halves) else None
    if factor:
        apart = math.log(halves[0] / halves[1])
        return [(factor, math.hypot(SOUND_GYRO, 0.5 * apart))]
    meta, capture = session.capture.meta, session.capture
    known = 1.0 / meta["gyro_lsb_per_dps"]
    whole = gravity.turn_about_a_point(capture.accel, capture.gyro, known, session.rate)
    if whole is None or whole.alike < ALIKE or whole.factor <= 0.0:
        return []
    m, parts = len(capture.accel) // PARTS, []
    for k in range(PARTS):
        part = gravity.turn_about_a_point(capture.accel[k * m:(k + 1) * m],
                                          capture.gyro[k * m:(k + 1) * m], known, session.rate)
        if part is not None and part.alike >= ALIKE and part.factor > 0.0:
            parts.append(1.0 / part.factor)
    size = float(np.median(parts)) if parts else 1.0 / whole.factor
    spread = float(np.std(parts)) / size / math.sqrt(len(parts)) if len(parts) > 2 else 0.0
    return [(size, math.hypot(MOVING * SOUND_GYRO, spread))]


def _between_pauses(session):
    """[(direction of gravity before, after (3,), turns (n, 3) rad by the gyro in between)] of the
    moves that turn gravity from one pause to the next, MOST_MOVES of them, evenly."""
    capture, m = session.capture, max(4, round(PAUSE_S * session.rate))
    n = len(capture.accel) // m
    a, w = (values[:n * m].reshape(n, m, 3) / capture.meta[lsb] for values, lsb in (
        (capture.accel, "accel_lsb_per_g"), (capture.gyro, "gyro_lsb_per_dps")))
    quiet = np.sqrt(a.var(axis=1).max(axis=1)) < PAUSE_G
    if n < 3 or quiet.sum() < 2:
        return []
    bias = np.median(w[quiet].mean(axis=1), axis=0)
    turning = np.sqrt(((w - bias) ** 2).sum(axis=2).mean(axis=1))
    pauses = np.flatnonzero(quiet & (turning < PAUSED * np.quantile(turning, FASTEST)))
    up = a.mean(axis=1)
    up /= np.maximum(np.linalg.norm(up, axis=1), 1e-9)[:, None]
    pairs = [(k, j) for k, j in zip(pauses, pauses[1:])
             if 1 < j - k <= LONGEST_S / PAUSE_S and up[k] @ up[j] < TURNED]
    moves, cut = [], saturation.railed(session, "gyro")
    for k, j in pairs[::-(-max(len(pairs), 1) // MOST_MOVES)]:
        first, end = k * m + m // 2, j * m + m // 2
        dt = np.diff(session.t_s[first:end + 1])
        if dt.max() > HOLE * np.median(dt) or cut[first:end].any():
            continue
        rates = capture.gyro[first:end] / capture.meta["gyro_lsb_per_dps"]
        rates = rates - 0.5 * (w[k].mean(axis=0) + w[j].mean(axis=0))
        few = np.arange(0, end - first, max(1, int(session.rate / TURNS_HZ)))
        moves.append((up[k], up[j], np.add.reduceat(np.radians(rates) * dt[:, None], few)))
    return moves


def _of_all(moves, left):
    """The factor by which the gyro's turns of all moves are too large, where that takes gravity to
    where it is after each of them; None where none does. left (moves, TRIED): _left() of each."""
    if len(moves) < FEWEST_MOVES // 2:
        return None
    best, _ = _likeliest(np.exp(TRIED), left)
    finer = best * np.exp(TRIED[::6] / 60.0)  # half a percent apart
    best, nats = _likeliest(finer, np.array([_left(*move, finer) for move in moves]))
    return 1.0 / best if present(nats) else None


def _likeliest(tried, left):
    """(the likeliest of factors (k,), its nats) by what they leave of moves (moves, k)."""
    core = 4.0 * PLACED ** 2 / (left ** 2 + PLACED ** 2) ** 2
    nats = np.log((1.0 - KNOCKED) * core + KNOCKED).sum(axis=0) - math.log(len(TRIED))
    return tried[int(nats.argmax())], nats.max()


def _left(before, after, turns, factors):
    """(k,) rad between gravity before a move and where turns (n, 3) rad times factors (k,) take it
    back to from after it."""
    way = attitude.exponential(turns[:, None] * factors[:, None])
    while len(way) > 1:  # two by two
        if len(way) % 2:
            way = np.concatenate([way, np.tile([1.0, 0.0, 0.0, 0.0], (1, len(factors), 1))])
        way = attitude.multiply(way[::2], way[1::2])
    there = attitude.matrix(way[0]) @ after
    return np.arccos(np.clip(there @ before, -1.0, 1.0))


def _by_flips(session):
    """[(factor, relative width)] of half turns about a face's axis that labels tell; with whole
    circles more they are an odd number of halves, which no range makes of one."""
    if not session.labelled:
        return []
    factors, cut = [], saturation.railed(session, "gyro")
    rates = session.capture.gyro / session.capture.meta["gyro_lsb_per_dps"]
    for before, after in zip(session.runs, session.runs[1:]):
        face = faces.face_of_code(before.code)
        same_face = face >= 0 and face == faces.face_of_code(after.code)
        if not same_face or before.code == after.code or cut[before.end:after.first].any():
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
