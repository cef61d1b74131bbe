"""Analog Devices ADXL345, an accelerometer. Source: datasheet rev. E, register map table 19."""

from sixflip.chips.registers import Registers, in_range, row_of_range, words_into

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

DEVID = const(0x00)
OFSX = const(0x1E)              # three offsets which the chip adds, 15.6 mg a count: kept at 0
BW_RATE = const(0x2C)
POWER_CTL = const(0x2D)         # bit 3: measure
INT_ENABLE = const(0x2E)
INT_SOURCE = const(0x30)        # bit 7: data ready
DATA_FORMAT = const(0x31)       # bit 3 FULL_RES, bits 1:0 range
DATAX0 = const(0x32)            # burst of 6: x y z, little-endian
FIFO_CTL = const(0x38)
DEVICE_ID = const(0xE5)
MEASURE = const(0x08)
FULL_RES = const(0x08)
BURST = const(6)

# FULL_RES: 256 counts per g in every range, 10 bits at ±2 g to 13 at ±16 g (table 1).
LSB_PER_G = const(256)
RANGE_G = const(16)
RANGES_G = (2, 4, 8, 16)
# (output rate in Hz, code in BW_RATE); bandwidth is half the rate (table 7). 800 Hz is the
# most that a 400 kHz bus carries.
OUTPUT_RATES = ((25, 8), (50, 9), (100, 10), (200, 11), (400, 12), (800, 13))


class ADXL345(Registers):
    """Alone it is an imu without gyro and thermometer; in a GY-85 it is half of one."""

    chip = "ADXL345"
    sensor = "adxl345"
    READY = (INT_SOURCE, 0x80)      # shown whatever INT_ENABLE says, section "INT_SOURCE"
    ACCEL_RANGES = tuple([(g, LSB_PER_G, code) for code, g in enumerate(RANGES_G)])
    GYRO_RANGES = ()
    TEMPERATURE = None
    MOST_HZ = 400
    gyro_tolerance = None
    zero_rate_dps = zero_rate_dps_per_c = 0.0
    name = "ADXL345 (0xe5)"
    who_am_i = (DEVICE_ID, 0)
    has_gyro = False
    has_temp = False
    accel_lsb_per_g = LSB_PER_G
    gyro_lsb_per_dps = 0
    gyro_range_dps = 0
    gyro_rail = 0
    temp_lsb_per_c = 0
    temp_offset_c = 0
    setup = ((BW_RATE, 2), (DATA_FORMAT, 1))
    offsets = ((OFSX, 3),)

    def __init__(self, i2c, address=0x53, who_am_i=DEVICE_ID, sleep_ms=None, accel_range_g=None,
                 gyro_range_dps=None):
        Registers.__init__(self, i2c, address, sleep_ms)
        self.accel_range_g, _, self._range = row_of_range(
            self.ACCEL_RANGES, accel_range_g or RANGE_G, "accel_range_g")
        self.accel_rail = LSB_PER_G * self.accel_range_g - 1
        self.rate_hz = 0
        self.output_rate_hz = self.filter_hz = 0
        self._burst = bytearray(BURST)

    def configure(self, rate_hz):
        """Set up for polling at rate_hz at 256 counts per g; OSError when a register does
        not take its value. The chip has no reset bit: everything that matters is written."""
        in_range(rate_hz, self.MOST_HZ)
        hz, code = [x for x in OUTPUT_RATES if x[0] >= 2 * rate_hz][0]
        self._set(POWER_CTL, 0)
        for register, value in ((BW_RATE, code), (DATA_FORMAT, FULL_RES | self._range),
                                (FIFO_CTL, 0), (INT_ENABLE, 0), (OFSX, 0),
                                (OFSX + 1, 0), (OFSX + 2, 0), (POWER_CTL, MEASURE)):
            self._set(register, value)
        self._hold()
        self.output_rate_hz = hz
        self.filter_hz = hz / 2
        self.rate_hz = rate_hz
        if self._sleep_ms is not None:
            self._sleep_ms(20)      # turn-on time 11.1 ms at 100 Hz (table 1, note 7)

    def answers(self, i2c):
        """Whether the chip answers on this bus, to be used from now on, as what it is."""
        return self._answers(i2c, DEVID, DEVICE_ID)

    def read_into(self, sample):
        """One burst into sample, array('h', 7): ax ay az in counts, the others 0. False
        when all three are 0 or all are -1, which no working accelerometer reads."""
        burst = self._burst
        self._i2c.readfrom_mem_into(self.address, DATAX0, burst)
        for i in range(3, 7):
            sample[i] = 0
        return words_into(sample, burst, 0, (0, 1, 2), 1)
