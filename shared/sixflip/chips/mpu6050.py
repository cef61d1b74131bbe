"""InvenSense MPU6050 and its relatives: accelerometer, gyro and thermometer in one chip.

Source: MPU-6000/6050 register map RM-MPU-6000A-00 rev. 4.2; the relatives' temperature,
accelerometer filter and offsets: MPU-6500 register map RM-MPU-6500A-00 rev. 2.1; the MPU6050's
offsets: InvenSense application note "MPU Hardware Offset Registers" rev. 1.0.
"""

from sixflip.chips.registers import Registers, filter_code, rate_divider, row_of_range

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
INT_STATUS = const(0x3A)        # bit 0: data ready, cleared by reading
ACCEL_XOUT_H = const(0x3B)      # burst of 14: accel x y z, temperature, gyro x y z, big-endian
PWR_MGMT_1 = const(0x6B)        # bit 7 reset, bit 6 sleep, bits 2:0 clock
PWR_MGMT_2 = const(0x6C)
WHO_AM_I = const(0x75)
XA_OFFSET_H = const(0x77)       # relatives: as XA_OFFS_H, a byte between the axes
RESET = const(0x80)
SLEEP = const(0x40)
CLOCK_GYRO_X = const(0x01)
BURST = const(14)

# (full scale, counts per unit, AFS_SEL or FS_SEL), which is its index here, too.
ACCEL_RANGES = ((2, 16384, 0), (4, 8192, 1), (8, 4096, 2), (16, 2048, 3))
GYRO_RANGES = ((250, 131.0, 0), (500, 65.5, 1), (1000, 32.8, 2), (2000, 16.4, 3))
# Bandwidth in Hz of DLPF_CFG 0..6; accelerometer, the gyro's differ by at most 4 Hz.
BANDWIDTH_HZ = (260, 184, 94, 44, 21, 10, 5)
# °C = counts / first + second.
TEMPERATURE = (340.0, 36.53)
TEMPERATURE_RELATIVES = (333.87, 21.0)
RAIL = const(32767)


class MPU6050(Registers):
    """One chip at one address; who_am_i is what register 0x75 answered to the probe."""

    sensor = "mpu6050"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    TEMPERATURE = TEMPERATURE   # of an MPU6050 itself
    # MPU-6000/6050 product specification rev. 3.4, table 6.1: sensitivity at 25 °C, zero-rate
    # output at 25 °C, and over the whole range of 125 K
    gyro_tolerance = 0.03
    zero_rate_dps = 20.0
    zero_rate_dps_per_c = 0.16
    has_gyro = True
    has_temp = True
    accel_rail = RAIL
    gyro_rail = RAIL
    setup = ((SMPLRT_DIV, 4), (PWR_MGMT_1, 2))
    offsets = ((XA_OFFS_H, 6), (XG_OFFS_USR_H, 6))

    def __init__(self, i2c, address=0x68, who_am_i=0x68, sleep_ms=None,
                 accel_range_g=None, gyro_range_dps=None):
        Registers.__init__(self, i2c, address, sleep_ms)
        self.chip = self._chip_name(who_am_i)
        self.name = "%s (0x%02x)" % (self.chip, who_am_i)
        self.who_am_i = (who_am_i, who_am_i)
        self.accel_range_g, self.accel_lsb_per_g, self._accel_code = row_of_range(
            ACCEL_RANGES, accel_range_g or 2, "accel_range_g")
        self.gyro_range_dps, self.gyro_lsb_per_dps, self._gyro_code = row_of_range(
            GYRO_RANGES, gyro_range_dps or 500, "gyro_range_dps")
        self.temp_lsb_per_c, self.temp_offset_c = (
            TEMPERATURE if who_am_i == 0x68 else TEMPERATURE_RELATIVES)
        self.rate_hz = self.filter_hz = self.output_rate_hz = 0
        self._burst = bytearray(BURST)
        if who_am_i != 0x68:
            self.setup = ((SMPLRT_DIV, 5), (PWR_MGMT_1, 2))
            self.offsets = ((XA_OFFSET_H, 8), (XG_OFFS_USR_H, 6))

    def configure(self, rate_hz):
        """Reset, wake and set up for polling at rate_hz; OSError when a register does not
        take its value, ValueError for a rate the chip cannot keep twice of."""
        divider = rate_divider(rate_hz)
        dlpf = filter_code(BANDWIDTH_HZ, rate_hz)
        self._write(PWR_MGMT_1, RESET)
        self._wait_clear(PWR_MGMT_1, RESET)
        self._set(PWR_MGMT_1, CLOCK_GYRO_X)
        self._set(PWR_MGMT_2, 0)
        for register, value in ((SMPLRT_DIV, divider), (CONFIG, dlpf),
                                (GYRO_CONFIG, self._gyro_code << 3),
                                (ACCEL_CONFIG, self._accel_code << 3)):
            self._set(register, value)
        if self.who_am_i[0] != 0x68:
            self._set(ACCEL_CONFIG_2, dlpf)
        self._hold()
        if self._sleep_ms is not None:
            self._sleep_ms(50)      # gyro start-up 30 ms (datasheet 6.1), filter settling
        self.rate_hz = rate_hz
        self.filter_hz = BANDWIDTH_HZ[dlpf]
        self.output_rate_hz = 1000 / (1 + divider)

    def answers(self, i2c):
        """Whether the chip answers on this bus, to be used from now on, as to the probe."""
        return self._answers(i2c, WHO_AM_I, self.who_am_i[0])

    def read_into(self, sample):
        """One burst into sample, array('h', 7): ax ay az gx gy gz temp, counts. False when
        every bit is 0 or every bit is 1: no sensor reads like that, a sleeping one does."""
        burst = self._burst
        self._i2c.readfrom_mem_into(self.address, ACCEL_XOUT_H, burst)
        ones = 0
        zeros = 0xFFFF
        for i in range(7):
            word = burst[2 * i] << 8 | burst[2 * i + 1]
            ones |= word
            zeros &= word
            column = i if i < 3 else (6 if i == 3 else i - 1)
            sample[column] = (word ^ 0x8000) - 0x8000
        return ones != 0 and zeros != 0xFFFF
