"""Noise, bias and step of a calibrated board out of one capture, in SI units.

All from rests, so that the hand is not in it: Allan deviation within each rest, pooled.
N: white noise density, adev(tau) sqrt(tau) for tau up to 1 s. B: bias instability, the floor of
the Allan deviation / 0.664. K: rate random walk, adev(tau) sqrt(3 / tau) at the longest tau
after the white part is taken off, from a rest of a minute or more. (IEEE Std 952-1997, annex C.)
"""
import numpy as np

from sixflip.scale_form import scale_form

from ..errors import CheckFailed
from ..solving.solution import solve
from . import pose_runs, signal_measures

SHORTEST_S = 2.0
WALK_S = 60.0  # a rest this long shows the random walk
FLICKER = 0.664  # sqrt(2 ln 2 / pi)
TAUS_S = (0.05, 0.1, 0.2, 0.5, 1.0)


class Triad:
    """One sensor: unit; per axis (3,): density N (unit/sqrt(Hz)), per_sample (unit), floor B
    (unit), walk K (unit/s/sqrt(Hz)) or None where no rest is long enough, bias (unit, what is
    read when nothing acts), step (unit); matrix (3, 3): measured = matrix · true + bias, or
    None for a gyro that was not turned about all its axes."""


def measure(capture):
    """{"accel": Triad, "gyro": Triad or absent}; CheckFailed where there is nothing to measure."""
    rate = capture.meta["rate_hz"]
    lengths = [p.n for p in capture.placements() if p.n >= SHORTEST_S * rate]
    if not lengths:
        raise CheckFailed("no rest of %g s or more in the capture: noise cannot be measured"
                          % SHORTEST_S)
    solved = solve(capture)
    if solved.accel is None or solved.verdict == "refused":
        raise CheckFailed("the capture does not calibrate the board: %s" % solved.reason)
    found = {"accel": _triad(capture, capture.accel, capture.meta["accel_lsb_per_g"] /
                             solved.g, "m/s2")}
    _, _, v, inverse = scale_form(solved.accel.P)
    found["accel"].matrix = np.array(inverse)
    found["accel"].bias = -np.array(v)
    if capture.gyro is not None:
        lsb = capture.meta["gyro_lsb_per_dps"] * 180.0 / np.pi
        gyro = found["gyro"] = _triad(capture, capture.gyro, lsb, "rad/s")
        gyro.matrix = None
        if solved.gyro is not None and not solved.gyro.missing:
            _, _, v, inverse = scale_form(solved.gyro.P)
            gyro.matrix, gyro.bias = np.array(inverse), -np.array(v)
        else:
            gyro.bias = capture.gyro[resting(capture)].mean(axis=0) / lsb
    return found


def resting(capture):
    """Mask (n,) of the samples in placements."""
    mask = np.zeros(len(capture), dtype=bool)
    for p in pose_runs.placements(capture):
        mask[p.first:p.first + p.n] = True
    return mask


def _triad(capture, counts, lsb, unit):
    rate = capture.meta["rate_hz"]
    rests = [counts[p.first:p.first + p.n] / lsb for p in pose_runs.placements(capture)
             if p.n >= SHORTEST_S * rate]
    out = Triad()
    out.unit = unit
    levels = []
    for tau in TAUS_S:
        m = int(round(tau * rate))
        deviation = pooled(rests, m) if m else None
        if deviation is not None:
            levels.append((m / rate, deviation))
    out.density = np.median([d * np.sqrt(t) for t, d in levels], axis=0)
    out.per_sample = pooled(rests, 1)
    longest = max(rests, key=len)
    m = max(1, len(longest) // 9)
    last = signal_measures.allan(longest, m)
    out.floor = np.minimum(np.min([d for _, d in levels], axis=0), last) / FLICKER
    out.walk = None
    if len(longest) >= WALK_S * rate:
        tau = m / rate
        excess = np.maximum(last ** 2 - out.density ** 2 / tau, 0.0)
        out.walk = np.sqrt(excess * 3.0 / tau)
    out.step = signal_measures.step(counts) / lsb
    return out


def pooled(rests, m):
    """Allan deviation (3,) over m samples, pooled over the rests that are long enough."""
    found = [(len(r) - 2 * m, signal_measures.allan(r, m) ** 2) for r in rests
             if len(r) >= 3 * m]
    if not found:
        return None
    weights = np.array([w for w, _ in found], dtype=float)
    return np.sqrt(np.average([v for _, v in found], axis=0, weights=weights))
