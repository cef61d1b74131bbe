"""What the gyro saw of the flips reaches both verdicts: a good one becomes doubtful."""

from sixflip.gyro import verdict as gyro_verdict


def run(unit):
    taken = unit.taken
    record = taken.record
    r = taken.gyro
    taken.gyro = None
    tolerance = taken.gyro_tolerance
    if r.verdict == "good":
        said = gyro_verdict.scale_doubt(r, tolerance)
        if said:
            for answer in (taken.facts["gyro"], record.gyro):
                answer["verdict"], answer["reason"] = "doubtful", said
    if taken.verdict != "refused":
        known = taken.angles or ()
        said = gyro_verdict.accelerometer_doubt(r, tolerance, record.accel["tilt_deg"], known)
        if said:
            taken.reason = said if taken.verdict == "good" else taken.reason + "; " + said
            taken.verdict = "doubtful"
            record.accel["verdict"], record.accel["reason"] = "doubtful", taken.reason
    return "saving"
