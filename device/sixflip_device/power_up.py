"""What happens at power-up, in the order of METHOD 6, and after it until the host says stop.

    phase                            needs                     gives
    session.start                    settings                  sensor, tested; the grace is over
    record.load_record               sensor                    record, or a request without one
    record.check_at_rest             record                    correction, the gyro's bias of today
    session.session_request          request, the flag's file  SessionRequest
    session.redo_session             SessionRequest            it with the session before
    session.sampling                 sensor, SessionRequest    SessionResult, the capture
    session.calibrate_accelerometer  SessionResult, record     Calibration
    session.calibrate_gyro           both of them, record      Calibration
    record.saving                    both of them              record, on the flash
    find_sensor                      settings                  sensor, identified anew
    record.active_record             record                    correction
    stream.stream                    correction                corrected samples, or a request

Every phase is a module with run(firmware, ...). The modules that it imports leave the heap when it
ends. If all stayed, 94 KB of the 100 that a board may have would be in use at the last pose, and
the solver found no room any more (a Cortex-M3 with the whole firmware; 74 KB as it is).
"""

import gc
import sys

from .firmware import Firmware
from .sensor import BusLost

# Bytes. Collected so often, what lasts stays at the front of a small heap and the free rest in one
# piece: an event of a kilobyte and a half finds room in it.
COLLECT_AFTER = 4096
SMALL_HEAP = 262144


def main():
    """The firmware of this board, whichever it is."""
    from .boards.this_board import board_here
    run(*board_here())


def run(board, settings, problems=()):
    """The firmware; returns only when the host says stop. problems: sentences on the settings."""
    firmware = Firmware(board, settings)
    for problem in problems:
        firmware.events.error(problem, "the settings as the README lists them")
    if hasattr(gc, "threshold") and gc.mem_free() + gc.mem_alloc() < SMALL_HEAP:
        gc.threshold(COLLECT_AFTER)
    while not firmware.stopped:
        try:
            power_up(firmware)
        except BusLost as error:
            firmware.events.error(str(error), "the sensor that was there a moment ago")
    firmware.events.emit("stopped")


def power_up(firmware):
    """From the search for the sensor to the stream; BusLost when the sensor is gone."""
    phase("session.start", firmware)
    if firmware.stopped:
        return
    phase("record.load_record", firmware)
    if firmware.request is None:
        phase("record.check_at_rest", firmware)
    while not firmware.stopped:
        if firmware.request is None:
            phase("stream.stream", firmware)
        else:
            calibrate(firmware)


def calibrate(firmware):
    """The calibration that is wanted. The record before it stays active if it comes to nothing."""
    request = phase("session.session_request", firmware)
    if request is not None and request.goes_on:
        request = phase("session.redo_session", firmware, request)
    if request is None:
        phase("record.check_at_rest", firmware)
        return
    session = phase("session.sampling", firmware, request)
    calibration = None
    if session.how == "complete":
        calibration = phase("session.calibrate_accelerometer", firmware, session)
        if firmware.sensor.imu.has_gyro:
            calibration = phase("session.calibrate_gyro", firmware, session, calibration)
    phase("record.saving", firmware, session, calibration)
    if session.how == "bus lost":
        raise BusLost(session.ended)
    phase("find_sensor", firmware)
    phase("record.active_record", firmware)


def phase(name, *given):
    """What run(*given) of a module of the firmware answers; its imports leave the heap."""
    loaded = set(sys.modules)
    gc.collect()
    try:
        return __import__("sixflip_device." + name, None, None, ["run"]).run(*given)
    finally:
        if sys.implementation.name == "micropython":  # a computer has room, and tests hold on
            for module in [one for one in sys.modules
                           if one.startswith("sixflip") and one not in loaded]:
                forget(module)


def forget(name):
    """Whatever still uses the module keeps it alive; the next import loads it again."""
    sys.modules.pop(name, None)
    dot = name.rfind(".")
    package = sys.modules.get(name[:dot])
    if package is not None and hasattr(package, name[dot + 1:]):
        delattr(package, name[dot + 1:])
