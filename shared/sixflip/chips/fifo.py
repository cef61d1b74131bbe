"""Samples out of the memory in a chip, one after the other: none lost, none twice.

Polling takes what the chip has at the moment; whatever it measured while the board did something
else (a window's end, a line on the port, a block of the capture) is gone. A chip with a FIFO has
kept it. Transfers are of two frames, 32 bytes at most, which every port and Linux's SMBus take.

A driver says what its chip's memory is like: FIFO_SETUP, its registers; FIFO_DATA, from which
a burst reads on and on; fifo_start(), which empties it and begins anew; fifo_level(), how many
frames wait in it, or FULL: samples were lost (what is cleared by reading is read last: the
level may be asked again). Frames are in one of the formats below.
"""

from errno import EIO, ETIMEDOUT

from sixflip.chips.registers import words_into

FULL = -1
ATTEMPTS = 3                # at a transfer that nobody acknowledges
CHUNK = 16                  # frames read at a time, two in a transfer
TAGS = 0x01, 0x02           # gyro, accelerometer (LSM6DSOX DS12814 rev. 4, table 196; TAG_SENSOR)


class Fifo:
    """Frames of 14 bytes, the same as a burst of the data registers (MPU6050, ICM-20948).

    left: samples that look() found and that were not read yet. A frame that is none of the
    chip's, and a transfer that failed half way, are an OSError: then start() anew.
    """

    FRAME = 14

    def __init__(self, imu):
        self.imu = imu
        self.left = 0
        self._burst = bytearray(CHUNK * self.FRAME)
        view, two = memoryview(self._burst), 2 * self.FRAME
        self._pairs = [view[at:at + two] for at in range(0, len(view), two)]
        self._halves = [pair[:self.FRAME] for pair in self._pairs]
        self._at = self._end = 0

    def start(self):
        """Empties the chip's memory and what was read of it."""
        self.left = self._at = self._end = 0
        self.imu.fifo_start()

    def look(self):
        """How many samples there are to be read, or FULL."""
        count = self._ask(None)
        self.left = max(0, count)
        return count

    def read_into(self, sample):
        """The next one of those that look() found, as a driver's read_into. Without one, False."""
        if self.left == 0:
            return False
        if self._at == self._end:
            self._read()
        at = self._at
        self._at = at + self.FRAME
        self.left -= 1
        return self._take(at, sample)

    def _read(self):
        """A chunk of what is left. Were it overwritten meanwhile, it would be no frames any more:
        that it was not is asked behind it."""
        n = min(self.left, CHUNK)
        self._at = self._end = 0
        for i in range(n // 2):
            self._ask(self._pairs[i])
        if n % 2:
            self._ask(self._halves[n // 2])
        if self._ask(None) < 0:
            raise OSError(EIO, "its FIFO was full")
        self._end = n * self.FRAME

    def _ask(self, buf):
        """Frames into buf, or without one the level. Who does not acknowledge has given no byte:
        that is asked again. After a time-out nobody knows how much of a frame is gone."""
        attempt = 1
        while True:
            try:
                if buf is None:
                    return self.imu.fifo_level()
                self.imu._fetch(self.imu.FIFO_DATA, buf)
                return 0
            except OSError as e:
                if attempt == ATTEMPTS or e.args[0] == ETIMEDOUT:
                    raise
                attempt += 1

    def _take(self, at, sample):
        return self._words(at, self.imu.COLUMNS, sample)

    def _words(self, at, columns, sample):
        return words_into(sample, self._burst, at, columns, self.imu.HIGH)

    def _out_of_step(self, header):
        raise OSError(EIO, "a frame of its FIFO begins with 0x%02x" % header)


class PairFifo(Fifo):
    """Gyro and accelerometer without a word of what is what (LSM6DS3TR-C); the temperature is
    that of the data registers when look() looked."""

    FRAME = 12

    def _take(self, at, sample):
        sample[6] = self.imu.fifo_temperature
        return self._words(at, (3, 4, 5, 0, 1, 2), sample)


class PacketFifo(Fifo):
    """Header, accelerometer, gyro, temperature in one byte, time stamp: packet 3 of an ICM-42688-P
    (DS-000347 rev. 1.5, section 6.1) and of an ICM-45686. 0.5 °C a count of the temperature."""

    FRAME = 16

    def _take(self, at, sample):
        burst = self._burst
        if burst[at] & 0xF0 != 0x60:    # accelerometer and gyro, 16 bits each
            self._out_of_step(burst[at])
        celsius = burst[at + 13]
        sample[6] = ((celsius ^ 0x80) - 0x80) * 64
        return self._words(at + 1, (0, 1, 2, 3, 4, 5), sample)


class TaggedFifo(Fifo):
    """Words of a tag and three numbers (LSM6DSOX, LSM6DSV): which sensor's, and a counter of two
    bits that goes on with every sample, so that one that is missing shows."""

    FRAME = 14                  # two words

    def start(self):
        """Empties and starts it; the first sample may have any count."""
        self._count = -1
        Fifo.start(self)

    def _take(self, at, sample):
        burst = self._burst
        first, second = burst[at], burst[at + 7]
        sample[6] = self.imu.fifo_temperature
        count = first >> 1 & 3
        if (first >> 3 == second >> 3 or first >> 3 not in TAGS or second >> 3 not in TAGS
                or second >> 1 & 3 != count or self._count not in (-1, count - 1, count + 3)):
            self._out_of_step(first)
        self._count = count
        gyro = at + 1 if first >> 3 == 1 else at + 8
        good = self._words(gyro, (3, 4, 5), sample)
        return self._words(2 * at + 9 - gyro, (0, 1, 2), sample) or good
