"""The board's time module over the virtual clock: sleeping costs no time unless paced.

boot.py sets clock and speed before anything else imports this.
"""

import select

import utime

clock = None
_asked = None  # a pipe that the relay writes Ctrl-C to
_hand = None  # a pipe with what somebody asks the box's operator for
_move = None  # called with a line of it
_poll = select.poll()
speed = None  # virtual seconds in a real second; None: as fast as the processor
_started_us = 0

gmtime = utime.gmtime
localtime = utime.localtime
mktime = utime.mktime
ticks_cpu = utime.ticks_cpu


def start(virtual_clock, factor, asked, hand=None, move=None):
    global clock, speed, _started_us, _asked, _hand, _move
    clock = virtual_clock
    _asked = asked
    _hand = hand
    _move = move
    _poll.register(asked, select.POLLIN)
    if hand:
        _poll.register(hand, select.POLLIN)
    speed = factor
    _started_us = utime.time_ns() // 1000 - int(clock.now_us() / (factor or 1))


def _look():
    """KeyboardInterrupt when Ctrl-C was pressed: see sixflip_host.virtual.pty_relay."""
    for ready in _poll.poll(0):
        if ready[0] is _asked:
            _asked.read(1)
            raise KeyboardInterrupt
        _move(_hand.readline())


def _pace():
    _look()
    if speed is not None:
        ahead_us = int(clock.now_us() / speed) - (utime.time_ns() // 1000 - _started_us)
        if ahead_us > 1000:
            utime.sleep_us(ahead_us)


def ticks_us():
    _look()
    return clock.ticks_us()


def ticks_ms():
    _look()
    return clock.ticks_ms()


def ticks_diff(later, earlier):
    return clock.ticks_diff(later, earlier)


def ticks_add(ticks, delta):
    return (ticks + delta) & 0x3FFFFFFF


def sleep_us(us):
    clock.sleep_us(us)
    _pace()


def sleep_ms(ms):
    clock.sleep_us(ms * 1000)
    _pace()


def sleep(seconds):
    clock.sleep_us(int(seconds * 1000000))
    _pace()


def time():
    return clock.now_us() // 1000000


def time_ns():
    return clock.now_us() * 1000
