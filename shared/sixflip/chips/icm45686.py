"""TDK InvenSense ICM-45686: accelerometer, gyro and thermometer.

Source: datasheet DS-000577 rev. 1.0 (sections 14 to 17: registers, the indirect ones among them),
each register read beside TDK's motion.mcu.icm45686.driver. Registers above 0xFF are reached by
writing their number to IREG_ADDR and reading or writing IREG_DATA, a byte at a time. ±32 g and
±4000 °/s are left out: of ±32 g makers report that the chip measures ±16 g all the same.
"""

from sixflip.chips.six_axis import SixAxis, output_rate

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

ACCEL_DATA_X1 = const(0x00)     # burst of 14: accel x y z, gyro x y z, temperature
PWR_MGMT0 = const(0x10)         # bits 3:2 gyro, 1:0 accelerometer: 11 is low noise
INT1_STATUS0 = const(0x19)      # bit 2: a new sample, cleared by reading; bit 7: reset done
ACCEL_CONFIG0 = const(0x1B)     # bits 6:4 range, 3:0 output rate
GYRO_CONFIG0 = const(0x1C)      # bits 7:4 range, 3:0 output rate
WHO_AM_I = const(0x72)
IREG_ADDR = const(0x7C)         # high byte of an indirect register's number, low byte, its data
IREG_DATA = const(0x7E)
REG_MISC2 = const(0x7F)         # bit 1: reset, over within 1 ms
SREG_CTRL = const(0xA267)       # bit 1: samples big-endian
GYRO_LPF = const(0xA4AC)        # IPREG_SYS1_REG_172, bits 2:0: bandwidth, a part of the rate
ACCEL_LPF = const(0xA583)       # IPREG_SYS2_REG_131, bits 2:0
RESET = const(0x02)
LOW_NOISE = const(0x0F)
BIG_ENDIAN = const(0x02)
RATE_BY_8 = const(0x02)

ACCEL_RANGES = ((2, 16384, 4), (4, 8192, 3), (8, 4096, 2), (16, 2048, 1))
GYRO_RANGES = ((125, 262.0, 5), (250, 131.0, 4), (500, 65.5, 3), (1000, 32.8, 2), (2000, 16.4, 1))
TEMPERATURE = (128.0, 25.0)
OUTPUT_RATES = ((50, 10), (100, 9), (200, 8), (400, 7), (800, 6), (1600, 5), (3200, 4))


class ICM45686(SixAxis):
    sensor = "icm45686"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = ACCEL_DATA_X1
    ID_REGISTER = WHO_AM_I
    COLUMNS = (0, 1, 2, 3, 4, 5, 6)
    HIGH = 1
    TEMPERATURE = TEMPERATURE
    # no figure of the sheet could be had: those of the ICM-42688-P
    gyro_tolerance = 0.015
    zero_rate_dps = 1.5
    zero_rate_dps_per_c = 0.015
    setup = ((PWR_MGMT0, 1), (ACCEL_CONFIG0, 2), (SREG_CTRL, 1), (GYRO_LPF, 1), (ACCEL_LPF, 1))

    def __init__(self, *args, **more):
        SixAxis.__init__(self, *args, **more)
        self._where = bytearray(2)
        self._what = bytearray(3)

    def _fetch(self, register, buf):
        if register <= 0xFF:
            SixAxis._fetch(self, register, buf)
            return
        self._where[0] = register >> 8
        self._where[1] = register & 0xFF
        self._i2c.writeto_mem(self.address, IREG_ADDR, self._where)
        SixAxis._fetch(self, IREG_DATA, buf)    # its 4 µs are over when a transfer begins

    def _store(self, register, buf):
        if register <= 0xFF:
            SixAxis._store(self, register, buf)
            return
        self._what[0] = register >> 8
        self._what[1] = register & 0xFF
        self._what[2] = buf[0]
        self._i2c.writeto_mem(self.address, IREG_ADDR, self._what)

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        hz, code = output_rate(OUTPUT_RATES, rate_hz)
        self._write(REG_MISC2, RESET)
        self._wait_clear(REG_MISC2, RESET)
        self._set(SREG_CTRL, self._read(SREG_CTRL) & ~BIG_ENDIAN & 0xFF)
        for register in (GYRO_LPF, ACCEL_LPF):
            self._set(register, self._read(register) & 0xF8 | RATE_BY_8)
        for register, value in ((ACCEL_CONFIG0, self._accel_bits << 4 | code),
                                (GYRO_CONFIG0, self._gyro_bits << 4 | code),
                                (PWR_MGMT0, LOW_NOISE)):
            self._set(register, value)
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # gyro start-up, filters settling
        self._hold()
        self.rate_hz = rate_hz
        self.output_rate_hz = hz
        self.filter_hz = hz / 8
