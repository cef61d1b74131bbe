"""Noise, bias and step of a sensor out of one capture, in SI units.

All from rests, so that the hand is not in it. N, B and K, each with a 90 % interval, are the
likeliest in the spectra of the rests (experiment/signal_measures.py); the random walk from a
rest of a minute or more. A capture that calibrates the board says what it reads when nothing
acts; a log of one long rest says that of the gyro, and of the accelerometer how it is noisy and
no more.
"""
from dataclasses import dataclass

import numpy as np

from sixflip.accelerometer.scale_form import scale_form

from ..calibrate.solution import solve
from ..errors import CheckFailed
from ..experiment import blocks, long_rest, signal_measures

SHORTEST_S = 2.0
WALK_S = 60.0  # a rest this long shows the random walk
FEWEST_SAMPLES = 64  # of a rest: fewer have no spectrum


@dataclass(frozen=True)
class Triad:
    """One sensor: unit; per axis (3,): density N (unit/sqrt(Hz)), per_sample (unit), floor B
    (unit), walk K (unit/s/sqrt(Hz)) or None where no rest is long enough, each of the three with
    a 90 % interval (2, 3) by its name; bias (unit, what is read when nothing acts) or None where
    the capture does not tell, step (unit); matrix (3, 3): measured = matrix · true + bias, or
    None where nothing was turned; seconds at rest, and of the longest rest."""

    unit: str
    density: np.ndarray
    per_sample: np.ndarray
    floor: np.ndarray
    walk: object
    intervals: dict
    bias: object
    step: np.ndarray
    matrix: object
    seconds: float
    longest_s: float


def measure(capture):
    """{"accel": Triad, "gyro": Triad or absent}; CheckFailed where there is nothing to measure."""
    rate = capture.meta["rate_hz"]
    shortest = max(SHORTEST_S * rate, FEWEST_SAMPLES)
    still = [(run.first, run.end) for run in blocks.session_of("the capture", capture).runs
             if run.end - run.first >= shortest]
    if not still:
        raise CheckFailed("no rest of %g s or more in the capture: noise cannot be measured"
                          % max(SHORTEST_S, FEWEST_SAMPLES / rate))
    if capture.accel is None:
        return {"gyro": _gyro(capture, still)}
    solved = solve(capture)
    matrix = bias = None
    if solved.accel is not None and solved.verdict != "refused":
        _, _, v, inverse = scale_form(solved.accel.P)
        matrix, bias = np.array(inverse), -np.array(v)
    elif not _one_attitude(capture, still):
        raise CheckFailed("the capture does not calibrate the board: %s" % solved.reason)
    triads = {"accel": _triad(capture, capture.accel, still,
                              capture.meta["accel_lsb_per_g"] / solved.g, "m/s2", matrix, bias)}
    if capture.gyro is not None:
        turned = triads["accel"].matrix is not None and solved.gyro is not None \
            and not solved.gyro.missing
        triads["gyro"] = _gyro(capture, still, solved.gyro.P if turned else None)
    return triads


def _gyro(capture, still, P=None):
    """Triad of the gyro; P: its calibration by turns, where there is one."""
    lsb = capture.meta["gyro_lsb_per_dps"] * 180.0 / np.pi
    matrix, bias = None, np.concatenate([capture.gyro[a:b] for a, b in still]).mean(axis=0) / lsb
    if P is not None:
        _, _, v, inverse = scale_form(P)
        matrix, bias = np.array(inverse), -np.array(v)
    return _triad(capture, capture.gyro, still, lsb, "rad/s", matrix, bias)


def _one_attitude(capture, still):
    """Whether all rests lie alike: a log at rest, and no calibration that failed."""
    means = np.array([capture.accel[a:b].mean(axis=0) for a, b in still])
    up = means / np.maximum(np.linalg.norm(means, axis=1), 1e-9)[:, None]
    return bool(np.degrees(np.arccos(np.clip(up @ up[0], -1.0, 1.0))).max() <= long_rest.SAME_DEG)


def _triad(capture, counts, still, lsb, unit, matrix, bias):
    rate = capture.meta["rate_hz"]
    parts = [counts[a:b] / lsb for a, b in still]
    longest = max(len(x) for x in parts) / rate
      # scipy takes its time
    of_axes = [signal_measures.noise_levels([x[:, axis] for x in parts], rate, longest >= WALK_S)
               for axis in range(3)]
    constant = ["xyz"[axis] for axis, one in enumerate(of_axes) if one[0] is None]
    if constant:
        raise CheckFailed("the %s axis reads one value throughout its rests, expected noise that "
                          "is wider than its steps" % constant[0])
    values, intervals = {}, {}
    for k, name in enumerate(("density", "floor", "walk")):
        levels = [one[k] for one in of_axes]
        if all(level is not None for level in levels):
            values[name] = np.array([level.value for level in levels])
            intervals[name] = np.array([[level.low for level in levels],
                                        [level.high for level in levels]])
    return Triad(unit, values["density"], pooled(parts, 1), values["floor"], values.get("walk"),
                 intervals, bias, signal_measures.step(counts) / lsb, matrix,
                 sum(len(x) for x in parts) / rate, longest)


def pooled(parts, m):
    """Allan deviation (3,) over m samples, pooled over the rests that are long enough."""
    variances = [(len(r) - 2 * m, signal_measures.allan(r, m) ** 2) for r in parts
                 if len(r) >= 3 * m]
    if not variances:
        return None
    weights = np.array([w for w, _ in variances], dtype=float)
    return np.sqrt(np.average([v for _, v in variances], axis=0, weights=weights))

