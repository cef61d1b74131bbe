"""Lines from the host: one JSON object each, with a "cmd"."""

import json


class HostLine:
    """poll() -> the next command as a dict, or None. A bad line is answered, never fatal."""

    def __init__(self, board, events):
        self._read_line = board.read_line
        self._events = events

    def poll(self):
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
