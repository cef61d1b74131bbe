"""What STMicroelectronics' LSM6 chips share: the burst, the reset, the tagged FIFO.

Sources: LSM6DSOX datasheet DS12814 rev. 4 (section 9, registers; 6, FIFO), LSM6DS3TR-C datasheet
DocID030071 rev. 3, LSM6DSV datasheet DS13476 rev. 5, each register read beside
STMicroelectronics' lsm6dsox-pid, lsm6ds3tr-c-pid and lsm6dsv-pid.
"""

from sixflip.chips.six_axis import SixAxis

try:
    from micropython import const
except ImportError:
    def const(value):
        return value

FUNC_CFG_ACCESS = const(0x01)   # bit 7: other registers are shown at the same numbers
FIFO_CTRL3 = const(0x09)        # bits 7:4 gyro, 3:0 accelerometer: rates at which they go in
FIFO_CTRL4 = const(0x0A)        # bits 2:0: 0 empty and off, 6 on, the oldest is overwritten
WHO_AM_I = const(0x0F)
CTRL3 = const(0x12)             # bit 6 BDU, 2 IF_INC, 1 BLE (LSM6DS3TR-C), 0 SW_RESET
STATUS_REG = const(0x1E)        # bit 0 XLDA, 1 GDA: a new sample, cleared by reading it
OUT_TEMP_L = const(0x20)        # burst of 14: temperature, gyro x y z, accel x y z
X_OFS_USR = const(0x73)         # accelerometer x y z, 8 bits each
FIFO_DATA_OUT_TAG = const(0x78)  # seven bytes a word; behind the last the first is read again
SW_RESET = const(0x01)
IF_INC = const(0x04)            # the register counts up in a burst
BDU = const(0x40)               # both bytes of a word are of one sample
STREAM = const(0x06)
OVERRUN = const(0x48)           # of FIFO_STATUS2: FIFO_OVR_IA and FIFO_OVR_LATCHED


class LSM6(SixAxis):
    """Subclasses have the ranges, the control registers and, where FIFO is not "", FIFO_STATUS
    (its two registers) and LEVEL_HIGH (bits of the second that belong to the level)."""

    DATA = OUT_TEMP_L
    ID_REGISTER = WHO_AM_I
    COLUMNS = (6, 3, 4, 5, 0, 1, 2)
    HIGH = 1
    TEMPERATURE = (256.0, 25.0)
    FIFO = "TaggedFifo"
    FIFO_DATA = FIFO_DATA_OUT_TAG
    FIFO_SETUP = ((FIFO_CTRL3, 2),)
    READY = (STATUS_REG, 0x03)
    FIFO_STATUS = 0
    LEVEL_HIGH = 0
    setup = ((0x10, 10),)       # CTRL1 to CTRL10
    offsets = ((X_OFS_USR, 3),)

    def _reset(self):
        """Every register to its default, and a burst counts up."""
        self._write(FUNC_CFG_ACCESS, 0)
        self._write(CTRL3, SW_RESET)
        self._wait_clear(CTRL3, SW_RESET)
        self._set(CTRL3, BDU | IF_INC)

    def fifo_start(self):
        """Emptied and filled at the output's rate; full, it loses the oldest words."""
        code = self._output_code    # the FIFO's rates have the codes of the output's
        self._set(FIFO_CTRL4, 0)
        self._set(FIFO_CTRL3, code << 4 | code)
        self._set(FIFO_CTRL4, STREAM)

    def fifo_level(self):
        """Samples waiting, or -1 when some were lost; the temperature is read beside."""
        self._read_temperature(OUT_TEMP_L)
        two = self._two
        self._fetch(self.FIFO_STATUS, two)
        return -1 if two[1] & OVERRUN else (two[0] | (two[1] & self.LEVEL_HIGH) << 8) // 2
