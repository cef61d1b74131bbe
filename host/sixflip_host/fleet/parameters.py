"""One calibration as numbers that boards are compared by, with their own estimation covariance.

The names are those of history/parameters.py, with misalignments and noise beside them. A block
is what varies together: an estimate has a covariance within a block and none between two.
"""
import math
from dataclasses import dataclass

import numpy as np

from sixflip.accelerometer.scale_form import scale_form

PAIRS = ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1))
BLOCKS = {}  # {block: names of its parameters}
for _sensor, _unit in (("accel", "mg"), ("gyro", "dps")):
    BLOCKS[_sensor + "_scale"] = tuple("%s_scale_%s" % (_sensor, a) for a in "xyz")
    BLOCKS[_sensor + "_misalignment"] = tuple(
        "%s_misalignment_%s%s_deg" % (_sensor, "xyz"[i], "xyz"[j]) for i, j in PAIRS)
    BLOCKS[_sensor + "_bias"] = tuple("%s_bias_%s_%s" % (_sensor, a, _unit) for a in "xyz")
    BLOCKS[_sensor + "_noise"] = tuple("%s_noise_%s_%s" % (_sensor, a, _unit) for a in "xyz")
NAMES = tuple(name for names in BLOCKS.values() for name in names)
PLACE = {name: k for k, name in enumerate(NAMES)}
SUBMEANS_HZ = 4.0  # of block_measures.white: how many values a second its estimate is made of
STEP = 1e-6  # of the numerical derivatives


@dataclass(frozen=True, eq=False)
class Estimate:
    """value (len(NAMES),), nan where nothing is known; covariance {block: (k, k)}."""

    value: np.ndarray
    covariance: dict

    def of(self, block):
        """(value (k,), covariance (k, k)) of a block."""
        index = [PLACE[name] for name in BLOCKS[block]]
        return self.value[index], self.covariance[block]


def nominal(name):
    """What a parameter is where a part has no error; None of a noise, which has no such value."""
    if "_noise_" in name:
        return None
    return 1.0 if "_scale_" in name else 0.0


def unit(name):
    """The unit of a parameter, for people."""
    if "_misalignment_" in name:
        return "°"
    if "_noise_" in name:
        return "mg/√Hz" if name.startswith("accel") else "°/s/√Hz"
    if "_bias_" in name:
        return "mg" if name.startswith("accel") else "°/s"
    return ""


def unknown():
    """An Estimate of nothing."""
    return Estimate(np.full(len(NAMES), np.nan),
                    {block: np.full((len(names),) * 2, np.nan) for block, names in BLOCKS.items()})


def estimate(P, sigma_P, g, gyro=None, noise=None):
    """Estimate of an accelerometer's P (4 x 4, m/s²; None: no such) with its standard errors.

    gyro   (P 4 x 3 rad/s, sigma 4 x 3, bias_dps (3,), sigma_bias_dps (3,), missing axes) or None
    noise  {sensor: ((3,) of a mean over one second, seconds at rest)} or None
    """
    estimated = unknown()
    if P is not None:
        _matrix(estimated, "accel", np.array(P, float)[:, :3], np.array(sigma_P, float)[:, :3],
                -1e3 / g, ())
    if gyro is not None:
        P, sigma, bias, sigma_bias, missing = gyro
        _matrix(estimated, "gyro", np.array(P, float)[:, :3], np.array(sigma, float)[:, :3],
                -math.degrees(1.0), missing)
        _put(estimated, "gyro_bias", np.array(bias, float), np.diag(np.square(sigma_bias)))
    for sensor, (level, seconds) in (noise or {}).items():
        # of a standard deviation from n successive differences [von Neumann et al., Annals of
        # Mathematical Statistics 12 (1941) 153]
        relative = 0.5 * math.sqrt(3.0 / max(SUBMEANS_HZ * seconds, 1.0))
        level = np.array(level, float)
        _put(estimated, sensor + "_noise", level, np.diag((relative * level) ** 2))
    return estimated


def _put(estimated, block, value, covariance):
    estimated.value[[PLACE[name] for name in BLOCKS[block]]] = value
    estimated.covariance[block][:] = covariance


def _forms(P, bias_unit):
    """Scale (3,), misalignment (6,) and bias (3,) of P (4, 3): see scale_form()."""
    T, scale, v, _ = scale_form(P.tolist())
    return np.concatenate([scale, [math.degrees(T[i][j]) for i, j in PAIRS],
                           bias_unit * np.array(v)])


def _matrix(estimated, sensor, P, sigma, bias_unit, missing):
    """Puts scale, misalignment and bias of a P with standard errors (4, 3), taken as independent,
    into an Estimate; those of axes that were not turned are unknown."""
    value = _forms(P, bias_unit)
    slope = np.empty((12, 12))
    for k in range(12):
        moved = P.copy()
        moved.flat[k] += STEP
        slope[:, k] = (_forms(moved, bias_unit) - value) / STEP
    covariance = slope * np.square(sigma).ravel() @ slope.T
    known = np.array([[k not in missing] for k in range(3)] + [
        [j not in missing and i not in missing] for i, j in PAIRS] + [[True]] * 3).ravel()
    value = np.where(known, value, np.nan)
    for block, own in (("_scale", slice(0, 3)), ("_misalignment", slice(3, 9)),
                       ("_bias", slice(9, 12))):
        _put(estimated, sensor + block, value[own], covariance[own, own])


def of_solution(solved, session):
    """Estimate of a solution.Solution and its blocks.Session (None: nothing on the noise)."""
    accel, gyro, noise = solved.accel, None, {}
    usable = accel is not None and solved.verdict != "refused"
    if solved.gyro is not None and solved.gyro.verdict != "refused":
        measured = solved.gyro
        gyro = (measured.P, measured.sigma, measured.bias_dps, measured.sigma_bias_dps,
                measured.missing)
    if session is not None and session.n:
        seconds = float(session.seconds.sum())
        for sensor in ("accel", "gyro"):
            level = getattr(session, "noise_" + sensor)
            if level is not None:
                noise[sensor] = level, seconds
    return estimate(accel.P if usable else None, accel.sigma_P if usable else None, solved.g, gyro,
              noise)


def of_record(record):
    """Estimate of a correction record; of a refused one, or without standard errors, nothing."""
    accel, gyro = record.accel, record.gyro
    if accel and (accel["verdict"] == "refused" or any(
            s is None for row in accel["sigma_P"] for s in row[:3])):
        accel = None
    if gyro and (gyro["verdict"] == "refused" or any(
            s is None for row in gyro["sigma_P"] for s in row[:3])):
        gyro = None
    told = None
    if gyro:
        from ..history.parameters import gyro_bias_dps
        told = (gyro["P"], gyro["sigma_P"], gyro_bias_dps(gyro["P"]),
                [math.degrees(s) for s in gyro["sigma_P"][3][:3]], gyro["missing"])
    return estimate(accel and accel["P"], accel and accel["sigma_P"], record.g, told)
