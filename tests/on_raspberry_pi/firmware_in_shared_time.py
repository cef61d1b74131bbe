"""python firmware_in_shared_time.py CLOCK FOLDER: the folder's main.py, as a Raspberry Pi runs it.

Only the time is not this computer's: sleeping moves the clock that the simulated chips read.
"""

import runpy
import sys
import time

from shared_time import SharedTime

LOOK_US = 2  # a loop that polls the clock ends

shared = SharedTime(sys.argv[1])
folder = sys.argv[2]


def monotonic_ns():
    shared.set(shared.us() + LOOK_US)
    return shared.us() * 1000


def sleep(seconds):
    shared.set(shared.us() + max(0, int(seconds * 1e6)))


time.monotonic_ns = monotonic_ns
time.sleep = sleep
sys.path[0] = folder
runpy.run_path(folder + "/main.py", run_name="__main__")
