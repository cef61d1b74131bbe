"""InvenSense MPU6050 and its relatives: accelerometer, gyro and thermometer in one chip.

Source: MPU-6000/6050 register map RM-MPU-6000A-00 rev. 4.2; the relatives' temperature,
accelerometer filter and offsets: MPU-6500 register map RM-MPU-6500A-00 rev. 2.1; the MPU6050's
offsets: InvenSense application note "MPU Hardware Offset Registers" rev. 1.0. The FIFO read
beside LibDriver's mpu6050.
"""

from sixflip.chips.registers import filter_code, rate_divider
from sixflip.chips.six_axis import BURST, SixAxis

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

XA_OFFS_H = const(0x06)         # accelerometer x y z, 16 bits each; the factory's trim is in them
XG_OFFS_USR_H = const(0x13)     # gyro x y z, 16 bits each, 4 / 131 deg/s a count in any range
SMPLRT_DIV = const(0x19)
CONFIG = const(0x1A)
GYRO_CONFIG = const(0x1B)
ACCEL_CONFIG = const(0x1C)
ACCEL_CONFIG_2 = const(0x1D)    # relatives only: filter of the accelerometer
FIFO_EN = const(0x23)           # bit 7 temperature, 6:4 gyro, 3 accelerometer
INT_ENABLE = const(0x38)        # bit 0: data ready is shown
INT_STATUS = const(0x3A)        # bit 0: data ready, 4: FIFO overflow, cleared by reading
ACCEL_XOUT_H = const(0x3B)      # burst of 14: accel x y z, temperature, gyro x y z, big-endian
USER_CTRL = const(0x6A)         # bit 6 FIFO on, 4 I2C off (SPI), 2 FIFO reset, clears itself
PWR_MGMT_1 = const(0x6B)        # bit 7 reset, bit 6 sleep, bits 2:0 clock
PWR_MGMT_2 = const(0x6C)
FIFO_COUNT_H = const(0x72)      # bytes in it, the low byte in the next
FIFO_R_W = const(0x74)
WHO_AM_I = const(0x75)
XA_OFFSET_H = const(0x77)       # relatives: as XA_OFFS_H, a byte between the axes
RESET = const(0x80)
SLEEP = const(0x40)
CLOCK_GYRO_X = const(0x01)
ALL_IN_FIFO = const(0xF8)
FIFO_ON = const(0x40)
FIFO_RESET = const(0x04)
I2C_IF_DIS = const(0x10)
OVERFLOW = const(0x10)

# (full scale, counts per unit, AFS_SEL or FS_SEL), which is its index here, too.
ACCEL_RANGES = ((2, 16384, 0), (4, 8192, 1), (8, 4096, 2), (16, 2048, 3))
GYRO_RANGES = ((250, 131.0, 0), (500, 65.5, 1), (1000, 32.8, 2), (2000, 16.4, 3))
# Bandwidth in Hz of DLPF_CFG 0..6; accelerometer, the gyro's differ by at most 4 Hz.
BANDWIDTH_HZ = (260, 184, 94, 44, 21, 10, 5)
BASE_HZ = const(1000)           # of the samples behind the filter
# °C = counts / first + second.
TEMPERATURE = (340.0, 36.53)
TEMPERATURE_RELATIVES = (333.87, 21.0)


class MPU6050(SixAxis):
    """One chip at one address; who_am_i is what register 0x75 answered to the probe."""

    sensor = "mpu6050"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = ACCEL_XOUT_H
    ID_REGISTER = WHO_AM_I
    COLUMNS = (0, 1, 2, 6, 3, 4, 5)
    TEMPERATURE = TEMPERATURE   # of an MPU6050 itself
    FIFO = "Fifo"
    FIFO_DATA = FIFO_R_W
    FIFO_SETUP = ((FIFO_EN, 1), (USER_CTRL, 1))
    READY = (INT_STATUS, 0x01)
    READY_ON = (INT_ENABLE, 0x01)
    # MPU-6000/6050 product specification rev. 3.4, table 6.1: sensitivity at 25 °C, zero-rate
    # output at 25 °C, and over the whole range of 125 K
    gyro_tolerance = 0.03
    zero_rate_dps = 20.0
    zero_rate_dps_per_c = 0.16
    setup = ((SMPLRT_DIV, 4), (PWR_MGMT_1, 2))
    offsets = ((XA_OFFS_H, 6), (XG_OFFS_USR_H, 6))

    def __init__(self, i2c, address=0x68, who_am_i=0x68, sleep_ms=None, accel_range_g=None,
                 gyro_range_dps=None):
        SixAxis.__init__(self, i2c, address, who_am_i, sleep_ms, accel_range_g, gyro_range_dps)
        if who_am_i != 0x68:
            self.temp_lsb_per_c, self.temp_offset_c = TEMPERATURE_RELATIVES
            self.setup = ((SMPLRT_DIV, 5), (PWR_MGMT_1, 2))
            self.offsets = ((XA_OFFSET_H, 8), (XG_OFFS_USR_H, 6))

    def configure(self, rate_hz):
        """Reset, wake and set up for polling at rate_hz; OSError when a register does not
        take its value, ValueError for a rate the chip cannot keep twice of."""
        divider = rate_divider(rate_hz) if self.fifo is None else int(BASE_HZ / rate_hz + 0.5) - 1
        hz = BASE_HZ / (1 + divider)
        dlpf = filter_code(BANDWIDTH_HZ, self._filter_hz(hz, rate_hz))
        self._write(PWR_MGMT_1, RESET)
        self._wait_clear(PWR_MGMT_1, RESET)
        self._no_i2c(USER_CTRL, I2C_IF_DIS)
        self._set(PWR_MGMT_1, CLOCK_GYRO_X)
        self._set(PWR_MGMT_2, 0)
        for register, value in ((SMPLRT_DIV, divider), (CONFIG, dlpf),
                                (GYRO_CONFIG, self._gyro_bits << 3),
                                (ACCEL_CONFIG, self._accel_bits << 3)):
            self._set(register, value)
        if self.who_am_i[0] != 0x68:
            self._set(ACCEL_CONFIG_2, dlpf)
        self._started(rate_hz, hz, BANDWIDTH_HZ[dlpf])
        if self._sleep_ms is not None:
            self._sleep_ms(50)      # gyro start-up 30 ms (datasheet 6.1), filter settling

    def fifo_start(self):
        """1024 bytes of the MPU6050, 512 of its relatives; full, they lose the oldest bytes."""
        on = self._interface
        self._write(USER_CTRL, on | FIFO_RESET)
        self._set(FIFO_EN, ALL_IN_FIFO)
        self._set(USER_CTRL, on | FIFO_ON)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost."""
        self._fetch(FIFO_COUNT_H, self._two)
        if self._read(INT_STATUS) & OVERFLOW:
            return -1
        return (self._two[0] << 8 | self._two[1]) // BURST
