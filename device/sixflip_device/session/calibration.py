"""From a session's placements and moves to a correction record and its verdict.

The accelerometer is solved from the placements (METHOD 1), the gyro from the flips and rests
(METHOD 2), and then each is held against the other: flips that were no half turns show in the
gyro, and make the accelerometer doubtful where the table is tilted.
"""

import math
from array import array

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer.verdict import judge_accelerometer
from sixflip.gyro import solver as gyroscope
from sixflip.gyro.flips import measured_angles, worthwhile
from sixflip.gyro.verdict import accelerometer_doubt, scale_doubt
from sixflip.poses.faces import AXIS, FACES, pose_name

from ..record.active_record import blank_record

NO_EARLIER_GYRO = "no gyro was calibrated in an earlier session"


class Calibration:
    """What a session comes to.

    record           sixflip.record.record.Record, complete but for what the board keeps
                     (mounting, terms) and its sequence number
    verdict, reason  of the accelerometer: "good", "doubtful" or "refused", and a sentence
    facts            what the host is told, for an event
    """

    def __init__(self, record, verdict, reason, facts):
        self.record = record
        self.verdict = verdict
        self.reason = reason
        self.facts = facts


def run(firmware, session):
    """The Calibration of a SessionResult, beside the record that is active until now."""
    imu = firmware.sensor.imu
    record = blank_record(firmware)
    record.session = session.number
    record.temp_c = _temperature(imu, session.placements)
    return calibrate(session.placements, session.moves, record, firmware.record, imu.accel_rail,
                     imu.gyro_tolerance)


def calibrate(placements, moves, record, earlier=None, rail=32767, gyro_tolerance=None):
    """The Calibration of a session's placements and moves.

    record  a Record that knows its sensor, and nothing else yet; it is filled in
    earlier the Record before this one, or None: its gyro tells how far the flips turned, and
            what it knows of axes without a flip is kept
    rail    count at which the accelerometer is saturated; gyro_tolerance: of its scale by its
            data sheet, a part of one, None where that is not known
    """
    angles, record.flips, flips = _flip_angles(placements, moves, record, earlier)
    result, failure = None, ""
    try:
        result = accelerometer.solve(placements, record.accel_lsb_per_g, record.g, angles=angles)
    except ValueError as e:
        failure = str(e)
    verdict, reason = judge_accelerometer(result, placements, record.accel_lsb_per_g,
                                          failure=failure, rail=rail)
    facts = {}
    if result is not None:
        facts = _accelerometer_facts(result, flips)
        record.accel = _accelerometer_section(result, verdict, reason)
    if record.gyro_lsb_per_dps:
        record.gyro_bias = {"bias_dps": _bias_dps(placements, record.gyro_lsb_per_dps),
                            "temp_c": record.temp_c}
        doubt = _calibrate_gyro(placements, moves, record, earlier, gyro_tolerance, angles, facts,
                                verdict != "refused")
        if doubt:
            reason = doubt if verdict == "good" else reason + "; " + doubt
            verdict = "doubtful"
            record.accel["verdict"], record.accel["reason"] = verdict, reason
    return Calibration(record, verdict, reason, facts)


def _temperature(imu, placements):
    """Mean over the poses, degrees C, or None."""
    n = sum([p.n for p in placements])
    if not imu.has_temp or not n:
        return None
    return sum([p.sums[6] for p in placements]) / n / imu.temp_lsb_per_c + imu.temp_offset_c


def _flip_angles(placements, moves, record, earlier):
    """({face: rad} or None where half turns are assumed, section of the record, for the host).

    By this session's own gyro it would be circular: its scale is to come from these flips.
    """
    gyro = earlier.gyro if earlier is not None and record.gyro_lsb_per_dps else None
    angles, section, reason = {}, None, ""
    if gyro is None or earlier.session == record.session:
        reason = NO_EARLIER_GYRO
    elif gyro["verdict"] != "good":
        reason = "the stored gyro is " + gyro["verdict"]
    else:
        known = [k for k in range(3) if k not in gyro["missing"]]
        sigma = max([gyro["sigma_P"][k][k] for k in known])
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


def _bias_dps(placements, lsb_per_dps):
    """Mean of the gyro over all rests."""
    n = sum([p.n for p in placements])
    return [sum([p.sums[3 + k] for p in placements]) / n / lsb_per_dps for k in range(3)]


def _accelerometer_facts(r, flips):
    return {"level": r.level, "tilt_deg": r.tilt_deg, "tilt_spread_deg": r.tilt_spread_deg,
            "residual_mg_rms": 1000 * _rms_g(r.residual),
            "residual_mg": {pose_name(p): array("f", [1000 * x for x in r.residual[p]])
                            for p in r.residual},
            "scale": r.scale, "v": r.v, "noise_mg": 1000 * r.noise_g, "flips": flips}


def _accelerometer_section(r, verdict, reason):
    return {"P": r.P, "sigma_P": r.sigma_P, "tilt_deg": r.tilt_deg,
            "tilt_spread_deg": r.tilt_spread_deg, "residual_rms_g": _rms_g(r.residual),
            "noise_g": r.noise_g, "level": r.level, "verdict": verdict, "reason": reason}


def _calibrate_gyro(placements, moves, record, earlier, tolerance, angles, facts, usable):
    """Fills in record.gyro and facts["gyro"]. What the flips' turns say against the
    accelerometer, or ""; usable: its result is not refused anyway."""
    old = earlier.gyro["P"] if earlier is not None and earlier.gyro else None
    try:
        r = gyroscope.solve(placements, moves, record.gyro_lsb_per_dps,
                            record.accel and record.accel["P"], old, record.accel_lsb_per_g)
    except ValueError as e:
        facts["gyro"] = {"verdict": "refused", "reason": str(e)}
        return ""
    verdict, reason = r.verdict, r.reason
    doubt = scale_doubt(r, tolerance) if verdict == "good" else ""
    if doubt:
        verdict, reason = "doubtful", doubt
    facts["gyro"] = _gyro_facts(r, verdict, reason)
    # a matrix that nobody should use is not kept, but for one that was kept before
    if verdict != "refused" or old is not None and len(r.missing) == 3 and not r.wrong_axes:
        record.gyro = {"P": r.P, "sigma_P": r.sigma, "missing": r.missing, "verdict": verdict,
                       "reason": reason}
    if not usable:
        return ""
    return accelerometer_doubt(r, tolerance, record.accel["tilt_deg"], angles or ())


def _gyro_facts(r, verdict, reason):
    return {"verdict": verdict, "reason": reason, "bias_dps": r.bias_dps,
            "missing": ["xyz"[k] for k in r.missing], "scale": [r.P[k][k] for k in range(3)],
            "flips": {face: {"angle_deg": r.flips[face]["angle_deg"],
                             "used": r.flips[face]["used"]} for face in r.flips}}
