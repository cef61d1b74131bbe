"""The sensor behind a bus that may fail: retried, freed, identified and configured again; one
sample a period.

The usual cause of a failing bus is a reset in mid-read: the chip holds SDA low until it has been
clocked out, up to nine pulses. The other one is a chip that lost its power for a moment and came
back asleep; it answers, with frozen numbers, so awake() is asked now and then.

Only the chip that was there is accepted again, by its ID register. Once it is given up
(BusLost), the firmware begins anew and probes for whatever is there.
"""



RETRIES = 3
RETRY_US = 500
PAUSES_MS = (10, 100, 500, 1000, 2000, 4000)  # before each recovery; then it is given up
EMPTY = 8  # samples in a row without a bit of difference: the chip is set up anew

READ = 0       # a fresh sample is in the buffer
RECOVERED = 1  # the chip was set up anew: what was being captured must be thrown away


class BusLost(OSError):
    """The sensor cannot be had back; the sentence says what was tried."""


def free_bus(board):
    """Nine clock pulses and a STOP where pins can be driven; always a new bus object."""
    if board.scl_pulse is not None:
        for _ in range(9):
            board.scl_pulse()
        board.stop_condition()
    board.reopen_i2c()


def sleeper(board):
    """For the drivers, which know no board."""
    def sleep_ms(ms):
        board.sleep_us(ms * 1000)
    return sleep_ms


class Sensor:
    """The IMU, .imu, behind a bus that may fail.

    .errors counts failed transfers, .recoveries how often the chip was set up anew; .shifted is
    the sentence on the last offset register that somebody changed, or "".
    """

    def __init__(self, board, imu, settings, events):
        self._board = board
        self._settings = settings
        self._events = events
        self.imu = imu
        self.errors = 0
        self.recoveries = 0
        self.shifted = ""
        self._vain = 0

    def read_into(self, sample):
        """READ or RECOVERED (then sample is not to be used); BusLost when it is hopeless."""
        try:
            if self.imu.read_into(sample):
                self._vain = 0
                return READ
            error = None  # all zeros or all ones: no sensor at work reads like that
        except OSError as e:
            error = e
        if error is None and self.check() != READ:
            return RECOVERED
        return self._retry(error, sample)

    def waiting(self):
        """Samples in the chip's FIFO, or -1: some were lost, or the chip was set up anew."""
        for _ in range(RETRIES):
            try:
                found = self.imu.fifo.look()
                if found < 0:
                    self._lost("its FIFO was full")
                return found
            except OSError as e:
                error = e
                self.errors += 1
                self._board.sleep_us(RETRY_US)
        self._recover(error)
        return -1

    def take(self, sample):
        """The next sample of those that waiting() found; False: some were lost, and it is said."""
        try:
            if self.imu.fifo.read_into(sample):
                self._vain = 0
                return True
            self._lost("an empty frame")
        except OSError as e:
            self._lost(e.args[1] if len(e.args) > 1 else "a transfer failed", e)
        return False

    def _lost(self, why, error=None):
        """Tells that samples of the FIFO are lost; when that goes on, sets up the chip anew."""
        self.errors += 1
        self._vain += 1
        self._report(error, "samples are lost: %s" % why)
        if self._vain % EMPTY == 0:
            self._recover(error or why)

    def silent(self):
        """Sets up anew a chip whose FIFO stays empty; RECOVERED."""
        self._vain += EMPTY
        return self._recover("no new samples")

    def check(self):
        """READ when the chip is as it was configured, else RECOVERED or BusLost."""
        error = None
        for _ in range(RETRIES):
            try:
                # a wrong answer may be a glitch on the bus: ask again before believing it
                if self.imu.awake() or self.imu.awake():
                    return READ
                self.shifted = self._shifted()
                self._report(None, (self.shifted or "the chip was reset or fell asleep")
                             + "; configuring it again")
                self.imu.configure(self._settings["rate_hz"])
                self.recoveries += 1
                return RECOVERED
            except OSError as e:
                error = e
                self.errors += 1
                self._board.sleep_us(RETRY_US)
        return self._recover(error)

    def _shifted(self):
        """Said three times, by the chip that was there: a stuck SDA reads as zeros through
        SoftI2C."""
        said = self.imu.shifted()
        for _ in range(2):
            if not said or self.imu.shifted() != said:
                return ""
        return said if self.imu.answers(self._board.i2c) else ""

    def hangs(self):
        """Sets up anew a chip that answers with one reading over and over; RECOVERED."""
        self.errors += 1
        return self._recover("identical readings")

    def _report(self, error, action):
        number = error.args[0] if isinstance(error, OSError) and error.args else None
        self._events.emit("bus_error", errno=number, count=self.errors, action=action)

    def _retry(self, error, sample):
        self.errors += 1
        for _ in range(RETRIES):
            self._board.sleep_us(RETRY_US)
            try:
                whole = self.imu.read_into(sample)
            except OSError as e:
                error = e
                self.errors += 1
                continue
            if whole:
                self._report(error, "read again")
                return READ
            error = None
        if error is None:
            self._vain += 1
            if self._vain % EMPTY:
                return RECOVERED
        return self._recover(error)

    def _recover(self, error):
        imu = self.imu
        for ms in PAUSES_MS:
            self._report(error, "freeing the bus and asking the chip again")
            self._board.sleep_us(ms * 1000)
            try:
                free_bus(self._board)
                if not imu.answers(self._board.i2c):
                    raise OSError(5, "another ID than that of the %s" % imu.name)
                imu.configure(self._settings["rate_hz"])
            except OSError as e:
                error = e
                self.errors += 1
                continue
            if self._vain > 6 * EMPTY:
                error = ("no bit of its samples differs" if imu.fifo is None
                         else "nothing comes out of its FIFO")
                break
            self.recoveries += 1
            self._report(error, "recovered")
            return RECOVERED
        self._report(error, "given up")
        raise BusLost("the sensor no longer answers (%s); recovered %d times before"
                      % (error, self.recoveries))


CHECK_EVERY = 8  # samples between two questions to the chip


def pacer(board, sensor, rate_hz):
    """What gives one sample after the other: by polling, or out of the chip's FIFO."""
    if sensor.imu.fifo is None:
        return Pacer(board, sensor, rate_hz)
    from .fifo_pacer import FifoPacer
    return FifoPacer(board, sensor)


class Pacer:
    """next(sample) waits until the next sample is due and reads it; nothing is allocated.

    Microseconds are small integers throughout: 31 bits hold 17 minutes of them, and
    differences are taken by the board's ticks_diff.
    """

    def __init__(self, board, sensor, rate_hz):
        self._board = board
        self._sensor = sensor
        self._period = 1000000 // int(rate_hz)
        self._ahead = 0
        self._countdown = CHECK_EVERY
        self._last = board.ticks_us()

    def next(self, sample):
        """Microseconds since the sample before, or -1: the chip was set up anew and what is
        in sample must not be used. The interval after a -1 covers the time that was lost.
        """
        board = self._board
        wait = self._period + self._ahead - board.ticks_diff(board.ticks_us(), self._last)
        if wait > 0:
            board.sleep_us(wait)
        found = self._sensor.read_into(sample)
        self._countdown -= 1
        if self._countdown == 0:
            self._countdown = CHECK_EVERY
            if self._sensor.check() != READ:
                found = -1
        if found != READ:
            return -1
        now = board.ticks_us()
        dt = board.ticks_diff(now, self._last)
        self._last = now
        self._ahead += self._period - dt
        if self._ahead < -self._period or self._ahead > self._period:
            self._ahead = 0  # late is late: no burst of samples to catch up
        return dt
