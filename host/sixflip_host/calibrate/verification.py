"""Every comparison of a board's record against the same capture solved here, and the fields of
a record that nobody can recompute from it."""

from sixflip.accelerometer.solver import best_level
from sixflip.poses.faces import face_of_code

from ..record_terms import names_of
from . import solution, verify_checks, verify_gyro

# Why a field is not verifiable.
SAVED = "the board counted or noted it when it saved the record"
HEADER = "the capture's header does not say it"
SUMS = "the board kept only the sums"
EARLIER = "the record whose gyro measured the flips is not here"
INSTALLED = "measured after the session, where the sensor is installed"
OTHER_CAPTURES = "other captures than this one told it: sixflip diagnose --record"
LATER = "this sixflip does not know the section"


def verify(capture, record, before=None):
    """Every Check of a record against a capture, and remarks on what could not be checked.

    before  the record before, None where there is none
    """
    remarks = []
    checks = verify_checks.belong_together(capture, record)
    if capture.truncated:
        remarks.append("the capture is not whole: " + capture.truncated)
        checks.append(verify_checks.Check("capture", capture.truncated, "", False, "whole"))
    if capture.sums_only:
        remarks.append("the board kept only the sums: this vouches for the solve alone, "
                       "not for the sums it started from")
    elif capture.board_placements is None:
        remarks.append("a text capture has no sums of the board: the host's own are used")
    else:
        checks += verify_checks.pose_blocks(capture)
    placements = capture.board_placements or capture.placements()
    if record.accel is None:
        return checks + [verify_checks.Check("accelerometer", "not in the record", "", False)], \
            remarks
    checks += verify_checks.accelerometer(record, placements, record.accel_lsb_per_g,
                                          verify_gyro.flip_angles(record))
    compared, said = verify_gyro.flip_checks(capture, record, placements, before)
    checks += compared
    remarks += said
    old_gyro = before and before.gyro["P"]
    checks += _verdict(capture, record, placements, old_gyro)
    compared, said = verify_gyro.checks(capture, record, placements, old_gyro)
    checks += compared
    remarks += said
    if record.gyro_lsb_per_dps:
        checks += verify_checks.gyro_bias(record, placements)
    checks += verify_checks.temperature(record, capture, placements)
    return checks, remarks


def _verdict(capture, record, placements, old_gyro):
    """Level, and the verdict the shared judge gives now that the samples are at hand."""
    host = solution.judge(capture, placements, record.g, record.accel["level"],
                          angles=verify_gyro.flip_angles(record))
    verify_gyro.doubt_flips(capture, record, placements, host, old_gyro)
    check = verify_checks.same("verdict", record.accel["verdict"], host.verdict)
    if capture.sums_only and (check.board, check.host) == ("doubtful", "good") \
            and "flip" in record.accel["reason"]:
        check.ok = True     # what the gyro saw of the flips was not kept
    if not check.ok:
        check.host = "%s: %s" % (host.verdict, host.reason)
    checks = [check, verify_checks.same("level", record.accel["level"], best_level(
        [one.pose for one in placements if face_of_code(one.pose) >= 0]))]
    if check.ok and not capture.sums_only:
        checks.append(verify_checks.same_words("reason", record.accel["reason"], host.reason,
                                               record.float_bits))
    return checks


def not_verifiable(capture, record, before):
    """[(field, why)] of the record's fields that the capture does not determine, in their order.

    before  the record in the other slot, or None
    """
    fields = [("sequence", SAVED), ("time", SAVED)]
    fields += [(name, HEADER) for name in verify_checks.STATED if name not in capture.meta]
    if capture.sums_only:
        fields += [("accel.reason", SUMS), ("gyro", SUMS)]
    if record.flips is not None:
        if capture.sums_only:
            fields.append(("flips", SUMS))
        elif before is None or before.sequence != record.flips["sequence"]:
            fields += [("flips.scale_sigma", EARLIER), ("flips.sequence", EARLIER)]
    if record.mounting is not None:
        fields.append(("mounting, roll %.4g pitch %.4g degrees" % (
            record.mounting["roll_deg"], record.mounting["pitch_deg"]), INSTALLED))
    fields += [(name, OTHER_CAPTURES) for name in names_of(record)]
    return fields + [("section %d" % tag, LATER) for tag, _ in record.unknown]
