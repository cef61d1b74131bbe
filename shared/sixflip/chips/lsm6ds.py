"""STMicroelectronics LSM6DSOX (LSM6DSO) and LSM6DS3TR-C: accelerometer, gyro and thermometer.

Sources: LSM6DSOX datasheet DS12814 rev. 4 (section 9, registers; table 2, sensitivities),
LSM6DS3TR-C datasheet DocID030071 rev. 3 (section 9; table 3; filters as in tables 68 and 73 of
DocID028475, the LSM6DSL, whose chain it is), each register read beside STMicroelectronics'
lsm6dsox-pid and lsm6ds3tr-c-pid; the LSM6DSOX's gyro filter is table 53 of the ASM330LHH's
datasheet, whose chain it is.
"""

from sixflip.chips.six_axis import SixAxis, narrow_enough, output_rate

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

FUNC_CFG_ACCESS = const(0x01)   # bit 7: other registers are shown at the same numbers
WHO_AM_I = const(0x0F)
CTRL1_XL = const(0x10)          # bits 7:4 output rate, 3:2 range, 1 LPF2_XL_EN or LPF1_BW_SEL
CTRL2_G = const(0x11)           # bits 7:4 output rate, 3:1 range
CTRL3_C = const(0x12)           # bit 6 BDU, 2 IF_INC, 1 BLE (LSM6DS3TR-C), 0 SW_RESET
CTRL4_C = const(0x13)           # bit 1 LPF1_SEL_G
CTRL6_C = const(0x15)           # FTYPE: bits 2:0, LSM6DS3TR-C 1:0; bits 7:3 stay 0
CTRL8_XL = const(0x17)          # bits 7:5 HPCF_XL; LSM6DS3TR-C: bit 7 LPF2_XL_EN, 6:5 HPCF_XL
STATUS_REG = const(0x1E)        # bit 0 XLDA, 1 GDA: a new sample, cleared by reading it
OUT_TEMP_L = const(0x20)        # burst of 14: temperature, gyro x y z, accel x y z
X_OFS_USR = const(0x73)         # accelerometer x y z, 8 bits each
SW_RESET = const(0x01)
BLE = const(0x02)
IF_INC = const(0x04)            # the register counts up in a burst
BDU = const(0x40)               # both bytes of a word are of one sample
LPF1_SEL_G = const(0x02)

# (full scale, counts per unit, bits): 0.061 mg and 8.75 mdps a count at ±2 g and ±250 °/s, as
# numbers that a record of thousandths and single-precision floats hold.
ACCEL_RANGES = ((2, 16393, 0), (4, 8197, 2), (8, 4098, 3), (16, 2049, 1))
GYRO_RANGES = ((125, 228.571, 1), (250, 114.286, 0), (500, 57.143, 2), (1000, 28.571, 4),
               (2000, 14.286, 6))
TEMPERATURE = (256.0, 25.0)
# (output rate in Hz, ODR_XL and ODR_G), both sensors alike.
OUTPUT_RATES = ((26, 2), (52, 3), (104, 4), (208, 5), (416, 6), (833, 7), (1667, 8), (3333, 9))


class LSM6(SixAxis):
    """What both have in common; subclasses fill in their filters."""

    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    DATA = OUT_TEMP_L
    ID_REGISTER = WHO_AM_I
    COLUMNS = (6, 3, 4, 5, 0, 1, 2)
    HIGH = 1
    TEMPERATURE = TEMPERATURE
    setup = ((CTRL1_XL, 10),)
    offsets = ((X_OFS_USR, 3),)

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        hz, code = output_rate(OUTPUT_RATES, rate_hz)
        ftype, accel_filter = self._filters(hz, rate_hz)
        self._write(FUNC_CFG_ACCESS, 0)
        self._write(CTRL3_C, SW_RESET)
        self._wait_clear(CTRL3_C, SW_RESET)
        self._set(CTRL3_C, BDU | IF_INC)
        self._set(CTRL4_C, LPF1_SEL_G)
        self._set(CTRL6_C, ftype)
        self._set(CTRL8_XL, accel_filter)
        self._set(CTRL1_XL, code << 4 | self._accel_bits << 2 | self.LPF2_XL_EN)
        self._set(CTRL2_G, code << 4 | self._gyro_bits << 1)
        self._hold()
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # turn-on 35 ms (table 4), filters settling
        self.rate_hz = rate_hz
        self.output_rate_hz = hz
        self.filter_hz = hz / self.ACCEL_DIVIDER


class LSM6DSOX(LSM6):
    """Also the LSM6DSO, which answers with the same identification."""

    sensor = "lsm6dsox"
    # DS12814, table 2: G_So%, G_TyOff, G_OffDr are typical figures; thrice each
    gyro_tolerance = 0.03
    zero_rate_dps = 3.0
    zero_rate_dps_per_c = 0.03
    LPF2_XL_EN = 0x02
    ACCEL_DIVIDER = 10
    # (FTYPE, bandwidth in Hz at an output rate of 26, 52, ... 3333 Hz)
    GYRO_LPF1 = ((0, (8.3, 16.7, 33, 67, 133, 222, 274, 292)),
                 (2, (8.3, 16.7, 33, 67, 112, 140, 150, 153)),
                 (4, (8.3, 16.7, 34, 62, 86, 96, 99, 99)),
                 (5, (8.3, 16.9, 31, 43, 48, 49, 50, 50)),
                 (6, (8.3, 13.4, 19, 23, 24.6, 25, 25, 25)))

    def _filters(self, hz, rate_hz):
        """FTYPE; CTRL8_XL: ODR/10 (HPCF_XL 001), 0.4 to 0.8 of the polling rate."""
        column = [row[0] for row in OUTPUT_RATES].index(hz)
        widths = [(ftype, row[column]) for ftype, row in self.GYRO_LPF1]
        return narrow_enough(widths, rate_hz)[0], 0x20


class LSM6DS3TRC(LSM6):
    """The LSM6DS3TR-C; its gyro filter can be chosen above 800 Hz only, else it follows the
    output rate."""

    sensor = "lsm6ds3trc"
    # DocID030071, table 3: G_So%, G_TyOff, G_OffDr are typical figures; thrice each
    gyro_tolerance = 0.03
    zero_rate_dps = 9.0
    zero_rate_dps_per_c = 0.15
    LPF2_XL_EN = 0x00               # bit 1 is LPF1_BW_SEL here, of no effect with LPF2
    ACCEL_DIVIDER = 9
    # (FTYPE, bandwidth at 833, 1667 and 3333 Hz), table 68; (output rate, bandwidth) below
    GYRO_LPF1 = ((0, (245, 315, 343)), (1, (195, 224, 234)), (2, (155, 168, 172)))
    GYRO_LPF2 = ((26, 8.3), (52, 16.7), (104, 33), (208, 67), (416, 133))

    def _filters(self, hz, rate_hz):
        """FTYPE 10, the narrowest; CTRL8_XL: LPF2, ODR/9 (HPCF_XL 10), low noise."""
        return 2, 0xC8
