"""Simulated registers in banks: only bank 0 has samples and identification."""

from sixflip_sim.chips.six_axis import SimulatedSixAxis


class SimulatedBanked(SimulatedSixAxis):
    """bank(b) are the registers of another bank; driver.BANK, in every bank, selects."""

    def power_on(self):
        SimulatedSixAxis.power_on(self)
        self._banks = {}
        self.selected = 0

    def bank(self, number):
        if number not in self._banks:
            self._banks[number] = bytearray(len(self.registers))
        return self._banks[number]

    def write_register(self, register, value):
        if self.resetting():
            return
        if register == self.driver.BANK:
            self.selected = value >> self.driver.SHIFT & 7
            self.registers[register] = value
        elif self.selected:
            self.bank(self.selected)[register] = value
        else:
            self.write_first(register, value)

    def write_first(self, register, value):
        """A register of bank 0 is written."""
        SimulatedSixAxis.write_register(self, register, value)

    def read_into(self, buf):
        start = self.pointer
        if not self.selected:
            SimulatedSixAxis.read_into(self, buf)
            return
        shown = self.bank(self.selected)
        for i in range(len(buf)):
            register = (start + i) % len(shown)
            buf[i] = self.registers[register] if register == self.driver.BANK else shown[register]


def signed(word, bits):
    """A number of so many bits with its sign."""
    half = 1 << (bits - 1)
    return ((word & (2 * half - 1)) ^ half) - half
