"""STMicroelectronics LSM6DSV and LSM6DSV16X: accelerometer, gyro and thermometer.

Source: datasheet DS13476 rev. 5 (section 9: tables 50 to 71, registers; table 64, gyro filter;
table 3, sensitivities), each register read beside STMicroelectronics' lsm6dsv-pid. Where an
LSM6DSOX has range and rate in one register, this one has a register each.
"""

from sixflip.chips.lsm6 import LSM6
from sixflip.chips.six_axis import narrow_enough

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

CTRL1 = const(0x10)             # bits 6:4 mode of the accelerometer, 3:0 output rate
CTRL2 = const(0x11)             # the gyro's
CTRL6 = const(0x15)             # bits 6:4 LPF1_G_BW, 3:0 range of the gyro
CTRL7 = const(0x16)             # bit 0 LPF1_G_EN
CTRL8 = const(0x17)             # bits 7:5 HP_LPF2_XL_BW, 1:0 range of the accelerometer
CTRL9 = const(0x18)             # bit 3 LPF2_XL_EN
FIFO_STATUS1 = const(0x1B)      # words in it, 7:0; the next has bit 8, 6 and 3 overrun
LPF1_G_EN = const(0x01)
LPF2_XL_EN = const(0x08)
ODR_BY_10 = const(0x20)         # HP_LPF2_XL_BW 001; 000 is ODR/4

# (full scale, counts per unit, bits), rounded as in lsm6ds.py.
ACCEL_RANGES = ((2, 16393, 0), (4, 8197, 1), (8, 4098, 2), (16, 2049, 3))
GYRO_RANGES = ((125, 228.571, 0), (250, 114.286, 1), (500, 57.143, 2), (1000, 28.571, 3),
               (2000, 14.286, 4))
OUTPUT_RATES = ((60, 5), (120, 6), (240, 7), (480, 8), (960, 9), (1920, 10), (3840, 11))
# (LPF1_G_BW, bandwidth in Hz at an output rate of 60, 120, ... 3840 Hz), table 64.
GYRO_LPF1 = ((0, (24.6, 49.4, 96, 175, 241, 273, 280)), (2, (24.6, 49.4, 96, 131, 149, 155, 156)),
             (4, (24.6, 49.4, 78.4, 94, 100, 101, 102)),
             (5, (24.6, 42.6, 53, 56.7, 57.9, 58.2, 58.3)),
             (6, (18.0, 24.2, 27.3, 28.4, 28.7, 28.8, 28.8)),
             (7, (12.1, 13.6, 14.2, 14.3, 14.4, 14.4, 14.4)))


class LSM6DSV(LSM6):
    """Also the LSM6DSV16X, which answers with the same identification."""

    sensor = "lsm6dsv"
    ACCEL_RANGES = ACCEL_RANGES
    GYRO_RANGES = GYRO_RANGES
    FIFO_STATUS = FIFO_STATUS1
    LEVEL_HIGH = 0x01
    # table 3: G_So%, G_TyOff, G_OffDr are typical figures; thrice each
    gyro_tolerance = 0.009
    zero_rate_dps = 3.0
    zero_rate_dps_per_c = 0.018

    def configure(self, rate_hz):
        """Reset and set up for polling at rate_hz; OSError when a register does not take its
        value, ValueError for a rate that is no chip's."""
        hz, code = self._output_rate(OUTPUT_RATES, rate_hz)
        self._output_code = code
        column = [row[0] for row in OUTPUT_RATES].index(hz)
        bw, _ = narrow_enough([(bits, row[column]) for bits, row in GYRO_LPF1],
                              self._filter_hz(hz, rate_hz))
        by = ODR_BY_10 if self.fifo is None else 0
        self._reset()
        for register, value in ((CTRL6, bw << 4 | self._gyro_bits), (CTRL7, LPF1_G_EN),
                                (CTRL8, by | self._accel_bits), (CTRL9, LPF2_XL_EN),
                                (CTRL1, code), (CTRL2, code)):
            self._set(register, value)
        self._started(rate_hz, hz, hz / (10 if by else 4))
        if self._sleep_ms is not None:
            self._sleep_ms(100)     # turn-on 30 ms (table 4), filters settling
