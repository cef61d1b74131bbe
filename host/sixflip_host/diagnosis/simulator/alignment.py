"""Whether two logs are of one motion, and how the clock of one lies to that of the other.

Both are told by the size of the turn rate, which is the same in every frame, with axes swapped
and in any unit: its correlation where they match best, and the offset and drift at which they do.
Where that finds no match, as of a lift that does not turn, the size of the force does likewise.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

GRID_HZ = 100.0  # sixteen steps in a period of the band: the first offset, before it is refined
BAND_HZ = 6.0  # of what is compared: beyond it a simulator's contacts are not repeatable
# Correlation from which on two logs are of one motion. Less takes two runs of one schedule for one
# motion, which pairing.one_motion has to tell apart; more loses a simulator whose wheels slip.
ALIKE = 0.85
# Of forces that change along one line: two rides of one lift, which starts alike each time but for
# 15 % of its force, match by 0.989; logs of one ride by 0.9995.
ALIKE_FORCES = 0.995
# Correlation from which on no other drift is tried: a gait matches itself a step further on, and a
# clock that runs two per cent slow was a worse match of another motion.
AS_FAST = 0.98
# Clocks of chips were seen within 1 % (99.3 and 100.3 Hz for 100); a simulator's real-time factor
# is off by more. By half a step of 0.1 % a log of a minute is 30 ms off at its end, a fifth of a
# period of the band.
DRIFTS = np.linspace(-0.03, 0.03, 61)
THINNED = 4  # of so many steps one will do for that: four a period of the band
MOST_ROWS = 3.0  # periods between two rows, from which on some are missing or came very late
FADED = 2.0  # periods of the band's end in which what lies beyond the ends has faded to 1e-4
KNOWN = 0.25  # of a log, that is neither missing nor cut off: less says little of its clock
LEAST_S = 8.0  # of a log: its turn rate has a hundred independent values in BAND_HZ
SHORTEST_S = 2.0  # of a log, two dozen values, that another is looked for at all


@dataclass(frozen=True)
class Alignment:
    """same: one motion; correlation of the turn rates; time of the real log = offset_s + (1 +
    drift) · time of the simulator's; offset_sigma_s, drift_sigma: standard errors; overlap_s; by:
    "turn rates" or "forces", which it is told by; turning: whether either log turns; nats: that
    the directions of what is read tell of it (motion_match); moving: whether either log moves, so
    that there is a motion to be compared."""

    same: bool
    correlation: float
    offset_s: float
    offset_sigma_s: float
    drift: float
    drift_sigma: float
    overlap_s: float
    by: str = "turn rates"
    turning: bool = True
    nats: float = 0.0
    moving: bool = True

    def of_simulator(self, t):
        """Times of the real log at times of the simulator's."""
        return self.offset_s + (1.0 + self.drift) * np.asarray(t)


def align(real, sim):
    """The Alignment of two Traces; its drift is known no better than the pace of their clocks."""
    found = _by_turns_or_forces(real, sim)
    return replace(found, drift_sigma=float(np.sqrt(
        found.drift_sigma ** 2 + real.clock_sigma ** 2 + sim.clock_sigma ** 2)))


def _by_turns_or_forces(real, sim):
    """The Alignment of two Traces with times that are known."""
    none = Alignment(False, 0.0, 0.0, np.inf, 0.0, np.inf, 0.0)
    if min(real.seconds, sim.seconds) < SHORTEST_S:
        return none
    changes = [np.zeros(1, bool) if x.rate is None else np.ptp(x.rate, axis=0) > 0.0
               for x in (real, sim)]
    turns = all(x.any() for x in changes)
    by_turns = _aligned(turn_rate(real), turn_rate(sim)) if turns else none
    if not all(x.all() for x in changes):
        # Of what turns about one axis the others say nothing in a simulator, and all of it is in
        # the size; where they would, the size is another one, and the forces may tell better.
        by_force = replace(_aligned(force_off(real), force_off(sim)), by="forces")
        return by_turns if by_turns.same and not (
            by_force.same and by_force.offset_sigma_s < by_turns.offset_sigma_s) else by_force
    if by_turns.same:
        return by_turns
    by_force = replace(_aligned(force_size(real), force_size(sim)), by="forces")
    return by_force if by_force.correlation >= ALIKE_FORCES else by_turns


def _aligned(a, b):
    """Alignment of two courses on their grids, (times, values, unread, railed) each."""
    if a[1].std() <= 0 or b[1].std() <= 0:
        return Alignment(False, 0.0, 0.0, np.inf, 0.0, np.inf, 0.0)
    best = coarse(a, b, 0.0) + (0.0,)
    if best[0] < AS_FAST:
        few = [tuple(x[::THINNED] for x in pair) for pair in (a, b)]
        best = max((coarse(*few, drift) + (drift,) for drift in DRIFTS), key=lambda x: x[0])
    return refined(a, b, *best[1:])


def turn_rate(trace):
    """(times of a grid, turn rate in rad/s, smooth, where rows within a period of the band are
    missing or at the end of a range, where they are at the end of a range)."""
    size = np.linalg.norm(trace.rate - np.median(trace.rate, axis=0)
                          if not trace.rests else trace.rate - trace.rest_means(
                              trace.rate).mean(axis=0), axis=1)
    return _on_grid(trace, size)


def force_off(trace):
    """As turn_rate(), of how far the specific force is from its median: where no turn rate is
    there to go by."""
    return _on_grid(trace, np.linalg.norm(trace.force - np.median(trace.force, axis=0), axis=1))


def force_size(trace):
    """As turn_rate(), of the specific force's size less its median: of what drives along gravity
    up and down are then two."""
    size = np.linalg.norm(trace.force, axis=1)
    return _on_grid(trace, size - np.median(size))


def _on_grid(trace, size):
    t = np.arange(0.0, trace.seconds, 1.0 / GRID_HZ)
    row = np.minimum(np.searchsorted(trace.t, t, "right"), len(trace.t) - 1)
    railed = trace.railed[row]
    unread = railed | trace.put_in[row] | trace.put_in[row - 1] | (
        trace.t[row] - trace.t[row - 1] > MOST_ROWS / trace.rate_hz)
    near = (np.convolve(x, np.ones(2 * int(GRID_HZ / BAND_HZ) + 1), "same") > 0.0
            for x in (unread, railed))
    return t, smooth(np.interp(t, trace.t, size), GRID_HZ), *near


def smooth(x, rate_hz, band_hz=BAND_HZ, low_pass=None):
    """x (n,) or (n, k) without what is faster than the band, by 1 / (1 + (f / band)^4); no delay.
    And behind a low_pass.LowPass, where one is to be.
    The same at any rate: a recursive filter's slope depends on it, and of two logs of different
    rates one would be the smoother."""
    band = min(band_hz, 0.4 * rate_hz)
    if len(x) < 40:
        return x
    beyond = min(len(x) - 1, int(rate_hz * max(1.0, FADED / band)))
    longer = np.concatenate([2.0 * x[:1] - x[beyond:0:-1], x, 2.0 * x[-1:] - x[-2:-beyond - 2:-1]])
    number = fft.next_fast_len(len(longer), real=True)
    hz = fft.rfftfreq(number, 1.0 / rate_hz)
    gain = 1.0 / (1.0 + (hz / band) ** 4)
    if low_pass is not None:
        gain = gain * low_pass.response(hz)
    spectrum = fft.rfft(longer, number, axis=0)
    slow = fft.irfft((spectrum.T * gain).T, number, axis=0)
    return slow[beyond:beyond + len(x)]


def coarse(a, b, drift):
    """(correlation, offset in s) of the best whole step."""
    step = a[0][1] - a[0][0]
    t = np.arange(0.0, b[0][-1] * (1.0 + drift), step)
    y = np.interp(t / (1.0 + drift), b[0], b[1])
    x = a[1] - a[1].mean()
    y = y - y.mean()
    n = len(x) + len(y)
    size = 1 << (n - 1).bit_length()
    cross = np.fft.irfft(np.fft.rfft(x, size) * np.conj(np.fft.rfft(y, size)), size)
    lags = np.concatenate([np.arange(0, len(x)), np.arange(-len(y) + 1, 0)])
    values = np.concatenate([cross[:len(x)], cross[size - len(y) + 1:]])
    # Only what overlaps counts, and at least half of the shorter log has to.
    sums = [np.concatenate([[0.0], np.cumsum(z ** 2)]) for z in (x, y)]
    first, end = np.maximum(lags, 0), np.minimum(len(y) + lags, len(x))
    enough = end - first >= 0.5 * min(len(x), len(y))
    power = np.maximum(sums[0][np.maximum(end, first)] - sums[0][first], 0) * np.maximum(
        sums[1][np.maximum(end, first) - lags] - sums[1][first - lags], 0)
    value = np.where(enough, values / np.sqrt(np.maximum(power, 1e-12 * power.max() + 1e-300)),
                     -1.0)
    best = int(value.argmax())
    return float(value[best]), lags[best] * step


def refined(a, b, offset, drift):
    """Gauss-Newton on offset and drift, the simulator's rate scaled freely."""
    for _ in range(6):
        t = offset + (1.0 + drift) * b[0]
        inside = (t >= 0.0) & (t <= a[0][-1])
        together = inside.sum() / GRID_HZ
        inside = known_where(a, b, t, inside)
        if inside.sum() < SHORTEST_S * GRID_HZ:
            return Alignment(False, 0.0, offset, np.inf, drift, np.inf, together)
        x = np.interp(t[inside], a[0], a[1])
        slope = np.interp(t[inside], a[0], np.gradient(a[1], a[0]))
        y = b[1][inside]
        gain = np.polyfit(y, x, 1)
        left = np.polyval(gain, y) - x
        columns = np.stack([slope, slope * b[0][inside]], 1)
        gram = columns.T @ columns
        step = np.linalg.lstsq(gram, columns.T @ left, rcond=None)[0]
        offset, drift = offset + step[0], drift + step[1]
        sigma = errors(columns, left - columns @ step)
    if not min(x.std(), y.std()) > 0.0:  # where they overlap one of them does not move
        return Alignment(False, 0.0, 0.0, np.inf, 0.0, np.inf, together)
    correlation = float(np.corrcoef(x, y)[0, 1])
    return Alignment(correlation >= _alike_of(y), correlation, float(offset), float(sigma[0]),
                     float(drift), float(sigma[1]), together)


def _alike_of(course):
    """Correlation with a course on the grid, shorter than LEAST_S, that is as far from none as
    ALIKE is in that time: Fisher's atanh of one of n independent values has the standard deviation
    1 / sqrt(n - 3) [Metron 1 (1921) 3]."""
    number, enough = len(course) / independent(course) - 3.0, 2.0 * BAND_HZ * LEAST_S - 3.0
    return ALIKE if len(course) >= LEAST_S * GRID_HZ else float(np.tanh(
        np.arctanh(ALIKE) * np.sqrt(enough / max(number, 1.0))))


def known_where(a, b, t, inside):
    """Those of the times t of a grid inside which two courses, as of turn_rate(), are known: not
    beside missing rows, where that leaves enough, and enough of what moves as well."""
    enough = max(KNOWN * inside.sum(), LEAST_S * GRID_HZ)
    masks = [inside & ~b[k] & (np.interp(t, a[0], a[k]) < 0.5) for k in (2, 3)]
    for known in masks:
        if known.sum() > enough and power(b[1][known]) >= KNOWN * power(b[1][masks[1]]):
            return known
    return inside


def power(values):
    """Sum of the squares of values (n, ...) about their mean."""
    return float(((values - values.mean(axis=0)) ** 2).sum()) if len(values) else 0.0


def errors(columns, left):
    """(k,) standard errors of the coefficients of columns (n, k), of what is left (n,) of them:
    the larger of those that the noise alone gives, neighbours of which are alike, and those that
    are there where what is left follows the columns for a while, now to one side and now to the
    other, as a controller's phase does [White, Econometrica 48 (1980) 817; Newey & West,
    Econometrica 55 (1987) 703]."""
    inverse = np.linalg.pinv(columns.T @ columns)
    by_noise = np.diag(inverse) * left.var() * independent(left)
    pulls = (columns * left[:, None]) @ inverse
    return np.sqrt(np.maximum(by_noise, (pulls ** 2).sum(axis=0) * [
        independent(pull) for pull in pulls.T]))


def independent(x):
    """By how much neighbouring values of x (n,) or (n, k) say the same: the sum of its
    autocorrelation up to the first zero [Geyer, Practical Markov Chain Monte Carlo,
    Statistical Science 7 (1992), 473]."""
    x = np.asarray(x, float)
    if x.ndim == 2:
        return max(independent(x[:, i]) for i in range(x.shape[1]))
    x = x - x.mean()
    power = np.abs(np.fft.rfft(x, 2 * len(x))) ** 2
    auto = np.fft.irfft(power)[:len(x)]
    if auto[0] <= 0:
        return 1.0
    auto = auto / auto[0]
    below = np.flatnonzero(auto <= 0.0)
    return float(1.0 + 2.0 * auto[1:below[0] if len(below) else len(auto)].sum())
