"""A tray of boards on the server's side: one thread that owns its session, whatever browsers do.

What a browser asks for holds for the session that it saw; what is done already changes nothing.
"""

import queue
import threading

from ..board.event_words import ROUND
from ..errors import SixflipError, internal_error
from ..narration import log
from ..terminal import plain
from ..tray import tray_screen
from ..tray.tray_session import TraySession
from ..tray.tray_words import headline, status

TICK_S = 0.1
BEGIN = "lay the jig on a table that does not shake, then start"


class TrayBench:
    """ports() -> names of the ports; told(): something changed. The same methods as Bench."""

    report = None

    def __init__(self, ports, told=lambda: None):
        self.ports = ports
        self.told = told
        self.asked = queue.SimpleQueue()
        self.number = 0         # of the session; 0: none yet
        self.session = None
        self.busy = self.problem = ""
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)

    # -- from any thread

    def ask(self, action, number, what=""):
        """An action of a browser; done soon, if it still makes sense then."""
        self.asked.put((action, number, what))

    def trail(self):
        return []

    def view(self):
        """What the page shows, ready for JSON."""
        session = self.session
        answer = {"number": self.number, "busy": self.busy, "problem": self.problem,
                  "faces": list(ROUND), "live": False, "over": True, "head": BEGIN, "boards": [],
                  "step": None, "reference": None, "undo": "", "log": []}
        if session and not self.busy:
            answer.update(snapshot(session.tray))
        return answer

    def close(self):
        """Ends every session in order; a sentence on what is kept, "" when none was under way."""
        self.over.set()
        self.thread.join()
        return self.end()

    # -- the thread

    def run(self):
        while not self.over.is_set():
            try:
                self.turn()
            except SixflipError as error:
                self.failed(str(error))
            except Exception as error:      # noqa: BLE001  without this thread no click does more
                log.debug("the page's thread", exc_info=True)
                self.failed(internal_error(error))

    def failed(self, line):
        self.problem, self.busy = plain(line)[:400], ""
        self.told()

    def turn(self):
        """One action, or a tenth of a second of the boards' words."""
        try:
            action, number, what = self.asked.get(timeout=0 if self.session else TICK_S)
        except queue.Empty:
            pass
        else:
            if number == self.number:
                self.act(action, what)
            self.told()
        if self.session:
            self.session.pump(TICK_S)
            self.told()

    def act(self, action, what):
        session = self.session
        tray = session.tray if session else None
        if action in ("start", "continue"):
            if tray is None or tray.over:
                self.begin({"continue": True} if action == "continue" else None)
        elif tray is None or not tray.face:
            return
        elif action == "redo" and (tray.face, tray.letter, tray.here) != (what, "a", {}):
            session.redo(what)
        elif action == "undo" and what and what == undoes(tray):
            session.undo()
        elif action == "stop" and not tray.over:
            self.problem = self.end()

    def begin(self, request):
        """A session on every board that answers; the one before is over."""
        self.end()
        self.problem, self.busy = "", "looking for boards"
        self.told()
        session = TraySession(self.ports(), request)
        session.find()
        self.session, self.busy = session, ""
        self.number += 1
        self.problem = "; ".join(plain(why) for why in session.passed.values())[:400]

    def end(self):
        session, self.session = self.session, None
        if session is None:
            return ""
        session.end()
        self.number += 1
        return "; ".join("%s: %s" % (session.tray.member(port).name, sentence)
                         for port, sentence in session.kept.items())


def undoes(tray):
    """What an undo would take back, as a word that is another one afterwards; "" for nothing."""
    face = tray.face if tray.here else tray.last
    return face and "%s%d" % (face, tray.redone)


def snapshot(tray):
    """A Tray for the page."""
    kind = tray_screen.drawn(tray)
    return {
        "live": bool(tray.members), "over": tray.over, "head": headline(tray),
        "step": {"kind": kind, "face": tray.face if kind != "wait" else "",
                 "letter": tray.letter},
        "reference": tray.member(tray.reference).number if tray.reference else None,
        "undo": undoes(tray), "log": list(tray.log),
        "boards": [board(tray, member) for member in tray.members]}


def board(tray, member):
    return {"number": member.number, "id": member.state.board, "port": member.port,
            "chip": member.state.chip, "verdict": member.state.verdict, "gone": bool(member.gone),
            "awaited": member in tray.awaited(), "status": status(tray, member),
            "faces": [tray_screen.marks(member, face).plain.strip() for face in ROUND]}
