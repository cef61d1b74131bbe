"""sixflip.json on the board's flash: read, validated, completed with defaults."""

import json

from sixflip import STANDARD_G

FILE = "sixflip.json"
MOST_TEXT = 4096  # characters of it: a small heap has no room for any more

# name: (default, kind, smallest, largest); None is allowed where the default is None and
# means "as the board file says". Kinds: int, float, str, bool.
KNOWN = {
    "board": (None, "str", 1, 32),
    "sensor": ("auto", "str", 1, 16),
    "i2c": (None, "int", 0, 16),
    "scl": (None, "pin", 0, 64),
    "sda": (None, "pin", 0, 64),
    "freq": (400000, "int", 10000, 1000000),
    "spi": (None, "dict", 0, 0),
    "led": (None, "pin", 0, 64),
    "button": (None, "pin", 0, 64),
    "accel_range_g": (None, "float", 1, 64),
    "gyro_range_dps": (None, "float", 10, 5000),
    "rate_hz": (100, "int", 10, 500),
    "fifo": (None, "bool", 0, 0),
    "grace_ms": (2000, "int", 0, 60000),
    "stream_hz": (10, "float", 0, 500),
    "g": (STANDARD_G, "float", 9.7, 9.9),
    "pose_samples": (400, "int", 50, 5000),
    "timeout_s": (300, "int", 5, 3600),
    "rest_s": (5, "float", 0, 60),
    "mounting": (None, "dict", 0, 0),
    "heading": (None, "dict", 0, 0),
}


def defaults():
    """{name: value} of a sixflip.json that says nothing."""
    return {name: KNOWN[name][0] for name in KNOWN}


def _wrong(value, kind, low, high):
    """What was expected instead of value, or "" when it is fine."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if kind == "str":
        if not isinstance(value, str) or not low <= len(value) <= high:
            return "a text of %d to %d characters" % (low, high)
    elif kind == "dict":
        if not isinstance(value, dict):
            return "an object"
    elif kind == "bool":
        if not isinstance(value, bool):
            return "true or false"
    elif kind == "pin":
        # pins have numbers on most boards and names such as "X1" or "LED" on others
        if isinstance(value, str):
            return "" if 0 < len(value) <= 16 else "a pin's name"
        if not number or isinstance(value, float) or not low <= value <= high:
            return "a pin number %d to %d, or a pin's name" % (low, high)
    elif not number or (kind == "int" and isinstance(value, float)):
        return "an integer" if kind == "int" else "a number"
    elif not low <= value <= high:
        return "%s to %s" % (low, high)
    return ""


def _sensor(value):
    from sixflip.chips.catalogue import SENSORS  # the probe's; not kept in the heap
    return "" if value in SENSORS else "one of auto, " + ", ".join(SENSORS)


def merge(values):
    """values (a dict from JSON) over the defaults -> (settings, list of sentences)."""
    settings = defaults()
    problems = []
    if not isinstance(values, dict):
        return settings, ["%s holds no JSON object; defaults are used" % FILE]
    for name in values:
        if name not in KNOWN:
            problems.append("%s: unknown setting %s is ignored" % (FILE, name))
            continue
        default, kind, low, high = KNOWN[name]
        value = values[name]
        if value is None and default is None:
            continue
        expected = _wrong(value, kind, low, high)
        if not expected and name == "sensor" and value != "auto":
            expected = _sensor(value)
        if expected:
            problems.append("%s: %s is %s, expected %s; %s is used"
                            % (FILE, name, str(value)[:40], expected, default))
        else:
            settings[name] = value
    return settings, problems


def load(root):
    """The settings in root + "sixflip.json" -> (settings, list of sentences about faults)."""
    try:
        with open(root + FILE) as f:
            text = f.read(MOST_TEXT + 1)
    except OSError:
        return defaults(), []
    except ValueError:  # not UTF-8
        return defaults(), ["%s is not text; defaults are used" % FILE]
    if len(text) > MOST_TEXT:
        return defaults(), ["%s has more than %d characters; defaults are used"
                            % (FILE, MOST_TEXT)]
    try:
        return merge(json.loads(text))
    except (ValueError, RuntimeError):
        return defaults(), ["%s is not JSON; defaults are used" % FILE]
