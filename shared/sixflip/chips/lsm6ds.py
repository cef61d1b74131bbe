"""STMicroelectronics LSM6DSOX (LSM6DSO) and LSM6DS3TR-C: accelerometer, gyro and thermometer.

Sources: as in lsm6.py; LSM6DSOX DS12814 rev. 4, table 2, and LSM6DS3TR-C DocID030071 rev. 3,
table 3: sensitivities; the LSM6DS3TR-C's filters as in tables 68 and 73 of DocID028475, the
LSM6DSL, whose chain it is; the LSM6DSOX's gyro filter is table 53 of the ASM330LHH's datasheet,
whose chain it is. The LSM6DS3TR-C's FIFO read beside STMicroelectronics' lsm6ds3tr-c-pid.
"""

from sixflip.chips.lsm6 import CTRL3, LSM6
from sixflip.chips.six_axis import narrow_enough

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

FIFO_CTRL3_3TRC = const(0x08)   # LSM6DS3TR-C: bits 5:3 gyro, 2:0 accelerometer: 1 is every sample
FIFO_CTRL5_3TRC = const(0x0A)   # LSM6DS3TR-C: bits 6:3 rate, 2:0 mode as FIFO_CTRL4
CTRL1_XL = const(0x10)          # bits 7:4 output rate, 3:2 range, 1 LPF2_XL_EN or LPF1_BW_SEL
CTRL2_G = const(0x11)           # bits 7:4 output rate, 3:1 range
CTRL3_C = CTRL3
CTRL4_C = const(0x13)           # bit 1 LPF1_SEL_G
CTRL6_C = const(0x15)           # FTYPE: bits 2:0, LSM6DS3TR-C 1:0; bits 7:3 stay 0
CTRL8_XL = const(0x17)          # bits 7:5 HPCF_XL; LSM6DS3TR-C: bit 7 LPF2_XL_EN, 6:5 HPCF_XL
FIFO_STATUS1 = const(0x3A)      # words in it, 7:0; the next has the high bits, 6 and 3 overrun;
                                # LSM6DS3TR-C: 6 overrun, and which word of a pattern is next
FIFO_DATA_OUT_L = const(0x3E)   # LSM6DS3TR-C: two bytes a word
BLE = const(0x02)
LPF1_SEL_G = const(0x02)
LPF1_BW_QUARTER = const(0x02)   # LSM6DS3TR-C, CTRL1_XL: without LPF2, ODR/4

# (full scale, counts per unit, bits): 0.061 mg and 8.75 mdps a count at ±2 g and ±250 °/s, as
# numbers that a record of thousandths and single-precision floats hold.
ACCEL_RANGES = ((2, 16393, 0), (4, 8197, 2), (8, 4098, 3), (16, 2049, 1))
GYRO_RANGES = ((125, 228.571, 1), (250, 114.286, 0), (500, 57.143, 2), (1000, 28.571, 4),
               (2000, 14.286, 6))
# (output rate in Hz, ODR_XL and ODR_G), both sensors alike.
OUTPUT_RATES = ((26, 2), (52, 3), (104, 4), (208, 5), (416, 6), (833, 7), (1667, 8), (3333, 9))


class LSM6DS(LSM6):
    """What both have in common; subclasses fill in their filters."""

    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    FIFO_STATUS = FIFO_STATUS1

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        self._output_code = code
        ftype, ctrl1, ctrl8, accel_hz = self._filters(hz, self._filter_hz(hz, rate_hz))
        self._reset()
        self._set(CTRL4_C, LPF1_SEL_G)
        self._set(CTRL6_C, ftype)
        self._set(CTRL8_XL, ctrl8)
        self._set(CTRL1_XL, code << 4 | self._accel_bits << 2 | ctrl1)
        self._set(CTRL2_G, code << 4 | self._gyro_bits << 1)
        self._started(rate_hz, hz, accel_hz)
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # turn-on 35 ms (table 4), filters settling


class LSM6DSOX(LSM6DS):
    """Also the LSM6DSO, which answers with the same identification."""

    sensor = "lsm6dsox"
    LEVEL_HIGH = 0x03
    # DS12814, table 2: G_So%, G_TyOff, G_OffDr are typical figures; thrice each
    gyro_tolerance = 0.03
    zero_rate_dps = 3.0
    zero_rate_dps_per_c = 0.03
    # (FTYPE, bandwidth in Hz at an output rate of 26, 52, ... 3333 Hz)
    GYRO_LPF1 = ((0, (8.3, 16.7, 33, 67, 133, 222, 274, 292)),
                 (2, (8.3, 16.7, 33, 67, 112, 140, 150, 153)),
                 (4, (8.3, 16.7, 34, 62, 86, 96, 99, 99)),
                 (5, (8.3, 16.9, 31, 43, 48, 49, 50, 50)),
                 (6, (8.3, 13.4, 19, 23, 24.6, 25, 25, 25)))

    def _filters(self, hz, rate_hz):
        """FTYPE; LPF2_XL_EN; HPCF_XL: ODR/10 (001), of a sample in a FIFO ODR/4 (000): 0.25 to 0.8
        of the samples' rate."""
        column = [row[0] for row in OUTPUT_RATES].index(hz)
        widths = [(ftype, row[column]) for ftype, row in self.GYRO_LPF1]
        by = 10 if self.fifo is None else 4
        return narrow_enough(widths, rate_hz)[0], 0x02, 0x20 if by == 10 else 0x00, hz / by


class LSM6DS3TRC(LSM6DS):
    """The LSM6DS3TR-C; its gyro filter can be chosen above 800 Hz only, else it follows the
    output rate. Its FIFO has no tags, but says which word of a pattern is the next."""

    sensor = "lsm6ds3trc"
    FIFO = "PairFifo"
    FIFO_DATA = FIFO_DATA_OUT_L
    FIFO_SETUP = ((FIFO_CTRL3_3TRC, 3),)
    # DocID030071, table 3: G_So%, G_TyOff, G_OffDr are typical figures; thrice each
    gyro_tolerance = 0.03
    zero_rate_dps = 9.0
    zero_rate_dps_per_c = 0.15
    # (FTYPE, bandwidth at 833, 1667 and 3333 Hz), table 68; (output rate, bandwidth) below
    GYRO_LPF1 = ((0, (245, 315, 343)), (1, (195, 224, 234)), (2, (155, 168, 172)))
    GYRO_LPF2 = ((26, 8.3), (52, 16.7), (104, 33), (208, 67), (416, 133))

    def __init__(self, *args, **more):
        LSM6DS.__init__(self, *args, **more)
        self._four = bytearray(4)

    def _filters(self, hz, rate_hz):
        """FTYPE 10, the narrowest; CTRL8_XL: LPF2, ODR/9 (HPCF_XL 10), low noise; of a sample in a
        FIFO LPF1 alone, ODR/4, there being nothing between."""
        if self.fifo is None:
            return 2, 0x00, 0xC8, hz / 9
        return 2, LPF1_BW_QUARTER, 0x00, hz / 4

    def fifo_start(self):
        """Emptied and filled at the output's rate; full, it loses the oldest."""
        self._set(FIFO_CTRL5_3TRC, 0)
        self._set(FIFO_CTRL3_3TRC, 0x09)
        self._set(FIFO_CTRL5_3TRC, self._output_code << 3 | 0x06)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost or the level is in the midst of one; the
        temperature is read beside."""
        self._read_temperature(self.DATA)
        four = self._four
        self._fetch(FIFO_STATUS1, four)
        if four[1] & 0x40 or four[2] or four[3] & 0x03:    # overrun, or in mid-pattern
            return -1
        return (four[0] | (four[1] & 0x07) << 8) // 6
