"""Locks the heap while the firmware samples, from one window's end to the next.

Locked is a whole turn of the loop: pacer, driver, awake check, session, capture, lamp. Left
out are the samples that end a window or a block. An allocation is a MemoryError, which ends
the firmware. Prints how many turns were locked, and how many there were.
"""

import sys

import micropython


class Lock:
    """Stands in for the board's sleep_us, which the pacer calls once a sample."""

    def __init__(self, board):
        self.guided = None
        self.on = False
        self.locked = 0
        self.samples = 0
        self.plain = board.sleep_us

    def sleep_us(self, us):
        if self.on:
            micropython.heap_unlock()
            self.on = False
        self.plain(us)
        if self.guided is None:
            return
        self.samples += 1
        window = self.guided.session._window
        writer = self.guided._store._writer
        if window.n != window.length - 1 and writer._count != writer._most:
            self.locked += 1
            self.on = True
            micropython.heap_lock()


def install(board, power_up):
    lock = Lock(board)
    board.sleep_us = lock.sleep_us
    run_phase = power_up.phase

    def phase(name, *given):
        if name != "session.sampling":
            return run_phase(name, *given)
        loaded = set(sys.modules)
        from sixflip_device.session import guided_session
        plain = guided_session.GuidedSession

        def made(*parts):
            lock.guided = plain(*parts)
            return lock.guided
        guided_session.GuidedSession = made
        after = run_phase(name, *given)
        lock.guided = None
        print('{"event": "locked", "turns": %d, "of": %d}' % (lock.locked, lock.samples))
        for module in [one for one in sys.modules if one not in loaded]:
            power_up.forget(module)
        return after
    power_up.phase = phase
