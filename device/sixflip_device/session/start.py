"""The first phase: the sensor is searched for and tested, and a host may stop the firmware.

The test is half a second of samples: does the sensor deliver what it should? In the grace window
nothing else happens, so that a host or a Ctrl-C can always get at the board.
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
STILL_G = 0.03  # largest standard deviation of an axis at rest, g


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


SEARCH_PERIOD_US = 2000000  # from one search for the sensor to the next
STEP_US = 20000


def _wait(firmware, us, pattern):
    """Waits, obeying the host; True when it changed what to do."""
    board = firmware.board
    lamp = led.Lamp(board, 1000000 // STEP_US)
    lamp.show(pattern)
    started = board.ticks_us()
    while board.ticks_diff(board.ticks_us(), started) < us:
        lamp.step()
        if firmware.listen():
            return True
        board.sleep_us(STEP_US)
    return False


def _hello(firmware, imu, report):
    firmware.events.emit(
        "hello", firmware=sixflip.__version__, board=firmware.board.name,
        id=firmware.board.unique_id,
        sensor=None if imu is None else imu.sensor, chip=None if imu is None else imu.name,
        who_am_i=None if imu is None else imu.who_am_i, report=report,
        float_bits=64 if 1.0 + 1e-9 != 1.0 else 32)


def _no_sensor(firmware, report):
    wanted = firmware.settings["sensor"]
    firmware.events.error(
        "no usable sensor: " + "; ".join(report),
        "an MPU6050 or another sensor that docs/wiring.md lists"
        if wanted == "auto" else "sensor %s as in sixflip.json" % wanted)


def _find_sensor(firmware):
    """Looks until the chip is there, and says once why it is not; False when the host stopped it.

    A calibration that was asked for meanwhile waits until there is a sensor.
    """
    said = None
    firmware.sensor = None
    while not firmware.stopped:
        try:
            imu, report = find(firmware.board, firmware.settings)
        except OSError as e:
            report = getattr(e, "report", None) or [
                "the bus fails while the chip is set up (%s)" % e]
            if said is None and firmware.first:
                _hello(firmware, None, report)
            if report != said:
                said = report
                _no_sensor(firmware, report)
            _wait(firmware, SEARCH_PERIOD_US, led.NO_CHIP)
            continue
        firmware.sensor = Sensor(firmware.board, imu, firmware.settings, firmware.events)
        _hello(firmware, imu, report)
        return True
    return False


def _self_test(firmware):
    answer = self_test(firmware.board, firmware.sensor, firmware.settings["rate_hz"])
    firmware.events.emit("selftest", who_am_i=firmware.sensor.imu.who_am_i, **answer)


def _button_or_flag(firmware):
    """A held button or the flag file asks for a calibration."""
    if firmware.board.button():
        return True
    try:
        os.stat(firmware.board.root + FLAG)
        return True
    except OSError:
        return False


def _grace(firmware):
    """The window in which a host can stop the firmware before it does anything."""
    ms = firmware.settings["grace_ms"]
    firmware.events.emit("grace", ms=ms)
    _wait(firmware, ms * 1000, led.MEASURING)
    if firmware.request is None and _button_or_flag(firmware):
        firmware.request = {}


def run(firmware):
    """Until there is a tested sensor, or the host has stopped the firmware."""
    while _find_sensor(firmware):
        try:
            _self_test(firmware)
            if firmware.first:
                _grace(firmware)
            return
        except BusLost as e:
            firmware.events.error(str(e), "the sensor that was there a moment ago")
            _wait(firmware, SEARCH_PERIOD_US, led.NO_CHIP)
