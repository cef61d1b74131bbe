"""The accelerometer from a session's placements (METHOD 1), and a record begun with it.

How far the flips turned is taken from the gyro of an earlier session, where there is one: by this
session's own gyro it would be circular, for its scale is to come from these flips.
"""

import math
from array import array

from sixflip import RAIL
from sixflip.accelerometer.solver import solve
from sixflip.accelerometer.verdict import judge_accelerometer
from sixflip.poses.faces import AXIS, FACES, pose_name

from ..record.active_record import blank_record
from .session_values import Calibration

NO_EARLIER_GYRO = "no gyro was calibrated in an earlier session"


def run(firmware, session):
    """The Calibration of a SessionResult, as far as the accelerometer goes."""
    imu = firmware.sensor.imu
    record = blank_record(firmware)
    record.session = session.number
    record.temp_c = _temperature(imu, session.placements)
    return calibrate_accelerometer(session.placements, session.moves, record, firmware.record,
                                   imu.accel_rail)


def calibrate_accelerometer(placements, moves, record, earlier=None, rail=RAIL):
    """The Calibration of a session's placements.

    record   a Record that knows its sensor, and nothing else yet; it is filled in
    earlier  the Record before this one, or None: its gyro tells how far the flips turned
    rail     count at which the accelerometer is saturated
    """
    angles, record.flips, flips = _flip_angles(placements, moves, record, earlier)
    result, failure = None, ""
    try:
        result = solve(placements, record.accel_lsb_per_g, record.g, angles=angles)
    except ValueError as e:
        failure = str(e)
    verdict, reason = judge_accelerometer(result, placements, record.accel_lsb_per_g,
                                          failure=failure, rail=rail)
    facts = {}
    if result is not None:
        facts = _facts(result, flips)
        record.accel = _section(result, verdict, reason)
    return Calibration(record, verdict, reason, facts, angles)


def _temperature(imu, placements):
    """Mean over the poses, degrees C, or None."""
    n = sum([p.n for p in placements])
    if not imu.has_temp or not n:
        return None
    return sum([p.sums[6] for p in placements]) / n / imu.temp_lsb_per_c + imu.temp_offset_c


def _flip_angles(placements, moves, record, earlier):
    """({face: rad}, empty where half turns are assumed; section of the record; for the host)."""
    gyro = earlier.gyro if earlier is not None and record.gyro_lsb_per_dps else None
    angles, section, reason = {}, None, ""
    if gyro is None or earlier.session == record.session:
        reason = NO_EARLIER_GYRO
    elif gyro["verdict"] != "good":
        reason = "the stored gyro is " + gyro["verdict"]
    else:
        known = [k for k in range(3) if k not in gyro["missing"]]
        sigma = max([gyro["sigma_P"][k][k] for k in known])
        from sixflip.gyro.flips import measured_angles, worthwhile  # no first session needs it
        try:
            found = measured_angles(placements, moves, record.gyro_lsb_per_dps, gyro["P"])
            angles = worthwhile({f: found[f] for f in found if AXIS[f] in known}, sigma)
            if not angles:
                reason = "the stored gyro saw no flip off by more than its own error"
        except ValueError as e:
            reason = str(e)
    if angles:
        section = {"excess": [angles.get(f, math.pi) - math.pi for f in range(6)],
                   "scale_sigma": sigma, "sequence": earlier.sequence}
    told = {"taken_as": "measured" if angles else "180 degrees", "reason": reason}
    if earlier is not None and record.gyro_lsb_per_dps:
        told["angles_deg"] = {FACES[f]: math.degrees(angles[f]) for f in sorted(angles)}
    return angles, section, told


def _rms_g(residual):
    """Root mean square over poses and axes, g."""
    squares = [x * x for pose in residual for x in residual[pose]]
    return (sum(squares) / len(squares)) ** 0.5


def _facts(r, flips):
    return {"level": r.level, "tilt_deg": r.tilt_deg, "tilt_spread_deg": r.tilt_spread_deg,
            "residual_mg_rms": 1000 * _rms_g(r.residual),
            "residual_mg": {pose_name(p): array("f", [1000 * x for x in r.residual[p]])
                            for p in r.residual},
            "scale": r.scale, "v": r.v, "noise_mg": 1000 * r.noise_g, "flips": flips}


def _section(r, verdict, reason):
    return {"P": r.P, "sigma_P": r.sigma_P, "tilt_deg": r.tilt_deg,
            "tilt_spread_deg": r.tilt_spread_deg, "residual_rms_g": _rms_g(r.residual),
            "noise_g": r.noise_g, "level": r.level, "verdict": verdict, "reason": reason}
