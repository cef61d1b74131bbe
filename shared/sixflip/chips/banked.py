"""Registers in banks: bank b, register r is written 0x100 * b + r in the drivers' tables.

Bank 0 has the samples and the identification, so it is what a driver leaves selected. Another
bank may be selected all the same: a board that was reset in between, a bank switch that was lost.
"""

from sixflip.chips.six_axis import SixAxis


class Banked(SixAxis):
    """BANK: the register that selects, which every bank has; SHIFT: where its bits begin."""

    BANK = SHIFT = 0

    def __init__(self, *args, **more):
        SixAxis.__init__(self, *args, **more)
        self._bank = -1             # the one selected; -1: not known
        self._select = bytearray(1)

    def _turn_to(self, bank):
        if bank != self._bank:
            self._bank = -1
            self._select[0] = bank << self.SHIFT
            self._i2c.writeto_mem(self.address, self.BANK, self._select)
            self._bank = bank

    def _fetch(self, register, buf):
        self._turn_to(register >> 8)
        SixAxis._fetch(self, register & 0xFF, buf)

    def _store(self, register, buf):
        self._turn_to(register >> 8)
        SixAxis._store(self, register & 0xFF, buf)

    def answers(self, i2c):
        """As any chip's, whichever bank was left selected."""
        self._bank = -1
        return SixAxis.answers(self, i2c)

    def awake(self):
        """As any chip's; and bank 0 is selected, which its identification shows."""
        self._bank = -1
        return SixAxis.awake(self) and self._read(self.ID_REGISTER) == self.who_am_i[0]

    def read_into(self, sample):
        """A sample, from bank 0."""
        if self._bank:
            self._turn_to(0)
        return SixAxis.read_into(self, sample)
