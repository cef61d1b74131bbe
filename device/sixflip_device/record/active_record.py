"""The active record: does it fit this sensor, what is corrected by it, and the one before it.

Activating a record makes the correction of its numbers, of its terms as well where it has some.
"""

from sixflip.record.record import Record


def blank_record(firmware):
    """A record that knows its sensor and holds nothing measured yet."""
    imu = firmware.sensor.imu
    record = Record()
    record.chip = imu.sensor
    record.who_am_i = tuple(imu.who_am_i)
    record.accel_range_g = imu.accel_range_g
    record.gyro_range_dps = imu.gyro_range_dps
    record.accel_lsb_per_g = imu.accel_lsb_per_g
    record.gyro_lsb_per_dps = imu.gyro_lsb_per_dps
    record.g = firmware.settings["g"]
    return record


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


def load(firmware):
    """Finds the newest record that fits; "" or why there is none. Tells it as an event."""
    from .record_slots import RecordSlots
    slot, record, refusals = RecordSlots(firmware.board.root).load(misfit(blank_record(firmware)))
    firmware.slot, firmware.record = slot, record
    refused = dict(refusals)
    if record is None:
        reason = "; ".join(["slot %s: %s" % r for r in refusals]) or "none is stored"
        firmware.events.emit("no_record", reason=reason, refused=refused)
        return reason
    from ..capture.files import finish_interrupted
    finish_interrupted(firmware.board.root, record.session)
    accel = record.accel
    firmware.events.emit("record", slot=slot, sequence=record.sequence, session=record.session,
                     verdict=accel["verdict"], reason=accel["reason"], temp_c=record.temp_c,
                     measured=record.measured(), terms=[tag for tag, _ in record.terms],
                     refused=refused)
    return ""


def _term_range_teller(firmware):
    """For a TermCorrection: tells, once, a temperature outside of what its terms were measured at.
    """
    def tell(temp_c, low_c, high_c):
        firmware.events.emit("term_range", temp_c=temp_c, low_c=low_c, high_c=high_c,
                         note="outside of what the terms were measured at; the edge holds")
    return tell


def activate(firmware):
    """From now on firmware.record corrects, or the data sheet's numbers without one. Terms that
    cannot be are told and left out."""
    from sixflip.record.correction import Correction, correction_of
    record = firmware.record
    firmware.bias_dps = None
    if record is None:
        firmware.correction = Correction(blank_record(firmware))
        return
    try:
        firmware.correction = correction_of(record, _term_range_teller(firmware))
    except ValueError as e:
        firmware.events.error("the record's terms are not in force: %s" % e,
                          "sections as sixflip.record.term_correction has them")
        firmware.correction = Correction(record)
    if record.gyro_bias is not None:
        firmware.bias_dps = record.gyro_bias["bias_dps"]


run = activate


def restore(firmware):
    """The record before this one becomes the newest again."""
    from .record_slots import RecordSlots
    try:
        slot, record = RecordSlots(firmware.board.root).restore(misfit(blank_record(firmware)))
    except ValueError as e:
        firmware.events.error("restore: %s" % e, "an older valid record for this sensor")
        return
    except OSError as e:
        firmware.events.error("restore: the flash gives an error: %s" % e, "room for a record")
        return
    firmware.slot, firmware.record = slot, record
    activate(firmware)
    firmware.events.emit("restored", slot=slot, sequence=record.sequence, session=record.session)
