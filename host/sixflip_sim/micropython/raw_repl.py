"""The REPL that boards have in C and the unix port has not: friendly, raw and raw-paste mode.

After shared/runtime/pyexec.c of MicroPython. While it reads, the terminal hands over every
byte; while code runs, 0x03 is a SIGINT, that is a KeyboardInterrupt even in a tight loop.
"""

import sys

try:
    import termios
except ImportError:
    termios = None

CTRL_A, CTRL_B, CTRL_C, CTRL_D, CTRL_E = 1, 2, 3, 4, 5
BANNER = "raw REPL; CTRL-B to exit\r\n>"
PROMPT = "\r\n>>> "
PASTE_WINDOW = 128  # MICROPY_REPL_STDIN_BUFFER_MAX / 2


class Restart(SystemExit):
    """The process ends and is started again: the code says how."""


HARD_RESET = 80
SOFT_RESET = 81  # boot.py and main.py run again
SOFT_RESET_RAW = 82  # main.py is skipped, back into raw mode


class Terminal:
    """Standard input and output of the process, in one of two modes."""

    def __init__(self, modes):
        """modes: {"repl": [iflag, oflag, lflag], "run": […]}, numbers of the host's termios."""
        self.modes = modes
        self.stdin = sys.stdin.buffer

    def mode(self, name):
        if termios is None:
            return
        attributes = termios.tcgetattr(0)
        attributes[0], attributes[1], attributes[3] = self.modes[name]
        termios.tcsetattr(0, termios.TCSANOW, attributes)

    def read(self):
        """One byte as an int; the far end closed: the process ends."""
        byte = self.stdin.read(1)
        if not byte:
            sys.exit(0)
        return byte[0]

    def write(self, text):
        sys.stdout.write(text)

    def write_bytes(self, data):
        sys.stdout.buffer.write(data)


class Repl:
    def __init__(self, terminal, raw=False):
        self.terminal = terminal
        self.raw = raw
        self.names = {"__name__": "__main__"}

    def loop(self):
        """Read and run until a Restart is raised."""
        terminal = self.terminal
        terminal.mode("repl")
        terminal.write(BANNER if self.raw else PROMPT)
        while True:
            try:
                if self.raw:
                    self.raw_line()
                else:
                    self.friendly_line()
            except KeyboardInterrupt:
                pass  # one that came just before the terminal's mode changed
            terminal.mode("repl")

    # -- raw mode

    def raw_line(self):
        terminal = self.terminal
        line = bytearray()
        while True:
            byte = terminal.read()
            if byte == CTRL_A:
                if len(line) == 2 and line[0] == CTRL_E:
                    if line[1] == ord("A"):
                        self.paste()
                    else:
                        terminal.write("R\x00")
                    terminal.write(">")
                else:
                    terminal.write(BANNER)
                return
            elif byte == CTRL_B:
                self.raw = False
                terminal.write("\r\nMicroPython " + sys.version + PROMPT)
                return
            elif byte == CTRL_C:
                line = bytearray()
            elif byte == CTRL_D:
                break
            else:
                line.append(byte)
        if not line:
            terminal.write("\r\nMPY: soft reboot\r\n")
            raise Restart(SOFT_RESET_RAW)
        terminal.write("OK")
        self.run_raw(line)
        terminal.write(">")

    def paste(self):
        """Raw paste: the host may send one window ahead, and each 0x01 grants another."""
        terminal = self.terminal
        terminal.write_bytes(bytes((ord("R"), 1, PASTE_WINDOW, 0, 1)))
        source = bytearray()
        room = PASTE_WINDOW
        while True:
            byte = terminal.read()
            if byte == CTRL_C:
                terminal.write("\x04")
                return
            if byte == CTRL_D:
                break
            source.append(byte)
            room -= 1
            if room == 0:
                terminal.write("\x01")
                room = PASTE_WINDOW
        terminal.write("\x04")
        self.run_raw(source)

    def run_raw(self, source):
        error = self.execute(source)
        self.terminal.write("\x04")
        if error:
            sys.print_exception(error)
        self.terminal.write("\x04")
        self.terminal.mode("repl")

    # -- friendly mode

    def friendly_line(self):
        """One line with echo; enough to look around by hand."""
        terminal = self.terminal
        line = ""
        while True:
            byte = terminal.read()
            if byte == CTRL_A:
                self.raw = True
                terminal.write(BANNER)
                return
            if byte in (CTRL_B, CTRL_C):
                break
            if byte == CTRL_D and not line:
                terminal.write("\r\nMPY: soft reboot\r\n")
                raise Restart(SOFT_RESET)
            if byte in (8, 127):
                if line:
                    line = line[:-1]
                    terminal.write("\x08 \x08")
            elif byte == 13:
                terminal.write("\r\n")
                self.run_friendly(line)
                terminal.mode("repl")
                break
            elif byte >= 32:
                line += chr(byte)
                terminal.write(chr(byte))
        terminal.write(PROMPT)

    def run_friendly(self, line):
        if not line.strip():
            return
        error = self.execute("__result = " + line)
        if isinstance(error, SyntaxError):
            error = self.execute(line)
        elif error is None and self.names["__result"] is not None:
            print(repr(self.names["__result"]))
        if error:
            sys.print_exception(error)

    # -- running

    def execute(self, source):
        """Run source text; its exception is returned, a Restart goes on upwards.

        The terminal stays in the mode of running code, so that a traceback has its line ends.
        """
        terminal = self.terminal
        error = None
        try:
            terminal.mode("run")
            exec(source if isinstance(source, str) else bytes(source), self.names)
        except Restart:
            raise
        except SystemExit:
            terminal.mode("repl")
            terminal.write("\r\nMPY: soft reboot\r\n")
            raise Restart(SOFT_RESET_RAW if self.raw else SOFT_RESET)
        except BaseException as exception:
            error = exception
        return error

    def run_file(self, path):
        """Run boot.py or main.py when there is one."""
        try:
            with open(path) as file:
                source = file.read()
        except OSError:
            return
        error = self.execute(source)
        if error:
            sys.print_exception(error)
