"""An emulated board: QEMU with its serial port on a pty, spoken to by the real mpremote."""

import os
import re
import signal
import subprocess
import sys
import time


def cortex_m3(elf):
    """QEMU's words for the MPS2 AN385 with a firmware.elf."""
    return ["-M", "mps2-an385", "-semihosting", "-kernel", str(elf)]


class QemuBoard:
    """Context manager; exec(code) runs code on the board and returns what it printed.

    machine  QEMU's words for the machine and what it starts
    """

    def __init__(self, machine, extra=()):
        self.command = ["qemu-system-arm", "-nographic", "-monitor", "null", "-serial", "pty",
                        *machine, *extra]
        self.process = None
        self.port = None

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        said = b""
        deadline = time.monotonic() + 20
        os.set_blocking(self.process.stdout.fileno(), False)
        while self.port is None:
            said += self.process.stdout.read() or b""
            found = re.search(rb"/dev/pts/\d+", said)
            if found:
                self.port = found.group().decode()
            elif self.process.poll() is not None or time.monotonic() > deadline:
                self.__exit__()
                raise RuntimeError("QEMU gave no serial port: %s" % said.decode(errors="replace"))
            else:
                time.sleep(0.05)
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def exec(self, *pieces, timeout=1200):
        """What the board printed; RuntimeError with its traceback when the code failed.

        The board is reset first; several pieces run one after the other, each compiled alone.
        """
        words = [word for code in pieces for word in ("exec", code)]
        self.process.send_signal(signal.SIGCONT)
        try:
            answer = subprocess.run(
                [sys.executable, "-m", "mpremote", "connect", self.port, *words],
                capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL)
        finally:
            # The port of MicroPython polls its UART without a pause: a board that waits for its
            # next line would keep a core of the host busy until the last test has ended.
            self.process.send_signal(signal.SIGSTOP)
        if answer.returncode:
            raise RuntimeError("on the board: " + (answer.stdout + answer.stderr).strip())
        return answer.stdout.replace("\r", "")
