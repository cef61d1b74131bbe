"""A tray of boards as it happens: their threads feed one queue, what they say makes the Tray."""

import queue
import time

from ..board import calibration_request
from ..board.raw_repl import patience_asked
from ..board.session_end import Ending
from ..history import logbook
from . import leading, tray_events
from .board_thread import HEARD, JOINED, LEFT, BoardThread
from .tray_value import tray

JOIN_S = 25     # to open a port, look for the firmware and ask for a session
END_S = calibration_request.STOP_S + 2


class TraySession:
    """tray: tray_value.Tray, once the boards are found; passed: {port: why} of the other ports.

    request: for the firmware of every board, None for the six faces
    """

    def __init__(self, ports, request=None, clock=time.monotonic):
        self.ports = list(ports)
        self.clock = clock
        self.patience = patience_asked()
        self.told = queue.SimpleQueue()
        self.threads = {port: BoardThread(port, request, self.told) for port in self.ports}
        self.witnesses, self.endings = {}, {}
        self.passed, self.kept = {}, {}
        self.tray = tray({})

    def find(self):
        """Opens every port; the boards that answer are the tray, each asked for its session."""
        for thread in self.threads.values():
            thread.start()
        early, joined = [], {}
        end = self.clock() + JOIN_S * self.patience
        while len(joined) + len(self.passed) < len(self.ports):
            told = self.next(end - self.clock())
            if told is None:
                break
            port, kind, what = told
            if kind == JOINED:
                joined[port] = what
            elif kind == LEFT and port not in joined:
                self.passed[port] = what
            else:
                early.append(told)
        for port in self.ports:
            if port not in joined and port not in self.passed:
                self.threads[port].end()
                self.passed[port] = "%s: no answer within %d s" % (port, JOIN_S * self.patience)
        there = {port: joined[port] for port in self.ports if port in joined}
        self.tray = tray(there, self.patience)
        self.witnesses = {port: logbook.Witness(joined[port]) for port in there}
        self.endings = {port: Ending() for port in there}
        for told in early:
            self.take(told)

    def next(self, wait_s):
        """The next (port, kind, what) of a thread, None when none comes in time."""
        try:
            return self.told.get(timeout=max(0.0, wait_s))
        except queue.Empty:
            return None

    def pump(self, wait_s):
        """Takes in what the boards say within wait_s seconds, and lets time go by."""
        end = self.clock() + wait_s
        while (told := self.next(end - self.clock())) is not None:
            self.take(told)
            if self.clock() > end:
                break
        self.apply(leading.tick(self.tray, self.clock()))

    def take(self, told):
        port, kind, what = told
        if port not in self.endings:    # too late to be in the tray
            return
        if kind == LEFT:
            self.apply(tray_events.left(self.tray, port, what, self.clock()))
        elif kind == HEARD:
            self.witnesses[port].hear(what)
            if self.endings[port].take(what):
                self.witnesses[port].done()
            self.apply(tray_events.after(self.tray, port, what, self.clock()))

    def apply(self, answer):
        """Keeps the Tray of an answer and sends its commands."""
        self.tray, commands = answer
        for port, command in commands:
            self.threads[port].send(command)

    # -- what a person asks for

    def redo(self, face):
        self.apply(leading.redo(self.tray, face, self.clock()))

    def undo(self):
        self.apply(leading.undo(self.tray, self.clock()))

    def end(self):
        """Ends every session that is under way and closes all links; kept: {port: sentence} of
        the boards that were stopped in the middle."""
        open_now = {port for port, thread in self.threads.items() if thread.is_alive()}
        for port in open_now:
            self.threads[port].end()
        end = self.clock() + END_S * self.patience
        while open_now and (told := self.next(end - self.clock())) is not None:
            port, kind, what = told
            if kind == LEFT:
                open_now.discard(port)
                if what and port in self.endings and not self.tray.member(port).over:
                    self.kept[port] = what
            elif kind == HEARD:
                self.take(told)
        for port in open_now & set(self.endings):
            self.kept[port] = "%s: did not answer; it goes on by itself or gives up" % port
