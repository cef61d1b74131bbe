"""What the host may ask for, one JSON line each.

    {"cmd": "info"}                              -> hello-like line: record, files, free bytes
    {"cmd": "calibrate"}                         guided calibration now; other ones: see asked.py
    {"cmd": "redo", "face": "Z+"}                that face again, now or of the session before
    {"cmd": "undo"}                              while calibrating
    {"cmd": "stream", "raw": true, "hz": 50}     what is streamed; hz 0: nothing; "heading" in
                                                 place of "raw", "binary": frames, not lines;
                                                 "record" instead of all: blocks of a capture
    {"cmd": "check"}                             is the calibration still valid?
    {"cmd": "mount"}                             how the sensor sits in the robot: mount.py
    {"cmd": "restore"}                           the record before this one
    {"cmd": "stop"}                              ends a calibration, or the firmware
    {"cmd": "reset"}
"""

from .flash_files import free_bytes


def _info(unit, command):
    from .capture.cut_short import unfinished
    record = unit.record
    unit.events.emit(
        "info", board=unit.board.name, id=unit.board.unique_id,
        sensor=None if unit.sensor is None else unit.sensor.imu.sensor,
        slot=unit.slot, sequence=None if record is None else record.sequence,
        verdict=None if record is None else record.accel["verdict"],
        stream_hz=unit.stream_hz, raw=unit.raw, heading=unit.heading, binary=unit.binary,
        bias_dps=unit.bias_dps,
        unfinished=unfinished(unit.board.root),
        bus_errors=0 if unit.sensor is None else unit.sensor.errors,
        free_bytes=free_bytes(unit.board.root))


def _stream(unit, command):
    hz = command.get("hz", unit.stream_hz)
    raw = command.get("raw", unit.raw and not command.get("heading"))
    heading = command.get("heading", unit.heading and not raw)
    binary = command.get("binary", unit.binary)
    if isinstance(hz, bool) or not isinstance(hz, (int, float)) or not 0 <= hz <= 500:
        unit.events.error("stream: hz is %s" % str(hz)[:20], "a number from 0 to 500")
        return
    record = command.get("record", False)
    for value in (raw, heading, binary, record):
        if not isinstance(value, bool):
            unit.events.error("stream: raw, heading, binary or record is %s" % str(value)[:20],
                              "true or false")
            return
    if raw and heading:
        unit.events.error("stream: raw and heading", "one of the two")
    elif heading and unit.sensor is not None and not unit.sensor.imu.has_gyro:
        unit.events.error("stream: no heading, the %s has no gyro" % unit.sensor.imu.sensor,
                          "a sensor with a gyro")
    else:
        unit.stream_hz = hz
        unit.raw, unit.heading, unit.binary, unit.recording = raw, heading, binary, record
        unit.output = None  # to be made as it is now wanted
        unit.events.emit("stream", hz=hz, raw=raw, heading=heading, binary=binary, record=record)


def _calibrate(unit, command):
    special = "poses" in command or "continue" in command or "record" in command
    unit.request = command if special else None
    unit.asked = True


def _redo(unit, command):
    unit.request = {"redo": command.get("face")}
    unit.asked = True


def _stop(unit, command):
    unit.stopped = True


def _restore(unit, command):
    from .record import active_record
    active_record.restore(unit)


def _check(unit, command):
    from .record.refresh import check
    check(unit)


def _mount(unit, command):
    from .record.mount import asked
    asked(unit, command)


def _reset(unit, command):
    unit.events.emit("reset")
    unit.board.reset()


ALWAYS = {"info": _info, "stream": _stream, "reset": _reset}
IDLE = {"calibrate": _calibrate, "redo": _redo, "stop": _stop}
WITH_SENSOR = {"restore": _restore, "check": _check, "mount": _mount}


def obey(unit, command, calibrating):
    cmd = command["cmd"]
    action = ALWAYS.get(cmd)
    if action is None and not calibrating:
        action = IDLE.get(cmd)
        if action is None and unit.sensor is not None:
            action = WITH_SENSOR.get(cmd)
    if action is not None:
        action(unit, command)
    elif cmd in IDLE or cmd in WITH_SENSOR:
        unit.events.error("%s is not possible now" % cmd, "no calibration under way, and a sensor")
    elif cmd == "undo":
        unit.events.error("%s outside a calibration" % cmd, "calibrate first")
    else:
        unit.events.error("unknown command %s" % cmd[:20],
                          "info calibrate redo undo stream check mount restore stop reset")
