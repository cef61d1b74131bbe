"""Values a board sends, checked on their way in: no kind of value raises or steers a terminal."""

import math

from sixflip.poses.faces import pose_code

from ..terminal import plain

TEXT = 300              # characters of a text
DEEP = 4                # objects in objects of an answer


def text(value, longest=TEXT):
    """A text of a board's, escaped and cut; "" for what is none."""
    return plain(value)[:longest] if isinstance(value, str) else ""


def number(value, default=0.0):
    """A finite number, else the default."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return default
    try:
        return float(value) if math.isfinite(value) else default
    except OverflowError:
        return default


def whole(value):
    value = number(value)
    return int(value) if 0 <= value < 1 << 31 else 0


def cleaned(value, deep=DEEP):
    """A JSON value of a board's with its texts escaped, its numbers finite, its depth bounded."""
    if isinstance(value, str):
        return text(value)
    if isinstance(value, bool) or value is None:
        return value
    if isinstance(value, (int, float)):
        return value if number(value, None) is not None else None
    if not deep:
        return None
    if isinstance(value, list):
        return [cleaned(item, deep - 1) for item in value[:64]]
    if isinstance(value, dict):
        return {text(key, 40): cleaned(item, deep - 1) for key, item in list(value.items())[:64]}
    return None


def poses(value):
    """The names of poses in a list; other things are passed over."""
    names = []
    for name in value if isinstance(value, list) else ():
        try:
            names.append(name if isinstance(name, str) and pose_code(name) else "")
        except (ValueError, IndexError):
            continue
    return tuple(name for name in names if name)


def three(value, unit):
    """Three numbers of a list times unit, or None."""
    if not isinstance(value, list) or len(value) != 3 or not any(map(number, value)):
        return None
    return tuple(number(v) * unit for v in value)
