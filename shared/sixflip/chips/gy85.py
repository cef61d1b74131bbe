"""GY-85: a board with an ADXL345 and an ITG3205 (and a magnetometer, see magnetometers.py)."""

from sixflip import RAIL
from sixflip.chips import itg3205
from sixflip.chips.adxl345 import ADXL345
from sixflip.chips.itg3205 import ITG3205
from sixflip.chips.registers import Registers


class GY85:
    """The pair as one imu: two bursts a sample, the temperature is the gyro's."""

    sensor = "gy85"
    name = "GY-85: ADXL345 (0xe5) and ITG3205 (0x68)"
    ACCEL_RANGES = ADXL345.ACCEL_RANGES
    GYRO_RANGES = ITG3205.GYRO_RANGES
    TEMPERATURE = itg3205.TEMPERATURE
    MOST_HZ = ADXL345.MOST_HZ
    gyro_tolerance = ITG3205.gyro_tolerance
    zero_rate_dps = ITG3205.zero_rate_dps
    zero_rate_dps_per_c = ITG3205.zero_rate_dps_per_c
    fifo = None                     # the ITG3205 has none
    has_gyro = True
    has_temp = True
    accel_lsb_per_g = ADXL345.accel_lsb_per_g
    gyro_lsb_per_dps = itg3205.LSB_PER_DPS
    gyro_range_dps = itg3205.RANGE_DPS
    gyro_rail = RAIL
    temp_lsb_per_c, temp_offset_c = itg3205.TEMPERATURE
    metadata = Registers.metadata

    def __init__(self, i2c, accel_address=0x53, gyro_address=0x68, gyro_id=itg3205.ID,
                 sleep_ms=None, accel_range_g=None, gyro_range_dps=None):
        self.accel = ADXL345(i2c, accel_address, sleep_ms=sleep_ms, accel_range_g=accel_range_g)
        self.gyro = ITG3205(i2c, gyro_address, sleep_ms)
        self.address = accel_address
        self.accel_range_g = self.accel.accel_range_g
        self.accel_rail = self.accel.accel_rail
        self.who_am_i = (self.accel.who_am_i[0], gyro_id)
        self.rate_hz = 0

    def configure(self, rate_hz):
        """Set up both chips; OSError names the one that does not take its value."""
        self.accel.configure(rate_hz)
        self.gyro.configure(rate_hz)
        self.rate_hz = rate_hz

    def answers(self, i2c):
        """Whether both chips answer on this bus, to be used from now on, as to the probe."""
        accel = self.accel.answers(i2c)
        return self.gyro.answers(i2c, self.who_am_i[1]) and accel

    def awake(self):
        """Whether both chips are as configured. Short reads, no allocation."""
        return self.accel.awake() and self.gyro.awake()

    def shifted(self):
        """"" or which offset somebody has changed; the gyro has none."""
        return self.accel.shifted()

    def read_into(self, sample):
        """ax ay az gx gy gz temp in counts; False when either chip's burst is empty."""
        accel = self.accel.read_into(sample)
        return self.gyro.read_into(sample) and accel
