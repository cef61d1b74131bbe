"""Whether two logs are of one motion, by the directions of what they read beside its size: a gyro
that differs from the other one makes the size of the turn another one, and a thing without a gyro
has none. Two runs of one schedule are alike in when they turn, and not in the directions.
"""
from dataclasses import replace

import numpy as np
from scipy import ndimage
from scipy.spatial.transform import Rotation

from . import alignment as align_by
from . import pairing

# Share of the variance that follows from the other log in one motion, where its size alone tells
# it: two runs of one schedule agree in when they turn, and not about which axes.
ONE_MOTION = 0.8
# Nats from which on the directions tell one motion, by other lags and by other runs: by other lags
# the best of 60 pairs of unlike motions had 6, by other runs the best of 14 pairs that move at the
# same times 3, and none of either had both. Each nat more is e times rarer.
ONE = 5.0
# Other runs of a schedule that are made of a log, by a turn of its own for each piece of so many
# seconds, as long as a quick move of a hand; what goes on for longer counts more than once.
RUNS, PIECE_S = 400, 2.0
# Of the rows: pairs of steps of µs that differ (a steady clock that is rounded has few, one that
# scatters by 0.1 ms hardly any twice), and stamps of both logs.
OWN_STEPS, ALIKE_ROWS = 0.3, 0.9
LAGS_HZ = 25.0  # grid on which a lag is looked for: four steps in a period of the band
# Width over which a spectrum is smoothed before a log is made white by it, and the frequency from
# which on it counts; share of the strongest direction's power below which a direction is noise;
# ends of a log that are faded in and out; and how far around the best lag none is another one.
WIDE_HZ, SLOWEST_HZ, LEAST_DIRECTION, FADE_S, PEAK_S = 0.4, 0.1, 1e-3, 1.0, 3.0
AGREE_S = 0.5  # two lags that are one: half of what the size of a turn is alike for
NEAR = 0.1, 0.01  # s of a lag that was found on its grid; relative, of the pace of chips' clocks
IN_STEP_S = 5e-4  # of a sensor's lag that is none: the least that a delay has to be
ROUNDS = 6  # of Gauss and Newton, from a step of the lags' grid


def aligned(real, sim):
    """The Alignment of two Traces by the size of what they read, or by its directions where these
    tell one motion at another lag, or the size none: what differs between two gyros, as an axis
    that is wrong at times or a high-pass, makes the size of the turn another one."""
    found = align_by.align(real, sim)
    one_clock = of_one_clock(real, sim)
    lag, nats = (0.0, np.inf) if one_clock else by_directions(real, sim)
    if nats < ONE:
        return found
    ends = np.array([0.0, min(real.seconds, sim.seconds)])
    off = np.abs(found.of_simulator(ends) - ends - lag).max()
    if found.same and one_clock and off * real.rate_hz < 1.0:
        # Of one clock less than a row is by how much a sensor is late, not the log.
        return replace(found, offset_s=0.0, drift=0.0, nats=nats)
    if found.same and off < AGREE_S:
        return replace(found, nats=nats)
    # A drift, too, takes the lag elsewhere at the ends.
    starts = [replace(found, offset_s=lag, drift=0.0)] + [found] * (not one_clock)
    tried = [(moved_on(real, sim, replace(start, by=by, nats=nats)), start) for start in starts
             for by in ("turn rates", "forces")]
    best, start = min(tried, key=lambda one: one[0].offset_sigma_s)
    if not best.same or start is found and found.same:
        return replace(found, nats=nats)
    return replace(best, offset_s=lag, drift=0.0) if one_clock else best


def of_one_clock(real, sim):
    """Whether both Traces have the stamps of one clock: such as scatter, so that no other has the
    same, and are the same row for row, but for some that one log lacks."""
    stamps = [np.rint(1e6 * log.t[~log.put_in]) for log in (real, sim)]
    steps = np.diff(stamps[0])
    two = np.unique(np.stack([steps[:-1], steps[1:]], 1), axis=0)
    return len(two) > OWN_STEPS * len(stamps[0]) and len(
        np.intersect1d(*stamps)) > ALIKE_ROWS * max(len(x) for x in stamps)


def by_directions(real, sim):
    """(s by which the real Trace is later than the simulator's, nats by which that is one motion
    and not another, nor another run of its schedule): of what each sensor reads along any two
    directions, as one axis alone may go as in another run. Each log is made white, so that what is
    slow in both says no more than it should [Knapp & Carter, IEEE Trans. ASSP 24 (1976) 320, the
    smoothed coherence transform]. How far the best of many lags is by chance, the other lags say;
    how far by a schedule, what it is with each piece of the log turned in a way of its own."""
    if min(real.seconds, sim.seconds) < align_by.LEAST_S:
        return 0.0, 0.0
    band_hz = min(align_by.BAND_HZ, 0.4 * real.rate_hz, 0.4 * sim.rate_hz)
    lengths = [int(LAGS_HZ * log.seconds) for log in (real, sim)]
    number = 1 << (sum(lengths) + 1).bit_length()
    lags = (np.arange(number) + number // 2) % number - number // 2
    over = np.minimum(lengths[0], lengths[1] + lags) - np.maximum(lags, 0)
    enough = over >= max(0.5 * min(lengths), LAGS_HZ * align_by.LEAST_S)
    powers, spectra = [], []
    for name in ("rate", "force"):
        if getattr(real, name) is None or getattr(sim, name) is None:
            continue
        a, b = (_white(log, getattr(log, name), number, band_hz) for log in (real, sim))
        cross = np.fft.irfft(a[:, :, None] * b[:, None].conj(), number, axis=0)
        powers.append(np.linalg.svd(cross[enough], compute_uv=False) ** 2)
        spectra.append((a, b))
    if not powers or not enough.any():
        return 0.0, 0.0
    second, lags = _second(powers), lags[enough]
    best = int(second.argmax())
    others = second[np.abs(lags - lags[best]) > PEAK_S * LAGS_HZ]
    if not others.size or not others.max() > 0.0:
        return 0.0, 0.0
    lag, nats = lags[best], (second[best] / others.max() - 1.0) * np.log(len(lags))
    if nats > ONE:
        nats = min(nats, _over_other_runs(spectra, lag, over[enough][best], number))
    return float(lag / LAGS_HZ), float(nats)


def _second(powers):
    """(n,) second of all directions' powers, [(n, 3) of a sensor, ...]."""
    return np.sort(np.concatenate(powers, 1), axis=1)[:, -2]


def _over_other_runs(spectra, lag, rows, number):
    """Nats by which white logs, [(real, simulated spectrum)] of sensors, are one motion at a lag
    and not two runs that move at the same times: of RUNS that are the same but for the directions
    of each piece, the best."""
    piece, rng = int(PIECE_S * LAGS_HZ), np.random.default_rng(RUNS)
    pieces, own, other = rows // piece, [], []
    at = max(lag, 0) + np.arange(pieces * piece)
    turns = Rotation.random(RUNS * pieces, random_state=RUNS).as_matrix().reshape(
        RUNS, pieces, 3, 3) * rng.choice([-1.0, 1.0], (RUNS, pieces, 1, 1))
    for pair in spectra:
        a, b = (np.fft.irfft(white, number, axis=0)[rows].reshape(pieces, piece, 3)
                for white, rows in zip(pair, (at, at - lag)))
        products = np.swapaxes(a, 1, 2) @ b
        own.append(np.linalg.svd(products.sum(axis=0)[None], compute_uv=False) ** 2)
        other.append(np.linalg.svd(np.einsum("pij,rpjk->rik", products, turns),
                                   compute_uv=False) ** 2)
    best = max(float(_second(other).max()), 1e-300)
    return (float(_second(own)[0]) / best - 1.0) * np.log(RUNS)


def _white(trace, values, number, band_hz):
    """(number // 2 + 1, 3) spectrum of what a Trace reads, of one power in all directions at all
    frequencies of the band."""
    t = np.arange(int(LAGS_HZ * trace.seconds)) / LAGS_HZ
    slow = align_by.smooth(values, trace.rate_hz, band_hz)
    x = np.stack([np.interp(t, trace.t, column) for column in (slow - slow.mean(axis=0)).T], 1)
    fade = np.clip(np.minimum(t, t[-1] - t) / FADE_S, 0.0, 1.0)
    spectrum = np.fft.rfft(x * np.sin(0.5 * np.pi * fade)[:, None] ** 2, number, axis=0)
    hz = np.fft.rfftfreq(number, 1.0 / LAGS_HZ)
    own = spectrum[:, :, None] * spectrum[:, None].conj()
    wide = max(3, int(WIDE_HZ / hz[1]))
    own = ndimage.uniform_filter1d(own.real, wide, axis=0) + 1j * ndimage.uniform_filter1d(
        own.imag, wide, axis=0)
    power, ways = np.linalg.eigh(own)
    power = np.maximum(power, np.maximum(LEAST_DIRECTION * power[:, -1:], 1e-300))
    white = np.einsum("fij,fj->fi", ways.conj().transpose(0, 2, 1), spectrum) / np.sqrt(power)
    inside = (hz > SLOWEST_HZ) & (hz < band_hz)
    return np.einsum("fij,fj->fi", ways, white) * inside[:, None]


def paced(real, sim, alignment, behind):
    """The Alignment with the drift that the logs have behind their low-passes, {sensor: LowPass}:
    how fast a thing turns in all is bent by one, and a clock seems to drift."""
    low_pass = behind.get("gyro" if alignment.by == "turn rates" else "accel")
    own = alignment if low_pass is None else moved_on(real, sim, alignment, low_pass)
    if not own.same:
        return alignment
    middle = 0.5 * sim.seconds
    return replace(alignment, drift=own.drift, drift_sigma=own.drift_sigma, offset_s=float(
        alignment.of_simulator(middle) - (1.0 + own.drift) * middle))


def moved_on(real, sim, start, low_pass=None):
    """The Alignment at which a linear map of how what the real Trace reads changes foretells most
    of how the simulator's does, by Gauss-Newton from one that is near: the course of gravity is
    alike for seconds, the change of it is not. Behind a low_pass.LowPass, where one has it."""
    name = "rate" if start.by == "turn rates" else "force"
    none, at = replace(start, same=False, offset_sigma_s=np.inf), start
    if getattr(real, name) is None or getattr(sim, name) is None:
        return none
    for _ in range(ROUNDS):
        t = np.arange(0.0, sim.seconds, 1.0 / pairing.GRID_HZ)
        there = at.of_simulator(t)
        inside = (np.minimum(t, sim.seconds - t) > pairing.EDGE_S) & (
            np.minimum(there, real.seconds - there) > pairing.EDGE_S)
        t = t[inside]
        if len(t) < align_by.LEAST_S * pairing.GRID_HZ:
            return none
        x, y = (pairing.at_times(
            log, getattr(log, name), own, pairing.BANDS[2],
            low_pass=low_pass and low_pass.on(which)) for which, log, own in (
                ("real", real, there[inside]), ("sim", sim, t)))
        share, change = _foretold(x, y)[1], np.gradient(x, axis=0)
        left, _, turn = _foretold(change, np.gradient(y, axis=0))
        pull = (np.gradient(change, axis=0) * pairing.GRID_HZ) @ turn
        columns = np.stack([pull, pull * t[:, None]], 2).transpose(1, 0, 2).reshape(-1, 2)
        left = left.T.ravel()
        known = left.var() * align_by.independent(left) * np.array(NEAR) ** -2.0
        step = np.linalg.solve(columns.T @ columns + np.diag(known), columns.T @ left - known * [
            at.offset_s - start.offset_s, at.drift - start.drift])
        at = replace(at, offset_s=float(at.offset_s + step[0]), drift=float(at.drift + step[1]))
    sigma = align_by.errors(columns, left - columns @ step)
    return replace(at, same=bool(share >= pairing.FORETOLD), offset_sigma_s=float(sigma[0]),
                   correlation=float(np.sqrt(max(share, 0.0))), overlap_s=len(t) / pairing.GRID_HZ,
                   drift_sigma=float(np.linalg.norm([sigma[1], real.clock_sigma,
                                                     sim.clock_sigma])))


def in_step(fitted, kind, real, sim, alignment):
    """The conventions.SensorFit of a kind that fitted(Alignment) makes, with the real log moved by
    the sensor's own lag where its pair has holes: beside one, where rows were left out, a delay
    has no row to take what was there before from, and two hundred holes halved one of 12.5 ms."""
    found = fitted(alignment)
    if not (np.diff(found.pair.t) > 1.5 / pairing.GRID_HZ).any():
        return found
    own = moved_on(real, sim, replace(alignment, by="forces" if kind == "accel" else "turn rates"))
    late = float(alignment.of_simulator(0.5 * sim.seconds) - own.of_simulator(0.5 * sim.seconds))
    if not own.same or abs(late) < IN_STEP_S:
        return found
    moved = fitted(replace(alignment, offset_s=alignment.offset_s - late))
    # Of readings that stop somewhere the lag is one of what is left of them: with it they have no
    # name any more, or more of them is left than without.
    less, more = ((one.fit.left[:, one.live] ** 2).mean() for one in (found, moved))
    if found.fit.name and (not moved.fit.name or more > less):
        return found
    return replace(moved, fit=replace(moved.fit, delay_s=moved.fit.delay_s + late))


def _foretold(signal, measured):
    """(what a linear map of signal (n, 3) leaves of measured (n, k), share of its variance that it
    foretells, the map)."""
    x, y = (values - values.mean(axis=0) for values in (signal, measured))
    turn = np.linalg.lstsq(x, y, rcond=None)[0]
    left = y - x @ turn
    return left, 1.0 - (left ** 2).sum() / max((y ** 2).sum(), 1e-30), turn


def one_motion(real, sim, alignment, motion, live):
    """Whether the logs turn about the same axes as well: two runs of one schedule turn equally
    fast at the same times. Some linear map has to give the simulator's rates out of the real
    ones, in the body or in the world (forces, where a gyro says nothing); where the directions
    tell one motion either sensor may, and the other is what differs."""
    pair = pairing.paired(real, sim, alignment, motion, pairing.BANDS[2])
    kinds = [(pair.sim_rate, (pair.rate, np.einsum("nij,nj->ni", pair.motion.turn, pair.rate)),
              live["gyro"]), (pair.sim_force, (pair.force, pair.motion.moved), live["accel"])]
    if alignment.nats < ONE:
        kinds = kinds[:1] if live["gyro"].any() else kinds[1:]
    if len(pair.t) < 4 * pairing.GRID_HZ:
        return False
    shares = [_foretold(signal, measured[:, channels])[1] for measured, signals, channels in kinds
              for signal in signals if channels.any()]
    return bool(max(shares, default=0.0) >= (
        ONE_MOTION if alignment.nats < ONE else pairing.FORETOLD))
