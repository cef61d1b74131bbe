"""TDK InvenSense ICM-45686: accelerometer, gyro and thermometer.

Source: datasheet DS-000577 rev. 1.0 (sections 14 to 17: registers, the indirect ones among them),
each register read beside TDK's motion.mcu.icm45686.driver. Registers above 0xFF are reached by
writing their number to IREG_ADDR and reading or writing IREG_DATA, a byte at a time. ±32 g and
±4000 °/s are left out: of ±32 g makers report that the chip measures ±16 g all the same.
"""

from sixflip.chips.six_axis import SixAxis

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

ACCEL_DATA_X1 = const(0x00)     # burst of 14: accel x y z, gyro x y z, temperature
PWR_MGMT0 = const(0x10)         # bits 3:2 gyro, 1:0 accelerometer: 11 is low noise
FIFO_COUNT_0 = const(0x12)      # packets in it; the first answer may be an old one (AN-000364)
FIFO_OUT = const(0x14)
INT1_CONFIG0 = const(0x16)      # bit 2: a new sample is shown
INT1_STATUS0 = const(0x19)      # bit 2: a new sample, cleared by reading; bit 7: reset done
ACCEL_CONFIG0 = const(0x1B)     # bits 6:4 range, 3:0 output rate
GYRO_CONFIG0 = const(0x1C)      # bits 7:4 range, 3:0 output rate
FIFO_CONFIG0 = const(0x1D)      # bits 7:6: 0 off, 1 on, the oldest is overwritten; 5:0 its size
FIFO_CONFIG2 = const(0x20)      # bit 7: it is emptied, and reads 0 when it is
FIFO_CONFIG3 = const(0x21)      # bits 2 gyro, 1 accelerometer, 0 on: to be set after the mode
WHO_AM_I = const(0x72)
IREG_ADDR = const(0x7C)         # high byte of an indirect register's number, low byte, its data
IREG_DATA = const(0x7E)
REG_MISC2 = const(0x7F)         # bit 1: reset, over within 1 ms
SREG_CTRL = const(0xA267)       # bit 1: samples big-endian
GYRO_LPF = const(0xA4AC)        # IPREG_SYS1_REG_172, bits 2:0: bandwidth, a part of the rate
ACCEL_LPF = const(0xA583)       # IPREG_SYS2_REG_131, bits 2:0
RESET = const(0x02)
DEPTH_2_KB = const(0x07)
STREAM = const(0x40)
FLUSH = const(0x80)
BOTH_IN_FIFO = const(0x06)
FIFO_ON = const(0x01)
FIFO_PACKETS = const(128)
LOW_NOISE = const(0x0F)
BIG_ENDIAN = const(0x02)
RATE_BY_8 = const(0x02)
RATE_BY_4 = const(0x01)

ACCEL_RANGES = ((2, 16384, 4), (4, 8192, 3), (8, 4096, 2), (16, 2048, 1))
GYRO_RANGES = ((125, 262.0, 5), (250, 131.0, 4), (500, 65.5, 3), (1000, 32.8, 2), (2000, 16.4, 1))
TEMPERATURE = (128.0, 25.0)
OUTPUT_RATES = ((50, 10), (100, 9), (200, 8), (400, 7), (800, 6), (1600, 5), (3200, 4))


class ICM45686(SixAxis):
    """Its registers above 0xFF are read and written through two that are below."""

    sensor = "icm45686"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = ACCEL_DATA_X1
    ID_REGISTER = WHO_AM_I
    COLUMNS = (0, 1, 2, 3, 4, 5, 6)
    HIGH = 1
    TEMPERATURE = TEMPERATURE
    FIFO = "PacketFifo"
    FIFO_DATA = FIFO_OUT
    FIFO_SETUP = ((FIFO_CONFIG0, 1), (FIFO_CONFIG3, 1))
    READY = (INT1_STATUS0, 0x04)
    READY_ON = (INT1_CONFIG0, 0x04)
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
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        by = RATE_BY_8 if self.fifo is None else RATE_BY_4
        self._write(REG_MISC2, RESET)
        self._wait_clear(REG_MISC2, RESET)
        self._set(SREG_CTRL, self._read(SREG_CTRL) & ~BIG_ENDIAN & 0xFF)
        for register in (GYRO_LPF, ACCEL_LPF):
            self._set(register, self._read(register) & 0xF8 | by)
        for register, value in ((ACCEL_CONFIG0, self._accel_bits << 4 | code),
                                (GYRO_CONFIG0, self._gyro_bits << 4 | code),
                                (PWR_MGMT0, LOW_NOISE)):
            self._set(register, value)
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # gyro start-up, filters settling
        self._started(rate_hz, hz, hz / (4 << by - 1))

    def fifo_start(self):
        """In the order that the maker's driver has: off, the mode, then on."""
        self._set(FIFO_CONFIG3, 0)
        self._set(FIFO_CONFIG0, DEPTH_2_KB)
        self._write(FIFO_CONFIG2, FLUSH)
        self._wait_clear(FIFO_CONFIG2, FLUSH)
        self._set(FIFO_CONFIG3, BOTH_IN_FIFO)
        self._set(FIFO_CONFIG0, STREAM | DEPTH_2_KB)
        self._set(FIFO_CONFIG3, BOTH_IN_FIFO | FIFO_ON)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost."""
        two = self._two
        self._fetch(FIFO_COUNT_0, two)
        self._fetch(FIFO_COUNT_0, two)
        level = two[0] | two[1] << 8
        return -1 if level >= FIFO_PACKETS else level
