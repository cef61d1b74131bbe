"""One JSON object a line on the serial port, for people and for the host alike.

The first key is always "event". Lines are pure ASCII whatever the text was, floats carry
seven significant digits (a single-precision board has no more), and NaN or infinity, which
JSON does not know, becomes null.
"""


def _as_it_is(byte):
    return 32 <= byte <= 126 and byte != 34 and byte != 92  # " and \


def _text(value):
    # its bytes: MicroPython keeps every character it ever made as a name, for good
    if all(map(_as_it_is, value.encode("utf-8", "surrogatepass"))):
        return '"' + value + '"'
    from .json_escapes import quoted  # hardly any text needs it
    return quoted(value)


def _number(value):
    if value != value or value - value != 0:
        return "null"
    return "%.7g" % value


def to_json(value):
    """JSON text of None, bool, int, float, str, bytes, list, tuple, array or dict."""
    if value is None:
        return "null"
    if value is True:
        return "true"
    if value is False:
        return "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, (bytes, bytearray)):
        return _text("".join(["%02x" % b for b in value]))
    if isinstance(value, dict):
        return "{" + ", ".join([_text(str(k)) + ": " + to_json(value[k]) for k in value]) + "}"
    return "[" + ", ".join([to_json(v) for v in value]) + "]"


class Events:
    """Writes events through write_line(text); a broken line never stops the firmware."""

    def __init__(self, write_line):
        self._write_line = write_line

    def emit(self, event, **fields):
        line = '{"event": "' + event + '"'  # grown: a list of its parts would double it
        for name in fields:
            line += ', "' + name + '": ' + to_json(fields[name])
        line += "}"
        self._write_line(line)

    def error(self, what, expected="", **fields):
        """Something is wrong: what, and what was expected instead."""
        self.emit("error", what=what, expected=expected, **fields)
