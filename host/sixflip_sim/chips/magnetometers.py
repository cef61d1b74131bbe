"""Simulated magnetometers: they answer their identification, that is all we ask of them."""

from sixflip.chips import magnetometers as chip
from sixflip_sim.chips.register_chip import RegisterChip


class SimulatedMagnetometer(RegisterChip):
    """name: "HMC5883L" or "QMC5883L"."""

    def __init__(self, clock, name):
        known = [entry[1:] for entry in chip.KNOWN if entry[0] == name]
        if not known:
            raise ValueError("magnetometer is %r, expected HMC5883L or QMC5883L" % name)
        address, self.id_register, self.identification = known[0]
        RegisterChip.__init__(self, address, clock, 16)

    def power_on(self):
        RegisterChip.power_on(self)
        for i in range(len(self.identification)):
            self.registers[self.id_register + i] = self.identification[i]
