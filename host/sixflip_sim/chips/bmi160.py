"""Simulated BMI160, by the driver's own tables."""

from sixflip.chips import bmi160 as chip
from sixflip_sim.chips.fifo import words
from sixflip_sim.chips.six_axis import SimulatedSixAxis, range_of, rate_of

_TAKES_US = {chip.ACCEL_ON: 3800, chip.GYRO_ON: 80000}


class SimulatedBMI160(SimulatedSixAxis):
    """Both sensors are suspended after a reset, and wake by a command that takes its time."""

    driver = chip.BMI160
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    data_length = 2 * len(columns)
    self_clearing = (chip.CMD, 0xFF)
    nominal_hz = (40.5, 40.5)
    TRAPS = ((chip.ACC_CONF, 0x2B), (chip.CMD, 0x10), (chip.GYR_CONF + 1, 0))
    FIFO_BYTES, FIFO_FRAME = 1020, 12       # 1024, of whole frames
    defaults = {chip.ACC_CONF: 0x28, chip.ACC_CONF + 1: 3, chip.GYR_CONF: 0x28, 0x45: 0x88,
                chip.FIFO_CONFIG_1: 0x10, chip.OFFSET + 6: 0xC0}

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self._awake_us = {}         # command: when it is carried out

    def fall_asleep(self):
        self._awake_us = {}
        self.registers[chip.PMU_STATUS] = 0

    def read_only(self, register):
        return register in (chip.PMU_STATUS, chip.STATUS) or \
            SimulatedSixAxis.read_only(self, register)

    def write_register(self, register, value):
        if register != chip.CMD:
            SimulatedSixAxis.write_register(self, register, value)
        elif value == chip.SOFT_RESET:
            self.reset()
        elif value == chip.FIFO_FLUSH:
            self.memory.clear()
        elif value in _TAKES_US and not self.resetting():
            self._awake_us[value] = self.clock.now_us() + _TAKES_US[value]
        elif value & 0xFC in (0x10, 0x14):  # to suspend, at once
            self._awake_us.pop(value | 1, None)

    def refresh(self, register, n):
        now = self.clock.now_us()
        status = 0
        for command, bits in ((chip.ACCEL_ON, 0x10), (chip.GYRO_ON, 0x04)):
            if self._awake_us.get(command, now + 1) <= now:
                status |= bits
        self.registers[chip.PMU_STATUS] = status
        SimulatedSixAxis.refresh(self, register, n)
        self.memory.fill()
        level = len(self.memory.bytes)
        self.registers[chip.FIFO_LENGTH] = level & 0xFF
        self.registers[chip.FIFO_LENGTH + 1] = level >> 8

    def fifo_on(self):
        return self.registers[chip.FIFO_CONFIG_1] == chip.BOTH_IN_FIFO

    def fifo_frame(self, k):
        return words(self.counts, (3, 4, 5, 0, 1, 2), 1)

    def output_hz(self):
        code = self.registers[chip.GYR_CONF] & 15
        if (self.registers[chip.PMU_STATUS] != chip.BOTH_NORMAL
                or self.registers[chip.ACC_CONF] & 15 != code):
            return 0
        return rate_of(chip.OUTPUT_RATES, code)

    def _bandwidth(self, register):
        return self.output_hz() * dict(chip.FILTERS).get(self.registers[register] >> 4 & 7, 0.405)

    def accel(self):
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.ACC_CONF + 1] & 15),
                self._bandwidth(chip.ACC_CONF))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.GYR_CONF + 1] & 7),
                self._bandwidth(chip.GYR_CONF))

    def shift(self, counts, lsb_per_g):
        if self.registers[chip.OFFSET + 6] & 0x40:      # 3.9 mg a count, signed
            for axis in range(3):
                offset = (self.registers[chip.OFFSET + axis] ^ 0x80) - 0x80
                counts[axis] += int(offset * lsb_per_g) * 39 // 10000


SIMULATED = {"bmi160": SimulatedBMI160}
