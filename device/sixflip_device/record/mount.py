"""How the sensor sits in the robot: measured at rest, stored in the record, and active at once.

{"cmd": "mount", "axes": "-y x z", "frame": "ned", "order": "xyz"}; what it leaves out is as
"mounting" in sixflip.json says, or else axes x y z, frame rep103, the paper's choice of order.
{"cmd": "mount", "off": true} takes the mounting out of the record.
"""

import math

from sixflip.record.correction import correction_of
from sixflip.record.mounting import estimate, parse_axes

from .active_record import activate
from .check_at_rest import shaken

OFF_G = 0.02        # |G| of a calibrated sensor at rest
CHANGED_DEG = 0.1   # below it, nothing is written at power-up
KEYS = ("axes", "frame", "order")


def _options(firmware, command):
    """What estimate() takes; ValueError with a sentence."""
    options = {}
    for source in (firmware.settings["mounting"] or {}, command):
        for name in KEYS:
            if source.get(name) is not None:
                if not isinstance(source[name], str):
                    raise ValueError("%s is %s: expected a text" % (name, str(source[name])[:20]))
                options[name] = source[name]
    parse_axes(options.get("axes", "x y z"))
    if options.get("order", "xyz") not in ("xyz", "yxz"):
        raise ValueError("order %s: expected xyz or yxz" % options["order"][:20])
    if options.get("frame", "ned") not in ("rep103", "ned"):
        raise ValueError("frame %s: expected rep103 or ned" % options["frame"][:20])
    return options


def _gravity(firmware, rest):
    """G in g in the sensor's axes, corrected; ValueError unless it is gravity and no more."""
    if not rest.still:
        raise ValueError("not at rest: " + rest.reason)
    reason = shaken(firmware, rest)
    if reason:
        raise ValueError(reason + "; stop the engine")
    record = firmware.record
    held, record.mounting = record.mounting, None  # it must not turn what is to be measured
    G = [x / record.g for x in correction_of(record).apply(rest.means, [0.0] * 6)[:3]]
    record.mounting = held
    size = math.sqrt(sum([x * x for x in G]))
    if not abs(size - 1.0) <= OFF_G:
        raise ValueError("gravity reads %.3f g, %.2f to %.2f is the limit: calibrate again"
                         % (size, 1 - OFF_G, 1 + OFF_G))
    return G


def _same(old, new):
    if old is None:
        return new is None
    if new is None:
        return False
    for name in KEYS:
        if old[name] != new[name]:
            return False
    for name in ("roll_deg", "pitch_deg"):
        if abs((old[name] - new[name] + 180) % 360 - 180) > CHANGED_DEG:
            return False
    return True


def _take(firmware, mounting, rest):
    """Stores the mounting with the record and activates it; OSError when the flash fails."""
    from .record_slots import RecordSlots
    record = firmware.record
    before = record.mounting, record.sequence
    record.mounting = mounting
    try:
        slot = RecordSlots(firmware.board.root).save(record)
    except OSError:
        record.mounting, record.sequence = before
        raise
    bias, means = firmware.bias_dps, firmware.correction.rest
    firmware.slot = slot
    activate(firmware)
    if means is not None:
        firmware.correction.set_rest(means)
        firmware.bias_dps = bias
    firmware.output = None


def _refuse(firmware, reason):
    held = firmware.record is not None and firmware.record.mounting is not None
    firmware.events.emit("not_mounted", reason=reason, mounting="stored" if held else "none")


def _tell(firmware, rest, written):
    facts = dict(firmware.record.mounting or {})
    if rest is not None:
        # of the angles, by noise alone
        noise = max(rest.noise[:3]) / firmware.sensor.imu.accel_lsb_per_g
        facts["sigma_deg"] = math.degrees(noise / math.sqrt(rest.n))
    firmware.events.emit("mounted", off=rest is None, slot=firmware.slot, written=written,
                     sequence=firmware.record.sequence, **facts)


def measure(firmware, rest, command, always=True):
    """From a Rest; a "mounted" event, or "not_mounted" with the reason.

    always False: the same angles as before are not written again.
    """
    try:
        mounting = estimate(*_gravity(firmware, rest), **_options(firmware, command))
        written = always or not _same(firmware.record.mounting, mounting)
        if written:
            _take(firmware, mounting, rest)
    except ValueError as e:
        return _refuse(firmware, str(e))
    except OSError as e:
        return _refuse(firmware, "the record could not be written: %s" % e)
    return _tell(firmware, rest, written)


def mount(firmware, command):
    """Obeys the command; it is answered with a "mounted" or "not_mounted" event."""
    if firmware.record is None:
        return _refuse(firmware, "no correction is in force: calibrate first")
    try:
        _options(firmware, command)
        if command.get("off") is True:
            if firmware.record.mounting is not None:
                _take(firmware, None, None)
            return _tell(firmware, None, True)
    except ValueError as e:
        return _refuse(firmware, str(e))
    except OSError as e:
        return _refuse(firmware, "the record could not be written: %s" % e)
    from .check_at_rest import refresh
    return measure(firmware, refresh(firmware, max(3.0, firmware.settings["rest_s"])), command)


def at_power_up(firmware, rest):
    """When sixflip.json says so; "at_power_up": false leaves it to the command."""
    if firmware.settings["mounting"].get("at_power_up", True) and rest.reason != "interrupted":
        measure(firmware, rest, {}, False)
