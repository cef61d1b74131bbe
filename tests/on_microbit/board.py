"""QEMU's micro:bit with Debian's firmware, spoken to in the REPL's paste mode.

Paste mode returns every character, so nothing is lost: QEMU hands over bytes faster than any
UART, and what the firmware's 64-byte buffer cannot take is gone without a word. That is why
mpremote, which sends 256 at a time, is not used here.
"""

import re
import time

import serial

from tests.on_qemu.board import QemuBoard

FIRMWARE = "/usr/share/firmware-microbit-micropython/firmware.hex"
AT_ONCE = 16  # bytes on their way
ANSWER_S = 60
CTRL_C, CTRL_D, CTRL_E = b"\x03", b"\x04", b"\x05"
PROMPT = b"\r\n>>> "
PASTE = b"=== "
# What paste mode itself runs out of comes without a traceback.
FAILED = re.compile("^(Traceback |MemoryError)", re.MULTILINE)


class Microbit(QemuBoard):
    """Context manager; exec(*pieces) runs them one after the other, what was made stays."""

    def __init__(self, firmware=FIRMWARE):
        super().__init__(["-M", "microbit", "-device", "loader,file=%s" % firmware])

    def __enter__(self):
        super().__enter__()
        self.serial = serial.Serial(self.port, 115200, timeout=0.1)
        self.reset()
        return self

    def __exit__(self, *error):
        self.serial.close()
        super().__exit__(*error)

    def reset(self):
        """A soft reset: an empty heap."""
        self.serial.write(b"\r" + CTRL_C)
        self._until(PROMPT)
        self.serial.reset_input_buffer()
        self.serial.write(CTRL_D)
        self._until(b'"help()" for more information.' + PROMPT)

    def _until(self, mark):
        """What comes up to the mark, without it; RuntimeError when it does not come."""
        came = b""
        end = time.monotonic() + ANSWER_S
        while mark not in came:
            came += self.serial.read(1)
            if time.monotonic() > end:
                raise RuntimeError("the micro:bit sent %r, %r was expected" % (came[-200:], mark))
        return came[:-len(mark)]

    def _paste(self, code):
        """Send the code, each bit once the bit before has come back."""
        self.serial.write(CTRL_E)
        self._until(PASTE)
        data = code.replace("\n", "\r").encode("ascii")
        for at in range(0, len(data), AT_ONCE):
            bit = data[at : at + AT_ONCE]
            self.serial.write(bit)
            self._until(bit.replace(b"\r", b"\r\n" + PASTE))
        self.serial.write(CTRL_D)
        return self._until(b">>> ")

    def exec(self, *pieces, timeout=None):
        """What the pieces printed; RuntimeError with the traceback of the first that failed."""
        printed = ""
        for code in pieces:
            answer = self._paste(code).decode().replace("\r", "").lstrip("\n")
            if FAILED.search(answer):
                raise RuntimeError("on the micro:bit: " + answer.strip())
            printed += answer
        return printed
