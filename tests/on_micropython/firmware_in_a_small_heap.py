"""A whole guided session under MicroPython, to be run with a small heap:

    micropython -X heapsize=128k firmware_in_a_small_heap.py FOLDER [live|hanging_bus|locked_loop]

FOLDER is the board's flash, the firmware included: as on a board its files have short names,
which MicroPython keeps in the heap. The chips' bursts come from a tape in FOLDER
(session_tape.py), so that no simulator is in the heap. Prints what this harness itself holds
of it before the first line of firmware is imported; with "live" also what is in use at every
event. The other two are modules beside this one, which change the board: what they need does
not count in the heap of a plain session.
"""

import gc
import json
import os
import sys

folder = sys.argv[1]
mode = "".join(sys.argv[2:])
LAST_REST = 200  # bursts


class Chips:
    """machine.I2C's methods over registers and tapes; few names, they count as well."""

    def __init__(self):
        with open(folder + "/tape.json") as f:
            self.i2c = json.load(f)
        for c in self.i2c:
            c["tape"] = open(folder + "/" + c["tape"], "rb")  # noqa: SIM115 - for the whole run
            c["registers"] = r = bytearray(128)
            for name in c["identity"]:
                r[int(name)] = c["identity"][name]

    def find(self, address):
        for c in self.i2c:
            if c["address"] == address:
                return c
        raise OSError(19)

    def readfrom_mem_into(self, address, register, buf):
        c = self.find(address)
        if register == c["data_register"] and len(buf) == c["length"]:
            if c["tape"].readinto(buf) < len(buf):  # the box stays as it lies at the tape's end
                c["tape"].seek(-LAST_REST * len(buf), 2)
                c["tape"].readinto(buf)
            return
        r = c["registers"]
        for i in range(len(buf)):
            buf[i] = r[register + i]

    def readfrom_mem(self, address, register, n):
        buf = bytearray(n)
        self.readfrom_mem_into(address, register, buf)
        return buf

    def writeto_mem(self, address, register, buf):
        c = self.find(address)
        for i in range(len(buf)):
            c["registers"][register + i] = buf[i] & ~c["self_clearing"].get(str(register), 0)


class SmallBoard:
    """A board of boards/board.py; read_line() stops it once corrected samples have come."""

    name = "small"
    unique_id = "00"
    root = folder + "/"
    scl_pulse = None

    def __init__(self, live):
        self.i2c = Chips()
        self.now = 0
        self.samples = 0
        self.live = live

    def reopen_i2c(self):
        return self.i2c

    def led(self, on):
        pass

    def button(self):
        return False

    def ticks_us(self):
        self.now += 2
        return self.now & 0x3FFFFFFF

    def ticks_diff(self, a, b):
        return ((a - b + 0x20000000) & 0x3FFFFFFF) - 0x20000000

    def sleep_us(self, us):
        self.now += us

    def read_line(self):
        return '{"cmd": "stop"}' if self.samples > 1 else None

    def write_line(self, text):
        if text.startswith('{"event": "sample"'):
            self.samples += 1
        elif not text.startswith('{"event": "state"'):
            if self.live:
                gc.collect()
                print("live", gc.mem_alloc(), end=" ")
            print(text)


board = SmallBoard(mode == "live")
gc.collect()
print("harness", gc.mem_alloc())

os.chdir(folder)
sys.path[:0] = [""]
from sixflip_device import power_up, settings  # noqa: E402

values, problems = settings.merge({"grace_ms": 0})
del settings
if mode and mode != "live":
    __import__(mode).install(board, power_up)
power_up.run(board, values, problems)
