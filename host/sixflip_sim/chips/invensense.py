"""What the simulated MPU6050 and ITG3205 have in common: sleep, reset, divider, data ready."""

from sixflip_sim.chips.register_chip import RegisterChip

RESET = 0x80
SLEEP = 0x40
_RESET_US = 5000            # the reset bit stays up that long


class InvenSense(RegisterChip):
    """Subclasses name the registers and say what a sample is.

    Sample k is taken at k times the sample period of the world's clock and held until the
    next; a sleeping chip keeps its last reading, all zeros after a reset.
    """

    power_register = 0
    divider_register = 0
    filter_register = 0
    status_register = 0
    data_register = 0
    data_length = 0
    clock_off = 0.0             # %, of the oscillator: a sample takes so much less time

    def __init__(self, address, clock, model):
        self.model = model
        self.counts = [0] * 7
        self._reset_until_us = -1
        RegisterChip.__init__(self, address, clock)

    def power_on(self):
        RegisterChip.power_on(self)
        self._k = -1

    def fall_asleep(self):
        self.registers[self.power_register] |= SLEEP

    def period_us(self):
        """Sample period: 1 kHz behind a filter, 8 kHz without, divided."""
        base = 125 if self.registers[self.filter_register] & 7 in (0, 7) else 1000
        period = base * (1 + self.registers[self.divider_register])
        return round(period / (1 + 0.01 * self.clock_off)) if self.clock_off else period

    def write_register(self, register, value):
        if self._resetting():
            return
        if register == self.power_register and value & RESET:
            self.power_on()
            self._reset_until_us = self.clock.now_us() + _RESET_US
        elif not self.read_only(register):
            self.registers[register] = value

    def read_only(self, register):
        data = self.data_register
        return (register in (self.id_register, self.status_register)
                or data <= register < data + self.data_length)

    def _resetting(self):
        return self.clock.now_us() < self._reset_until_us

    def read_into(self, buf):
        start = self.pointer
        RegisterChip.read_into(self, buf)
        if start <= self.power_register < start + len(buf) and self._resetting():
            buf[self.power_register - start] |= RESET

    def refresh(self, register, n):
        if (self.frozen or self.registers[self.power_register] & SLEEP or self._resetting()
                or register + n <= self.status_register
                or register >= self.data_register + self.data_length):
            return
        period = self.period_us()
        k = self.clock.now_us() // period
        if k == self._k:
            return
        self._k = k
        self.sample(k, k * period)
        self.registers[self.status_register] |= 1

    def sample(self, k, t_us):
        """Put sample k into the data registers."""

    def after_read(self, register, n):
        if register <= self.status_register < register + n:
            self.registers[self.status_register] &= 0xFE

    def store(self, columns):
        """Big-endian words of self.counts in the given order into the data registers."""
        registers = self.registers
        i = self.data_register
        for column in columns:
            count = self.counts[column]
            registers[i] = count >> 8 & 0xFF
            registers[i + 1] = count & 0xFF
            i += 2
