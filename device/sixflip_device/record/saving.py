"""The last phase of a calibration: what came of it is told, and the record goes to flash.

A refused session replaces nothing: its capture is kept as refused.bin, and the record before
stays active. The capture of a good one that says nothing new is kept as unsaved.bin, and the flash
is not written to: its blocks bear only so many writes.
"""

from ..capture.files import file_cut_short, keep, keep_unsaved, refuse
from ..flash_files import UNSAVED

TIMES = 2.0  # standard errors of the difference


def _same(old, new):
    """P of two sections agrees within TIMES its uncertainty (and has not become surer)."""
    for i in range(len(old["P"])):
        for j in range(3):
            s, t = old["sigma_P"][i][j], new["sigma_P"][i][j]
            if s is None or t is None or t < 0.5 * s:
                return False
            if abs(new["P"][i][j] - old["P"][i][j]) > TIMES * (s * s + t * t) ** 0.5:
                return False
    return True


def unchanged(old, new):
    """True when new says nothing that old does not say as well."""
    if old.measured() != new.measured() or old.g != new.g:
        return False
    for name in ("accel", "gyro"):
        a, b = getattr(old, name), getattr(new, name)
        if a is None:
            continue
        if a["verdict"] != b["verdict"] or not _same(a, b):
            return False
    return True


def _file_away(firmware, session, how):
    """how: of capture/files.py. A capture that cannot be renamed stays as capture.new."""
    if session.has_capture:
        try:
            how(firmware.board.root)
        except OSError as e:
            firmware.events.error("the capture stays as capture.new: %s" % e,
                                  "a rename that works")


def _verdict(calibration):
    """(verdict, reason); a record that would not be read back is refused."""
    if calibration.verdict != "refused":
        from sixflip.record.record import implausible
        reason = implausible(calibration.record)
        if reason:
            return "refused", "no sensor is like that: " + reason
    return calibration.verdict, calibration.reason


def _save(firmware, session, new):
    """Writes the record if it says anything new, and makes it the firmware's."""
    old = firmware.record
    if old is not None:
        new.mounting = old.mounting  # the box has moved, the sensor in it has not
        new.terms = old.terms  # they count from whatever temperature it is calibrated at
        if unchanged(old, new):
            _file_away(firmware, session, keep_unsaved)
            firmware.events.emit(
                "saved", slot=firmware.slot, sequence=old.sequence, written=False,
                capture=UNSAVED, reason="no number changed by more than its uncertainty")
            return
    from .record_slots import RecordSlots
    firmware.record = new
    try:
        firmware.slot = RecordSlots(firmware.board.root).save(new)
    except OSError as e:
        firmware.slot = None
        firmware.events.error("the record could not be written: %s; it is in force until the "
                              "power goes" % e, "room for 1 KB on the flash")
        _file_away(firmware, session, keep_unsaved)
        return
    _file_away(firmware, session, keep)
    firmware.events.emit("saved", slot=firmware.slot, sequence=new.sequence, written=True)


def run(firmware, session, calibration):
    """The solved and the saved event; calibration None: the session did not come to its end."""
    if calibration is None:
        firmware.events.emit("solved", verdict="refused", reason=session.ended,
                             missing=session.missing)
        _file_away(firmware, session, file_cut_short)
        return
    verdict, reason = _verdict(calibration)
    firmware.events.emit("solved", verdict=verdict, reason=reason, **calibration.facts)
    if verdict == "refused":
        _file_away(firmware, session, refuse)
    else:
        _save(firmware, session, calibration.record)
