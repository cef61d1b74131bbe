"""The record in force: loaded if it fits this sensor, restored (refresh.py: at rest)."""

from .blank_record import blank_record


def misfit(own):
    """A function of a record: "" when it belongs to the sensor of the record own, else why
    not."""
    def reason(record):
        if record.chip != own.chip:
            return "it is for %s, the sensor is %s" % (record.chip, own.chip)
        if tuple(record.who_am_i) != own.who_am_i:
            return "it is for who_am_i %s, the sensor has %s" % (
                _ids(record.who_am_i), _ids(own.who_am_i))
        ranges = (record.accel_range_g, record.gyro_range_dps)
        if ranges != (own.accel_range_g, own.gyro_range_dps):
            return "it is for the ranges %s g and %s deg/s, the sensor is set to %s and %s" % (
                ranges + (own.accel_range_g, own.gyro_range_dps))
        if abs(record.accel_lsb_per_g - own.accel_lsb_per_g) > 0.001 or \
                abs(record.gyro_lsb_per_dps - own.gyro_lsb_per_dps) > 0.001:
            return "it is for %s counts per g and %s per deg/s, the sensor has %s and %s" % (
                record.accel_lsb_per_g, record.gyro_lsb_per_dps, own.accel_lsb_per_g,
                own.gyro_lsb_per_dps)
        if record.accel is None:
            return "it holds no accelerometer correction"
        if record.accel["verdict"] == "refused":
            return "its verdict is refused: " + record.accel["reason"]
        return ""
    return reason


def _ids(ids):
    return "/".join(["0x%02x" % i for i in ids])


def use(unit, slot, record):
    """Makes record (None: the data sheet's numbers) what corrects from now on; its terms, if it
    has some, do not yet: terms.py."""
    from sixflip.record.correction import Correction
    unit.slot = slot
    unit.record = record
    unit.correction = Correction(blank_record(unit) if record is None else record)
    unit.bias_dps = None
    if record is not None and record.gyro_bias is not None:
        unit.bias_dps = record.gyro_bias["bias_dps"]


def recall(unit):
    """Finds the newest record that fits; "" or why there is none. Tells it as an event."""
    from .record_slots import RecordSlots
    slot, record, refusals = RecordSlots(unit.board.root).load(misfit(blank_record(unit)))
    unit.slot, unit.record = slot, record
    refused = dict(refusals)
    if record is None:
        reason = "; ".join(["slot %s: %s" % r for r in refusals]) or "none is stored"
        unit.events.emit("no_record", reason=reason, refused=refused)
        return reason
    from ..capture.files import finish_interrupted
    finish_interrupted(unit.board.root, record.session)
    accel = record.accel
    unit.events.emit("record", slot=slot, sequence=record.sequence, session=record.session,
                     verdict=accel["verdict"], reason=accel["reason"], temp_c=record.temp_c,
                     measured=record.measured(), terms=[tag for tag, _ in record.terms],
                     refused=refused)
    return ""


def again(unit, own):
    """The record that was let go of for a session is read again; own as for misfit()."""
    if unit.record is None and unit.slot is not None:
        from .record_slots import RecordSlots
        unit.slot, unit.record, _ = RecordSlots(unit.board.root).load(misfit(own))


def restore(unit):
    """The record before this one becomes the newest again."""
    from .record_slots import RecordSlots
    try:
        slot, record = RecordSlots(unit.board.root).restore(misfit(blank_record(unit)))
    except ValueError as e:
        unit.events.error("restore: %s" % e, "an older valid record for this sensor")
        return
    except OSError as e:
        unit.events.error("restore: the flash gives an error: %s" % e, "room for a record")
        return
    use(unit, slot, record)
    if record.terms:
        from .terms import beside_stream
        beside_stream(unit)
    unit.events.emit("restored", slot=slot, sequence=record.sequence, session=record.session)
