"""Two chips wired to one bus at the same address: both obey, both pull the lines low."""


class SharedAddress:
    """first, second: RegisterChips. A bit reads 1 only where both chips let the line go."""

    frozen = False
    plugged = True
    high_byte = 0

    def __init__(self, first, second):
        self.chips = (first, second)
        self.address = first.address
        self.id_register = first.id_register

    def reachable(self):
        return True

    def power_on(self):
        for chip in self.chips:
            chip.power_on()

    def fall_asleep(self):
        for chip in self.chips:
            chip.fall_asleep()

    def select(self, register):
        for chip in self.chips:
            chip.select(register)

    def write(self, data):
        for chip in self.chips:
            chip.write(data)

    def read_into(self, buf):
        other = bytearray(len(buf))
        self.chips[0].read_into(buf)
        self.chips[1].read_into(other)
        for i in range(len(buf)):
            buf[i] &= other[i]
