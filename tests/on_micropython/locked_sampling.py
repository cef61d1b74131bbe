"""Twelve poses with the heap locked on every sample that ends neither window nor block.

Samples are made before the lock; an allocation inside it is a MemoryError. Prints the number
of samples, of locked ones, of poses, and the kinds of allocation the lock does catch.
"""

import sys

HERE = __file__[: __file__.rindex("/")]
sys.path[:0] = [HERE + "/../shared", HERE + "/../../shared"]

import micropython  # noqa: E402  after the path is set
from synthetic_operator import Operator  # noqa: E402

from sixflip.capture.writer import BlockWriter  # noqa: E402
from sixflip.poses.session import Session  # noqa: E402

session = Session(16384, 65.5, 32767, 32767, 100)
writer = BlockWriter(lambda data: None, b"{}")
window = session._window
locked = 0


def sink(dt_us, sample):
    global locked
    ends = window.n == window.length - 1 or writer._count == writer._most
    if ends:
        writer.add(dt_us, sample)
        return session.feed(dt_us, sample)
    locked += 1
    micropython.heap_lock()
    try:
        writer.add(dt_us, sample)
        event = session.feed(dt_us, sample)
    finally:
        micropython.heap_unlock()
    return event


def caught(act):
    """Whether the lock catches what a careless sampling loop would do."""
    micropython.heap_lock()
    try:
        act()
        return False
    except MemoryError:
        return True
    finally:
        micropython.heap_unlock()


x = 1.5
big = 1 << 61
hands = Operator(sink)
hands.six_faces()
print("samples", session.samples, "locked", locked, "poses", len(session.placements))
print("float", caught(lambda: x * x), "big", caught(lambda: big + big),
      "tuple", caught(lambda: (x, x, big)))
