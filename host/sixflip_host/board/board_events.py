"""The firmware's JSON lines as checked dicts; whatever else comes over the port is passed over."""

import json
import time

from ..errors import NoBoard
from . import board_schema


def parse(line):
    """The event of one line as a dict, or None: a traceback, an echo, half a line, noise."""
    # The last one: a reset may have cut off the line before it.
    start = line.rfind('{"event"')
    if start < 0:
        return None
    try:
        event = json.loads(line[start:])
    except (ValueError, RecursionError):
        return None
    if not isinstance(event, dict) or not isinstance(event.get("event"), str):
        return None
    return board_schema.event(event)


def events(link, silence_s, total_s=None):
    """Checked events until none came for silence_s, or total_s are over.

    Lines that are no event count as silence: noise is no sign of life. Both times last longer on
    a link with patience. An event whose values do not fit comes as a misfit: board_schema.event.
    """
    patience = getattr(link, "patience", 1)
    started = heard = time.monotonic()
    for line in link.lines(silence_s):
        event = parse(line)
        if event:
            yield event
            if event["event"] != "misfit":
                heard = time.monotonic()
        now = time.monotonic()
        if now - heard > silence_s * patience or (
                total_s is not None and now - started > total_s * patience):
            return


def wait_for(link, names, silence_s=30, total_s=120, seen=None):
    """The first event with one of the names; NoBoard when it does not come, or does not fit.

    seen(event) is called with every event on the way, the last one included.
    """
    for event in events(link, silence_s, total_s):
        if seen:
            seen(event)
        if event["event"] in names:
            return event
        if event["event"] == "misfit" and event["of"] in names:
            raise NoBoard(unusable(link.port, event))
    raise NoBoard("%s: the firmware says nothing of %s within %d s; is it provisioned? "
                  "(sixflip provision)" % (link.port, " or ".join(names), silence_s))


def unusable(port, misfit):
    """A sentence on an event that was waited for and does not fit."""
    return "%s: cannot use what the board says, %s; is its firmware of this version? " \
        "(sixflip provision)" % (port, misfit["why"])
