"""The link to one board of a tray, in a thread of its own that feeds a queue common to all."""

import contextlib
import queue
import threading

from ..board import calibration_request
from ..board.ports import open_link
from ..errors import SixflipError, internal_error
from ..guide.board_session import BoardSession
from ..terminal import plain

PUMP_S = 0.1
AGAIN = "sixflip calibrate --all --continue"
JOINED, HEARD, LEFT = "joined", "heard", "left"


class Told(BoardSession):
    """A BoardSession that tells every event on; what comes of it is kept by who hears it."""

    def __init__(self, link, board, tell):
        super().__init__(link, board, keep=False)
        self.tell = tell

    def hear(self, event):
        super().hear(event)
        self.tell(HEARD, event)


class BoardThread(threading.Thread):
    """Opens a port, starts the session that was asked for and follows it.

    told       a queue of (port, kind, what): joined with the board's id, heard with an event,
               left with a sentence. After "left" nothing more comes.
    request    for the firmware, as calibration_request.ask_for_calibration takes it

    The board stays linked after its session, for a face to be taken again, until end() is called.
    """

    def __init__(self, port, request, told):
        super().__init__(daemon=True, name="tray " + port)
        self.port = port
        self.request = request
        self.told = told
        self.commands = queue.SimpleQueue()
        self.leaving = threading.Event()

    def send(self, command):
        """A command (a dict) for the firmware."""
        self.commands.put(command)

    def end(self):
        """End the session if one is under way, close the link, and say "left"."""
        self.leaving.set()

    def tell(self, kind, what):
        self.told.put((self.port, kind, what))

    def run(self):
        try:
            self.tell(LEFT, self.follow())
        except SixflipError as error:
            self.tell(LEFT, plain(error))
        except Exception as error:  # a bug of ours, on one board: the others go on
            self.tell(LEFT, internal_error(error))

    def follow(self):
        """What is kept on the board when the person left in the middle, "" when it was over."""
        with open_link(self.port) as link:
            board = started(link, self.request)
            self.tell(JOINED, board)
            session = Told(link, board, self.tell)
            while not self.leaving.is_set():
                session.pump(PUMP_S)
                while not self.commands.empty():
                    session.send(self.commands.get())
            if session.ending.over:
                return ""
            return calibration_request.stop(link, AGAIN)


def started(link, request):
    """The id of a board whose session was asked for, None where one is gone on with that is under
    way. A board without the firmware is started again, as what ran on it was stopped."""
    if request and "continue" in request and calibration_request.under_way(link) is not None:
        return None
    try:
        return calibration_request.ask_for_calibration(link, request)
    except calibration_request.NoFirmware:
        with contextlib.suppress(SixflipError):
            link.reset()
        raise
