"""A simulated chip on SPI: what machine.SPI and its select pin do, over a simulated bus.

Only the chips that are driven on SPI are told apart from others by sixflip.chips.catalogue; any
register chip answers here. Nobody acknowledges on SPI: where the I2C bus would raise an error,
the line reads high. A wrong mode samples on the other edge: every byte is late by a bit.
"""


class SimulatedSPI:
    """bus: a SimulatedI2C, whose chips, clock and faults are used; its first chip is selected by
    the line. mode: 0 to 3."""

    def __init__(self, bus, mode):
        self.bus = bus
        self.mode = mode
        self._register = None       # of the transfer that runs
        self._last = 0
        for chip in bus.chips:
            chip.spi = True

    def select(self, level):
        """The select line is low while a transfer runs."""
        self._register = None

    def write(self, data):
        if self._register is None:
            self._register = data[0]
            data = data[1:]
        if not len(data) or self.mode not in (0, 3):
            return
        try:
            if not self._register & 0x80:
                self.bus.writeto_mem(self._address(), self._register, data)
        except OSError:
            return                  # it went to nobody

    def readinto(self, buf, write=0):
        try:
            self.bus.readfrom_mem_into(self._address(), self._register & 0x7F, buf)
        except OSError:
            for i in range(len(buf)):
                buf[i] = 0xFF
            return
        if self.mode not in (0, 3):
            late = self._last
            for i in range(len(buf)):
                late, buf[i] = buf[i] & 1, buf[i] >> 1 | late << 7

    def _address(self):
        if not self.bus.chips:
            raise OSError(19)       # ENODEV
        return self.bus.chips[0].address
