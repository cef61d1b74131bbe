"""First phase: the sensor, the self-test, the grace window."""

import os

import sixflip

from . import led
from .bus_recovery import BusLost, Sensor
from .find_sensor import find
from .flash_files import FLAG

LOOK_AGAIN_US = 2000000
STEP_US = 20000


def _wait(unit, us, pattern):
    """Waits, obeying the host; True when it changed what to do."""
    board = unit.board
    lamp = led.Lamp(board, 1000000 // STEP_US)
    lamp.show(pattern)
    started = board.ticks_us()
    while board.ticks_diff(board.ticks_us(), started) < us:
        lamp.step()
        if unit.listen():
            return True
        board.sleep_us(STEP_US)
    return False


def _hello(unit, imu, report):
    unit.events.emit(
        "hello", firmware=sixflip.__version__, board=unit.board.name, id=unit.board.unique_id,
        sensor=None if imu is None else imu.sensor, chip=None if imu is None else imu.name,
        who_am_i=None if imu is None else imu.who_am_i, report=report,
        float_bits=64 if 1.0 + 1e-9 != 1.0 else 32)


def _no_sensor(unit, report):
    wanted = unit.settings["sensor"]
    unit.events.error(
        "no usable sensor: " + "; ".join(report),
        "an MPU6050 or another sensor that docs/wiring.md lists"
        if wanted == "auto" else "sensor %s as in sixflip.json" % wanted)


def _find_sensor(unit):
    """Looks until the chip is there; False when the host stopped it. Says so once."""
    said = None
    unit.sensor = None
    while not unit.stopped:
        try:
            imu, report = find(unit.board, unit.settings)
        except OSError as e:
            report = getattr(e, "report", None) or [
                "the bus fails while the chip is set up (%s)" % e]
            if said is None and unit.first:
                _hello(unit, None, report)
            if report != said:
                said = report
                _no_sensor(unit, report)
            _wait(unit, LOOK_AGAIN_US, led.NO_CHIP)
            continue
        unit.sensor = Sensor(unit.board, imu, unit.settings, unit.events)
        _hello(unit, imu, report)
        return True
    return False


def _self_test(unit):
    from . import self_test
    answer = self_test.run(unit.board, unit.sensor, unit.settings["rate_hz"])
    unit.events.emit("selftest", who_am_i=unit.sensor.imu.who_am_i, **answer)


def _asked_for(unit):
    """A held button or the flag file asks for a calibration."""
    if unit.board.button():
        return True
    try:
        os.stat(unit.board.root + FLAG)
        return True
    except OSError:
        return False


def _grace(unit):
    """The window in which a host can stop the firmware before it does anything."""
    ms = unit.settings["grace_ms"]
    unit.events.emit("grace", ms=ms)
    _wait(unit, ms * 1000, led.MEASURING)
    unit.asked = unit.asked or _asked_for(unit)


def run(unit):
    try:
        if not _find_sensor(unit):
            return ""
        _self_test(unit)
        if unit.first:
            _grace(unit)
    except BusLost as e:
        unit.events.error(str(e), "the sensor that was there a moment ago")
        _wait(unit, LOOK_AGAIN_US, led.NO_CHIP)
        return "" if unit.stopped else "start"
    return "" if unit.stopped else "recall"
