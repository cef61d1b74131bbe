"""Whether a board holds a session that can be gone on with."""

import json

from ..board import calibration_request
from ..board.board_events import events

ANSWER_S = 2.0


def on_board(link):
    """True for a session under way, or one whose capture lacks poses; nothing on the board is
    changed by asking."""
    if calibration_request.under_way(link) is not None:
        return True
    link.send(json.dumps({"cmd": "info"}))
    for event in events(link, ANSWER_S, ANSWER_S):
        if event["event"] == "info":
            return event.get("unfinished") is True
    return False
