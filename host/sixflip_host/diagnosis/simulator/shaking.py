"""Layer two, how hard each of two logs of one motion shakes while it moves, faster than a body is
steered and slower than either log's rows show: what motors, propellers and the ground do. Nobody
simulates their phases, so it is the power that is compared, piece by piece: that of the whole
band; and that of a line, which may be slower since nobody steers to a frequency, such as a motor's
that is in one log alone under a floor's rumbling that both have. Of a line what follows from the
other log at its frequency is none of its own [Bendat and Piersol, Random Data (2010), section 6.1:
coherent output power].
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import special
from scipy.interpolate import CubicSpline

from . import row_times, single_log
from .alignment import BAND_HZ, independent
from .parameters import DIFFERS, MG, compared
from .sensor_axes import DEG

FASTER_HZ = 2.0 * BAND_HZ  # where what the logs are compared by has faded
SHOWS = 0.4  # of the rows a second: what a log of them shows undistorted
SHAKES = 3.0  # times as hard: two runs over one floor differ by less (`make zoo`)
GAP = 1.5  # rows: a step at a place where some are missing shakes nothing
FEWEST_S = 8  # of moving
FEWEST_RESTS = 2  # pieces of rest: of one alone nothing tells whether it is like others
PIECE_S = 0.5  # short enough for a move of a hand, and long enough to know a line to 2 Hz by
FEET_HZ = BAND_HZ - 2.0 / PIECE_S  # where the slowest line has its foot; all bins begin there
FAST = slice(round((FASTER_HZ - FEET_HZ) * PIECE_S), None)  # bins from FASTER_HZ on
SLOWEST = round((BAND_HZ - FEET_HZ) * PIECE_S)  # bin of a line: below are gaits and pendulums
LOBE = 1  # bins beside a line that Hann's window lays half of its height into


@dataclass(frozen=True)
class Spectra:
    """What a log has in the bins from FEET_HZ on: of its moving pieces what Fourier makes of
    them (m, f, 3), scaled to power, with the number of each (m,); power at rest (f, 3),
    a mean over so many pieces."""

    moving: np.ndarray
    pieces: np.ndarray
    still: np.ndarray
    rests: int

    def at_rest(self, bins, axis):
        """(power at rest of an axis in some bins, its standard error): each bin of each piece
        is exponential about the power there, and Hann's window makes one of two bins [Percival
        & Walden, Spectral Analysis for Physical Applications (1993), section 6.6]."""
        still = self.still[bins, axis]
        return float(still.sum()), float(np.sqrt(2.0 * (still ** 2).sum() / self.rests))

    def beside_a_line(self, bins, axis):
        """The same of what the noise at rest has there: what runs there, too, is no noise."""
        noise = np.minimum(self.still[bins, axis], np.median(self.still[:, axis]))
        return float(noise.sum()), float(np.sqrt(2.0 * (noise ** 2).sum() / self.rests))


@dataclass(frozen=True)
class Levels:
    """Power beyond that at rest, of the real log and of the simulator's (2,), with its standard
    errors, and the floor that is not told from none."""

    power: np.ndarray
    error: np.ndarray
    floor: float

    def differ(self, sigmas):
        """Whether one shakes SHAKES times as hard as the other, by so many standard errors."""
        ratio = abs(np.log((self.power[0] + self.floor) / (self.power[1] + self.floor)))
        return bool(ratio > np.log(SHAKES ** 2) and ratio > sigmas * np.hypot(
            *(self.error / (self.power + self.floor))))


def shaking(real, sim, aligned, behind=None):
    """[Parameter] of how hard each Trace of one motion shakes, one an axis: in the whole band, or
    where that does not differ by a line. aligned: the alignment.Alignment of their clocks; behind
    {sensor: low_pass.LowPass}: that one of them has, which is no other shaking."""
    numbers, top = [], SHOWS * min(real.rate_hz, sim.rate_hz)
    for kind, name in (("accel", "force"), ("gyro", "rate")):
        values = [getattr(x, name) for x in (real, sim)]
        if top < 1.5 * FASTER_HZ or any(v is None for v in values):
            continue
        # What one of them cuts off is left out of both: it is where they are shaken most.
        ends = np.array([[single_log.limit(x) or np.inf for x in v.T] for v in values]).min(axis=0)
        clipped = [(np.abs(v) >= ends).any(axis=1) | log.railed
                   for log, v in zip((real, sim), values)]
        low_pass = (behind or {}).get(kind)
        puts = [low_pass and low_pass.on(which) for which in ("real", "sim")]
        steps = [single_log.step(v, log.quantum[kind == "gyro"])
                 for log, v in zip((real, sim), values)]
        own = [_spectra(log, v, cut, top, *more)
               for log, v, cut, *more in zip((real, sim), values, clipped, steps, puts)]
        if any(s is None for s in own):
            continue
        beside = _spectra(*_on_its_rows(real, sim, aligned, values[1], clipped[1]), top,
                          steps[1], puts[1])
        for i, axis in enumerate("xyz"):
            levels, where = _of_band(own, i), "between %.0f and %.0f Hz" % (FASTER_HZ, top)
            if not levels.differ(DIFFERS):
                line, where = _line(own[0], beside, i)
                levels = line or levels
            numbers.append(_parameter(kind, axis, levels, where))
    return numbers


def _of_band(spectra, i):
    """Levels of one axis in the whole band, each log by its own pieces."""
    each = [(np.abs(s.moving[:, FAST, i]) ** 2).sum(axis=1) for s in spectra]
    return _levels(each, [s.at_rest(FAST, i) for s in spectra])


def _levels(each, still):
    """Levels of powers of pieces, two (m,), and those at rest, two (power, standard error)."""
    error = [np.sqrt(x.var(ddof=1) / len(x) * independent((x - x.mean())[:, None]) + s ** 2)
             for x, (_, s) in zip(each, still)]
    return Levels(np.array([max(x.mean() - s, 0.0) for x, (s, _) in zip(each, still)]),
                  np.array(error), max(*(s for s, _ in still), 1e-300))


def _line(real, sim, i):
    """(Levels, where) of the strongest line of one axis of two Spectra whose pieces are those of
    one clock, where it is such in one log alone: stands out of its own, and the other has none of
    that power at any frequency, since a motor of another speed shakes as much. (None, "")
    otherwise."""
    nothing = None, ""
    if sim is None:
        return nothing
    _, *rows = np.intersect1d(real.pieces, sim.pieces, return_indices=True)
    bins = len(real.still)
    if len(rows[0]) * PIECE_S < FEWEST_S or bins <= 2 * LOBE + SLOWEST:
        return nothing
    x, y = (s.moving[k][:, :, i] for s, k in zip((real, sim), rows))
    cross = (x * y.conj()).mean(axis=0)
    whole = [(np.abs(v) ** 2).mean(axis=0) for v in (x, y)]
    each, shared = [], np.abs(cross)
    for own, other, power, gain in ((x, y, whole, cross), (y, x, whole[::-1], cross.conj())):
        alone = np.abs(own - gain / np.maximum(power[1], 1e-300) * other) ** 2
        mean = np.maximum(alone.mean(axis=0), 1e-300)
        # Of a line in the other log alone a part of what both have does not follow from it.
        each.append(alone * np.clip((power[0] - shared) / mean, 0.0, 1.0))
    lines = [slice(k - LOBE, k + LOBE + 1) for k in range(LOBE, bins - LOBE)]
    of_lines = [_levels([e[:, line].sum(axis=1) for e in each],
                        [s.beside_a_line(line, i) for s in (real, sim)]) for line in lines]
    powers = np.array([levels.power + levels.floor for levels in of_lines])
    stronger = int(np.diff(powers[SLOWEST:].max(axis=0))[0] > 0.0)
    at = SLOWEST + int(np.argmax(powers[SLOWEST:, stronger]))
    # What falls off from one end of the band to the other is the foot of how it is steered.
    feet = [side.min(initial=np.inf) for side in np.split(powers[:, stronger], [at])]
    beside = max(*feet, np.median(powers[:, stronger]), powers[:, 1 - stronger].max())
    # The strongest of many is as far off by chance as one alone is less often.
    rare = -special.ndtri(special.ndtr(-DIFFERS) / len(of_lines))
    if powers[at, stronger] <= SHAKES ** 2 * beside or not of_lines[at].differ(rare):
        return nothing
    inside = whole[stronger][lines[at]]  # of a line between two bins either has a part
    middle = float(inside @ np.arange(bins)[lines[at]] / inside.sum())
    return of_lines[at], "at %.0f Hz" % (FEET_HZ + middle / PIECE_S)


def _parameter(kind, axis, levels, where):
    scale = MG if kind == "accel" else DEG
    sizes = scale * np.sqrt(levels.power)
    errors = 0.5 * scale * levels.error / np.sqrt(np.maximum(levels.power, levels.floor))
    parameter = compared("shaking", kind, axis, "mg" if kind == "accel" else "°/s",
                         sizes[0], errors[0], sizes[1], errors[1], apart=np.inf if where else 0.0)
    return replace(parameter, set_to=None, how=shaken_so(*sizes, where)) if where else parameter


def shaken_so(real, simulated, where):
    """What to do about a simulator that shakes less, or more, than the real one: root mean
    squares."""
    return "%s %s while it moves: %.3g instead of %.3g" % (
        "let it shake" if real > simulated else "it shakes too much", where, real, simulated)


def _on_its_rows(real, sim, aligned, values, cut):
    """(the real Trace, values of the simulator's (n, 3) at its times, where they are cut off or
    unread)."""
    at = (real.t - aligned.offset_s) / (1.0 + aligned.drift)
    t, even = row_times.on_even_times(sim.t, values, sim.rate_hz)
    spline = CubicSpline(*row_times.increasing(t, even), extrapolate=False)(at)
    gap = np.diff(sim.t, append=sim.t[-1:]) * sim.rate_hz > GAP
    bad = np.interp(at, sim.t, (cut | gap | sim.put_in).astype(float)) > 0.0
    outside = ~np.isfinite(spline).all(axis=1)
    return real, np.where(outside[:, None], 0.0, spline), bad | outside


def _spectra(trace, values, cut, top, step, low_pass=None):
    """Spectra of values (n, 3) at the rows of a Trace, away from what is cut off (n,), up to a
    frequency, behind a LowPass or none; None where there is too little of moving or of rest. What
    steps (3,) do to a motion that crosses them is noise, though a rest may lie within one."""
    hz = np.arange(FEET_HZ, top, 1.0 / PIECE_S)
    made, still, read = pieces(trace, values, cut, hz)
    if low_pass is not None:
        made = made * low_pass.response(hz)[:, None]
    moves, rests = read & ~still.any(axis=1), read & still.all(axis=1)
    if moves.sum() * PIECE_S < FEWEST_S or rests.sum() < FEWEST_RESTS:
        return None
    rounded = step ** 2 / 12.0 / (0.5 * PIECE_S * trace.rate_hz)  # of a bin
    return Spectra(made[moves], np.flatnonzero(moves), np.maximum(
        (np.abs(made[rests]) ** 2).mean(axis=0), rounded), int(rests.sum()))


def pieces(trace, values, cut, wanted):
    """(what Fourier makes of pieces of values (n, 3) of a Trace at the wanted frequencies (f,),
    (m, f, 3), scaled to power; (m, rows) rows at rest; (m,) read without a gap or a cut row)."""
    still = np.zeros(len(values), bool)
    for first, end in trace.rests:
        still[first:end] = True
    gap = np.diff(trace.t, append=trace.t[-1:]) * trace.rate_hz > GAP
    rows = max(2, int(round(PIECE_S * trace.rate_hz)))
    number = len(values) // rows
    read = ~(gap | trace.put_in | cut)[:number * rows].reshape(-1, rows).any(axis=1)
    x = values[:number * rows].reshape(-1, rows, 3)
    x = x - x.mean(axis=1, keepdims=True)
    t = np.arange(rows) - (rows - 1) / 2.0
    x = x - t[:, None] * (np.einsum("j,ijk->ik", t, x) / (t @ t))[:, None]  # how it is steered
    window = np.hanning(rows + 1)[:rows]
    made = np.fft.rfft(x * window[:, None], axis=1) * np.sqrt(2.0 / (rows * (window ** 2).sum()))
    hz = np.fft.rfftfreq(rows, 1.0 / trace.rate_hz)
    return (made[:, np.argmin(np.abs(hz[:, None] - wanted), axis=0)],
            still[:number * rows].reshape(-1, rows), read)
