"""Simulated QMI8658, by the driver's own tables."""

from sixflip.chips import qmi8658 as chip
from sixflip_sim.chips.six_axis import SimulatedSixAxis, range_of, rate_of

_PARTS = (0.0266, 0.0363, 0.0539, chip.FILTER_PART)     # of the output rate, table 22
_UNFILTERED = 0.275


class SimulatedQMI8658(SimulatedSixAxis):
    """Off after a reset, big-endian, and a burst reads one register over and over."""

    driver = chip.QMI8658
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    self_clearing = (chip.RESET_REGISTER, 0xFF)
    nominal_hz = (60, 60)
    TRAPS = ((chip.CTRL1, chip.BIG_ENDIAN), (chip.CTRL1, chip.BIG_ENDIAN | chip.COUNT_UP),
             (chip.CTRL7, 0))
    RESET_US = 15000
    cleared_by_data = False
    defaults = {chip.CTRL1: chip.BIG_ENDIAN, chip.RESULT: chip.DONE}

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self.registers[1] = 0x7C        # REVISION_ID

    def fall_asleep(self):
        self.registers[chip.CTRL7] = 0

    def read_only(self, register):
        return register in (1, chip.RESULT, chip.STATUS0) or \
            SimulatedSixAxis.read_only(self, register)

    def write_register(self, register, value):
        if register == chip.RESET_REGISTER:
            if value == chip.RESET and not self.resetting():
                self.reset()
        else:
            SimulatedSixAxis.write_register(self, register, value)

    def counts_up(self):
        return self.registers[chip.CTRL1] & chip.COUNT_UP

    def read_into(self, buf):
        start = self.pointer
        SimulatedSixAxis.read_into(self, buf)
        if start == chip.RESULT and self.resetting():
            buf[0] = 0

    def high(self):
        return 0 if self.registers[chip.CTRL1] & chip.BIG_ENDIAN else 1

    def output_hz(self):
        code = self.registers[chip.CTRL3] & 15
        if (self.registers[chip.CTRL7] & chip.BOTH_ON != chip.BOTH_ON
                or self.registers[chip.CTRL2] & 15 != code):
            return 0
        return rate_of(chip.OUTPUT_RATES, code)

    def accel(self):
        setting = self.registers[chip.CTRL5]
        part = _PARTS[setting >> 1 & 3] if setting & 0x01 else _UNFILTERED
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.CTRL2] >> 4 & 7),
                part * self.output_hz())

    def gyro(self):
        setting = self.registers[chip.CTRL5]
        part = _PARTS[setting >> 5 & 3] if setting & 0x10 else _UNFILTERED
        return (range_of(chip.GYRO_RANGES, self.registers[chip.CTRL3] >> 4 & 7),
                part * self.output_hz())


SIMULATED = {"qmi8658": SimulatedQMI8658}
