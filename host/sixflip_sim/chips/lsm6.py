"""What the simulated LSM6 chips have in common, by the drivers' own tables."""

from sixflip.chips import lsm6 as chip
from sixflip_sim.chips.fifo import tagged
from sixflip_sim.chips.six_axis import SimulatedSixAxis

HIDDEN = 0x80               # FUNC_CFG_ACCESS: the embedded functions' registers are shown


class SimulatedLSM6(SimulatedSixAxis):
    """Powered down after a reset: the output rates are 0. With IF_INC off a burst reads one
    register over and over, with BLE on the bytes are the other way round, and behind
    FUNC_CFG_ACCESS stand other registers, the identification not among them."""

    self_clearing = (chip.CTRL3, chip.SW_RESET)
    FIFO_FRAME = 14
    OFFSETS_BIT = None          # register and bit that let X_OFS_USR count; None: always

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self._hidden = bytearray(len(self.registers))

    def counts_up(self):
        return self.registers[chip.CTRL3] & chip.IF_INC

    def write_register(self, register, value):
        if self._is_hidden(register):
            self._hidden[register] = value
        elif register == chip.CTRL3 and value & chip.SW_RESET and not self.resetting():
            self.reset()
        elif register != chip.STATUS_REG:
            SimulatedSixAxis.write_register(self, register, value)
            if register == chip.FIFO_CTRL4 and not value & 0x07:
                self.memory.clear()

    def _is_hidden(self, register):
        return (self.registers[chip.FUNC_CFG_ACCESS] & HIDDEN
                and register != chip.FUNC_CFG_ACCESS)

    def read_into(self, buf):
        start = self.pointer
        if self._is_hidden(start):
            for i in range(len(buf)):
                buf[i] = self._hidden[(start + i) % len(self._hidden)]
        else:
            SimulatedSixAxis.read_into(self, buf)
        if start == chip.CTRL3 and self.resetting():
            buf[0] |= chip.SW_RESET

    def shift(self, counts, lsb_per_g):
        if self.OFFSETS_BIT and not self.registers[self.OFFSETS_BIT[0]] & self.OFFSETS_BIT[1]:
            return
        for axis in range(3):   # 2^-10 g a count, signed, subtracted
            offset = (self.registers[chip.X_OFS_USR + axis] ^ 0x80) - 0x80
            counts[axis] -= int(offset * lsb_per_g) >> 10

    def refresh(self, register, n):
        SimulatedSixAxis.refresh(self, register, n)
        if register == self.driver.FIFO_STATUS:
            self.memory.fill()
            self.show_level()

    def show_level(self):
        """FIFO_STATUS1 and 2: words in the memory, and whether some were overwritten."""
        words = len(self.memory.bytes) // 7
        self.registers[self.driver.FIFO_STATUS] = words & 0xFF
        self.registers[self.driver.FIFO_STATUS + 1] = (
            words >> 8 & self.driver.LEVEL_HIGH | (chip.OVERRUN if self.memory.lost else 0))

    def after_read(self, register, n):
        SimulatedSixAxis.after_read(self, register, n)
        if register == self.driver.FIFO_STATUS:
            self.memory.lost = False

    def fifo_on(self):
        """Both sensors at the output rate, the oldest overwritten; else it is not simulated."""
        return (self.registers[chip.FIFO_CTRL4] & 0x07 == chip.STREAM
                and self.registers[chip.FIFO_CTRL3] == 0x11 * self.output_code())

    def fifo_frame(self, k):
        return (tagged(1, self.counts, (3, 4, 5), k) + tagged(2, self.counts, (0, 1, 2), k))
