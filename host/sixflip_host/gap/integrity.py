"""Stage 0: what the registers and the clock tell without statistics of rests.

Steps (common divisor), dead band, torn reads, rails, clipped peaks, repeated and dropped
samples, the true rate, axes swapped or inverted, a full scale that is off by two or four.
"""
import itertools
import math

import numpy as np
from scipy import stats

from sixflip import faces

from .finding import Finding

FEWEST_VALUES = 12  # distinct counts before a common divisor means anything
RAIL = 32767
RATE_OFF, JITTER_SHARE, MISSING, SPAN = 1e-3, 1.5, 0.7, 20
TORN_P, SPIKE = 2e-4, 4.2  # standard deviations at which a sample stands out
CALM = 8.0  # standard deviations that the neighbours of a sample at rest may span
FEWEST_DROPS, FEWEST_TORN, FEWEST_RAILED = 2, 3, 1
CLEAR = 0.7  # share of gravity that an axis must carry to be called swapped
FEWEST_SAMPLES = 50
CERTAIN = 99.0  # nats written where chance is out of the question


def findings(sessions):
    """list of Finding over all sessions."""
    found = []
    for sensor in ("accel", "gyro"):
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None for c in columns):
            continue
        found += _per_axis("quantisation", sensor, [steps(c) for c in columns],
                           "counts come in steps", "amplitude")
        found += _per_axis("dead_band", sensor, [_dead_band(c) for c in columns],
                           "counts near 0 read 0", "amplitude")
        found += _saturation(sessions, sensor, columns)
        found += _torn(sessions, sensor, columns)
    return found + _rate(sessions) + _drops(sessions) + _swapped(sessions)


def _per_axis(effect, sensor, sizes, words, domain):
    """One Finding of what all sessions agree on, axis by axis (3,) in counts; 0 is nothing."""
    least = np.min(sizes, axis=0)
    axes = [i for i in range(3) if least[i] > 1]
    if not axes:
        return []
    value = {"xyz"[i]: int(least[i]) for i in axes}
    return [Finding(effect, sensor, ["xyz"[i] for i in axes], value, "counts", CERTAIN, domain,
                    words, {k: (v, v) for k, v in value.items()})]


def steps(counts):
    """(3,) greatest common divisor of the counts' distances; 1 where too few values differ."""
    out = []
    for column in counts.T:
        values = np.unique(column).astype(np.int64)
        values = values[np.abs(values) < RAIL]  # a rail need not lie on a step
        out.append(int(np.gcd.reduce(np.diff(values))) if len(values) >= FEWEST_VALUES else 1)
    return np.array(out)


def _dead_band(counts):
    """(3,) smallest count that is not 0, where many more near 0 were to be expected."""
    out = []
    for column in counts.T:
        step = max(1, steps(column[:, None])[0])
        small = np.abs(column.astype(np.int64))
        zeros, others = int((small == 0).sum()), small[small > 0]
        least = int(others.min()) if len(others) else 0
        near = int((others < 2 * least).sum()) if least else 0
        expected = near * (least / step - 1.0) / max(least / step, 1.0)
        out.append(least if zeros > 20 and least > 2 * step and expected > 40 else 0)
    return np.array(out)


def _range_rail(session, sensor):
    """Count of the rail of the range the header states (accel_range_g, gyro_range_dps)."""
    meta = session.capture.meta
    top, lsb = (("accel_range_g", "accel_lsb_per_g") if sensor == "accel"
                else ("gyro_range_dps", "gyro_lsb_per_dps"))
    if top not in meta:
        return RAIL - 3
    return min(RAIL - 3, int(meta[top] * meta[lsb]) - 4)


def _saturation(sessions, sensor, columns):
    """Samples on a rail, or many that share the largest value and none near it."""
    value, words = {}, ""
    for i in range(3):
        for session, counts in zip(sessions, columns):
            size = np.abs(counts[:, i].astype(np.int64))
            rail = _range_rail(session, sensor)
            on_rail = int((size >= rail).sum())
            if on_rail >= FEWEST_RAILED:
                value["xyz"[i]] = 1
                words = "%d samples sit on the rail" % on_rail
            elif _plateau(counts[:, i]):
                value["xyz"[i]] = 1
                words = "peaks are cut off at %d counts" % int(size.max())
    if not value:
        return []
    return [Finding("saturation", sensor, sorted(value), value, "1", CERTAIN, "amplitude", words,
                    {k: (v, v) for k, v in value.items()})]


def railed(session, sensor="accel"):
    """(n,) True where a sample sits on a rail or on a level that peaks are cut off at."""
    counts = getattr(session.capture, sensor)
    rail = _range_rail(session, sensor)
    found = np.zeros(len(counts), bool)
    for column in counts.T.astype(np.int64):
        found |= np.abs(column) >= rail
        for sign in (1, -1):
            if _cut_off(sign * column):
                found |= sign * column == (sign * column).max()
    return found


def _plateau(column):
    """True when the peaks of either sign are cut off."""
    x = column.astype(np.int64)
    return _cut_off(x) or _cut_off(-x)


def _cut_off(x):
    """True when the largest value is met in runs, and hardly anything lies just inside."""
    top = x.max()
    at = x == top
    if at.all() or np.median(np.abs(np.diff(x[~at]))) == 0:
        return False  # rounded so coarsely that any rest looks cut off
    spread = max(4.0, 3.0 * steps(x[:, None])[0], 0.02 * float(np.ptp(x)))
    inside = ((x < top) & (x > top - spread)).sum()
    runs = int((at[1:] & at[:-1]).sum())
    return bool(at.sum() >= 12 and runs >= 6 and at.sum() > 3 * inside
                and (~at).sum() > at.sum())


def _torn(sessions, sensor, columns):
    """Single samples off by 256 m whose high byte is a neighbour's: half of all other spikes
    at most would be so placed."""
    found = [torn_in(column) for counts in columns if len(counts) >= 20
             for column in counts.T.astype(np.int64)]
    chances = sum(int((np.diff(column // 256) != 0).sum()) for counts in columns
                  for column in counts.T.astype(np.int64))
    near = sum(f[0] for f in found)
    torn = max((sum(f[k] for f in found) for k in (1, 2)), default=0)
    if torn < FEWEST_TORN:
        return []
    p = stats.binom.sf(torn - 1, near, 0.5)
    if p > TORN_P or torn < 0.5 * near:
        return []
    share = 100.0 * torn / max(chances, torn)
    return [Finding("torn_reads", sensor, [], {"chance": round(share, 3)}, "%",
                    min(CERTAIN, -math.log(max(p, 1e-300))), "noise",
                    "%d samples mix the bytes of two readings" % torn)]


def torn_in(column):
    """(samples off by about 256 m, those with the page of the sample before, of the one after).

    A sample is held against the median of three on either side where these agree, against a
    cubic through two on either side where they do not; where noise alone reaches half of 256
    nothing can be said.
    """
    x = column[3:-3]
    around = np.lib.stride_tricks.sliding_window_view(column, 7)[:, [0, 1, 2, 4, 5, 6]]
    calm = np.ptp(around, axis=1) < CALM * _spread(np.diff(column))
    near = np.zeros(len(x), bool)
    for mask, level in ((calm, np.median(around, axis=1)),
                        (~calm, (4.0 * (around[:, 2] + around[:, 3]) - around[:, 1]
                                 - around[:, 4]) / 6.0)):
        jump = (x - level)[mask]
        sigma = max(_spread(jump), 1.0) if len(jump) > 50 else np.inf
        if SPIKE * sigma > 250.0:
            continue
        times = np.rint(np.abs(jump) / 256.0)
        near[mask] = (np.abs(jump) > SPIKE * sigma) & (times >= 1) & (times <= 16) & (
            np.abs(np.abs(jump) - 256.0 * times) < 2.5 * sigma)
    page = column // 256
    before, after = page[2:-4] == page[3:-3], page[4:-2] == page[3:-3]
    return int(near.sum()), int((near & before).sum()), int((near & after).sum())


def _spread(values):
    """Standard deviation by the median, blind to a few outliers."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values)))) + 1e-9


def period(session):
    """(usual time between two samples in us, its scatter over spans): the median over spans
    of SPAN samples, so that rounded or jittering timestamps do not matter."""
    t = session.capture.t_us
    spans = (t[SPAN:] - t[:-SPAN]) / float(SPAN)
    return float(np.median(spans)), float(1.4826 * np.median(np.abs(spans - np.median(spans))))


def _rate(sessions):
    """The clock against the header's rate_hz: span by span, and over the whole capture."""
    errors, widths = [], []
    for session in sessions:
        t = session.capture.t_us
        if len(t) < 10 * SPAN:
            return []
        usual, scatter = period(session)
        total = float(t[-1] - t[0]) / (len(t) - 1)
        if usual <= 0 or total <= 0:
            return []
        nominal = 1e6 / session.rate
        error = min((nominal / usual - 1.0, nominal / total - 1.0), key=abs)
        if (usual > nominal) != (total > nominal):
            error = 0.0
        errors.append(error)
        widths.append((scatter + 1.0) / usual / math.sqrt(len(t) / SPAN))
    worst = min(abs(e) / (RATE_OFF + 5.0 * s) for e, s in zip(errors, widths))
    if worst < 1.0 or len({e > 0 for e in errors}) > 1:
        return []
    percent = 100.0 * float(np.mean(errors))
    half = 100.0 * max(float(np.ptp(errors)) / 2, 2.0 * max(widths), 1e-4)
    return [Finding("sample_rate", "device", [], {"rate": round(percent, 4)}, "%", CERTAIN,
                    "timing", "the samples come at %.2f Hz, not %g" % (
                        sessions[0].rate * (1 + percent / 100.0), sessions[0].rate),
                    {"rate": (percent - half, percent + half)})]


def _drops(sessions):
    """Gaps that hide samples: wide, and not made up for by the samples around them."""
    lost = rows = 0
    longest = 0.0
    for session in sessions:
        t = session.capture.t_us.astype(float)
        if len(t) < 10 * SPAN:
            continue
        usual, _ = period(session)
        if usual <= 0:
            return []
        gaps = np.diff(t)
        wide = np.flatnonzero(gaps > JITTER_SHARE * usual)
        before = np.maximum(wide - SPAN // 2, 0)
        after = np.minimum(wide + 1 + SPAN // 2, len(t) - 1)
        late = (t[after] - t[before]) / usual - (after - before)
        real = np.minimum(late, gaps[wide] / usual - 1.0) > MISSING
        lost += int(np.rint(gaps[wide][real] / usual - 1.0).sum())
        rows += len(t)
        longest = max(longest, float(gaps[wide][real].max()) / 1e3 if real.any() else 0.0)
    if lost < FEWEST_DROPS:
        return []
    chance = 100.0 * lost / (rows + lost)
    half = 100.0 * 1.645 * math.sqrt(lost) / (rows + lost)
    return [Finding("dropped_samples", "device", [], {"chance": round(chance, 4)}, "%", CERTAIN,
                    "timing", "%d samples are missing, the longest gap lasts %.0f ms"
                    % (lost, longest), {"chance": (max(0.0, chance - half), chance + half)})]


LOW_BITS = 6  # bits that noise and motion must have moved
MOVED = 4  # times a bit's weight that a column must span to have moved it


def stuck_bits(sessions):
    """[(sensor, axis, bit, value)] of single low bits that never change while those around
    them do (bits stuck from the lowest on are steps, see quantisation)."""
    found = []
    for sensor in ("accel", "gyro"):
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        for i in range(3):
            x = np.concatenate([getattr(s.capture, sensor)[:, i] for s in sessions]).astype(
                np.int64)
            if len(x) < FEWEST_SAMPLES:
                continue
            ever, always = np.bitwise_or.reduce(x), np.bitwise_and.reduce(x)
            step = max(1, steps(x[:, None])[0])
            for bit in range(LOW_BITS):
                weight = 1 << bit
                fixed = not ever & weight or bool(always & weight)
                if fixed and step < 2 * weight and np.ptp(x) > MOVED * weight * 2:
                    found.append((sensor, "xyz"[i], bit, int(bool(always & weight))))
    return found


def stuck(sessions):
    """Sentences on columns that never change."""
    out = []
    for sensor, words in (("accel", "accelerometer"), ("gyro", "gyro")):
        columns = [getattr(s.capture, sensor) for s in sessions]
        if any(c is None for c in columns):
            continue
        for i in range(3):
            if any(len(c) >= FEWEST_SAMPLES and np.ptp(c[:, i].astype(int)) == 0
                   for c in columns):
                out.append("the %s axis of the %s never changes: it is stuck" % ("xyz"[i], words))
    return out


def _swapped(sessions):
    """Accelerometer axes against the labels of the faces."""
    means, axes = [], []
    for session in sessions:
        if not session.labelled:
            continue
        for code, first, end in session.runs:
            face = faces.face_of_code(code)
            if face >= 0:
                means.append(session.capture.accel[first:end].mean(axis=0)
                             / session.capture.meta["accel_lsb_per_g"])
                axes.append([faces.SIGN[face] * (k == faces.AXIS[face]) for k in range(3)])
    if len(means) < 4 or np.linalg.matrix_rank(np.array(axes)) < 3:
        return []
    matrix = np.linalg.lstsq(np.hstack([axes, np.ones((len(axes), 1))]), np.array(means),
                             rcond=None)[0][:3].T  # measured = matrix · true
    best = nearest_permutation(matrix)
    if (best == np.eye(3)).all() or (np.abs(matrix) * np.abs(best)).sum(axis=1).min() < CLEAR:
        return []
    value = {}
    for i in range(3):
        source = int(np.abs(best[i]).argmax())
        signed = int(best[i, source]) * (source + 1)
        if signed != i + 1:
            value["xyz"[i]] = signed
    return [Finding("axis_swap", "accel", sorted(value), value, "axis", CERTAIN, "orientation",
                    "axes are swapped or inverted against the labels",
                    {k: (v, v) for k, v in value.items()})]


def nearest_permutation(matrix):
    """The signed permutation (3, 3) nearest to a matrix."""
    best = None
    for order in itertools.permutations(range(3)):
        total = sum(abs(matrix[i, order[i]]) for i in range(3))
        if best is None or total > best[0]:
            signed = np.zeros((3, 3))
            for i in range(3):
                signed[i, order[i]] = np.sign(matrix[i, order[i]]) or 1.0
            best = total, signed
    return best[1]


def full_scale(sessions, nominal):
    """A sentence when the readings are off by a factor of two or four, else ""."""
    size = float(np.median([1.0 / np.cbrt(abs(np.linalg.det(m.matrix))) for m in nominal]))
    for factor in (0.25, 0.5, 2.0, 4.0):
        if abs(size / factor - 1.0) < 0.1:
            return ("the accelerometer reads %g times gravity: its full scale is not the one the "
                    "header states" % factor)
    return ""
