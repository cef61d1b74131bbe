"""The fields of a record that its capture does not determine: nobody can recompute them."""

from ..record_terms import names_of
from .verify_checks import STATED

SAVED = "the board counted or noted it when it saved the record"
HEADER = "the capture's header does not say it"
SUMS = "the board kept only the sums"
EARLIER = "the record whose gyro measured the flips is not here"
INSTALLED = "measured after the session, where the sensor is installed"
OTHER_CAPTURES = "other captures than this one told it: sixflip diagnose --record"
LATER = "this sixflip does not know the section"


def fields(capture, record, before):
    """[(field, why)] in the order of the record; before: the record in the other slot or None."""
    out = [("sequence", SAVED), ("time", SAVED)]
    out += [(name, HEADER) for name in STATED if name not in capture.meta]
    if capture.sums_only:
        out += [("accel.reason", SUMS), ("gyro", SUMS)]
    if record.flips is not None:
        if capture.sums_only:
            out.append(("flips", SUMS))
        elif before is None or before.sequence != record.flips["sequence"]:
            out += [("flips.scale_sigma", EARLIER), ("flips.sequence", EARLIER)]
    if record.mounting is not None:
        out.append(("mounting, roll %.4g pitch %.4g degrees" % (
            record.mounting["roll_deg"], record.mounting["pitch_deg"]), INSTALLED))
    out += [(name, OTHER_CAPTURES) for name in names_of(record)]
    return out + [("section %d" % tag, LATER) for tag, _ in record.unknown]
