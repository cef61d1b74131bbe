"""The settings of a board, sixflip.json: what each does, what of those asked for the chip has, and
what stays of those that are there.

Names, defaults and limits are those of sixflip_device.settings; docs/settings.md says more.
"""

import json
import re

from sixflip.chips import catalogue
from sixflip_device import settings

from ..errors import UsageError
from . import board_schema

SETTINGS = "sixflip.json"
PLATFORMS = {"rp2": "pico", "esp32": "esp32", "pyboard": "pyboard"}
UNITS = {"g": "accel_range_g", "dps": "gyro_range_dps"}
DOES = {
    "board": "which of the firmware's boards it is",
    "sensor": "auto, or the one that must be there",
    "i2c": "number of the bus",
    "scl": "pin of the clock line, or its name",
    "sda": "pin of the data line",
    "freq": "clock of the bus, Hz",
    "spi": "an object: the sensor is on SPI",
    "led": "pin of the lamp",
    "button": "pin of one that starts a calibration",
    "accel_range_g": "full scale, g",
    "gyro_range_dps": "full scale, deg/s",
    "rate_hz": "samples a second; filters follow it",
    "fifo": "true: through the chip's memory",
    "grace_ms": "time to stop the firmware, ms",
    "stream_hz": "corrected lines a second, 0: none",
    "g": "gravity of the place, m/s2",
    "pose_samples": "samples of each placement",
    "timeout_s": "a session's end without a placement, s",
    "rest_s": "rest at power-up for the bias, s; 0: not",
    "mounting": "an object, see sixflip mount --help",
    "heading": "an object of gain and lever_arm (m)",
}


def number(value):
    """Text of a limit, without a point where it is whole."""
    return "%d" % value if value == int(value) else "%g" % value


def help_table():
    """What `sixflip provision --help` says of them: a table as text, a line each."""
    rows = []
    for name, (default, kind, low, high) in settings.KNOWN.items():
        usual = "" if default is None else "%s" % default
        limits = number(low) + ".." + number(high) if kind in ("int", "float", "pin") else ""
        rows.append("  %-14s %-7s %-14s %s" % (name, usual, limits, DOES[name]))
    head = "  %-14s %-7s %-14s %s" % ("key", "default", "limits", "what it does")
    return "\n".join(["sixflip.json on the board, which provision keeps and completes:", head,
                      *rows,
                      "without a default: the board's or the chip's own; docs/settings.md"])


def ranges(text):
    """{"accel_range_g": 8, "gyro_range_dps": 2000} of "8g,2000dps"."""
    wanted = {}
    for part in text.split(","):
        match = re.fullmatch(r"(\d+(?:\.\d+)?)(g|dps)", part.strip())
        if not match or UNITS[match[2]] in wanted:
            raise UsageError("--range %s: expected a full scale in g, one in dps or both, such as "
                             "8g,2000dps" % text)
        key, value = UNITS[match[2]], float(match[1])
        _, _, low, high = settings.KNOWN[key]
        if not low <= value <= high:
            raise UsageError("--range %s: %s is %g, expected %g to %g" % (text, key, value, low,
                                                                          high))
        wanted[key] = int(value) if value == int(value) else value
    return wanted


def what_the_chip_offers(sensor, wanted):
    """(the settings as the chip has them, sentences where that is not what was asked for)."""
    driver, said, had = catalogue.driver(sensor), [], dict(wanted)
    for key, rows, unit in (("accel_range_g", driver.ACCEL_RANGES, "g"),
                            ("gyro_range_dps", driver.GYRO_RANGES, "deg/s")):
        scales = sorted(row[0] for row in rows)
        if key not in wanted or wanted[key] in scales:
            continue
        if not scales:
            del had[key]
            said.append("the %s has no gyro: no range of one" % sensor)
            continue
        had[key] = next((scale for scale in scales if scale >= wanted[key]), scales[-1])
        said.append("the %s has no ±%g %s but %s: ±%g is taken" % (
            sensor, wanted[key], unit, " ".join("%g" % scale for scale in scales), had[key]))
    if wanted.get("rate_hz", 0) > driver.MOST_HZ:
        had["rate_hz"] = driver.MOST_HZ
        said.append("the %s is polled %d times a second at most: %d are taken"
                    % (sensor, driver.MOST_HZ, driver.MOST_HZ))
    return had, said


def json_settings(data):
    """The settings of a sixflip.json, {} where it is damaged: they are written anew then."""
    try:
        return board_schema.SETTINGS.take(json.loads(data))
    except (ValueError, RecursionError):
        return {}


def merged_settings(link, present, wanted):
    """Bytes of sixflip.json: what is on the board, changed where the command line says so."""
    values = json_settings(link.get(SETTINGS)) if SETTINGS in present else {}
    values.update(wanted)
    if "board" not in values:
        values["board"] = PLATFORMS.get(link.platform(), "pico")
    return (json.dumps(values, indent=1, sort_keys=True) + "\n").encode()


def settings_line(data, wanted):
    """What sixflip.json on the board says from now on, and what of it was there before."""
    values = json.loads(data)
    kept = [name for name in sorted(values) if name not in wanted and name != "sensor"]
    sensor = values.get("sensor", "auto")
    line = "sensor: %s" % ("found out at power-up" if sensor == "auto" else sensor)
    if "sensor" not in wanted and "sensor" in values:
        line += ", as configured on the board (--sensor changes it)"
    return line + "".join("; %s: %s" % (name, json.dumps(values[name])) for name in kept)
