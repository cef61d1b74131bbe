"""Accelerometer, gyro and thermometer behind one burst: what such chips share."""

from sixflip import RAIL
from sixflip.chips.registers import Registers, in_range, row_of_range, words_into

BURST = 14


class SixAxis(Registers):
    """Base of the drivers; subclasses name the registers and configure().

    ACCEL_RANGES, GYRO_RANGES   (full scale, counts per unit, its bits in the register), ...
    RANGES          the usual full scales, g and °/s
    DATA, COLUMNS   first register of the burst; the columns of a sample in its order, None for
                    two bytes of something else
    HIGH            which byte of a word is the high one, 0 or 1
    TEMPERATURE     °C = counts / first + second
    FIFO            the class of fifo.py that reads the chip's memory, "": it has none that is used
    who_am_i        what the chip's identification register answered to the probe
    """

    ACCEL_RANGES = GYRO_RANGES = COLUMNS = ()
    RANGES = (2, 500)
    DATA = ID_REGISTER = 0
    HIGH = 0
    FIFO = ""
    FIFO_SETUP = ()
    fifo_temperature = 0
    TEMPERATURE = (1, 0)
    has_gyro = True
    has_temp = True
    accel_rail = gyro_rail = RAIL

    def __init__(self, i2c, address, who_am_i, sleep_ms=None, accel_range_g=None,
                 gyro_range_dps=None):
        Registers.__init__(self, i2c, address, sleep_ms)
        self.chip = self._chip_name(who_am_i)
        self.name = "%s (0x%02x)" % (self.chip, who_am_i)
        self.who_am_i = (who_am_i, who_am_i)
        self.accel_range_g, self.accel_lsb_per_g, self._accel_bits = row_of_range(
            self.ACCEL_RANGES, accel_range_g or self.RANGES[0], "accel_range_g")
        self.gyro_range_dps, self.gyro_lsb_per_dps, self._gyro_bits = row_of_range(
            self.GYRO_RANGES, gyro_range_dps or self.RANGES[1], "gyro_range_dps")
        self.temp_lsb_per_c, self.temp_offset_c = self.TEMPERATURE
        self.rate_hz = self.filter_hz = self.output_rate_hz = 0
        self._burst = bytearray(2 * len(self.COLUMNS))

    def use_fifo(self):
        """From the next configure() on every sample comes through the chip's memory."""
        from sixflip.chips import fifo
        self.fifo = getattr(fifo, self.FIFO)(self)
        self.setup = self.setup + self.FIFO_SETUP
        self.read_into = self.fifo.read_into

    def _output_rate(self, rates, rate_hz):
        """(Hz, code) of the output rate for so many samples a second: see output_rate(); through
        a FIFO every sample counts, and it is the nearest. rates: (Hz, code), rising."""
        if self.fifo is None:
            return output_rate(rates, rate_hz)
        in_range(rate_hz, self.MOST_HZ)
        return min(rates, key=lambda row: abs(row[0] - rate_hz))

    def _filter_hz(self, hz, rate_hz):
        """Samples a second that the filters have to suit."""
        return rate_hz if self.fifo is None else hz

    def _started(self, rate_hz, hz, filter_hz):
        """Ends configure(): the rates as they are, and a FIFO that begins to fill."""
        self.output_rate_hz = hz
        self.filter_hz = filter_hz
        self.rate_hz = rate_hz if self.fifo is None else int(hz + 0.5)
        if self.fifo is not None:
            self.fifo.start()
        self._hold()

    def _read_temperature(self, register):
        """For the samples of a FIFO that has none; low byte first."""
        self._fetch(register, self._two)
        self.fifo_temperature = ((self._two[0] | self._two[1] << 8) ^ 0x8000) - 0x8000

    def answers(self, i2c):
        """Whether the chip answers on this bus, to be used from now on, as to the probe."""
        return self._answers(i2c, self.ID_REGISTER, self.who_am_i[0])

    def read_into(self, sample):
        """One burst into sample, array('h', 7): ax ay az gx gy gz temp, counts; see words_into."""
        burst = self._burst
        self._i2c.readfrom_mem_into(self.address, self.DATA, burst)
        return words_into(sample, burst, 0, self.COLUMNS, self.HIGH)


def output_rate(rates, rate_hz):
    """(Hz, code) of the slowest output rate that is four times the polling rate, as
    rate_divider() says why; the fastest where none is. rates: (Hz, code), rising."""
    in_range(rate_hz, 500)
    for row in rates:
        if row[0] >= 4 * rate_hz:
            return row
    return rates[-1]


def narrow_enough(filters, rate_hz):
    """(code, Hz) of the widest filter not wider than half the polling rate, the narrowest if
    none is. filters: (code, Hz) in any order."""
    best = None
    for row in filters:
        if best is None or best[1] > rate_hz / 2:
            better = best is None or row[1] < best[1]
        else:
            better = best[1] < row[1] <= rate_hz / 2
        if better:
            best = row
    return best
