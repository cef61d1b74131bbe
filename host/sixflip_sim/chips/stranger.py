"""A chip that answers its identification and nothing else: for what is recognised, not driven."""

from sixflip_sim.chips.register_chip import RegisterChip


class Stranger(RegisterChip):
    """Register id_register of the chip at the address always reads who_am_i."""

    def __init__(self, clock, address, id_register, who_am_i):
        self.id_register = id_register
        self.who_am_i = who_am_i
        RegisterChip.__init__(self, address, clock)

    def power_on(self):
        RegisterChip.power_on(self)
        self.registers[self.id_register] = self.who_am_i

    def write_register(self, register, value):
        if register != self.id_register:
            self.registers[register] = value
