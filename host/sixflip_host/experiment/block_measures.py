"""Rests cut into blocks, and what is measured of each block: its means (mg, deg/s), its time and
temperature, and how noisy the sensor is in it: white noise, what rounding leaves, how loud it is.

A block is a range of samples: counts (N, 3) are those of the whole capture, first and end (n,)
say which of them each of n blocks holds.
"""
import numpy as np

from sixflip.poses import faces

from ..capture.registers import fixed_bits, steps, unit_of_count

# s left out at both ends of a rest: where it begins and ends is known to some samples only, and
# the hand may still be on the box there. Of a protocol's rest it costs one sample in 25.
EDGE_S = 0.1
# Two blocks tell what fades within a rest, of which the fastest creep (session_terms.CREEP_S, 5 s)
# needs one each half of its time. All blocks of a rest are in one matrix (covariance.Group): a
# minute's rest has no more than six, and a rest as short as a protocol's no more than two.
BLOCK_S, MOST_BLOCKS = 2.5, 6
SHORT_REST_BLOCKS = 2
LONG_REST_S = 12.0  # more than twice a protocol's rest (5 s, planning/protocols.py)
LEAST_CUT_S = 1.6  # less has no two blocks of three short means each (SUBMEAN_S): it stays whole
# s of the short means that white noise is told from. A chip's low-pass (20 Hz and more) has
# settled in a tenth of it, so that its colour is in the noise; flicker of 10 s has not moved.
SUBMEAN_S = 0.25
# Harmonics of rounding: those after the eighth hold less than a tenth of it even without noise
# (sum of 1 / k^2 from 9 on, of pi^2 / 6). A square wave's fall as slowly and are all odd.
ALL, ODD = np.arange(1, 9), np.arange(1, 200, 2)
# A block of so many times the power of the quietest tenth of the blocks is shaken: the power of
# 250 samples (2.5 s at 100 Hz) errs by 11 % (see freedom), which noise alone does not double.
QUIETEST, STANDS_OUT = 0.1, 2.0


def of_runs(capture, runs, rate, t_s, labelled, smooth):
    """{field of blocks.Session: array (n,) or (n, 3)} of the n blocks of runs (rests.Run, ...).

    rate: Hz; t_s (N,) s of every sample; labelled: whether the poses of the runs are known;
    smooth: Thermometer or None.
    """
    cut = []
    for placement, (code, first, end) in enumerate(runs):
        edge = min(int(EDGE_S * rate), (end - first) // 4)
        cut += [(placement, code, a, b) for a, b in cut_rest(first + edge, end - edge, rate)]
    placement, code, first, end = np.array(cut, dtype=np.int64).reshape(len(cut), 4).T.copy()
    t = t_s[(first + end) // 2]
    starts = np.array([t_s[run.first] for run in runs])
    # Where nobody labelled, a face is a guess, and only the length of gravity is used.
    face = np.array([faces.face_of_code(int(c)) if labelled else -1 for c in code], dtype=int)
    accel, gyro = readings(capture, first, end)
    measures = {"placement": placement, "code": code, "first": first, "end": end, "face": face,
                "t": t, "since": t - starts[placement] if len(cut) else t,
                "seconds": (end - first) / rate, "accel": accel, "gyro": gyro,
                "temperature": smooth.at(t) if smooth else None,
                "temperature_rate": smooth.rate_at(t) if smooth else None,
                "loudness": np.zeros(len(cut)) if capture.accel is None
                else loudness(capture, first, end), "noise_accel": None,
                "noise_gyro": None, "rounding_accel": None, "rounding_gyro": None}
    for sensor, counts, scale in _sensors(capture) if len(cut) else ():
        measures["noise_" + sensor] = white(counts, first, end, rate) * scale
        measures["rounding_" + sensor] = rounding(counts, first, end) * scale
    return measures


def _sensors(capture):
    """[(name, counts, mg or deg/s a count)] of the sensors that there are."""
    return [(sensor, getattr(capture, sensor), unit_of_count(capture.meta, sensor))
            for sensor in ("accel", "gyro") if getattr(capture, sensor) is not None]


def readings(capture, first, end):
    """((n, 3) mg, (n, 3) deg/s): means of the blocks; None of a sensor that there is not."""
    means = dict.fromkeys(("accel", "gyro"))
    for sensor, counts, scale in _sensors(capture):
        means[sensor] = _means(counts, first, end) * scale
    return means["accel"], means["gyro"]


def _means(counts, first, end):
    return np.array([counts[a:b].mean(axis=0) for a, b in zip(first, end)]).reshape(-1, 3)


def cut_rest(first, end, rate):
    """[(first, end)] of the blocks of a rest."""
    seconds = (end - first) / rate
    if seconds < LEAST_CUT_S:
        number = 1
    elif seconds <= LONG_REST_S:
        number = SHORT_REST_BLOCKS
    else:
        number = int(min(MOST_BLOCKS, max(SHORT_REST_BLOCKS, seconds // BLOCK_S)))
    edges = np.linspace(first, end, number + 1).astype(int)
    return list(zip(edges[:-1].tolist(), edges[1:].tolist()))


def rounding(counts, first, end):
    """(3,) counts: standard deviation of what rounding to steps leaves in the mean of a rest.

    Noise much wider than a step averages it out: the k-th harmonic of the rounding
    error, step / (pi k), is damped by exp(-2 pi^2 k^2 (noise / step)^2) [Widrow & Kollar,
    Quantization Noise (2008), chapter 5]. A bit that never changes takes a square wave of the
    value off, of twice its weight as period and as step, which has the odd harmonics only.
    """
    step = steps(counts)
    changes = np.concatenate([np.diff(counts[a:b].astype(float), axis=0)
                              for a, b in zip(first, end)])
    seen = np.sqrt(np.maximum(changes.var(axis=0) / 2.0 - step ** 2 / 12.0, 0.0))
    left = _of_mean(step, ALL, seen)
    for axis, column in enumerate(counts.T):
        waves = [2.0 ** (bit + 1) for bit, _ in fixed_bits(column.astype(np.int64))]
        if waves:
            left[axis] += _of_waves(np.array(waves), seen[axis])
    return np.sqrt(left)


def _of_waves(periods, seen):
    """Variance that square waves leave in a mean, of the standard deviation seen in samples,
    which has in it what they do not leave there: the noise is less than that."""
    from scipy import optimize  # of a stuck bit only: without it scipy takes no start-up time
    whole = (periods ** 2).sum() / 16.0

    def excess(noise):
        return noise ** 2 + whole - _of_mean(periods, ODD, noise).sum() - seen ** 2
    noise = optimize.brentq(excess, 0.0, seen) if excess(0.0) < 0.0 else 0.0
    return _of_mean(periods, ODD, noise).sum()


def _of_mean(step, orders, noise):
    """Variance in the mean of what has so much noise of these harmonics of a rounding error."""
    k = orders[:, None]
    return ((step / (np.pi * k) * np.exp(-2.0 * (np.pi * k * noise / step) ** 2)) ** 2
            ).sum(axis=0) / 2.0


def white(counts, first, end, rate):
    """(3,) counts: standard deviation of a mean over one second, from the differences of
    neighbouring short means (slow changes are not in it)."""
    m = max(1, int(SUBMEAN_S * rate))
    squares, number = np.zeros(3), 0
    for a, b in zip(first, end):
        k = (b - a) // m
        if k < 2:
            continue
        short = counts[a:a + k * m].astype(float).reshape(k, m, 3).mean(axis=1)
        squares += (np.diff(short, axis=0) ** 2).sum(axis=0)
        number += k - 1
    if not number:
        return counts[first[0]:end[0]].std(axis=0) / np.sqrt(rate)
    floor = 1.0 / np.sqrt(12.0 * rate)  # of counting: rounding is noise, too
    return np.maximum(np.sqrt(squares / number / 2.0 * m / rate), floor)


def freedom(first, end, rate):
    """Degrees of freedom with which white() knows the noise of three axes together: squares of
    differences of neighbours, of which a mean over N has a relative variance of 3 / N [von
    Neumann et al., Ann. Math. Stat. 12 (1941) 153]."""
    number = ((end - first) // max(1, int(SUBMEAN_S * rate)) - 1).clip(min=0).sum()
    return max(2.0 * float(number), 1.0)


def loudness(capture, first, end, axes=slice(None)):
    """(n,) mg rms of what changes from sample to sample in each block, all axes together; axes:
    those that are listened to."""
    return np.sqrt([np.diff(capture.accel[a:b, axes].astype(float), axis=0).var(axis=0).sum() / 2.0
                    for a, b in zip(first, end)]) * unit_of_count(capture.meta, "accel")


def vibrations(loud):
    """[(n,)] mg rms of each block of several sessions above the quietest tenth of the quietest
    one; zero where nothing stands out. loud: their loudness."""
    quiet = min((np.quantile(one ** 2, QUIETEST) for one in loud if len(one)), default=0.0)
    return [np.sqrt(np.where(one ** 2 > STANDS_OUT * quiet, one ** 2 - quiet, 0.0))
            for one in loud]
