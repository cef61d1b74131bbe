"""Accelerometer, gyro and thermometer behind one burst of 14 bytes: what such chips share."""

from sixflip.chips.registers import Registers, row_of_range

RAIL = 32767
BURST = 14


class SixAxis(Registers):
    """Base of the drivers; subclasses name the registers and configure().

    ACCEL_RANGES, GYRO_RANGES   (full scale, counts per unit, its bits in the register), ...
    RANGES          the usual full scales, g and °/s
    DATA, COLUMNS   first register of the burst; the columns of a sample in its order
    HIGH            which byte of a word is the high one, 0 or 1
    TEMPERATURE     °C = counts / first + second
    who_am_i        what the chip's identification register answered to the probe
    """

    ACCEL_RANGES = GYRO_RANGES = COLUMNS = ()
    RANGES = (2, 500)
    DATA = ID_REGISTER = 0
    HIGH = 0
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
        self._burst = bytearray(BURST)

    def answers(self, i2c):
        """Whether the chip answers on this bus, to be used from now on, as to the probe."""
        return self._answers(i2c, self.ID_REGISTER, self.who_am_i[0])

    def read_into(self, sample):
        """One burst into sample, array('h', 7): ax ay az gx gy gz temp, counts. False when
        every bit is 0 or every bit is 1: no sensor reads like that, a sleeping one does."""
        burst = self._burst
        self._i2c.readfrom_mem_into(self.address, self.DATA, burst)
        high = self.HIGH
        ones = 0
        zeros = 0xFFFF
        i = 0
        for column in self.COLUMNS:
            word = burst[i + high] << 8 | burst[i + 1 - high]
            ones |= word
            zeros &= word
            sample[column] = (word ^ 0x8000) - 0x8000
            i += 2
        return ones != 0 and zeros != 0xFFFF


def output_rate(rates, rate_hz):
    """(Hz, code) of the slowest output rate that is four times the polling rate, as
    rate_divider() says why; the fastest where none is. rates: (Hz, code), rising."""
    if not 1 <= rate_hz <= 500:
        raise ValueError("rate_hz is %s, expected 1 to 500" % rate_hz)
    for row in rates:
        if row[0] >= 4 * rate_hz:
            return row
    return rates[-1]


def narrow_enough(filters, rate_hz):
    """(code, Hz) of the widest filter not wider than half the polling rate, the narrowest if
    none is. filters: (code, Hz) in any order."""
    found = None
    for row in filters:
        if found is None or found[1] > rate_hz / 2:
            better = found is None or row[1] < found[1]
        else:
            better = found[1] < row[1] <= rate_hz / 2
        if better:
            found = row
    return found
