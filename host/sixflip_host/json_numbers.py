"""Numbers and their units as JSON has them."""

import math


def finite(value):
    """JSON has no NaN: None stands for what is not a number."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def number(value, digits=4):
    """A finite number with so many significant digits, or None."""
    if value is None or not math.isfinite(value):
        return None
    return float("%.*g" % (digits, value))


def spelled(unit):
    """The library's units in GAP.md's spelling."""
    return unit.replace("degC", "°C").replace("deg/s", "°/s") if unit else unit
