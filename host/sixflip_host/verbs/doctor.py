"""sixflip doctor: what is wrong between this computer, the board and the sensor."""

import contextlib
import json
import os
import subprocess
import sys
from pathlib import Path

from serial.tools import list_ports

from ..board import board_answers
from ..board.board_schema import BusAnswer
from ..board.ports import add_port, open_link
from ..calibrate.verify_files import RECORDS, decode_record
from ..doctor import reach, wiring
from ..doctor.finding import FAULT, OK, WARNING, fault
from ..errors import BadFile, CheckFailed, NoBoard, SixflipError
from ..terminal import plain, styled

EXAMPLE = "sixflip doctor --port /dev/ttyACM0"
SCRIPT = Path(__file__).resolve().parents[1] / "doctor" / "on_board" / "look_at_bus.py"
ANSWER_S = 60               # a stuck bus lets every transfer wait
STYLE = {OK: "green", WARNING: "yellow", FAULT: "bold red"}


def add_arguments(parser):
    """The options of the verb."""
    add_port(parser)
    parser.add_argument("--json", action="store_true", help="the findings as JSON")


def run(args):
    """Look, and say; 0 without a fault, 1 with one, 3 where there is no board or no chip."""
    findings = look(args.port or os.environ.get("SIXFLIP_PORT"))
    if args.json:
        print(json.dumps({"format": 1, "kind": "sixflip doctor",
                          "ok": not any(one.state == FAULT for one in findings),
                          "findings": [vars(one) for one in findings]}))
    else:
        _words(findings)
    if any(one.unreachable for one in findings):
        return NoBoard.exit_code
    return CheckFailed.exit_code if any(one.state == FAULT for one in findings) else 0


def look(port=None):
    """[Finding], from the plug to the sensor; ends at the first thing that hides the rest."""
    findings = []
    if port is None:
        findings, port = reach.ports(list(list_ports.comports()))
        if port is None:
            return findings
    if not port.startswith("local:"):
        seen = reach.opened(port)
        if not findings or seen.state != OK:
            findings = [seen]
        if seen.unreachable:
            return findings
    try:
        with open_link(port) as link:
            return findings + on_board(link)
    except NoBoard as error:
        return findings + [fault("port", str(error), "unplug the board, plug it in, try again",
                                 True)]


def on_board(link):
    """Findings of a board that can be reached; it is reset at the end."""
    findings = reach.micropython(link)
    if any(one.unreachable for one in findings):
        return findings
    findings += reach.firmware(link)
    try:
        if findings[-1].state != FAULT:
            findings += _of_the_bus(link)
    except SixflipError as error:
        findings.append(fault("bus", str(error), "sixflip provision, then try again"))
    with contextlib.suppress(SixflipError):
        link.reset()
    return findings


def _of_the_bus(link):
    said = ask(link)
    findings = wiring.judge(said)
    if not any(one.unreachable for one in findings):
        findings += wiring.record(said, slots(link))
    return findings


def ask(link):
    """{name: values} of what the board says when it looks at its bus."""
    code = SCRIPT.read_text(encoding="utf-8")
    printed = link.run(code, "looking at its bus", timeout=ANSWER_S) if hasattr(link, "run") \
        else here(link.folder, code)
    return parse(link.port, printed)


def here(folder, code):
    """The same on this computer, a Raspberry Pi: the firmware of a folder on its own bus."""
    environment = dict(os.environ, SIXFLIP_BOARD_DIR=str(folder), PYTHONDONTWRITEBYTECODE="1",
                       PYTHONPATH=str(folder))
    try:
        done = subprocess.run([sys.executable, "-c", code], env=environment, cwd=folder,
                              capture_output=True, timeout=ANSWER_S)
    except subprocess.TimeoutExpired:
        raise NoBoard("local:%s: the bus does not answer within %d s" % (folder, ANSWER_S))
    if done.returncode:
        raise NoBoard("local:%s: %s" % (folder, (done.stderr.decode("utf-8", "replace").strip()
                                                .splitlines() or ["no word"])[-1]))
    return done.stdout


def parse(port, printed):
    """{name: values} of lines that are Python literals, ("name", ...) each; "ready" a list."""
    said = {}
    for line in printed.splitlines():
        if line.strip():
            name, *values = board_answers.parse(port, line, BusAnswer())
            if name == "ready":     # of each chip
                said.setdefault(name, []).append(tuple(values))
            else:
                said[name] = tuple(values)
    if "stopped" in said:
        return said
    for name in ("settings", "scan", "ids"):
        if name not in said:
            raise NoBoard("%s: the board said nothing of its %s, expected a line" % (port, name))
    if "means" in said and not {"selftest", "sensor"} <= set(said):
        raise NoBoard("%s: the board told a mean of no sensor" % port)
    return said


def slots(link):
    """[(name, Record or the sentence why it cannot be read)] of the records in flash."""
    records = []
    present = link.files([])
    for name in RECORDS:
        if name in present:
            try:
                records.append((name, decode_record(name, link.get(name))))
            except BadFile as error:
                records.append((name, str(error)))
    return records


def _words(findings):
    from ..terminal import Sentence, console
    screen = console()
    for finding in findings:
        state = styled("%-8s " % finding.state, STYLE[finding.state])
        screen.print(Sentence(state + plain("%s: %s" % (finding.check, finding.found)), hanging=9))
        if finding.todo and finding.state != OK:
            screen.print(plain("         what to do: " + finding.todo))
    counts = ["%d %s%s" % (n, state, "" if n == 1 else "s") for state in (FAULT, WARNING)
              if (n := sum(one.state == state for one in findings))]
    screen.print(", ".join(counts) or "nothing is wrong")
