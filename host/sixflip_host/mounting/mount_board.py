"""How the sensor of a board sits in the robot: the board measures it and answers in words."""

import json

from ..board.board_events import wait_for
from ..board.console import Console
from ..board.ports import open_link
from ..errors import CheckFailed, UsageError
from . import robot_axes


def command(args):
    """The line for the board; UsageError where a board cannot do it."""
    axes = robot_axes.parse(args.axes)
    if axes.left_handed:
        raise UsageError("--axes %s is left-handed: a board cannot hold it, expected right-handed "
                         "axes" % args.axes)
    asked = {"cmd": "mount", "axes": axes.axes, "frame": axes.frame}
    if args.order:
        asked["order"] = args.order
    return asked


def ask(args):
    """The board's "mounted" event; CheckFailed with its reason."""
    asked = command(args)
    with open_link(args.port) as link:
        link.reset()
        started = wait_for(link, ("ready", "calibrating"))
        if started["event"] == "calibrating":
            raise CheckFailed("%s: no correction is in force, so the board is calibrating; a "
                              "mounting needs a calibrated sensor" % link.port)
        link.send(json.dumps(asked))
        answer = wait_for(link, ("mounted", "not_mounted", "error"), silence_s=60)
        while answer["event"] == "error" and "mount" not in answer["what"]:
            answer = wait_for(link, ("mounted", "not_mounted", "error"), silence_s=60)
    if answer["event"] == "error":
        raise CheckFailed("%s; expected %s" % (answer["what"], answer.get("expected")))
    if answer["event"] == "not_mounted":
        raise CheckFailed("no mounting measured: %s; the board goes on with %s" % (
            answer.get("reason"), "the one it has" if answer.get("mounting") == "stored"
            else "none"))
    return answer


def run(args):
    """Ask and print."""
    answer = ask(args)
    if args.json:
        print(json.dumps(answer))
    else:
        Console().show(answer)
    return 0
