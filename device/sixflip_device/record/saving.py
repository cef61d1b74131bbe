"""Last phase of a calibration: what came of it is told, and the record goes to flash.

A refused session replaces nothing: its capture is kept as refused.bin, and the record
before goes on. A good one that says nothing new is kept as unsaved.bin.

Is a new calibration worth a write to the flash?
"""

from ..capture.files import keep, keep_unsaved, refuse
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


def _file_away(unit, how):
    """how: of capture_files. A capture that cannot be renamed stays as capture.new."""
    if unit.taken.kept:
        try:
            how(unit.board.root)
        except OSError as e:
            unit.events.error("the capture stays as capture.new: %s" % e, "a rename that works")


def _tell(unit):
    """The solved event; True when there is something to save."""
    taken = unit.taken
    if taken.how != "complete":
        unit.events.emit("solved", verdict="refused", reason=taken.ended,
                         missing=taken.missing)
        return False
    if taken.verdict != "refused":
        from sixflip.record.record import implausible
        reason = implausible(taken.record)
        if reason:  # it would not be read back
            taken.verdict, taken.reason = "refused", "no sensor is like that: " + reason
    unit.events.emit("solved", verdict=taken.verdict, reason=taken.reason, **taken.facts)
    taken.facts = None
    return taken.verdict != "refused"


def _save(unit, new):
    """Writes it if it says anything new; sets unit.record and unit.slot."""
    from .active_record import again
    again(unit, new)
    old = unit.record
    if old is not None:
        new.mounting = old.mounting  # the box has moved, the sensor in it has not
        new.terms = old.terms  # they count from whatever temperature it is calibrated at
        if unchanged(old, new):
            _file_away(unit, keep_unsaved)
            return unit.events.emit(
                "saved", slot=unit.slot, sequence=old.sequence, written=False, capture=UNSAVED,
                reason="no number changed by more than its uncertainty")
    from .record_slots import RecordSlots
    unit.record = new
    try:
        unit.slot = RecordSlots(unit.board.root).save(new)
    except OSError as e:
        unit.slot = None
        unit.events.error("the record could not be written: %s; it is in force until the "
                          "power goes" % e, "room for 1 KB on the flash")
        return _file_away(unit, keep_unsaved)
    _file_away(unit, keep)
    return unit.events.emit("saved", slot=unit.slot, sequence=new.sequence, written=True)


def run(unit):
    taken = unit.taken
    taken.placements = taken.moves = None
    if _tell(unit):
        _save(unit, taken.record)
    elif taken.how == "complete":
        _file_away(unit, refuse)
    else:
        from ..capture.cut_short import file_cut_short
        _file_away(unit, file_cut_short)
    unit.taken = None
    if taken.how == "bus lost":
        unit.events.error(taken.ended, "the sensor that was there a moment ago")
        return "start"
    return "resume"
