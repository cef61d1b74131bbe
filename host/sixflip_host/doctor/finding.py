"""One thing that was looked at: how it is, what was found, what to do."""

from dataclasses import dataclass

OK, WARNING, FAULT = "ok", "warning", "fault"


@dataclass
class Finding:
    """check: what was looked at; state: ok, warning or fault; todo: "" where nothing is.

    unreachable: a fault behind which there is nothing to look at: no port, no board, no chip.
    """

    check: str
    state: str
    found: str
    todo: str = ""
    unreachable: bool = False


def ok(check, found):
    return Finding(check, OK, found)


def warning(check, found, todo):
    return Finding(check, WARNING, found, todo)


def fault(check, found, todo, unreachable=False):
    return Finding(check, FAULT, found, todo, unreachable)
