"""Eight-bit registers behind an I2C address: read, write, and write with a check."""

import errno


class Registers:
    """Base of the drivers. `i2c` is handed in and has machine.I2C's method names.

    sleep_ms waits for a number of milliseconds; without one the driver waits by reading,
    a bounded number of times (a register read takes 0.1 ms at 400 kHz).

    setup, offsets  (first register, how many), ...: every register that scales readings (range,
                    filter, rate, power), and every one that shifts them; as they read at the
                    end of configure() they have to stay
    READY           (register, bits): a new sample, cleared by reading it or the sample
    READY_ON        (register, bits) that have it shown; None: it is always
    """

    chip = "chip"
    MOST_HZ = 500               # the most a second that configure() takes
    fifo = None                 # a Fifo where samples come through the chip's memory
    setup = offsets = ()
    READY = (0, 0)
    READY_ON = None

    def __init__(self, i2c, address, sleep_ms=None):
        self.address = address
        self._i2c = i2c
        self._sleep_ms = sleep_ms
        self._byte = bytearray(1)
        self._two = bytearray(2)
        self._interface = 0  # the bit that a chip on SPI has set in a register of its own
        self._held = []  # (first register, values as configured, room for what it reads)

    def _answers(self, i2c, register, expected):
        """From now on on this bus. Whether the ID register reads as it did to the probe."""
        self._i2c = i2c
        return self._read(register) == expected

    def _chip_name(self, who_am_i):
        from sixflip.chips import catalogue  # the probe's; not kept in the heap
        return catalogue.name_of(self.sensor, who_am_i)

    def _fetch(self, register, buf):
        """Fill buf from the register on. A chip with banks has a fetch of its own."""
        self._i2c.readfrom_mem_into(self.address, register, buf)

    def _store(self, register, buf):
        self._i2c.writeto_mem(self.address, register, buf)

    def _read(self, register):
        self._fetch(register, self._byte)
        return self._byte[0]

    def _write(self, register, value):
        self._byte[0] = value
        self._store(register, self._byte)

    def _set(self, register, value):
        """Write and read back: SoftI2C returns as if all were well when data is not
        acknowledged. Three attempts, then OSError saying what was expected."""
        for _ in range(3):
            self._write(register, value)
            read = self._read(register)
            if read == value:
                return
        raise OSError(errno.EIO, "%s at 0x%02x: register 0x%02x reads 0x%02x, expected 0x%02x"
                      % (self.chip, self.address, register, read, value))

    def _no_i2c(self, register, bit):
        """On SPI: no more I2C, which would take the lines' edges for its own. The makers ask for
        it in their data sheets' sections on SPI. On I2C the bit would shut the chip off."""
        self._interface = bit if getattr(self._i2c, "spi", False) else 0
        if self._interface:
            self._set(register, bit)

    def _hold(self):
        """Ends configure(): what setup and offsets read has to stay."""
        held = self._held = []
        for first, n in self.setup + self.offsets:
            kept = bytearray(n)
            self._fetch(first, kept)
            held.append((first, kept, bytearray(n)))
        if not self.awake():
            raise OSError(errno.EIO, "%s at 0x%02x: registers read otherwise each time"
                          % (self.chip, self.address))

    def awake(self):
        """Whether setup and offsets are as configure() left them, which they are not after a
        brown-out. Short reads, no allocation: to be asked often, and when read_into says False."""
        for first, kept, buffer in self._held:
            self._fetch(first, buffer)
            if buffer != kept:
                return False
        return True

    def shifted(self):
        """"" or a sentence: which offset somebody has changed. A reset changes none, it brings
        back what was configured (0) or the factory's trim."""
        for first, kept, buffer in self._held[len(self.setup):]:
            self._fetch(first, buffer)
            for i in range(len(kept)):
                if buffer[i] != kept[i]:
                    return ("register 0x%02x of the %s was 0x%02x when it was configured and "
                            "reads 0x%02x" % (first + i, self.chip, kept[i], buffer[i]))
        return ""

    def metadata(self):
        """What a capture's header says of the sensor."""
        from sixflip.chips.header import metadata  # once a session: not kept in the heap
        return metadata(self)

    def _wait_clear(self, register, mask):
        """Wait until the bits of mask read 0 (end of a reset), else OSError."""
        self._wait_for(register, mask, 0)

    def _wait_for(self, register, mask, bits):
        """Wait until the bits of mask read as these, else OSError. A chip may leave its address
        unanswered while it resets, so errors count as "not yet"."""
        tries = 2000 if self._sleep_ms is None else 50
        read = -1
        for _ in range(tries):
            if self._sleep_ms is not None:
                self._sleep_ms(5)
            try:
                read = self._read(register)
            except OSError:
                continue
            if read & mask == bits:
                return
        if read < 0:
            raise OSError(errno.EIO, "%s at 0x%02x: no answer after its reset"
                          % (self.chip, self.address))
        raise OSError(errno.EIO, "%s at 0x%02x: reset not finished, register 0x%02x reads "
                      "0x%02x, expected 0x%02x in bits 0x%02x"
                      % (self.chip, self.address, register, read, bits, mask))


def words_into(sample, burst, at, columns, high):
    """Words of a burst from a byte on into columns of a sample, array('h'); None: two bytes of
    something else. high: which byte of a word is the high one. False when every bit is 0 or every
    bit is 1: no sensor reads like that, a sleeping one does."""
    ones = 0
    zeros = 0xFFFF
    for column in columns:
        if column is not None:
            word = burst[at + high] << 8 | burst[at + 1 - high]
            ones |= word
            zeros &= word
            sample[column] = (word ^ 0x8000) - 0x8000
        at += 2
    return ones != 0 and zeros != 0xFFFF


def row_of_range(ranges, full_scale, what):
    """The row of a full scale, (full scale, counts per unit, bits); ValueError naming the
    choices."""
    for row in ranges:
        if row[0] == full_scale:
            return row
    raise ValueError("%s is %s, expected one of %s"
                     % (what, full_scale, ", ".join([str(r[0]) for r in ranges])))


def in_range(rate_hz, most):
    """ValueError for a rate that is no chip's."""
    if not 1 <= rate_hz <= most:
        raise ValueError("rate_hz is %s, expected 1 to %d" % (rate_hz, most))


def filter_code(bandwidths_hz, rate_hz):
    """Index of the widest filter not wider than half the polling rate (the narrowest one
    if none is). bandwidths_hz falls with the index; index 0, the unfiltered one, is out."""
    for code in range(1, len(bandwidths_hz)):
        if 2 * bandwidths_hz[code] <= rate_hz:
            return code
    return len(bandwidths_hz) - 1


def rate_divider(rate_hz):
    """SMPLRT_DIV of InvenSense chips behind their 1 kHz filter: output rate is
    1000 / (1 + divider), four times the polling rate where there is so much, else twice: what a
    poll finds is then a quarter of an interval old at most, and a turn is not seen too early or
    too late by more than that when a poll is late or the two clocks drift apart."""
    in_range(rate_hz, 500)
    return max(0, min(int(250 // rate_hz) - 1, 255))
