"""Every sample of a chip's FIFO, with its time by the board's clock.

The chip measures by a clock of its own, which is a few percent off, and the board looks when it
has time. At a look the newest sample is some part of a period old, never less than nothing nor
more than a period: an age outside says that the period was taken too short or too long, by how
much, and moves both. In between, samples are a period apart. Whole numbers throughout, sixteenths
of a microsecond.
"""

from .sensor import READ

BATCH = 8           # samples to wait for at a time
SILENT_US = 500000  # without a sample: the chip hangs
OFF = 16            # the period is within 1 / OFF of what the chip's sheet says
LOOKS = 3           # until one takes less than half a period
SLOW = 16           # looks over which an age that does not fit moves the period


class FifoPacer:
    """next(sample) as a Pacer's; nothing is allocated in between but for what is told."""

    def __init__(self, board, sensor):
        self._board = board
        self._sensor = sensor
        self._fifo = sensor.imu.fifo
        self._nominal = self._period = int(16000000 / sensor.imu.output_rate_hz + 0.5)
        self._step = self._period
        self._dated = board.ticks_us()  # of the last look that found samples
        self._age = 0                   # of the newest of them then
        self._rest = 0                  # of the interval told last
        self._begun = None              # None: there was no sample before
        self._begin()

    def _begin(self):
        """The memory is emptied; from now on. The next interval covers what is lost."""
        if self._begun:                 # the last sample told is so much older than that look
            self._age += self._fifo.left * self._step
        if self._begun is not None:
            self._begun = False
        self._looked = self._board.ticks_us()
        try:
            self._fifo.start()
        except OSError:
            self._fifo.left = 0     # the next look meets it, too

    def next(self, sample):
        """Microseconds since the sample before, or -1: samples were lost, or the chip was set up
        anew, and what is in sample must not be used."""
        fifo = self._fifo
        sensor = self._sensor
        if fifo.left == 0 and not self._look():
            self._begin()
            return -1
        if not sensor.take(sample):
            self._begin()
            return -1
        step = self._step + self._rest
        if self._first:
            step = self._first
            self._first = 0
        self._rest = step & 15
        return step >> 4

    def _look(self):
        """True when there are samples; False when there was a loss or the chip is another."""
        board = self._board
        sensor = self._sensor
        started = board.ticks_us()
        while True:
            wait = (BATCH * self._period >> 4) - board.ticks_diff(board.ticks_us(), self._looked)
            if wait > 0:
                board.sleep_us(wait)
            for _ in range(LOOKS):
                looked = board.ticks_us()
                found = sensor.waiting()
                if board.ticks_diff(board.ticks_us(), looked) << 5 < self._period:
                    break           # else something came in between: when was that level?
            if found < 0 or sensor.check() != READ:
                return False
            if found:
                self._date(found, looked)
                return True
            self._looked = looked
            if board.ticks_diff(looked, started) > SILENT_US:
                sensor.silent()
                return False

    def _date(self, n, now):
        """n samples were there at a time: how far they are apart, and how old the newest is."""
        period = self._period
        elapsed = self._board.ticks_diff(now, self._dated) << 4
        if not self._begun:
            age = period >> 1
            self._first = period if self._begun is None else max(
                16, elapsed + self._age - age - (n - 1) * period)
            self._begun = True
            self._step = period
        else:
            age = self._age + elapsed - n * period
            off = age if age < 0 else age - period if age > period else 0
            self._step = max(16, period + off // n)
            self._first = 0
            age -= off
            moved = period + off // (n * SLOW)
            least = self._nominal - self._nominal // OFF
            most = self._nominal + self._nominal // OFF
            self._period = min(most, max(least, moved))
        self._age = age
        self._dated = self._looked = now
