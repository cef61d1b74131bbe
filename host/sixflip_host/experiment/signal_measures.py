"""What recordings of one sensor are compared by: white noise, Allan deviation, amplitude spectrum,
steps of the counts, the strongest line; and the levels of its noise at rest, with intervals.

x is (n, k), n samples of k channels, in any unit, which the results are in as well.

The two-sided density of a reading at rest is S(f) = N^2 + B^2 / (2 pi f) + K^2 / (2 pi f)^2
[IEEE Std 952-1997, annex C]: N the noise density (unit/sqrt(Hz)), B the bias instability, whose
Allan deviation is flat at 0.664 B, K the rate random walk. Every rest's spectrum is the mean over
a few sine tapers [Riedel & Sidorenko, IEEE Trans. Signal Processing 43 (1995) 188], which do not
leak from the walk into the white noise. The three squares are the likeliest ones that are not
negative [Whittle, J. Royal Stat. Soc. B 15 (1953) 125]; their intervals are those of the profile
of the likelihood. A line of the curve of the Allan deviation read off at one time, as is usual,
takes what the other two add there for its own.
"""
from dataclasses import dataclass

import numpy as np

MEDIAN_OF_SQUARE = 0.4549  # of a standard normal
TAPERS = 4  # eight degrees of freedom a frequency; more of them blur it
HIGHEST = 0.1  # of the sample rate: above that a chip's own filter takes noise away
# Groups of frequencies, equally spaced in their logarithm: over the four decades of half an hour
# at 100 Hz each is a sixth of an octave wide, in which not even the power of a random walk changes
# by more than a fifth.
GROUPS = 80
# Parts of the frequencies, whose medians a line is held against, and how many are in each at
# least: as many as the tapers spread a line over.
PARTS, FEWEST = 20, 2 * TAPERS + 1
LINE = 6.0  # times the median of its part: noise is as loud in one of 1.7 million frequencies
HALF_OF_90 = 1.353  # nats below the maximum at the ends of a 90 % interval: half of chi2(0.9, 1)
ROUNDS = 200  # of halved steps, which settle in 30 but where a square goes to zero


def white(x):
    """Standard deviation of what changes from sample to sample, per column of x (n, k)."""
    return np.diff(x, axis=0).std(axis=0) / np.sqrt(2.0)


def allan(x, m):
    """Allan deviation (k,) of x (n, k) over m samples, overlapping; nan when x is too short.

    Source: IEEE Std 952-1997, annex C.
    """
    if len(x) < 3 * m:
        return np.full(x.shape[1], np.nan)
    total = np.vstack([np.zeros((1, x.shape[1])), np.cumsum(x - x.mean(axis=0), axis=0)])
    second = (total[2 * m:] - 2.0 * total[m:-m] + total[:-2 * m]) / m
    return np.sqrt(0.5 * np.mean(second ** 2, axis=0))


def spectrum(x, rate_hz, length=1024):
    """(frequencies, amplitude density (f, k) in units per root Hz): Welch's, Hann windows."""
    from scipy.signal import welch
    length = min(length, len(x))
    frequencies, density = welch(x, rate_hz, nperseg=length, axis=0)
    return frequencies, np.sqrt(density)


def band(x, rate_hz, low, high):
    """Root mean square amplitude density (k,) between two frequencies."""
    frequencies, density = spectrum(x, rate_hz)
    inside = (frequencies >= low) & (frequencies < high)
    return np.sqrt(np.mean(density[inside] ** 2, axis=0))


def step(counts):
    """Greatest common divisor (k,) of all counts: the size of a step."""
    return np.gcd.reduce(np.abs(np.asarray(counts, dtype=np.int64)), axis=0)


def line(x, rate_hz, above_hz=5.0):
    """(frequency, amplitude, phase in rad at the first sample) of the strongest line in x (n,),
    the frequency refined between the bins by the least squares fit of a sine."""
    n = len(x)
    amplitude = np.abs(np.fft.rfft((x - x.mean()) * np.hanning(n)))
    frequencies = np.fft.rfftfreq(n, 1.0 / rate_hz)
    amplitude[frequencies < above_hz] = 0.0
    near = frequencies[amplitude.argmax()]
    best = max(near + np.linspace(-1.0, 1.0, 81) * rate_hz / n,
               key=lambda f: sine(x, rate_hz, f)[0])
    return (best,) + sine(x, rate_hz, best)


def sine(x, rate_hz, frequency):
    """(amplitude, phase) of the sine a·sin(2 pi f t + phase) nearest to x (n,)."""
    angle = 2.0 * np.pi * frequency * np.arange(len(x)) / rate_hz
    columns = np.stack([np.sin(angle), np.cos(angle), np.ones(len(x))], 1)
    s, c, _ = np.linalg.lstsq(columns, x, rcond=None)[0]
    return float(np.hypot(s, c)), float(np.arctan2(c, s))


def railed(counts, rail=32764):
    """Share (k,) of samples on a rail."""
    return (np.abs(np.asarray(counts, dtype=np.int64)) >= rail).mean(axis=0)


@dataclass(frozen=True)
class Level:
    """value with its 90 % interval; low is 0 where the data do not show that it is there."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Groups:
    """Mean power over groups of frequencies: f (n,) Hz, power (n,), shape (n,) of its gamma
    distribution (how many independent values are in it)."""

    f: np.ndarray
    power: np.ndarray
    shape: np.ndarray


def noise_levels(rests, rate, walks):
    """(density, flicker, walk) as Levels of the rests, a list of (n,) readings of one axis;
    walks: whether the rests are long enough to say how fast a bias walks, else that Level is None:
    what is slow in them has its share all the same, or the white noise would lose it. A rest that
    reads one value throughout says nothing, its noise is below the steps: where all do, no Level
    is known and all are None."""
    rests = [x for x in rests if np.ptp(x) > 0]
    if not rests:
        return None, None, None
    groups = [_grouped(*_power(x, rate), len(x), rate) for x in rests]
    f, power, shape = (np.concatenate([getattr(g, k) for g in groups])
                       for k in ("f", "power", "shape"))
    columns = np.stack([np.ones(len(f)), 1.0 / (2.0 * np.pi * f), 1.0 / (2.0 * np.pi * f) ** 2],
                       1)
    squares, top = _likeliest(columns, power, shape)
    profiles = [_level(columns, power, shape, squares, top, k) for k in range(columns.shape[1])]
    profiles = [_sparing(columns, power, shape, profiles, k) for k in range(len(profiles))]
    return tuple(profiles) if walks else (*profiles[:2], None)


def _sparing(columns, power, shape, levels, k):
    """A Level whose value is the likeliest one without the others that the data do not show: what
    cannot be negative would take a part of it on average. Their likelihoods differ by less than
    HALF_OF_90, so that its own interval holds it."""
    absent = [j for j, level in enumerate(levels) if j and j != k and level.low == 0.0]
    present = [j for j in range(len(levels)) if j not in absent]
    if not absent:
        return levels[k]
    square = _likeliest(columns[:, present], power, shape)[0][present.index(k)]
    value = float(np.clip(np.sqrt(square), levels[k].low, levels[k].high))
    return Level(value, levels[k].low, levels[k].high)


def _power(x, rate):
    """(f, two-sided power density) of one rest."""
    from scipy import signal
    x, n = signal.detrend(np.asarray(x, float)), len(x)
    total = np.zeros(n // 2 + 1)
    place = np.pi * np.arange(1, n + 1) / (n + 1)
    for k in range(1, TAPERS + 1):
        taper = np.sqrt(2.0 / (n + 1)) * np.sin(k * place)
        total += np.abs(np.fft.rfft(x * taper)) ** 2
    return np.fft.rfftfreq(n, 1.0 / rate), total / TAPERS / rate


def _grouped(f, power, n, rate):
    """Groups of the frequencies that say something of noise: above what taking off a straight
    line touches, below the chip's filter, and no lines."""
    use = (f > (TAPERS + 1) / 2.0 * rate / n) & (f < HIGHEST * rate)
    f, power = f[use], power[use]
    if len(f) > 30:
        lines = np.flatnonzero(power > LINE * _usual(f, power))
        near = (lines[:, None] + np.arange(-TAPERS, TAPERS + 1)).ravel()
        keep = np.ones(len(f), bool)
        keep[near[(near >= 0) & (near < len(f))]] = False
        f, power = f[keep], power[keep]
    edges = np.unique(np.searchsorted(f, np.geomspace(f[0], f[-1], GROUPS + 1)[1:-1]))
    parts = [part for part in np.split(np.arange(len(f)), edges) if len(part)]
    # Neighbouring frequencies share their tapers: 2 K degrees of freedom in each K + 1 of them.
    return Groups(np.array([np.exp(np.log(f[p]).mean()) for p in parts]),
                  np.array([power[p].mean() for p in parts]),
                  np.array([len(p) * TAPERS / (TAPERS + 1.0) for p in parts]))


def _usual(f, power):
    """Median power about each frequency, on straight lines between parts in the logarithms of
    both: it falls as steeply as noise does, and the first frequencies are no lines."""
    edges = [0]
    for edge in np.searchsorted(f, np.geomspace(f[0], f[-1], PARTS + 1)[1:-1]).tolist():
        if edge - edges[-1] >= FEWEST:
            edges.append(edge)
    parts = np.split(np.arange(len(f)), edges[1:])
    x = [np.log(f[part]).mean() for part in parts]
    y = [np.median(np.log(power[part])) for part in parts]
    if len(parts) < 2:
        return np.full(len(f), np.exp(y[0]))
    slope = np.interp(np.log(f), x, y)
    first = np.log(f) < x[0]
    slope[first] += (y[1] - y[0]) / (x[1] - x[0]) * (np.log(f[first]) - x[0])
    return np.exp(slope)


def _likelihood(columns, power, shape, squares):
    density = columns @ squares
    return float((shape * (-np.log(density) - power / density)).sum())


def _likeliest(columns, power, shape, held=None):
    """(squares, log likelihood); held: (index, value) of a square that is given. Fisher scoring:
    weighted least squares whose weights are those of the density found [McCullagh & Nelder,
    Generalized Linear Models (1989), section 8.3]."""
    from scipy import optimize  # it takes its time, which verbs without arithmetic do not have
    scale = np.median(power) / columns.mean(axis=0)
    free = [k for k in range(columns.shape[1]) if held is None or k != held[0]]
    fixed = np.zeros(len(power)) if held is None else held[1] * columns[:, held[0]]
    squares = np.array(scale) / columns.shape[1]
    if held is not None:
        squares[held[0]] = held[1]
    best = squares, _likelihood(columns, power, shape, squares)
    for _ in range(ROUNDS):
        weight = np.sqrt(shape) / (columns @ squares)
        scaled = weight[:, None] * columns[:, free] * scale[free]
        step = optimize.nnls(scaled, weight * (power - fixed))[0] * scale[free]
        new = squares.copy()
        new[free] = 0.5 * (squares[free] + step)  # half steps: full ones swing about
        if not (columns @ new > 0.0).all():
            break
        value = _likelihood(columns, power, shape, new)
        if value > best[1]:
            best = new, value
        if np.allclose(new, squares, rtol=1e-9, atol=1e-9 * scale.min()):
            break
        squares = new
    return best


def _level(columns, power, shape, squares, top, k):
    """Level of one of the squares by the profile of the likelihood."""
    from scipy import optimize
    def below(value):
        return top - _likeliest(columns, power, shape, (k, value))[1] - HALF_OF_90
    square = float(squares[k])
    unit = max(square, 1e-6 * np.median(power) / columns[:, k].mean())
    high = unit
    while below(high) < 0.0 and high < 1e12 * unit:
        high *= 2.0
    high = optimize.brentq(below, max(square, 0.0), high, rtol=1e-3)
    low = 0.0
    if square > 0.0 and below(0.0) > 0.0:
        low = optimize.brentq(below, 0.0, square, rtol=1e-3)
    return Level(np.sqrt(square), np.sqrt(low), np.sqrt(high))
