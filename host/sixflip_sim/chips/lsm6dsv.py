"""Simulated LSM6DSV, by the driver's own tables: an LSM6DSOX with other control registers."""

from sixflip.chips import lsm6dsv as chip
from sixflip.chips.lsm6 import BDU, CTRL3, FUNC_CFG_ACCESS, IF_INC
from sixflip_sim.chips.lsm6 import HIDDEN, SimulatedLSM6
from sixflip_sim.chips.six_axis import range_of, rate_of


class SimulatedLSM6DSV(SimulatedLSM6):
    driver = chip.LSM6DSV
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    TRAPS = ((CTRL3, 0), (FUNC_CFG_ACCESS, HIDDEN), (chip.CTRL8, 0x03))
    nominal_hz = (48, 28.4)
    defaults = {CTRL3: IF_INC | BDU}
    OFFSETS_BIT = (chip.CTRL9, 0x01)
    FIFO_BYTES = 256 * 7        # "1.5 KB" of data, DS13476 section 5

    def fall_asleep(self):
        self.registers[chip.CTRL1] = 0
        self.registers[chip.CTRL2] = 0

    def output_code(self):
        return self.registers[chip.CTRL2]

    def output_hz(self):
        code = self.output_code()
        if code != self.registers[chip.CTRL1]:
            return 0
        return rate_of(chip.OUTPUT_RATES, code)

    def accel(self):
        hz = self.output_hz()
        wide = 2 if not self.registers[chip.CTRL9] & chip.LPF2_XL_EN else (
            4, 10, 20, 45, 100, 200, 400, 800)[self.registers[chip.CTRL8] >> 5]
        return range_of(chip.ACCEL_RANGES, self.registers[chip.CTRL8] & 3), hz / wide

    def gyro(self):
        column = [row[0] for row in chip.OUTPUT_RATES].index(self.output_hz())
        widths = dict(chip.GYRO_LPF1)
        bw = self.registers[chip.CTRL6] >> 4 & 7
        on = self.registers[chip.CTRL7] & chip.LPF1_G_EN
        return (range_of(chip.GYRO_RANGES, self.registers[chip.CTRL6] & 15),
                widths.get(bw if on else 0, widths[0])[column])


SIMULATED = {"lsm6dsv": SimulatedLSM6DSV}
