"""A tray of boards calibrated from a terminal: on a screen with keys, or line by line."""

import os
import shutil

from ..board import serial_ports, typed_lines
from ..board.console import Console
from ..board.ports import VARIABLE
from ..errors import Interrupted, NoBoard
from ..guide import terminal_guide
from ..terminal import console, plain, say, table, verdict_text
from . import tray_screen
from .tray_session import TraySession
from .tray_words import COLUMNS, results

TICK_S = 0.1


class TrayGuide(terminal_guide.Guide):
    """What is on the screen and what the next key means. session: a TraySession."""

    def lines(self, ascii_only=False):
        height = max(tray_screen.HEIGHT, shutil.get_terminal_size().lines)
        return tray_screen.screen(self.session.tray, self.asking, self.note, ascii_only, height)

    def command(self, key):
        tray = self.session.tray
        if key == "?":
            self.asking = "help"
        elif tray.over and key in ("q", "enter"):
            self.leave = True
        elif key == "q":
            self.asking = "quit"
        elif key == "r" and tray.face:
            self.asking = "redo"
        elif key == "u" and tray.face and not tray.over:
            self.session.undo()
        elif key not in ("esc", "enter"):
            self.note = "key %s means nothing here; ? helps" % key


def ports_of(named):
    """The ports that the command line names, or $SIXFLIP_PORT, or all that boards are plugged
    into; NoBoard when there is none."""
    ports = list(dict.fromkeys(named or os.environ.get(VARIABLE, "").split() or
                               [row["port"] for row in serial_ports.boards()]))
    if not ports:
        raise NoBoard("no board is plugged in, expected some on USB; name their ports with --port "
                      "PORT --port PORT, or try without hardware: sixflip virtual-board "
                      "--boards 8")
    return ports


def in_lines(session):
    """Line by line until all boards are done; True: the person quit in the middle."""
    screen, shown = Console(), 0
    with typed_lines.TypedLines(screen.echo) as typed:
        if typed.live:
            screen.say(typed_lines.HELP)
        while True:
            log = session.tray.log
            for line in log[shown:]:
                screen.say(line)
            shown = len(log)
            if session.tray.over:
                return False
            session.pump(TICK_S)
            line = typed.poll()
            if line is not None and obey(session, line, screen.say):
                return True


def obey(session, line, say):
    """Does what a typed line asks for; True: quit."""
    try:
        command = typed_lines.command(line)
    except ValueError as error:
        say(str(error))
        return False
    if command["cmd"] == "redo":
        session.redo(command["face"])
    elif command["cmd"] == "undo":
        session.undo()
    return command["cmd"] == "stop"


def follow(session, guided):
    """Leads through the tray; raises Interrupted when the person stops in the middle."""
    try:
        if not guided:
            quit_early = in_lines(session)
        else:
            quit_early = TrayGuide(session).run()
            say(session.tray.log)
    except KeyboardInterrupt:
        quit_early = True
    session.end()
    if quit_early:
        for port, sentence in session.kept.items():
            print(plain("%s: %s" % (session.tray.member(port).name, sentence)))


def run(named, request, guided):
    """Calibrates a tray; the exit code."""
    session = TraySession(ports_of(named), request)
    try:
        print("looking for boards at %d ports" % len(session.ports), flush=True)
        session.find()
        for why in session.passed.values():
            print(plain(why) + "; passed over")
        if not session.tray.members:
            raise NoBoard("no port has a Sixflip board, expected one at least")
        follow(session, guided)
    finally:
        session.end()
    say_results(session, bool(named))
    if session.kept:
        raise Interrupted("stopped in the middle; sixflip calibrate --all --continue goes on")
    verdicts = [member.state.verdict for member in session.tray.members if not member.gone]
    all_good = len(verdicts) == len(session.tray.members) and not (named and session.passed)
    return 0 if all_good and set(verdicts) <= {"good", "doubtful"} else 1


def say_results(session, named):
    """The table of boards; a port that the command line names is one even if nobody answers."""
    rows = [[*row[:2], verdict_text(row[2]), *row[3:]]
            for row in results(session.tray, session.passed if named else {})]
    console().print(table("", COLUMNS, rows, prose=True))
