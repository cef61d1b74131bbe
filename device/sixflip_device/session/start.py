"""First phase: the sensor, the self-test, the grace window.

Half a second of samples at power-up: does the sensor deliver what it should?
"""

import os
from array import array

import sixflip
from sixflip.poses.still_window import StillWindow

from .. import led
from ..find_sensor import find
from ..flash_files import FLAG
from ..sensor import BusLost, Sensor, pacer

SAMPLES = 50
STILL_G = 0.03  # standard deviation per axis above which nobody calls it at rest


def self_test(board, sensor, rate_hz):
    """Returns a dict for the selftest event: ok, problems (sentences), rate_hz reached,
    noise (standard deviations in counts, ax ay az gx gy gz), still, temperature_c."""
    imu = sensor.imu
    sample = array("h", [0] * 7)
    window = StillWindow(SAMPLES, imu.accel_rail, imu.gyro_rail, 1000000 // rate_hz)
    paced = pacer(board, sensor, rate_hz)
    full = False
    while not full:
        dt = paced.next(sample)
        if dt >= 0:
            full = window.add(dt, sample)
    reached = SAMPLES * 1e6 / max(1, window.us)
    noise = [window.variance(k) ** 0.5 for k in range(6)]
    problems = []
    if window.stale:
        problems.append("stale: %d identical readings in a row" % window.stale)
    if window.accel_saturated or window.gyro_saturated:
        problems.append("saturated: a reading of %d, full scale"
                        % (window.accel_saturated or window.gyro_saturated))
    if reached < 0.9 * rate_hz:
        problems.append("too slow: %.0f samples a second, expected %d" % (reached, rate_hz))
    temp_c = None
    if imu.has_temp:
        temp_c = window.total(6) / SAMPLES / imu.temp_lsb_per_c + imu.temp_offset_c
    return {"ok": not problems, "problems": problems, "rate_hz": reached, "noise": noise,
            "still": max(noise[:3]) < STILL_G * imu.accel_lsb_per_g,
            "temperature_c": temp_c, "bus_errors": sensor.errors}


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
    answer = self_test(unit.board, unit.sensor, unit.settings["rate_hz"])
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
