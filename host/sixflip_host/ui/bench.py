"""The board on the server's side: one thread that owns the link, whatever the browsers do.

State lives here alone. A browser sends an action with the session number it saw; what was
meant for an earlier session, or is done already, changes nothing, however often it is clicked.
"""

import contextlib
import queue
import threading
import time
from pathlib import Path

from ..board import calibration_request, pulled_files
from ..errors import SixflipError, internal_error
from ..guide.board_session import BoardSession
from ..guide.session_state import CALIBRATING, OVER, State
from ..narration import log
from ..terminal import plain
from . import gap_report, snapshot

TICK_S = 0.1
ACTIONS = ("look", "start", "continue", "redo", "undo", "stop", "pull", "report")
ANSWER_S = 3.0          # a board that has not answered by then is asked again


class Bench:
    """open_link() -> a Link; output: folder for what is pulled; told(): something changed.

    keep     whether calibrations go into the history; capture: of a replay, for its report
    request  request(link): what a plan asks the board for; step(at): what it says, see Console
    """

    def __init__(self, open_link, output, told=lambda: None, keep=True, capture=None,
                 request=lambda link: None, step=None):
        self.open_link = open_link
        self.output = Path(output)
        self.told = told
        self.keep = keep
        self.capture = capture
        self.step = step
        self.request = request
        self.asked = queue.SimpleQueue()
        self.number = 0         # of the session; 0: none yet
        self.session = None
        self.link = None
        self.busy = ""
        self.problem = ""
        self.board_port = ""    # where a board was, before the first session
        self.left = False       # it told of an unfinished session
        self.done = {}          # (number, action, what): when sent, and State.redone then
        self.pulled = None
        self.report = None      # bytes of the page
        self.reporting = None
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)

    # -- from any thread

    def ask(self, action, number, what=""):
        """An action of a browser; done soon, if it still makes sense then."""
        self.asked.put((action, number, what))

    def view(self):
        """What the page shows, ready for JSON."""
        session = self.session
        state = session.state if session else State()
        answer = snapshot.snapshot(state, self.step)
        answer.update(number=self.number, busy=self.busy, problem=self.problem,
                      live=self.link is not None, replay=self.capture is not None,
                      found=plain(self.board_port), unfinished=self.unfinished(),
                      port=self.link.port if self.link else "",
                      pulled=plain(self.pulled) if self.pulled else "",
                      reporting=self.reporting is not None, report=self.report is not None)
        return answer

    def trail(self):
        session = self.session
        return snapshot.trail(session.state) if session else []

    def close(self):
        """End the session in order; a sentence on what is kept, "" when none was under way."""
        self.over.set()
        self.thread.join()
        said = ""
        if self.link:
            if self.session and self.session.state.stage == CALIBRATING:
                said = calibration_request.stop(self.link)
            self.link.close()
        return said

    # -- the thread

    def run(self):
        while not self.over.is_set():
            try:
                self.turn()
            except SixflipError as error:
                self.lost(str(error))
            except OSError as error:
                self.lost("%s: %s" % (error.filename or "the board", error.strerror or error))
            except Exception as error:      # noqa: BLE001  without this thread no click does more
                log.debug("the page's thread", exc_info=True)
                self.lost(internal_error(error))

    def turn(self):
        """One action or a tenth of a second of the board's words."""
        try:
            action, number, what = self.asked.get(timeout=0 if self.link else TICK_S)
        except queue.Empty:
            pass
        else:
            if number == self.number:
                self.act(action, what)
            self.told()
        if self.link and self.session and self.session.pump(TICK_S):
            self.told()

    def lost(self, line):
        """The board went away, or something could not be done: said, and tried again by hand."""
        self.problem, self.busy = plain(line)[:400], ""
        link, self.link = self.link, None
        if link:
            with contextlib.suppress(SixflipError, OSError):
                link.close()
        self.told()

    def stage(self):
        return self.session.state.stage if self.session else OVER

    def act(self, action, what):
        under_way = self.link is not None and self.stage() != OVER
        if action == "look":
            self.look()
        elif action in ("start", "continue"):
            if not under_way:
                self.begin(action)
        elif action in ("pull", "report"):
            if not under_way:
                self.fetch() if action == "pull" else self.make_report()
        elif self.link and not self.waiting((self.number, action, what)):
            self.tell(action, what)

    def look(self):
        """Before the first session: which board is there, and what it has left unfinished. That
        there is none is no fault yet; the port is left to others again."""
        if self.number or self.board_port or self.capture is not None:
            return
        with contextlib.suppress(SixflipError, OSError):
            link = self.open_link()
            try:
                self.left = calibration_request.unfinished(link)
                self.board_port = link.port
            finally:
                link.close()

    def unfinished(self):
        """Whether there is something for "continue"."""
        if self.capture is not None:
            return False
        if self.session is None:
            return self.left
        state = self.session.state
        return bool(state.taken and not state.plan and state.missing and (
            state.stage == OVER or self.link is None))

    def begin(self, action):
        """A new session, or the one that was left unfinished."""
        self.problem, self.busy = "", "connecting"
        self.told()
        if self.link is None:
            self.link = self.open_link()
        if action == "continue" and calibration_request.under_way(self.link) is not None:
            board = None
        else:
            request = {"continue": True} if action == "continue" else self.request(self.link)
            board = calibration_request.ask_for_calibration(self.link, request)
        self.done.clear()
        self.session = BoardSession(self.link, board, self.step, self.keep)
        self.count()
        self.busy = ""

    def count(self):
        """One session more; what was fetched is of the one before."""
        self.number += 1
        self.pulled = self.report = None

    def tell(self, action, what):
        """redo, undo or stop for the session that was seen."""
        state, number = self.session.state, self.number
        if action == "redo" and not state.plan and (
                state.stage == OVER or {what + "a", what + "b"} & set(state.taken)):
            self.session.redo(what)
            if state.stage == OVER:
                self.count()    # it goes on as a session of its own
        elif action == "undo" and what and what == snapshot.last_placement(state):
            self.session.undo()
        elif action == "stop" and state.stage == CALIBRATING:
            self.session.stop()
        else:
            return
        self.done[number, action, what] = time.monotonic(), state.redone

    def waiting(self, asked):
        """Whether this was sent to the board, which has not answered yet."""
        sent_at, redone = self.done.get(asked, (0.0, -1))
        return self.session.state.redone == redone and time.monotonic() - sent_at < ANSWER_S

    def fetch(self):
        """Capture and records of the board into the output folder."""
        if self.link is None:
            self.link = self.open_link()
        self.problem, self.busy = "", "fetching"
        self.told()
        self.pulled = pulled_files.fetch(self.link, self.output, lambda line: None)
        pulled_files.convert(self.pulled, lambda line: None)
        self.link.restart_firmware()
        self.busy = ""

    def make_report(self):
        """sixflip report --gap of what was pulled, or of the replayed capture; beside this."""
        if self.reporting:
            return
        if self.capture is None and self.pulled is None:
            self.fetch()
        what = self.pulled or self.capture
        self.problem = ""
        self.reporting = threading.Thread(target=self.write_report, args=(what,), daemon=True)
        self.reporting.start()

    report_command = staticmethod(gap_report.command)

    def write_report(self, what):
        page, problem = gap_report.page(self.report_command, what, self.output)
        if problem:
            self.problem = problem
        else:
            self.report = page
        self.reporting = None
        self.told()
