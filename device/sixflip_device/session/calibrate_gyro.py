"""The gyro from a session's flips and rests (METHOD 2), held against the accelerometer.

Flips that were no half turns show in the gyro, and make the accelerometer doubtful where the table
is tilted: one flip that differs from the others, or all of them, which the moves between the faces
contradict.
"""

from sixflip.gyro.solver import solve
from sixflip.gyro.verdict import accelerometer_doubt, scale_doubt

from .session_values import Calibration


def run(firmware, session, calibration):
    """The Calibration with the gyro in it; firmware.record: that of an earlier session."""
    return calibrate_gyro(calibration, session.placements, session.moves, firmware.record,
                          firmware.sensor.imu.gyro_tolerance)


def calibrate_gyro(calibration, placements, moves, earlier=None, tolerance=None):
    """The Calibration with the gyro's bias, matrix and verdict in it.

    earlier    the Record before this one, or None: its gyro is kept for axes without a flip
    tolerance  of the gyro's scale by its data sheet, a part of one; None: not known
    """
    record = calibration.record
    record.gyro_bias = {"bias_dps": _bias_dps(placements, record.gyro_lsb_per_dps),
                        "temp_c": record.temp_c}
    old = earlier.gyro["P"] if earlier is not None and earlier.gyro else None
    try:
        r = solve(placements, moves, record.gyro_lsb_per_dps,
                  record.accel and record.accel["P"], old, record.accel_lsb_per_g)
    except ValueError as e:
        return _with_gyro(calibration, {"verdict": "refused", "reason": str(e)})
    verdict, reason = r.verdict, r.reason
    doubt = scale_doubt(r, tolerance) if verdict == "good" else ""
    if doubt:
        verdict, reason = "doubtful", doubt
    # a matrix that nobody should use is not kept, but for one that was kept before
    if verdict != "refused" or old is not None and len(r.missing) == 3 and not r.wrong_axes:
        record.gyro = {"P": r.P, "sigma_P": r.sigma, "missing": r.missing, "verdict": verdict,
                       "reason": reason}
    doubt = ""
    if calibration.verdict != "refused":
        doubt = accelerometer_doubt(r, tolerance, record.accel["tilt_deg"], calibration.angles)
    return _with_gyro(calibration, _facts(r, verdict, reason), doubt)


def _bias_dps(placements, lsb_per_dps):
    """Mean of the gyro over all rests."""
    n = sum([p.n for p in placements])
    return [sum([p.sums[3 + k] for p in placements]) / n / lsb_per_dps for k in range(3)]


def _facts(r, verdict, reason):
    """What the host is told of the gyro."""
    return {"verdict": verdict, "reason": reason, "bias_dps": r.bias_dps,
            "missing": ["xyz"[k] for k in r.missing], "scale": [r.P[k][k] for k in range(3)],
            "flips": {face: {"angle_deg": r.flips[face]["angle_deg"],
                             "used": r.flips[face]["used"]} for face in r.flips}}


def _with_gyro(calibration, facts, doubt=""):
    """The Calibration with what there is to tell of the gyro; doubt: what the flips say against
    the accelerometer."""
    record, verdict, reason = calibration.record, calibration.verdict, calibration.reason
    if doubt:
        reason = doubt if verdict == "good" else reason + "; " + doubt
        verdict = "doubtful"
        record.accel["verdict"], record.accel["reason"] = verdict, reason
    return Calibration(record, verdict, reason, dict(calibration.facts, gyro=facts),
                       calibration.angles)
