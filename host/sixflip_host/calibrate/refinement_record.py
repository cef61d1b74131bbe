"""Between a refinement's parameters and the correction record that a board loads."""

import numpy as np

from sixflip.record.correction_record import Record
from sixflip.record.record import following

from .. import record_terms
from ..errors import BadFile, CheckFailed
from . import joint_refinement
from .joint_refinement import N_ACCEL, N_GYRO

BIASES = ["accelerometer %s bias" % axis for axis in "xyz"]
RAD = np.pi / 180.0


def parameters(record, flips, g):
    """Parameters (see refinement_residuals) out of a correction Record."""
    p = joint_refinement.nominal(flips)
    if record.accel is None:
        raise BadFile("the record holds no accelerometer, there is nothing to keep")
    P = np.array(record.accel["P"])
    p[:9] = P[:3, :3].T.ravel()
    p[9:12] = P[3, :3] / record.g
    W = p[N_ACCEL : N_ACCEL + N_GYRO].reshape(3, 7)
    if record.gyro is not None:
        P = np.array(record.gyro["P"])
        W[:, :3], W[:, 3] = P[:3].T, P[3]
    if record.gyro_bias is not None:
        W[:, 3] = -W[:, :3] @ np.array(record.gyro_bias["bias_dps"]) * RAD
    return p


def build(capture, refined, kept=None):
    """The Record of a refinement's dictionary.

    kept: the record it started from; its identity, mounting and unsolved parts stay.
    Raises CheckFailed for what the record cannot hold.
    """
    record = Record() if kept is None else kept
    meta = capture.meta
    if kept is None:
        record.chip = meta["sensor"]
        session, who = meta.get("session"), meta.get("who_am_i")
        record.session = session & 0xFFFFFFFF if isinstance(session, int) else 0
        if isinstance(who, list) and len(who) == 2 and all(isinstance(k, int) for k in who):
            record.who_am_i = (who[0] & 0xFF, who[1] & 0xFF)
        record.accel_lsb_per_g = float(meta["accel_lsb_per_g"])
        record.accel_range_g = int(meta.get("accel_range_g", 0))
        record.gyro_lsb_per_dps = float(meta.get("gyro_lsb_per_dps", 0))
        record.gyro_range_dps = int(meta.get("gyro_range_dps", 0))
        record.g = float(refined["g"])
    elif abs(record.accel_lsb_per_g - meta["accel_lsb_per_g"]) > 1e-3 * record.accel_lsb_per_g:
        raise CheckFailed("the record is for %g counts per g, the capture has %g"
                          % (record.accel_lsb_per_g, meta["accel_lsb_per_g"]))
    if capture.temp is not None and (kept is None or set(BIASES) <= set(refined["solved"])):
        # A term that follows the temperature counts from that of the bias.
        record.temp_c = (float(np.mean(capture.temp)) / meta["temp_lsb_per_c"]
                         + meta["temp_offset_c"])
    record.sequence = following(record.sequence)
    record.accel = _accelerometer(refined, kept)
    gyro = refined["gyro"]
    if gyro is not None:
        if gyro["per_g_dps"]:
            record_terms.put(record, "g_sensitivity", {
                "k": gyro["per_g_dps"], "sigma": gyro["per_g_sigma_dps"], "axes": [0, 1, 2],
                "origin": "refinement", "source": "", "before": None, "after": None,
                "floor": None})
        record.gyro = {"P": gyro["P"], "sigma_P": gyro["sigma"]["P"], "missing": [],
                       "verdict": refined["verdict"], "reason": refined["reason"]}
        record.gyro_bias = {"bias_dps": gyro["bias_dps"], "temp_c": record.temp_c}
    return record


def _accelerometer(refined, kept):
    accel = refined["accel"]
    fields = {"P": accel["P"], "sigma_P": accel["sigma"]["P"],
              "tilt_deg": None, "tilt_spread_deg": None, "noise_g": None}
    level = "tilt solved" if len(refined["flips"]) == 6 else "no flips"
    if kept is not None:
        fields.update({k: kept.accel[k] for k in ("tilt_deg", "tilt_spread_deg", "noise_g")})
        level = kept.accel["level"]
    fields.update(level=level, residual_rms_g=refined["norm_off_mg_rms"] * 1e-3,
                  verdict=refined["verdict"], reason=refined["reason"])
    return fields
