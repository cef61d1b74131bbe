"""Carries bytes between the port that mpremote opens and the terminal of the board's process."""

import os
import pty
import select
import signal
import termios
import threading
import time
import tty

CHUNK = 1024  # well below the 4096 bytes a terminal holds
CTRL_C = b"\x03"
CTRL_C_PAUSE_S = 0.02
PATIENCE_S = 1.5
SOON_S = 0.005
QUIET_S = 0.05
RAPID_DEATHS = 5


def read_some(descriptor):
    try:
        return os.read(descriptor, CHUNK)
    except BlockingIOError:
        return b""


def write_some(descriptor, data):
    """Number of bytes the terminal took."""
    try:
        return os.write(descriptor, data)
    except BlockingIOError:
        return 0


class PtyRelay(threading.Thread):
    """The thread also starts the process again when it ends.

    corrupt  a function of bytes for a bad cable, or None; applied to what the board sends
    """

    def __init__(self, board):
        super().__init__(daemon=True, name="pty relay")
        self.board = board
        self.outer_master, self.outer_slave = pty.openpty()
        self.inner_master, self.inner_slave = pty.openpty()
        # Our own handles of both slaves keep the masters from EIO between two users.
        for slave in (self.outer_slave, self.inner_slave):
            tty.setraw(slave, termios.TCSANOW)
        os.set_blocking(self.outer_master, False)
        os.set_blocking(self.inner_master, False)
        self.port = os.ttyname(self.outer_slave)
        self.corrupt = None
        self.ended = threading.Event()
        self.wake_read, self.wake_write = os.pipe()
        self.ask_read, self.ask_write = os.pipe()  # Ctrl-C for code that looks at the time
        self.asked_until = None
        self.hand_read, self.hand_write = os.pipe()  # what the box's operator is asked for

    def run(self):
        to_host, to_board = b"", b""
        deaths = 0
        while not self.ended.is_set():
            if self.asked_until is not None:
                self.see_whether_heard()
            readers = [self.wake_read]
            writers = []
            if to_host:
                writers.append(self.outer_master)
            else:
                readers.append(self.inner_master)
            if not to_board:
                readers.append(self.outer_master)
            elif self.asked_until is None:
                writers.append(self.inner_master)
            readable, writable, _ = select.select(
                readers, writers, [], QUIET_S if self.asked_until is None else SOON_S)
            if self.outer_master in writable:
                to_host = to_host[write_some(self.outer_master, to_host):]
            if self.inner_master in readable:
                to_host = read_some(self.inner_master)
                self.ask_operator(to_host)
                if self.corrupt:
                    to_host = self.corrupt(to_host)
            if self.outer_master in readable:
                to_board = read_some(self.outer_master)
            if self.inner_master in writable:
                to_board = self.write_to_board(to_board)
            if not readable and not writable and self.board.child.poll() is not None:
                deaths = deaths + 1 if self.restart() else 0
                if deaths > RAPID_DEATHS:
                    break

    def write_to_board(self, data):
        """Hand over what comes before a Ctrl-C, or that one; returns the rest.

        A run of Ctrl-C becomes one: on a board the second finds the code stopped already.
        """
        head = data.partition(CTRL_C)[0]
        if head:
            return data[write_some(self.inner_master, head):]
        if self.code_runs():
            os.write(self.ask_write, CTRL_C)
            self.asked_until = time.monotonic() + PATIENCE_S
        elif not write_some(self.inner_master, CTRL_C):
            return data
        return data.lstrip(CTRL_C)

    def code_runs(self):
        """True while the board executes code, False while its REPL reads."""
        return bool(termios.tcgetattr(self.inner_slave)[3] & termios.ISIG)

    def see_whether_heard(self):
        """Ctrl-C for running code is asked for first and forced after PATIENCE_S.

        A board raises KeyboardInterrupt between two bytecodes. The unix port raises it
        wherever its SIGINT arrives, in mid-collection of garbage too, and never works again
        after that. So its time module, which firmware calls all the time, looks at a pipe and
        raises there; only code that never looks at the time gets the signal.
        """
        if not select.select([self.ask_read], [], [], 0)[0]:
            self.asked_until = None
        elif not self.code_runs():
            self.take_back()
            write_some(self.inner_master, CTRL_C)
        elif time.monotonic() > self.asked_until:
            self.take_back()
            self.board.child.send_signal(signal.SIGINT)
            time.sleep(CTRL_C_PAUSE_S)

    def take_back(self):
        """What was asked for is over."""
        while select.select([self.ask_read], [], [], 0)[0]:
            os.read(self.ask_read, CHUNK)
        self.asked_until = None

    def ask_operator(self, data):
        """What the board says is heard by the one who handles the box, too. What is to be done
        then is asked for only as long as the board has not said more."""
        commands = self.board.hand_asked.hear(data) if self.board.hand_asked else []
        waits, _, _ = select.select([self.hand_read, self.inner_master], [], [], 0)
        if commands and not waits:
            os.write(self.hand_write, commands[-1])

    def restart(self):
        """Start the process again; True when it died young for no reason of its own."""
        code = self.board.child.returncode
        self.take_back()
        while select.select([self.hand_read], [], [], 0)[0]:
            os.read(self.hand_read, CHUNK)
        tty.setraw(self.inner_slave, termios.TCSANOW)
        self.board.start_again(code)
        return code == 1

    def stop(self):
        """End the thread; the descriptors stay open until close()."""
        self.ended.set()
        os.write(self.wake_write, b"x")
        if self.is_alive():
            self.join(5)

    def close(self):
        for descriptor in (self.outer_master, self.outer_slave, self.inner_master,
                           self.inner_slave, self.wake_read, self.wake_write,
                           self.ask_read, self.ask_write, self.hand_read, self.hand_write):
            os.close(descriptor)
