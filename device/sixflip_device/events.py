"""Lines to the host and from it: one JSON object each.

The first key of an event is always "event". Lines are pure ASCII whatever the text was, floats
have seven significant digits (a single-precision board has no more), and NaN or infinity, which
JSON does not know, becomes null. A line of the host has a "cmd" (commands.py).
"""

import json


def quoted(value):
    """A JSON string of text that cannot stand in JSON as it is."""
    out = ['"']
    for ch in value:
        code = ord(ch)
        if ch == '"' or ch == "\\":
            out.append("\\" + ch)
        elif 32 <= code < 127:
            out.append(ch)
        elif code < 0x10000:
            out.append("\\u%04x" % code)
        else:
            code -= 0x10000
            out.append("\\u%04x\\u%04x" % (0xD800 + (code >> 10), 0xDC00 + (code & 0x3FF)))
    out.append('"')
    return "".join(out)


def _as_it_is(byte):
    return 32 <= byte <= 126 and byte != 34 and byte != 92  # " and \


def _text(value):
    # its bytes: MicroPython keeps every character it ever made as a name, for good
    if all(map(_as_it_is, value.encode("utf-8", "surrogatepass"))):
        return '"' + value + '"'
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
        """Writes an event and its fields as a line."""
        line = '{"event": "' + event + '"'  # grown: a list of its parts would double it
        for name in fields:
            line += ', "' + name + '": ' + to_json(fields[name])
        line += "}"
        self._write_line(line)

    def error(self, what, expected="", **fields):
        """Something is wrong: what, and what was expected instead."""
        self.emit("error", what=what, expected=expected, **fields)


class HostLine:
    """poll() -> the next command as a dict, or None. A bad line is answered, never fatal."""

    def __init__(self, board, events):
        self._read_line = board.read_line
        self._events = events

    def poll(self):
        """The next command as a dict with "cmd", or None."""
        line = self._read_line()
        if line is None or not line.strip():
            return None
        try:
            command = json.loads(line)
        except (ValueError, RuntimeError):  # RuntimeError: nested too deep
            command = None
        if not isinstance(command, dict) or not isinstance(command.get("cmd"), str):
            self._events.error("a line that is no command: " + line[:40],
                               'expected a JSON object such as {"cmd": "info"}')
            return None
        return command
