"""The firmware's JSON lines as dicts; whatever else comes over the port is passed over."""

import json
import time

from ..errors import NoBoard


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
    return event


def events(link, silence_s, total_s=None):
    """Events until nothing came for silence_s, or total_s (real seconds) are over.

    Both last longer on a link with patience.
    """
    end = None
    if total_s is not None:
        end = time.monotonic() + total_s * getattr(link, "patience", 1)
    for line in link.lines(silence_s):
        event = parse(line)
        if event:
            yield event
        if end is not None and time.monotonic() > end:
            return


def wait_for(link, names, silence_s=30, total_s=120, seen=None):
    """The first event with one of the names; NoBoard when it does not come.

    seen(event) is called with every event on the way, the last one included.
    """
    for event in events(link, silence_s, total_s):
        if seen:
            seen(event)
        if event["event"] in names:
            return event
    raise NoBoard("%s: the firmware says nothing of %s within %d s; is it provisioned? "
                  "(sixflip provision)" % (link.port, " or ".join(names), silence_s))
