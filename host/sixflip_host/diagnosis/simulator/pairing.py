"""Both logs of one motion on one grid of times, in the band of frequencies in which they agree.

Contacts, wheels and a hand's tremor are not repeated by a simulator, and what only one log has is
noise in the other's prediction. The band ends where the simulator's output is no longer coherent
with anything that the real log says; in it reliable() tells the motion from the real log's noise.
"""
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import coherence

from sixflip import STANDARD_G
from sixflip.poses import faces

from ...experiment import noise_arrays
from . import alignment as align_by
from . import row_times
from .row_times import increasing
from .traces import Motion, spinning

GRID_HZ = 50.0  # eight points in a period of the widest band
EDGE_S = 0.4  # left out at both ends, where the low-pass (alignment.smooth) has one side only
COHERENT = 0.9  # of a frequency that is used: noise is then a tenth of the power there at most
BANDS = (align_by.BAND_HZ, 4.0, 2.5, 1.6, 1.0, 0.7)  # Hz, each two thirds of the one before
SEGMENT_S = 6.0  # of which the coherence is a mean: four periods of the narrowest band
FLAT, RESTS_DPS = 0.966, 2.0  # cosine of 15 deg, as the simulator has a face; slower is a rest
WARMING_S = 10.0  # over which the temperature's rate is taken: a thermometer has steps
FORETOLD = 0.5  # of what a simulator reads is not, where it does something else than the sensor


@dataclass(frozen=True)
class Pair:
    """On a grid of times t (n,) s of the simulator's clock: of the real log force, rate (n, 3),
    celsius (n,) or None and Motion; of the simulator sim_force, sim_rate (n, 3)."""

    t: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    celsius: np.ndarray
    motion: Motion
    sim_force: np.ndarray
    sim_rate: np.ndarray
    band_hz: float

    def real(self, kind):
        """(n, 3) readings of a sensor of the real log."""
        return self.force if kind == "accel" else self.rate

    def simulated(self, kind):
        """(n, 3) readings of a sensor of the simulator's."""
        return self.sim_force if kind == "accel" else self.sim_rate


def paired(real, sim, alignment, motion, band_hz=BANDS[0], low_pass=None):
    """Pair of two Traces and the real one's Motion; samples on a rail, and lost ones, are left
    out. Of a low_pass.LowPass the log that is not behind it is put behind it."""
    t = np.arange(0.0, sim.seconds, 1.0 / GRID_HZ)
    there = alignment.of_simulator(t)
    inside = (there > EDGE_S) & (there < real.seconds - EDGE_S) & (t > EDGE_S) & (
        t < sim.seconds - EDGE_S)
    for log, at in ((real, there), (sim, t)):
        inside &= ~paused(log, at)
    t, there = t[inside], there[inside]

    # Where the clocks go unlike, the same band of both is another one by each log's own.
    own_hz = band_hz / (1.0 + alignment.drift)

    behind = {log: low_pass and low_pass.on(log) for log in ("real", "sim")}

    def onto(trace, values, at, slope=False):
        return at_times(trace, values, at, own_hz if trace is real else band_hz, slope,
                        behind["real" if trace is real else "sim"])

    # A simulator without a gyro is compared by its forces alone.
    sim_rate = np.zeros_like(sim.force) if sim.rate is None else sim.rate
    fields = {name: onto(real, getattr(motion, name), there)
              for name in ("turn", "up", "rate", "moved", "speed")}
    # The slope of what the band leaves of it: from row to row that of a hand's tremor is a few
    # percent too small, which an arm makes a force of. Its square has what is beyond the band.
    fields["rate_dot"] = onto(real, motion.rate, there, slope=True)
    fields["spin"] = onto(real, spinning(motion.rate), there)
    railed, put_in = (sum(np.interp(at, log.t, getattr(log, name).astype(float)) for log, at in (
        (real, there), (sim, t))) > 0 for name in ("railed", "put_in"))
    keep = ~_near(railed, put_in, (fields["rate"], onto(real, real.force, there)), band_hz)
    return Pair(t[keep], onto(real, real.force, there)[keep], onto(real, real.rate, there)[keep],
                None if real.celsius is None else np.interp(there, real.t, real.celsius)[keep],
                Motion(**{k: v[keep] for k, v in fields.items()}),
                onto(sim, sim.force, t)[keep], onto(sim, sim_rate, t)[keep], band_hz)


def _near(railed, put_in, moves, band_hz):
    """(n,) True at times beside readings that are not to be compared: in a period of the band the
    low-pass has forgotten all but a hundredth of what was cut off, in half of one a tenth; of a
    log that is cut most of the time nothing better is known. Nor is it where rows were put in so
    often that what is left hardly moves, by what either sensor reads, moves [(n, 3)]: every fifth
    row of a motion, and none at rest, leave the rest alone to be compared."""
    def beside(bad, periods):
        wide = max(1, int(periods * GRID_HZ / band_hz))
        return np.convolve(bad, np.ones(2 * wide + 1), "same") > 0

    for cut in (railed | put_in, railed):
        for periods in (1.0, 0.5):
            near, without = beside(cut, periods), beside(railed, periods)
            if near.mean() <= 1.0 - align_by.KNOWN and all(
                    align_by.power(x[~near]) >= align_by.KNOWN * align_by.power(x[~without])
                    for x in moves):
                return near
    return np.zeros(len(railed), bool)


def paused(trace, at):
    """(m,) True at times at which nobody read the Trace for longer than lost rows are put in, and
    EDGE_S around them, where the low-pass has one side only."""
    out = np.zeros(len(at), bool)
    for k in np.flatnonzero(np.diff(trace.t) > max(row_times.PUT_IN_S, 2.0 / trace.rate_hz)):
        out |= (at > trace.t[k] - EDGE_S) & (at < trace.t[k + 1] + EDGE_S)
    return out


def moment(pair):
    """Moment of arrays: what the real log of a Pair says, rates without the bias at its stills."""
    m = noise_arrays.moment()
    m.t, m.f = pair.t, tuple(pair.force.T / STANDARD_G)
    m.up = tuple(pair.motion.up.T)
    resting = np.linalg.norm(pair.motion.rate, axis=1) < np.radians(RESTS_DPS)
    m.face = -1 + sum((face + 1) * (resting & (sign * m.up[axis] > FLAT))
                      for face, (axis, sign) in enumerate(zip(faces.AXIS, faces.SIGN)))
    bias = (pair.rate - pair.motion.rate)[resting if resting.any() else slice(None)].mean(axis=0)
    m.w = tuple(np.degrees(pair.rate - bias).T)
    if pair.celsius is None:
        m.temperature, m.temperature_rate = np.full(len(pair.t), 25.0), np.zeros(len(pair.t))
    else:
        m.temperature = pair.celsius
        rows = max(1, int(WARMING_S * GRID_HZ))
        smooth = np.convolve(np.pad(pair.celsius, rows, "edge"), np.hanning(2 * rows + 1) / rows,
                             "valid")
        m.temperature_rate = np.gradient(smooth, pair.t)
    return m


def at_times(trace, values, at, band_hz, slope=False, low_pass=None):
    """(m, …) of values (n, …), one a row of a Trace, what is slower than the band, and behind a
    low_pass.LowPass, at times at (m,) s of its clock, or its slope."""
    t, flat = row_times.on_even_times(trace.t, values.reshape(len(values), -1), trace.rate_hz)
    course = CubicSpline(*increasing(t, align_by.smooth(flat, trace.rate_hz, band_hz, low_pass)))
    return course(at, int(slope)).reshape((len(at),) + values.shape[1:])


def coherent_band(measured, signals):
    """Hz: the widest of BANDS up to which measured (n, 3) follows from signals (n, k)."""
    design = np.column_stack([signals, np.ones(len(signals))])
    said = design @ np.linalg.lstsq(design, measured, rcond=None)[0]
    power, shared = 0.0, 0.0
    for i in range(3):
        if measured[:, i].std() <= 0:
            continue
        f, c = coherence(measured[:, i], said[:, i], GRID_HZ, nperseg=min(
            len(measured), int(SEGMENT_S * GRID_HZ)))
        weight = measured[:, i].var()
        power, shared = power + weight, shared + weight * c
    if not np.ndim(shared):
        return BANDS[0]
    c = shared / power
    for band in BANDS:
        inside = (f > 0) & (f <= band) & (f > band / 2)
        if inside.any() and np.median(c[inside]) >= COHERENT:
            return band
    return BANDS[-1]


def not_foretold(nameless, measured):
    """(n, k) what the nameless Hypothesis leaves of the simulator's channels measured (n, k), late
    and smoothed as it may be: the noise of both logs, and what shakes each in its own way."""
    slope = np.gradient(nameless.signal, axis=0)
    design = np.column_stack([nameless.signal, slope, np.gradient(slope, axis=0), nameless.free,
                              np.ones(len(measured))])
    return measured - design @ np.linalg.lstsq(design, measured, rcond=None)[0]


def shaken(left, measured, signal):
    """What shakes both logs, each in its own way, in the unit of the real one: a floor does. It is
    of what is left (n, k) of the simulator's channels measured (n, k) as much as is foretold of
    them by the real log's signal (n, 3); in the quietest one, as which is which is not known yet.
    Where most of them is not foretold the simulator does something else, and nothing is known of
    what shakes."""
    left, seen = left.var(axis=0), np.maximum(measured.var(axis=0), 1e-30)
    if left.sum() > FORETOLD * seen.sum():
        return 0.0
    unit2 = (seen - left).mean() / max(signal.var(axis=0).mean(), 1e-30)
    own = left / (2.0 - left / seen)  # noise of both where all is foretold, else its own alone
    return float(np.sqrt(own.min() / unit2))


def reliable(values, sigma):
    """values (n, 3) of the real log, drawn to their mean along each direction by the share of the
    variance there that their noise makes up in the band: what is expected of the motion, given the
    reading. What follows from the motion alone is then fitted without being made too small, and a
    direction that reads nothing but noise, as all but one do where a thing turns about one axis,
    says nothing of the simulator's [Fuller, Measurement Error Models (1987), section 2.2; Carroll
    et al., Measurement Error in Nonlinear Models (2006), chapter 4]. sigma (3,): of the noise."""
    mean, sigma = values.mean(axis=0), np.maximum(sigma, 1e-15)
    white = (values - mean) / sigma
    power, directions = np.linalg.eigh(white.T @ white / len(white))
    share = np.clip(1.0 - 1.0 / np.maximum(power, 1e-30), 0.0, 1.0)
    return mean + (white @ (directions * share)) @ directions.T * sigma


def local_noise(left):
    """(n,): how noisy the log is around each sample, in units of the average: a robot on its way
    shakes, at rest it does not; never less than the quieter half."""
    wide = int(GRID_HZ)
    power = (left ** 2 / np.maximum(left.var(axis=0), 1e-18)).mean(axis=1)
    level = np.sqrt(np.convolve(power, np.ones(wide), "same") / np.convolve(
        np.ones(len(power)), np.ones(wide), "same"))
    level = np.maximum(level, 0.5 * np.median(level) + 1e-9)
    return level / np.sqrt((level ** 2).mean())
