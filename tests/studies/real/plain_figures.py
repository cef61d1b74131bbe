"""Figures computed from a recording's samples with numpy and scipy alone: rests, regressions,
spectra, steps, rails, gaps. Nothing of the product is used here.

A standard error of a regression over the blocks of a rest is the ordinary one times
sqrt((1 + r) / (1 - r)), r the correlation of neighbouring residuals [Bartlett, JRSS 98 (1935)
536]: sensors wander by themselves, and that is not five standard errors of anything.
"""
from dataclasses import dataclass

import numpy as np
from scipy import signal, stats
from scipy.spatial.transform import Rotation

WINDOW_S, STILL_TIMES, STILL_MG = 0.4, 2.5, 40.0
CREEPS_MG, CREEPS_DPS = 3.0, 0.2  # from window to window, which no motion is as slow as
BLOCKS = 60
TAUS = (0.05, 0.1, 0.2, 0.4)  # of the rest's length: decays that are tried
LINE_P, LINE_SHARE = 1e-8, 0.3  # chance, and amplitude over the noise's standard deviation


def rests(plain, least_s=5.0):
    """[(first, end)] of stretches whose scatter is that of the quietest, the longest first."""
    m = max(8, int(WINDOW_S * plain.rate))
    k = len(plain.t) // m
    columns = [plain.accel] + ([plain.gyro] if plain.gyro is not None else [])
    still = np.ones(k, bool)
    for values in columns:
        parts = values[:k * m].reshape(k, m, 3)
        scatter = signal.detrend(parts, axis=1).std(axis=1)
        quiet = np.maximum(np.quantile(scatter, 0.1, axis=0), 1e-9)
        creeps = CREEPS_MG if values is plain.accel else CREEPS_DPS
        still &= (scatter < np.maximum(STILL_TIMES * quiet, creeps)).all(axis=1)
        step = np.abs(np.diff(parts.mean(axis=1), axis=0, prepend=parts[:1].mean(axis=1)))
        still &= (step < np.maximum(6.0 * np.maximum(scatter, quiet), creeps)).all(axis=1)
    still &= signal.detrend(plain.accel[:k * m].reshape(k, m, 3), axis=1).std(axis=1).max(
        axis=1) < STILL_MG
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still, [0]])))
    found = [(a * m, b * m) for a, b in zip(edges[::2], edges[1::2])
             if (b - a) * m >= least_s * plain.rate]
    return sorted(found, key=lambda pair: pair[0] - pair[1])


@dataclass(frozen=True)
class Slope:
    """Of one regression: value and standard error of the regressor's coefficient, share of the
    variance of the block means that the regression takes (0..1)."""

    value: float
    error: float
    share: float

    @property
    def t(self):
        return abs(self.value) / max(self.error, 1e-300)


def means(x, number=BLOCKS):
    """(number, ...) means of equal blocks."""
    m = len(x) // number
    return x[:number * m].reshape(number, m, *x.shape[1:]).mean(axis=1)


def regression(y, columns):
    """Slope of the first of the columns, a constant beside them."""
    design = np.column_stack([*columns, np.ones(len(y))])
    found, _, rank, _ = np.linalg.lstsq(design, y, rcond=None)
    if rank < design.shape[1]:
        return Slope(0.0, np.inf, 0.0)
    left = y - design @ found
    r = min(max(np.corrcoef(left[1:], left[:-1])[0, 1], 0.0), 0.99) if left.std() > 0 else 0.0
    variance = (left ** 2).sum() / (len(y) - design.shape[1]) * np.linalg.inv(
        design.T @ design)[0, 0]
    return Slope(float(found[0]), float(np.sqrt(variance * (1 + r) / (1 - r))),
                 float(1.0 - left.var() / max(y.var(), 1e-300)))


def temperature(plain, sensor, axis, rest):
    """Slope over the temperature of a rest, or None where there is none or it stands still."""
    if plain.temp is None:
        return None
    a, b = rest
    t = means(plain.temp[a:b])
    if np.ptp(t) < 0.4:
        return None
    return regression(means(plain.of(sensor)[a:b, axis]), [t])


def cubic_share(plain, sensor, axis, rest):
    """(standard deviation of block means, the same after a cubic in temperature)."""
    a, b = rest
    t, y = means(plain.temp[a:b]), means(plain.of(sensor)[a:b, axis])
    t = (t - t.mean()) / max(np.ptp(t), 1e-9)
    design = np.vander(t, 4)
    left = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
    return float(y.std()), float(left.std())


def temperature_rate(plain, sensor, axis, rest):
    """Slope over the rate of the temperature, per degC/min, of a rest, a cubic in the temperature
    beside it: of what changes from block to block, since a sensor wanders."""
    a, b = rest
    t, y = means(plain.temp[a:b], 100), means(plain.of(sensor)[a:b, axis], 100)
    rate = 60.0 * np.gradient(t, means(plain.t[a:b], 100))
    u = (t - t.mean()) / max(np.ptp(t), 1e-9)
    return regression(np.diff(y), [np.diff(x) for x in (rate, u, u ** 2, u ** 3)])


def between_files(recordings, sensor, axis):
    """Slope over the temperature from file to file, of the longest rest of each; its error by
    what the blocks within the files leave, and by one degree of freedom at least."""
    t, y = [], []
    for one in recordings:
        a, b = rests(one)[0]
        t.append(one.temp[a:b].mean())
        y.append(one.of(sensor)[a:b, axis].mean())
    t, y = np.array(t), np.array(y)
    slope, offset = np.polyfit(t, y, 1)
    left = y - slope * t - offset
    sigma = np.sqrt((left ** 2).sum() / max(len(t) - 2, 1))
    return Slope(float(slope), float(sigma / np.sqrt(((t - t.mean()) ** 2).sum())),
                 float(1.0 - left.var() / max(y.var(), 1e-300)))


def gravity(plain, stretches):
    """|a| in g of the longest rest; where nothing rests, the median of the samples."""
    if not stretches:
        return float(np.median(np.linalg.norm(plain.accel, axis=1))) / 1000.0
    a, b = stretches[0]
    return float(np.linalg.norm(plain.accel[a:b].mean(axis=0))) / 1000.0


def noise(plain, sensor, stretches):
    """Counts (3,): standard deviation of neighbouring samples, in the longest rest."""
    a, b = stretches[0] if stretches else (0, len(plain.t))
    return np.diff(plain.counts[sensor][a:b], axis=0).std(axis=0) / np.sqrt(2.0)


def in_time(plain, sensor, axis, rest):
    """The strongest Slope over time or one of the decays of a rest."""
    a, b = rest
    y, u = means(plain.of(sensor)[a:b, axis]), (np.arange(BLOCKS) + 0.5) / BLOCKS
    tried = [regression(y, [u])] + [regression(y, [np.exp(-u / tau)]) for tau in TAUS]
    return max(tried, key=lambda one: one.t)


def wander(plain, sensor, axis, rest):
    """Allan deviation at a twelfth of the rest over that of white noise of the same sensor."""
    a, b = rest
    y = means(plain.of(sensor)[a:b, axis], 12)
    # blocks of a fourth of a second: what a filter smooths is still white to them
    number = int(min((plain.t[b - 1] - plain.t[a]) * 4, b - a))
    fine = means(plain.of(sensor)[a:b, axis], max(24, number))
    white = np.diff(fine).std() / np.sqrt(2.0) * np.sqrt(12.0 / len(fine))
    return float(np.sqrt(0.5 * np.mean(np.diff(y) ** 2)) / max(white, 1e-300))


def line_at(plain, sensor, axis, hertz, stretches):
    """(p of the largest bin within 2 / T of a frequency, its frequency, how often the mean power
    within a tenth of it is that of its neighbourhood) of the periodogram averaged over equal
    parts of all stretches, 5 s long or 2 s where there are few."""
    for seconds in (5.0, 2.0):
        n = int(seconds * plain.rate)
        parts = [signal.detrend(plain.of(sensor)[k:k + n, axis]) for a, b in stretches
                 for k in range(a, b - n + 1, n)]
        if len(parts) >= 4:
            break
    if not parts:
        return 1.0, 0.0, 0.0
    power = np.abs(np.fft.rfft(np.array(parts) * np.hanning(n), axis=1)) ** 2
    power = (power / np.median(power[:, 2:], axis=1)[:, None]).mean(axis=0)
    k, frequency = int(round(hertz / plain.rate * n)), np.fft.rfftfreq(n, 1.0 / plain.rate)
    near = np.arange(max(1, k - 2), min(k + 3, len(power)))
    beside = np.abs(frequency / hertz - 1.0)
    around = np.median(power[(beside > 0.1) & (beside < 0.5)])
    top = near[power[near].argmax()]
    level = stats.gamma.median(len(parts)) / len(parts)
    p = len(power) * stats.gamma.sf(power[top] / around * level * len(parts), len(parts))
    return float(p), float(frequency[top]), float(power[beside < 0.1].mean() / around)


def in_phase(plain, sensor, axis, hertz, stretch):
    """Share of the power of a line in parts of 2 s that one sine over the whole stretch has, by
    least squares at the best of the frequencies near."""
    a, b = stretch
    x, t = signal.detrend(plain.of(sensor)[a:b, axis]), np.arange(b - a) / plain.rate

    def power(x, t, f):
        design = np.stack([np.sin(2 * np.pi * f * t), np.cos(2 * np.pi * f * t)], 1)
        return float((np.linalg.lstsq(design, x, rcond=None)[0] ** 2).sum())
    n, span = int(2.0 * plain.rate), (b - a) / plain.rate
    tried = hertz + np.arange(-2.0, 2.01, 0.25) / span
    parts = [max(power(x[k:k + n], t[k:k + n], f) for f in hertz + np.array([-0.2, 0.0, 0.2]))
             for k in range(0, b - a - n + 1, n)]
    return max(power(x, t, f) for f in tried) / max(np.mean(parts), 1e-300)


def lines(plain, sensor, axis, rest, lowest=0.7):
    """[(Hz, amplitude, p)] of sines in a rest: the peak over the running median, improbable as
    the largest of all bins; as narrow as a sine is, or it is a resonance."""
    a, b = rest
    x = signal.detrend(plain.of(sensor)[a:b, axis])
    n, window = len(x), np.hanning(len(x))
    if n < 256:
        return []
    power = np.abs(np.fft.rfft(x * window)) ** 2 / (window ** 2).sum()
    first = int(lowest * n / plain.rate) + 2
    band = power[first:-1]
    width = max(31, len(band) // 20) | 1
    floor = signal.medfilt(band, width if width <= len(band) else len(band) // 2 * 2 - 1)
    ratio = band / np.maximum(floor / np.log(2.0), 1e-300)
    k = int(ratio.argmax())
    p = len(band) * stats.expon.sf(ratio[k])
    lobe = band[max(0, k - 2):k + 3].sum()
    around = band[max(0, k - 12):k + 13].sum()
    amplitude = np.sqrt(4.0 * lobe / n)
    if p > LINE_P or lobe < 0.8 * around or amplitude < LINE_SHARE * x.std():
        return []
    return [((first + k) * plain.rate / n, float(amplitude), float(p))]


def steps(plain, sensor, axis):
    """Greatest common divisor of the distances of the counts that occur."""
    values = np.unique(plain.counts[sensor][:, axis])
    values = values[np.abs(values) < 32767]
    return int(np.gcd.reduce(np.diff(values))) if len(values) > 12 else 1


def railed(plain, sensor, axis):
    """Samples at the ends of 16 bits."""
    return int((np.abs(plain.counts[sensor][:, axis]) >= 32764).sum())


def repeated(plain, sensor):
    """Share of samples that are the one before, on all three axes."""
    x = plain.counts[sensor]
    return float((np.diff(x, axis=0) == 0).all(axis=1).mean())


def missing(plain):
    """Samples that the recorded times leave room for: of each gap of more than 1.7 usual
    intervals what twenty intervals around it do not make up for."""
    t = plain.t
    usual = np.median((t[20:] - t[:-20]) / 20.0)
    lost = 0.0
    for k in np.flatnonzero(np.diff(t) > 1.7 * usual):
        a, b = max(0, k - 10), min(len(t) - 1, k + 11)
        late = (t[b] - t[a]) / usual - (b - a)
        if late > 0.7:
            lost += min(np.rint((t[k + 1] - t[k]) / usual) - 1.0, np.rint(late))
    return int(lost)


def shaken(plain):
    """Root mean square of third differences in the middle second over that in the quietest."""
    m = max(8, int(plain.rate))
    x = np.diff(plain.accel, n=3, axis=0)
    k = len(x) // m
    level = np.sqrt((x[:k * m].reshape(k, m, 3) ** 2).mean(axis=1))
    return np.median(level, axis=0) / np.maximum(np.quantile(level, 0.02, axis=0), 1e-9)


def near_256(plain, sensor):
    """Single samples that lie 256 m off two neighbours which agree, all axes."""
    found = 0
    for x in plain.counts[sensor].T:
        off = x[1:-1] - (x[:-2] + x[2:]) / 2.0
        sigma = 1.4826 * np.median(np.abs(off)) + 1.0
        agree = np.abs(x[2:] - x[:-2]) < 6.0 * sigma
        times = np.rint(off / 256.0)
        found += int((agree & (np.abs(times) >= 1) & (np.abs(off) > 6.0 * sigma)
                      & (np.abs(off - 256.0 * times) < 3.0 * sigma)).sum())
    return found


def g_sensitivity(plain):
    """(3, 3) deg/s a g and its standard errors: means of the rests, gyro against
    accelerometer."""
    found = rests(plain, 2.0)
    f = np.array([plain.accel[a:b].mean(axis=0) / 1000.0 for a, b in found])
    w = np.array([plain.gyro[a:b].mean(axis=0) for a, b in found])
    design = np.column_stack([f, np.ones(len(f))])
    theta = np.linalg.lstsq(design, w, rcond=None)[0]
    left = w - design @ theta
    sigma = np.sqrt((left ** 2).sum(axis=0) / max(len(f) - 4, 1))
    return theta[:3].T, np.sqrt(np.diag(np.linalg.inv(design.T @ design))[:3])[None] * \
        sigma[:, None]


def lag_ms(plain):
    """(milliseconds that the gyro is behind the accelerometer, standard error), or None.

    In each move gravity is carried by the gyro from the rest before and turned so that it ends
    at the rest behind. Where the gyro is late, what is carried is late, and what the
    accelerometer reads beside it follows the change of gravity; the hand's own acceleration does
    not, from move to move, which is what the error comes from.
    """
    stops, f, cross, square = sorted(rests(plain, 2.0)), plain.accel / 1000.0, [], []
    for (first, start), (stop, last) in zip(stops, stops[1:]):
        edge = int(0.3 * plain.rate)
        part = slice(max(start - edge, first), min(stop + edge, last))
        bias = 0.5 * (plain.gyro[first:start].mean(axis=0) + plain.gyro[stop:last].mean(axis=0))
        w = np.radians(plain.gyro[part] - bias)
        turns = Rotation.from_rotvec(0.5 * (w[:-1] + w[1:]) / plain.rate)
        whole = [Rotation.identity()]
        for one in turns:
            whole.append(whole[-1] * one)   # of the box, in the axes that it had at first
        whole = Rotation.concatenate(whole)
        means = f[first:start].mean(axis=0), f[stop:last].mean(axis=0)
        up, at_last = (v / np.linalg.norm(v) for v in means)
        end = whole[-1].apply(at_last)      # what it would have been at first
        off = np.cross(up, end)
        if not 0.3 < np.abs(w).max() or np.linalg.norm(off) > 0.3:
            continue
        angle = np.concatenate([[0.0], np.cumsum(np.linalg.norm(w[:-1], axis=1))])
        along = (angle / angle[-1])[:, None]
        carried = whole.inv().apply(Rotation.from_rotvec(off * along).apply(up))
        change = -np.cross(w, carried)
        left = f[part] - carried - (means[0] - up) * (1.0 - along) - (means[1] - at_last) * along
        cross.append(float((change * left).sum()))
        square.append(float((change ** 2).sum()))
    if len(cross) < 5:
        return None
    cross, square = np.array(cross), np.array(square)
    lag = cross.sum() / square.sum()
    error = np.sqrt(((cross - lag * square) ** 2).sum()) / square.sum()
    return 1e3 * float(lag), 1e3 * float(error)
