"""QST QMI8658A and QMI8658C: accelerometer, gyro and thermometer.

Source: QMI8658A datasheet 13-52-25 rev. A (tables 7, 8, 11, 13; 22, 24, 25, 27: registers), each
register, those of its FIFO too, read beside lewisxhe's SensorLib. After a reset its samples are
big-endian and a burst does not count up: CTRL1 says otherwise here.
"""

from sixflip.chips.six_axis import SixAxis, in_range

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

WHO_AM_I = const(0x00)
CTRL1 = const(0x02)             # bit 6: the register counts up, bit 5: big-endian
CTRL2 = const(0x03)             # accelerometer: bits 6:4 range, 3:0 output rate
CTRL3 = const(0x04)             # gyro, likewise
CTRL5 = const(0x06)             # bits 6:5 and 4 filter of the gyro, 2:1 and 0 accelerometer
CTRL7 = const(0x08)             # bit 1 gyro on, bit 0 accelerometer on
STATUS0 = const(0x2E)           # bits 1:0: a new sample, cleared by reading
TEMP_L = const(0x33)            # burst of 14: temperature, accel x y z, gyro x y z
RESULT = const(0x4D)            # reads 0x80 when a reset is over
RESET_REGISTER = const(0x60)
RESET = const(0xB0)
DONE = const(0x80)
COUNT_UP = const(0x40)
BIG_ENDIAN = const(0x20)
BOTH_ON = const(0x03)
FILTERS_ON = const(0x77)        # mode 11 of both: 13.37 % of the output rate
FILTER_PART = 0.1337

ACCEL_RANGES = ((2, 16384, 0), (4, 8192, 1), (8, 4096, 2), (16, 2048, 3))
GYRO_RANGES = ((128, 256.0, 3), (256, 128.0, 4), (512, 64.0, 5), (1024, 32.0, 6), (2048, 16.0, 7))
TEMPERATURE = (256.0, 0.0)
# Of the gyro's drive, with both on; above 1 kHz the gyro is much noisier (table 12).
OUTPUT_RATES = ((56.05, 7), (112.1, 6), (224.2, 5), (448.4, 4), (896.8, 3))


class QMI8658(SixAxis):
    """Polled at every rate. Its FIFO takes nothing in from CTRL_CMD_REQ_FIFO until FIFO_RD_MODE is
    cleared (8.4): on a bus of 400 kHz the command and eight samples take 2.8 of the 4.5 ms from
    one sample to the next at 224 Hz, so that more would be missed than by polling."""

    sensor = "qmi8658"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    RANGES = (2, 512)
    DATA = TEMP_L
    ID_REGISTER = WHO_AM_I
    COLUMNS = (6, 0, 1, 2, 3, 4, 5)
    HIGH = 1
    TEMPERATURE = TEMPERATURE
    READY = (STATUS0, 0x03)
    MOST_HZ = 400                   # half of the fastest output rate
    gyro_tolerance = 0.09           # table 8: 3 %, 10 °/s, 0.1 °/s per °C, typical; thrice each
    zero_rate_dps = 30.0
    zero_rate_dps_per_c = 0.3
    setup = ((CTRL1, 3), (CTRL5, 1), (CTRL7, 1))    # offsets are shifted by commands, not kept

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        in_range(rate_hz, self.MOST_HZ)
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        self._write(RESET_REGISTER, RESET)
        self._wait_for(RESULT, 0xFF, DONE)  # 15 ms (table 7), in which nothing may be written
        for register, value in ((CTRL1, COUNT_UP), (CTRL2, self._accel_bits << 4 | code),
                                (CTRL3, self._gyro_bits << 4 | code), (CTRL5, FILTERS_ON),
                                (CTRL7, BOTH_ON)):
            self._set(register, value)
        self._started(rate_hz, hz, FILTER_PART * hz)
        if self._sleep_ms is not None:
            self._sleep_ms(200)     # gyro turn-on 150 ms and three samples (table 8)
