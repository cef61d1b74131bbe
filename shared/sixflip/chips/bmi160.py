"""Bosch Sensortec BMI160: accelerometer, gyro and thermometer.

Source: datasheet BST-BMI160-DS000-07 rev. 0.8 (sections 2.4, filters; 2.5, FIFO; 2.11, registers),
each register read beside Bosch's BMI160_SensorAPI. The temperature stands eight bytes behind the
samples: a burst reads over what is in between. On SPI a byte precedes its registers: I2C only.
"""

from sixflip.chips.six_axis import SixAxis, narrow_enough

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

CHIP_ID = const(0x00)
PMU_STATUS = const(0x03)        # bits 5:4 accelerometer, 3:2 gyro: 01 is normal, 00 suspended
GYR_X_L = const(0x0C)           # burst of 22: gyro x y z, accel x y z, ten bytes, temperature
STATUS = const(0x1B)            # bits 7 and 6: a new sample, cleared by reading it
TEMPERATURE_0 = const(0x20)
FIFO_LENGTH = const(0x22)       # bytes in it, bits 10:8 in the next; whole frames
FIFO_OUT = const(0x24)
ACC_CONF = const(0x40)          # bits 6:4 acc_bwp, 3:0 output rate; the next bits 3:0 range
GYR_CONF = const(0x42)          # bits 5:4 gyr_bwp, 3:0 output rate; the next bits 2:0 range
FIFO_CONFIG_1 = const(0x47)     # bits 7 gyro, 6 accelerometer, 4 headers
OFFSET = const(0x71)            # accelerometer x y z, gyro x y z, their high bits and whether on
CMD = const(0x7E)
ACCEL_ON = const(0x11)
GYRO_ON = const(0x15)
FIFO_FLUSH = const(0xB0)
SOFT_RESET = const(0xB6)
BOTH_NORMAL = const(0x14)
BOTH_IN_FIFO = const(0xC0)
FULL_BYTES = const(1008)        # 84 frames: the 1024 bytes of it are as good as full

ACCEL_RANGES = ((2, 16384, 3), (4, 8192, 5), (8, 4096, 8), (16, 2048, 12))
GYRO_RANGES = ((125, 262.4, 4), (250, 131.2, 3), (500, 65.6, 2), (1000, 32.8, 1), (2000, 16.4, 0))
TEMPERATURE = (512.0, 23.0)
OUTPUT_RATES = ((50, 7), (100, 8), (200, 9), (400, 10), (800, 11), (1600, 12))
# (acc_bwp and gyr_bwp, part of the output rate): normal, two and four times oversampled. Of the
# accelerometer as section 2.4.1 has it (5.06 Hz of 50); the gyro's, of 200 Hz 74.6, is as near.
FILTERS = ((2, 0.405), (1, 0.2025), (0, 0.10125))


class BMI160(SixAxis):
    """Its samples and its temperature in one burst; a command switches each sensor on."""

    sensor = "bmi160"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = GYR_X_L
    ID_REGISTER = CHIP_ID
    COLUMNS = (3, 4, 5, 0, 1, 2, None, None, None, None, 6)
    HIGH = 1
    TEMPERATURE = TEMPERATURE
    FIFO = "PairFifo"
    FIFO_DATA = FIFO_OUT
    FIFO_SETUP = ((FIFO_CONFIG_1, 1),)
    READY = (STATUS, 0xC0)
    # of the sensitivity no figure could be had: as the MPU6050's; the others are thrice typical
    gyro_tolerance = 0.03
    zero_rate_dps = 9.0
    zero_rate_dps_per_c = 0.24
    setup = ((PMU_STATUS, 1), (ACC_CONF, 4))
    offsets = ((OFFSET, 7),)

    def configure(self, rate_hz):
        """Reset, wake and set up for polling at rate_hz; OSError when a register does not take
        its value, ValueError for a rate that is no chip's."""
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        bwp, filter_hz = narrow_enough([(bits, part * hz) for bits, part in FILTERS],
                                       self._filter_hz(hz, rate_hz))
        self._write(CMD, SOFT_RESET)
        self._wait_for(PMU_STATUS, 0x3C, 0)
        self._write(CMD, ACCEL_ON)      # 4 ms, and the gyro 80 (table 2)
        self._wait_for(PMU_STATUS, 0x30, 0x10)
        self._write(CMD, GYRO_ON)
        self._wait_for(PMU_STATUS, 0x3C, BOTH_NORMAL)
        for register, value in ((ACC_CONF, bwp << 4 | code), (ACC_CONF + 1, self._accel_bits),
                                (GYR_CONF, bwp << 4 | code), (GYR_CONF + 1, self._gyro_bits)):
            self._set(register, value)
        self._started(rate_hz, hz, filter_hz)
        if self._sleep_ms is not None:
            self._sleep_ms(100)         # filters settling

    def fifo_start(self):
        """Accelerometer and gyro without headers, emptied."""
        self._set(FIFO_CONFIG_1, BOTH_IN_FIFO)
        self._write(CMD, FIFO_FLUSH)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost."""
        self._read_temperature(TEMPERATURE_0)
        self._fetch(FIFO_LENGTH, self._two)
        level = self._two[0] | (self._two[1] & 0x07) << 8
        return -1 if level >= FULL_BYTES else level // 12
