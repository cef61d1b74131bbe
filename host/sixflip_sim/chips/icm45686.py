"""Simulated ICM-45686, by the driver's own tables."""

from sixflip.chips import icm45686 as chip
from sixflip_sim.chips.fifo import packet
from sixflip_sim.chips.six_axis import SimulatedSixAxis, range_of, rate_of


class SimulatedICM45686(SimulatedSixAxis):
    """Both sensors are off after a reset; filters and byte order stand behind IREG_ADDR."""

    driver = chip.ICM45686
    id_register, data_register = driver.ID_REGISTER, driver.DATA
    columns, high_byte = driver.COLUMNS, driver.HIGH
    self_clearing = (chip.REG_MISC2, chip.RESET)
    nominal_hz = (50, 50)
    TRAPS = ((chip.PWR_MGMT0, 0), (chip.ACCEL_CONFIG0, 0x07),
             (chip.IREG_ADDR, (chip.SREG_CTRL >> 8, chip.SREG_CTRL & 0xFF, chip.BIG_ENDIAN)))
    cleared_by_data = False
    FIFO_BYTES, FIFO_FRAME = 2048, 16
    defaults = {chip.ACCEL_CONFIG0: 0x06, chip.GYRO_CONFIG0: 0x06}

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self.indirect = {}          # register: value; 0 where nobody has written

    def fall_asleep(self):
        self.registers[chip.PWR_MGMT0] = 0

    def _where(self):
        return self.registers[chip.IREG_ADDR] << 8 | self.registers[chip.IREG_ADDR + 1]

    def write_register(self, register, value):
        if register == chip.REG_MISC2 and value & chip.RESET and not self.resetting():
            self.reset()
        elif register == chip.IREG_DATA and not self.resetting():
            self.indirect[self._where()] = value
        elif register == chip.FIFO_CONFIG2:
            self.memory.clear()
        elif register != chip.INT1_STATUS0:
            if register == chip.FIFO_CONFIG0 and self.registers[chip.FIFO_CONFIG3] & chip.FIFO_ON:
                return              # the mode is to be chosen while it is off
            SimulatedSixAxis.write_register(self, register, value)

    def read_into(self, buf):
        start = self.pointer
        SimulatedSixAxis.read_into(self, buf)
        if start == chip.FIFO_CONFIG2:
            buf[0] &= ~chip.FLUSH & 0xFF    # at once
        elif start == chip.IREG_DATA:
            buf[0] = self.indirect.get(self._where(), 0)
        elif start == chip.REG_MISC2:
            buf[0] = chip.RESET if self.resetting() else 1

    def after_read(self, register, n):
        """The level that is read is the one of the reading before (AN-000364)."""
        SimulatedSixAxis.after_read(self, register, n)
        if register == chip.FIFO_COUNT_0:
            self.memory.fill()
            level = len(self.memory.bytes) // 16
            self.registers[chip.FIFO_COUNT_0] = level & 0xFF
            self.registers[chip.FIFO_COUNT_0 + 1] = level >> 8

    def fifo_on(self):
        return (self.registers[chip.FIFO_CONFIG0] == chip.STREAM | chip.DEPTH_2_KB
                and self.registers[chip.FIFO_CONFIG3] == chip.BOTH_IN_FIFO | chip.FIFO_ON)

    def fifo_frame(self, k):
        return packet(self.counts, self.high(), k)

    def high(self):
        return 0 if self.indirect.get(chip.SREG_CTRL, 0) & chip.BIG_ENDIAN else 1

    def output_hz(self):
        code = self.registers[chip.GYRO_CONFIG0] & 15
        if (self.registers[chip.PWR_MGMT0] != chip.LOW_NOISE
                or self.registers[chip.ACCEL_CONFIG0] & 15 != code):
            return 0
        return rate_of(chip.OUTPUT_RATES, code)

    def _bandwidth(self, register):
        part = (2, 4, 8, 16, 32, 64, 128, 128)[self.indirect.get(register, 0) & 7]
        return self.output_hz() / part

    def accel(self):
        return (range_of(chip.ACCEL_RANGES, self.registers[chip.ACCEL_CONFIG0] >> 4 & 7),
                self._bandwidth(chip.ACCEL_LPF))

    def gyro(self):
        return (range_of(chip.GYRO_RANGES, self.registers[chip.GYRO_CONFIG0] >> 4),
                self._bandwidth(chip.GYRO_LPF))


SIMULATED = {"icm45686": SimulatedICM45686}
