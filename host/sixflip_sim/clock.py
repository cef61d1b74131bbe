"""A clock that only moves when told to, with the names of MicroPython's time module."""

_PERIOD = 1 << 30               # ticks_us wraps here, as on a 32-bit board
_HALF = 1 << 29


class VirtualClock:
    """Time in ns since the world began. Every look at it costs look_us, as on a board, so
    that a loop which polls the clock ends."""

    def __init__(self, look_us=2, start_us=0):
        self._ns = start_us * 1000
        self._look_ns = look_us * 1000

    def advance_ns(self, ns):
        """Let time pass, for instance while bytes move over the bus."""
        self._ns += ns

    def now_us(self):
        """Microseconds since the world began; it does not wrap and does not cost time."""
        return self._ns // 1000

    def ticks_us(self):
        self._ns += self._look_ns
        return self._ns // 1000 & (_PERIOD - 1)

    def ticks_ms(self):
        self._ns += self._look_ns
        return self._ns // 1000000 & (_PERIOD - 1)

    def ticks_diff(self, later, earlier):
        return ((later - earlier + _HALF) & (_PERIOD - 1)) - _HALF

    def ticks_add(self, ticks, delta):
        return (ticks + delta) & (_PERIOD - 1)

    def sleep_us(self, us):
        if us > 0:
            self._ns += int(us) * 1000

    def sleep_ms(self, ms):
        if ms > 0:
            self._ns += int(ms) * 1000000

    def sleep(self, seconds):
        self.sleep_us(seconds * 1000000)
