"""What each setting of sixflip.json does, in a line: for `sixflip provision --help`.

Names, defaults and limits are those of sixflip_device.settings; docs/settings.md says more.
"""

from sixflip_device.settings import KNOWN

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
    return "%d" % value if value == int(value) else "%g" % value


def lines():
    """A table of them as text, a line each."""
    rows = []
    for name, (default, kind, low, high) in KNOWN.items():
        usual = "" if default is None else "%s" % default
        limits = number(low) + ".." + number(high) if kind in ("int", "float", "pin") else ""
        rows.append("  %-14s %-7s %-14s %s" % (name, usual, limits, DOES[name]))
    head = "  %-14s %-7s %-14s %s" % ("key", "default", "limits", "what it does")
    return "\n".join(["sixflip.json on the board, which provision keeps and completes:", head,
                      *rows,
                      "without a default: the board's or the chip's own; docs/settings.md"])
