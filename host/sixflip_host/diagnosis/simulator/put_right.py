"""A simulator's log with its conventions put right, as far as they can be: axes, signs and units.

What is still to be said of it (its numbers, its effects) is then said of the sensor it means.
"""
import copy
from dataclasses import replace

import numpy as np

from sixflip import RAIL

# After these a simulator's numbers are not those of a sensor any more.
SPOILED = ("no_gravity", "gravity_sign", "gravity_after_rotation", "constant_channel",
           "world_frame_forces", "world_frame_rates", "unknown")
# These are wrong only while it moves, or in noise: what its rests say stands.
IN_MOTION = ("time_step", "no_centripetal_term", "lever_arm_missing", "accel_delay", "gyro_delay",
             "accel_rate_held", "gyro_rate_held", "noise_per_sample", "bias_sign")


def trace(log, found):
    """The Trace with axes, signs and units as the Conventions say they should be."""
    force = log.force @ _matrix(found, "accel") / _unit(found, "accel")
    rate = None if log.rate is None else log.rate @ _matrix(found, "gyro") / _unit(found, "gyro")
    return replace(log, force=force, rate=rate)


def capture(log, found):
    """The Capture likewise, a new one, or None where nothing of a sensor is left in it."""
    if any(c.name in SPOILED for c in found):
        return None
    out = copy.copy(log)
    out.accel = _counts(log.accel, _matrix(found, "accel"))
    out.meta = {**log.meta, "accel_lsb_per_g": log.meta["accel_lsb_per_g"]
                * _unit(found, "accel")}
    if log.gyro is not None:
        out.gyro = _counts(log.gyro, _matrix(found, "gyro"))
        out.meta["gyro_lsb_per_dps"] = log.meta["gyro_lsb_per_dps"] * _unit(found, "gyro")
    return out


def only_in_motion(found):
    """True when the log was wrong in what moves it, and the moves of it say nothing."""
    return any(c.name in IN_MOTION for c in found)


def _counts(counts, matrix):
    """int16 (n, 3): counts along other axes; the one count without a mirror image stays."""
    if np.array_equal(matrix, np.eye(3)):
        return counts
    turned = np.asarray(counts, dtype=np.int64) @ matrix.astype(np.int64)
    return np.clip(turned, -RAIL - 1, RAIL).astype(counts.dtype)


def _matrix(found, kind):
    """(3, 3) by which readings (n, 3) of a sensor become the body's."""
    out = np.eye(3)
    for c in found:
        if c.name in (kind + "_axes", "both_axes"):
            out = out @ of_axes(c.value)
        if c.name == "force_sign" and kind == "accel":
            out = -out
    return out


def of_axes(value):
    """(3, 3) of {"x": "-y", ...}"""
    out = np.zeros((3, 3))
    for i, axis in enumerate("xyz"):
        if value[axis] != "0":
            out[i, "xyz".index(value[axis][-1])] = -1.0 if value[axis][0] == "-" else 1.0
    return out


def _unit(found, kind):
    return float(np.prod([c.value["factor"] for c in found if c.name == kind + "_unit"]))
