"""Simulated LSM6DSOX and LSM6DS3TR-C, by the driver's own tables."""

from sixflip.chips import lsm6ds as chip
from sixflip.chips.lsm6 import FUNC_CFG_ACCESS, IF_INC
from sixflip_sim.chips.fifo import words
from sixflip_sim.chips.lsm6 import HIDDEN, SimulatedLSM6
from sixflip_sim.chips.six_axis import range_of, rate_of


class SimulatedLSM6DS(SimulatedLSM6):
    """Range and rate are in one register."""

    def fall_asleep(self):
        self.registers[chip.CTRL1_XL] &= 0x0F
        self.registers[chip.CTRL2_G] &= 0x0F

    def output_code(self):
        return self.registers[chip.CTRL2_G] >> 4

    def output_hz(self):
        code = self.output_code()
        if code != self.registers[chip.CTRL1_XL] >> 4:
            return 0            # the driver runs both alike; anything else is not simulated
        return rate_of(chip.OUTPUT_RATES, code)

    def accel(self):
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.CTRL1_XL] >> 2 & 3),
                self.accel_bandwidth(self.output_hz()))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.CTRL2_G] >> 1 & 7),
                self.gyro_bandwidth(self.output_hz()))


class SimulatedLSM6DSOX(SimulatedLSM6DS):
    driver = chip.LSM6DSOX
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    TRAPS = ((chip.CTRL3_C, 0), (FUNC_CFG_ACCESS, HIDDEN), (chip.CTRL1_XL, 0x4C))
    nominal_hz = (41.6, 48)
    defaults = {chip.CTRL3_C: IF_INC, 0x18: 0xE0}
    OFFSETS_BIT = (0x16, 0x02)  # CTRL7_G, USR_OFF_ON_OUT
    FIFO_BYTES = 512 * 7        # "3 Kbyte" of data, DS12814 section 6

    def accel_bandwidth(self, hz):
        if not self.registers[chip.CTRL1_XL] & 0x02:
            return hz / 2
        return hz / (4, 10, 20, 45, 100, 200, 400, 800)[self.registers[chip.CTRL8_XL] >> 5]

    def gyro_bandwidth(self, hz):
        column = [row[0] for row in chip.OUTPUT_RATES].index(hz)
        on = self.registers[chip.CTRL4_C] & chip.LPF1_SEL_G
        widths = dict(self.driver.GYRO_LPF1)
        return widths.get(self.registers[chip.CTRL6_C] & 7 if on else 0, widths[0])[column]


class SimulatedLSM6DS3TRC(SimulatedLSM6DS):
    driver = chip.LSM6DS3TRC
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    TRAPS = SimulatedLSM6DSOX.TRAPS + ((chip.CTRL3_C, chip.BLE | IF_INC),)
    nominal_hz = (416 / 9, 133)
    defaults = {chip.CTRL3_C: IF_INC, 0x18: 0xE0}

    FIFO_BYTES, FIFO_FRAME = 4096, 12

    def high(self):
        return 0 if self.registers[chip.CTRL3_C] & chip.BLE else 1

    def fifo_on(self):
        return (self.registers[chip.FIFO_CTRL5_3TRC] == self.output_code() << 3 | 0x06
                and self.registers[chip.FIFO_CTRL3_3TRC] == 0x09)

    def fifo_frame(self, k):
        return words(self.counts, (3, 4, 5, 0, 1, 2), self.high())

    def show_level(self):
        level = len(self.memory.bytes) // 2
        pattern = -level % 6
        self.registers[chip.FIFO_STATUS1:chip.FIFO_STATUS1 + 4] = bytes(
            [level & 0xFF, level >> 8 | (0x40 if self.memory.lost else 0), pattern, 0])

    def accel_bandwidth(self, hz):
        setting = self.registers[chip.CTRL8_XL]
        if not setting & 0x80:
            return hz / (4 if self.registers[chip.CTRL1_XL] & 0x02 else 2)
        return hz / (50, 100, 9, 400)[setting >> 5 & 3]

    def gyro_bandwidth(self, hz):
        for rate, bandwidth in self.driver.GYRO_LPF2:
            if rate == hz:
                return bandwidth
        return dict(self.driver.GYRO_LPF1).get(
            self.registers[chip.CTRL6_C] & 3, (293, 505, 925))[(833, 1667, 3333).index(hz)]


SIMULATED = {"lsm6dsox": SimulatedLSM6DSOX, "lsm6ds3trc": SimulatedLSM6DS3TRC}
