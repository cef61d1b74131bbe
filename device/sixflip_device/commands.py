"""What the host may ask for, one JSON line each.

    {"cmd": "info"}                              -> hello-like line: record, files, free bytes
    {"cmd": "calibrate"}                         guided calibration now; other ones are in
                                                 session_request.py
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

from sixflip.poses.faces import FACES, face_of_code, pose_name

from .flash_files import free_bytes


def _info(firmware, command):
    from .capture.files import unfinished
    record = firmware.record
    firmware.events.emit(
        "info", board=firmware.board.name, id=firmware.board.unique_id,
        sensor=None if firmware.sensor is None else firmware.sensor.imu.sensor,
        slot=firmware.slot, sequence=None if record is None else record.sequence,
        verdict=None if record is None else record.accel["verdict"],
        stream_hz=firmware.stream_hz, raw=firmware.raw, heading=firmware.heading,
        binary=firmware.binary,
        bias_dps=firmware.bias_dps,
        unfinished=unfinished(firmware.board.root),
        bus_errors=0 if firmware.sensor is None else firmware.sensor.errors,
        free_bytes=free_bytes(firmware.board.root))


def _stream(firmware, command):
    hz = command.get("hz", firmware.stream_hz)
    raw = command.get("raw", firmware.raw and not command.get("heading"))
    heading = command.get("heading", firmware.heading and not raw)
    binary = command.get("binary", firmware.binary)
    if isinstance(hz, bool) or not isinstance(hz, (int, float)) or not 0 <= hz <= 500:
        firmware.events.error("stream: hz is %s" % str(hz)[:20], "a number from 0 to 500")
        return
    record = command.get("record", False)
    for value in (raw, heading, binary, record):
        if not isinstance(value, bool):
            firmware.events.error("stream: raw, heading, binary or record is %s" % str(value)[:20],
                              "true or false")
            return
    if raw and heading:
        firmware.events.error("stream: raw and heading", "one of the two")
    elif heading and firmware.sensor is not None and not firmware.sensor.imu.has_gyro:
        firmware.events.error(
            "stream: no heading, the %s has no gyro" % firmware.sensor.imu.sensor,
            "a sensor with a gyro")
    else:
        firmware.stream_hz = hz
        firmware.raw, firmware.heading = raw, heading
        firmware.binary, firmware.recording = binary, record
        firmware.output = None  # to be made as it is now wanted
        firmware.events.emit("stream", hz=hz, raw=raw, heading=heading, binary=binary,
                             record=record)


def _calibrate(firmware, command):
    special = "poses" in command or "continue" in command or "record" in command
    firmware.request = command if special else {}


def _redo(firmware, command):
    firmware.request = {"redo": command.get("face")}


def _stop(firmware, command):
    firmware.stopped = True


def _restore(firmware, command):
    from .record.active_record import restore
    restore(firmware)


def _check(firmware, command):
    from .record.check_at_rest import check
    check(firmware)


def _mount(firmware, command):
    from .record.mount import mount
    mount(firmware, command)


def _reset(firmware, command):
    firmware.events.emit("reset")
    firmware.board.reset()


ALWAYS = {"info": _info, "stream": _stream, "reset": _reset}
IDLE = {"calibrate": _calibrate, "redo": _redo, "stop": _stop}
WITH_SENSOR = {"restore": _restore, "check": _check, "mount": _mount}


def obey(firmware, command, calibrating):
    """Obeys a command (a dict with "cmd"), or answers with an error event."""
    cmd = command["cmd"]
    action = ALWAYS.get(cmd)
    if action is None and not calibrating:
        action = IDLE.get(cmd)
        if action is None and firmware.sensor is not None:
            action = WITH_SENSOR.get(cmd)
    if action is not None:
        action(firmware, command)
    elif cmd in IDLE or cmd in WITH_SENSOR:
        firmware.events.error("%s is not possible now" % cmd,
                              "no calibration under way, and a sensor")
    elif cmd == "undo":
        firmware.events.error("%s outside a calibration" % cmd, "calibrate first")
    else:
        firmware.events.error("unknown command %s" % cmd[:20],
                          "info calibrate redo undo stream check mount restore stop reset")


def obey_in_session(command, firmware, session, store, teller):
    """While a session is under way: redo, undo, and what is obeyed at all times."""
    cmd = command["cmd"]
    placements = session.placements
    if cmd == "redo" and command.get("face") in FACES:
        _redo_face(FACES.index(command["face"]), session, store, teller)
    elif cmd == "redo":
        firmware.events.error("redo without a face", "one of " + " ".join(FACES))
    elif cmd == "undo" and placements and session.wanted:
        gone = session.undo()  # of a pose that may come more than once
        store.withdraw(gone.pose, gone.first)
        teller.redo(pose_name(gone.pose))
    elif cmd == "undo" and placements:
        _redo_face(face_of_code(placements[-1].pose), session, store, teller)
    elif cmd == "undo":
        firmware.events.error("nothing to undo", "an accepted pose")
    elif cmd == "record" and store.recorded:
        store.resend_header()
    else:
        obey(firmware, command, True)


def _redo_face(face, session, store, teller):
    """Both poses of the face are taken again."""
    session.redo(face)
    for code in session.withdrawn:
        store.withdraw(code)
    del session.withdrawn[:]
    teller.redo(FACES[face])
