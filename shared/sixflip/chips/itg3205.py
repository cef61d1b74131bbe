"""InvenSense ITG-3205, a gyro with a thermometer. Source: datasheet PS-ITG-3205A-00 rev. 1.0."""

from sixflip.chips.registers import Registers, filter_code, rate_divider, words_into

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

WHO_AM_I = const(0x00)          # bits 6:1 = 110100, the others may read anything
SMPLRT_DIV = const(0x15)
DLPF_FS = const(0x16)           # bits 4:3 FS_SEL, bits 2:0 filter
INT_CFG = const(0x17)           # bit 0: data ready is shown
INT_STATUS = const(0x1A)        # bit 0: data ready, cleared by reading
TEMP_OUT_H = const(0x1B)        # burst of 8: temperature, gyro x y z, big-endian
PWR_MGM = const(0x3E)           # bit 7 reset, bit 6 sleep, bits 2:0 clock
RESET = const(0x80)
SLEEP = const(0x40)
CLOCK_GYRO_X = const(0x01)
ID_MASK = const(0x7E)
ID = const(0x68)
FS_2000 = const(0x18)           # FS_SEL = 3; it is 0, "reserved", after power-up
BURST = const(8)
COLUMNS = (6, 3, 4, 5)

LSB_PER_DPS = 14.375
RANGE_DPS = const(2000)
BANDWIDTH_HZ = (256, 188, 98, 42, 20, 10, 5)
# °C = counts / 280 + 82.142857: -13200 counts at 35 °C (section 3.3).
TEMPERATURE = (280.0, 82.142857)


class ITG3205(Registers):
    """The gyro half of a GY-85; it is no imu by itself."""

    chip = "ITG3205"
    READY = (INT_STATUS, 0x01)
    READY_ON = (INT_CFG, 0x01)
    TEMPERATURE = TEMPERATURE
    ACCEL_RANGES = ()
    GYRO_RANGES = ((RANGE_DPS, LSB_PER_DPS, 3),)
    # table 3.1: sensitivity at 25 °C, zero-rate output over the whole range of 125 K
    gyro_tolerance = 0.06
    zero_rate_dps = 40.0
    zero_rate_dps_per_c = 0.32
    setup = ((SMPLRT_DIV, 2), (PWR_MGM, 1))     # it has no offset registers

    def __init__(self, i2c, address=0x68, sleep_ms=None):
        Registers.__init__(self, i2c, address, sleep_ms)
        self._burst = bytearray(BURST)
        self.output_rate_hz = 0

    def configure(self, rate_hz):
        """Reset, wake and set up for polling at rate_hz; OSError when a register does not
        take its value."""
        divider = rate_divider(rate_hz)
        dlpf_fs = FS_2000 | filter_code(BANDWIDTH_HZ, rate_hz)
        self._write(PWR_MGM, RESET)
        self._wait_clear(PWR_MGM, RESET)
        self._set(PWR_MGM, CLOCK_GYRO_X)
        self._set(SMPLRT_DIV, divider)
        self._set(DLPF_FS, dlpf_fs)
        self._hold()
        self.output_rate_hz = 1000 / (1 + divider)
        if self._sleep_ms is not None:
            self._sleep_ms(70)      # start-up 50 ms (section 3.1), filter settling

    def answers(self, i2c, who_am_i):
        """Whether the chip answers on this bus, to be used from now on, as to the probe."""
        return self._answers(i2c, WHO_AM_I, who_am_i)

    def read_into(self, sample):
        """One burst into sample, array('h', 7): gx gy gz temp at 3..6, the others left as
        they are. False when every bit is 0 or every bit is 1."""
        burst = self._burst
        self._i2c.readfrom_mem_into(self.address, TEMP_OUT_H, burst)
        return words_into(sample, burst, 0, COLUMNS, 0)
