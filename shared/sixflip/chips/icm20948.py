"""TDK InvenSense ICM-20948: accelerometer, gyro and thermometer (its magnetometer is not used).

Source: datasheet DS-000189 rev. 1.3, sections 7 to 10 (banks 0 to 2), tables 1, 2, 16 and 18;
register numbers and bandwidths read beside SparkFun's ICM-20948 library, the FIFO's beside
ICM20948_WE.
"""

from sixflip.chips.banked import Banked
from sixflip.chips.six_axis import BURST, in_range, narrow_enough

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

WHO_AM_I = const(0x00)
USER_CTRL = const(0x03)         # bit 6 FIFO on, 4 I2C off (SPI)
PWR_MGMT_1 = const(0x06)        # bit 7 reset, bit 6 sleep, bits 2:0 clock
PWR_MGMT_2 = const(0x07)
INT_ENABLE_1 = const(0x11)      # bit 0: a new sample is shown
INT_STATUS_1 = const(0x1A)      # bit 0: a new sample, cleared by reading
INT_STATUS_2 = const(0x1B)      # bits 4:0: FIFO overflow, cleared by reading
ACCEL_XOUT_H = const(0x2D)      # burst of 14: accel x y z, gyro x y z, temperature, big-endian
FIFO_EN_2 = const(0x67)         # bit 4 accelerometer, 3:1 gyro, 0 temperature
FIFO_RST = const(0x68)          # bits 4:0: set and cleared, it is empty
FIFO_COUNTH = const(0x70)       # bits 12:8 of the bytes in it, 7:0 in the next
FIFO_R_W = const(0x72)
REG_BANK_SEL = const(0x7F)      # bits 5:4, in every bank
XA_OFFS_H = const(0x114)        # accelerometer x y z, a byte between; the factory trimmed them
GYRO_SMPLRT_DIV = const(0x200)
GYRO_CONFIG_1 = const(0x201)    # bits 5:3 filter, 2:1 range, 0: the filter is on
XG_OFFS_USRH = const(0x203)     # gyro x y z, 16 bits each
ACCEL_SMPLRT_DIV_1 = const(0x210)  # bits 11:8 of the divider, 7:0 in the next
ACCEL_CONFIG = const(0x214)
RESET = const(0x80)
SLEEP = const(0x40)
CLOCK_AUTO = const(0x01)
FILTER_ON = const(0x01)
I2C_IF_DIS = const(0x10)
FIFO_ON = const(0x40)
ALL_IN_FIFO = const(0x1F)

ACCEL_RANGES = ((2, 16384, 0), (4, 8192, 1), (8, 4096, 2), (16, 2048, 3))
GYRO_RANGES = ((250, 131.0, 0), (500, 65.5, 1), (1000, 32.8, 2), (2000, 16.4, 3))
TEMPERATURE = (333.87, 21.0)
BASE_HZ = const(1125)
# (DLPFCFG, 3 dB bandwidth in Hz)
ACCEL_FILTERS = ((1, 246.0), (2, 111.4), (3, 50.4), (4, 23.9), (5, 11.5), (6, 5.7))
GYRO_FILTERS = ((0, 196.6), (1, 151.8), (2, 119.5), (3, 51.2), (4, 23.9), (5, 11.6), (6, 5.7))
# A filter a little wider than half the polling rate is taken for the narrower: 50.4 Hz at 100.
WIDER = 1.025


class ICM20948(Banked):
    """Its rates are divided from 1125 Hz."""

    sensor = "icm20948"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = ACCEL_XOUT_H
    ID_REGISTER = WHO_AM_I
    COLUMNS = (0, 1, 2, 3, 4, 5, 6)
    TEMPERATURE = TEMPERATURE
    BANK = REG_BANK_SEL
    SHIFT = 4
    FIFO = "Fifo"
    FIFO_DATA = FIFO_R_W
    FIFO_SETUP = ((USER_CTRL, 1), (FIFO_EN_2, 1))
    READY = (INT_STATUS_1, 0x01)
    READY_ON = (INT_ENABLE_1, 0x01)
    gyro_tolerance = 0.045          # table 1: 1.5 % at 25 °C, and 3 % with temperature
    zero_rate_dps = 5.0
    zero_rate_dps_per_c = 0.05
    setup = ((PWR_MGMT_1, 2), (GYRO_SMPLRT_DIV, 2), (ACCEL_SMPLRT_DIV_1, 5))
    offsets = ((XA_OFFS_H, 8), (XG_OFFS_USRH, 6))

    def configure(self, rate_hz):
        """Reset, wake and set up for polling at rate_hz; OSError when a register does not take
        its value, ValueError for a rate that is no chip's."""
        in_range(rate_hz, self.MOST_HZ)
        every = BASE_HZ // (4 * rate_hz) if self.fifo is None else BASE_HZ / rate_hz + 0.5
        divider = max(0, min(int(every) - 1, 255))
        hz = BASE_HZ / (1 + divider)
        suits = WIDER * self._filter_hz(hz, rate_hz)
        accel, accel_hz = narrow_enough(ACCEL_FILTERS, suits)
        gyro, _ = narrow_enough(GYRO_FILTERS, suits)
        self._bank = -1
        self._write(PWR_MGMT_1, RESET)
        self._wait_clear(PWR_MGMT_1, RESET)
        self._bank = -1             # the reset selects bank 0
        self._no_i2c(USER_CTRL, I2C_IF_DIS)
        for register, value in (
                (PWR_MGMT_1, CLOCK_AUTO), (PWR_MGMT_2, 0), (GYRO_SMPLRT_DIV, divider),
                (GYRO_CONFIG_1, gyro << 3 | self._gyro_bits << 1 | FILTER_ON),
                (ACCEL_SMPLRT_DIV_1, 0), (ACCEL_SMPLRT_DIV_1 + 1, divider),
                (ACCEL_CONFIG, accel << 3 | self._accel_bits << 1 | FILTER_ON)):
            self._set(register, value)
        self._started(rate_hz, hz, accel_hz)
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # gyro start-up 35 ms (table 1), filters settling

    def fifo_start(self):
        """512 bytes; full, they lose the oldest ones."""
        on = self._interface
        self._set(USER_CTRL, on)
        self._set(FIFO_RST, ALL_IN_FIFO)
        self._set(FIFO_RST, 0)
        self._set(FIFO_EN_2, ALL_IN_FIFO)
        self._set(USER_CTRL, on | FIFO_ON)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost."""
        self._fetch(FIFO_COUNTH, self._two)
        if self._read(INT_STATUS_2) & ALL_IN_FIFO:
            return -1
        return ((self._two[0] & 0x1F) << 8 | self._two[1]) // BURST
