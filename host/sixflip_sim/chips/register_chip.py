"""A chip with an address, eight-bit registers and a pointer which counts up in a burst."""


class RegisterChip:
    """Base of the simulated chips; the bus calls select, write and read_into.

    id_register: where the identification is (faults of the bus aim at it); high_byte: 0 or 1,
    which byte of a reading's word is the high one. What a tape needs to stand for the chip:
    data_register and data_length of a burst, columns of a sample in its order, self_clearing,
    the register of the reset and its bits, which read 0 when it is over.
    """

    data_register = data_length = 0
    columns = ()
    self_clearing = None

    id_register = 0
    high_byte = 0

    def __init__(self, address, clock, size=128):
        self.address = address
        self.clock = clock
        self.registers = bytearray(size)
        self.pointer = 0
        self.plugged = True
        self.frozen = False         # a stuck chip: answers, but its readings never change
        self.power_on()

    def power_on(self):
        """Every register to its value after power-up."""
        for i in range(len(self.registers)):
            self.registers[i] = 0

    def reachable(self):
        """Whether it listens on this bus, as its registers are set."""
        return True

    def fall_asleep(self):
        """What a glitch on the supply can do without a full reset."""

    def select(self, register):
        self.pointer = register

    def write(self, data):
        """Bytes after the register's number, one register after the other."""
        for value in data:
            self.write_register(self.pointer, value)
            self.pointer = (self.pointer + 1) % len(self.registers)

    def write_register(self, register, value):
        self.registers[register] = value

    def refresh(self, register, n):
        """Called before a read of n registers: take over a new sample if there is one."""

    def after_read(self, register, n):
        """Called after a read: bits that reading clears."""

    def read_into(self, buf):
        """Fill buf from the pointer on; one transaction sees one sample (shadow registers)."""
        n = len(buf)
        start = self.pointer
        self.refresh(start, n)
        end = start + n
        size = len(self.registers)
        if end <= size:
            buf[:] = self.registers[start:end]
        else:
            for i in range(n):
                buf[i] = self.registers[(start + i) % size]
        self.after_read(start, n)
        self.pointer = end % size
