"""TDK InvenSense ICM-42688-P: accelerometer, gyro and thermometer.

Source: datasheet DS-000347 rev. 1.5: sections 14 (bank 0) and 17 (bank 4), 5 (bandwidth of the UI
filter), 6 (FIFO), tables 1 and 2; register numbers read beside finani's ICM42688 library.
"""

from sixflip.chips.banked import Banked
from sixflip.chips.six_axis import narrow_enough

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

DEVICE_CONFIG = const(0x11)     # bit 0: reset, over within 1 ms
FIFO_CONFIG = const(0x16)       # bits 7:6: 0 off, 1 on, the oldest is overwritten
TEMP_DATA1 = const(0x1D)        # burst of 14: temperature, accel x y z, gyro x y z
INT_STATUS = const(0x2D)        # bit 3: data ready, 1: FIFO full, cleared by reading
FIFO_COUNTH = const(0x2E)       # bytes in it, big-endian, as FIFO_OUT behind it
FIFO_OUT = const(0x30)
SIGNAL_PATH_RESET = const(0x4B)  # bit 1: the FIFO is emptied
INTF_CONFIG0 = const(0x4C)      # bits 5 and 4: FIFO count and samples big-endian; 1:0: 11, no I2C
PWR_MGMT0 = const(0x4E)         # bits 3:2 gyro, 1:0 accelerometer: 11 is low noise
GYRO_CONFIG0 = const(0x4F)      # bits 7:5 range, 3:0 output rate
ACCEL_CONFIG0 = const(0x50)
GYRO_CONFIG1 = const(0x51)      # bits 3:2: order of the filter, 01 is the second, the default
GYRO_ACCEL_CONFIG0 = const(0x52)  # bits 7:4 filter of the accelerometer, 3:0 of the gyro
FIFO_CONFIG1 = const(0x5F)      # bits 2 temperature, 1 gyro, 0 accelerometer
WHO_AM_I = const(0x75)
REG_BANK_SEL = const(0x76)      # in every bank
OFFSET_USER0 = const(0x477)     # nine bytes: gyro in 1/32 °/s, accelerometer in 0.5 mg
RESET = const(0x01)
BIG_ENDIAN = const(0x30)
NO_I2C = const(0x03)
FULL = const(0x02)
FLUSH = const(0x02)
STREAM = const(0x40)
ALL_IN_FIFO = const(0x07)
FIFO_BYTES = const(2048)
LOW_NOISE = const(0x0F)
ORDER_2 = const(0x16)

ACCEL_RANGES = ((2, 16384, 3), (4, 8192, 2), (8, 4096, 1), (16, 2048, 0))
GYRO_RANGES = ((125, 262.0, 4), (250, 131.0, 3), (500, 65.5, 2), (1000, 32.8, 1), (2000, 16.4, 0))
TEMPERATURE = (132.48, 25.0)
OUTPUT_RATES = ((50, 9), (100, 8), (200, 7), (500, 15), (1000, 6))
# (UI_FILT_BW, 3 dB bandwidth in Hz at 50, 100, 200, 500 and 1000 Hz), second order
FILTERS = ((0, (24.7, 49.3, 98.7, 246.7, 493.3)), (1, (92.3, 92.3, 92.3, 115.3, 230.7)),
           (3, (47.0, 47.0, 47.0, 58.8, 117.5)), (4, (38.8, 38.8, 38.8, 48.5, 97.1)),
           (6, (19.2, 19.2, 19.2, 24.0, 48.0)), (7, (8.5, 8.5, 8.5, 10.6, 21.3)))


class ICM42688(Banked):
    """Its set-up is in bank 0, the offsets that a user may write in bank 4."""

    sensor = "icm42688"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = TEMP_DATA1
    ID_REGISTER = WHO_AM_I
    COLUMNS = (6, 0, 1, 2, 3, 4, 5)
    TEMPERATURE = TEMPERATURE
    BANK = REG_BANK_SEL
    FIFO = "PacketFifo"
    FIFO_DATA = FIFO_OUT
    FIFO_SETUP = ((FIFO_CONFIG, 1), (FIFO_CONFIG1, 1))
    READY = (INT_STATUS, 0x08)
    # tables 1: tolerances by characterisation, typical figures; thrice each
    gyro_tolerance = 0.015
    zero_rate_dps = 1.5
    zero_rate_dps_per_c = 0.015
    setup = ((INTF_CONFIG0, 1), (PWR_MGMT0, 5))
    offsets = ((OFFSET_USER0, 9),)

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        column = [row[0] for row in OUTPUT_RATES].index(hz)
        bits, filter_hz = narrow_enough([(bits, row[column]) for bits, row in FILTERS],
                                        self._filter_hz(hz, rate_hz))
        self._bank = -1
        self._write(DEVICE_CONFIG, RESET)
        self._wait_clear(DEVICE_CONFIG, RESET)
        self._no_i2c(INTF_CONFIG0, BIG_ENDIAN | NO_I2C)
        for register, value in (
                (INTF_CONFIG0, self._interface or BIG_ENDIAN),
                (GYRO_CONFIG0, self._gyro_bits << 5 | code),
                (ACCEL_CONFIG0, self._accel_bits << 5 | code), (GYRO_CONFIG1, ORDER_2),
                (GYRO_ACCEL_CONFIG0, bits << 4 | bits),
                (PWR_MGMT0, LOW_NOISE)):     # the last: no other write for 200 µs behind it
            self._set(register, value)
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # gyro start-up 30 ms (table 1), filters settling
        self._started(rate_hz, hz, filter_hz)

    def fifo_start(self):
        """Packets of both sensors, emptied; full, the oldest ones are lost."""
        self._set(FIFO_CONFIG, 0)
        self._write(SIGNAL_PATH_RESET, FLUSH)
        self._set(FIFO_CONFIG1, ALL_IN_FIFO)
        self._set(FIFO_CONFIG, STREAM)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost."""
        self._fetch(FIFO_COUNTH, self._two)
        level = self._two[0] << 8 | self._two[1]
        return -1 if self._read(INT_STATUS) & FULL or level >= FIFO_BYTES else level // 16
