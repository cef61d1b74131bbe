"""What the simulated chips of sixflip.chips.six_axis have in common."""

import math

from sixflip import RAIL
from sixflip.chips.six_axis import BURST
from sixflip_sim.chips.fifo import Memory, words
from sixflip_sim.chips.register_chip import RegisterChip


class SimulatedSixAxis(RegisterChip):
    """Sample k is taken at k output periods of the world's clock and held until the next.

    Subclasses name the driver whose tables they go by, and say what their registers mean:
    output_hz() (0: asleep), accel() and gyro() -> (counts per unit, bandwidth in Hz), high().
    nominal_hz are the bandwidths for which the model's noise holds, those of 100 Hz polling;
    RESET_US is how long a reset takes.
    """

    driver = None
    data_length = BURST
    nominal_hz = (50, 50)
    RESET_US = 1000
    TRAPS = ()                  # (register, value or values), ...: what others may have written
    cleared_by_data = True      # of the bits of ready: by reading the sample, or by reading them
    clock_off = 0.0             # %, of the oscillator: a sample takes so much less time
    FIFO_BYTES = FIFO_FRAME = 0  # of the memory and of a sample in it; 0: it is not simulated
    no_i2c = (0, 0)             # the register and the bits that shut I2C off, for SPI
    spi = False                 # whether this one is wired so

    def __init__(self, clock, model, address, who_am_i, size=128):
        self.model = model
        self.who_am_i = who_am_i
        self.counts = [0] * 7
        self.temperature = self.driver.TEMPERATURE
        self._reset_until_us = -1
        self.memory = Memory(self, self.FIFO_BYTES, self.FIFO_FRAME) if self.FIFO_BYTES else None
        RegisterChip.__init__(self, address, clock, size)

    def power_on(self):
        RegisterChip.power_on(self)
        self._k = -1
        if self.memory:
            self.memory.clear()
        self.registers[self.id_register] = self.who_am_i
        for register in self.defaults:
            self.registers[register] = self.defaults[register]

    defaults = {}               # registers that are not 0 after a reset

    def reset(self):
        """By a register: everything to its default; it takes RESET_US."""
        self.power_on()
        self._reset_until_us = self.clock.now_us() + self.RESET_US

    def resetting(self):
        return self.clock.now_us() < self._reset_until_us

    def read_only(self, register):
        data = self.data_register
        return register == self.id_register or data <= register < data + self.data_length

    def write_register(self, register, value):
        if not self.resetting() and not self.read_only(register):
            self.registers[register] = value

    def counts_up(self):
        """Whether a transfer goes on to the next register, as the registers are set."""
        return True

    def write(self, data):
        start = self.pointer
        RegisterChip.write(self, data if self.counts_up() else data[:1])
        if not self.counts_up():
            for value in data[1:]:
                self.write_register(start, value)
            self.pointer = start

    def read_into(self, buf):
        if self.read_memory(buf):
            return
        start = self.pointer
        if self.counts_up() or len(buf) == 1:
            RegisterChip.read_into(self, buf)
            return
        self.refresh(start, 1)
        for i in range(len(buf)):
            buf[i] = self.registers[start]

    def high(self):
        """Which byte of a word is the high one, as the registers are set."""
        return self.driver.HIGH

    def refresh(self, register, n):
        period_ns = self.period_ns()
        status, bits = self.driver.READY
        if (self.frozen or not period_ns or self.resetting()
                or not (register <= status < register + n
                        or self.data_register - n < register
                        < self.data_register + self.data_length)):
            return
        k = self.clock.now_us() * 1000 // period_ns
        if k == self._k:
            return
        self._k = k
        self._take(k, k * period_ns // 1000)
        self.registers[status] |= bits

    def period_ns(self):
        """From one sample to the next; 0: asleep."""
        hz = self.output_hz()
        return round(1e9 / hz / (1 + 0.01 * self.clock_off)) if hz else 0

    def measure(self, k, t_us):
        """Sample k into self.counts."""
        counts, model = self.counts, self.model
        lsb, hz = self.accel()
        model.accel_counts(k, t_us, lsb, RAIL, math.sqrt(hz / self.nominal_hz[0]), counts)
        self.shift(counts, lsb)
        lsb, hz = self.gyro()
        model.gyro_counts(k, t_us, lsb, RAIL, math.sqrt(hz / self.nominal_hz[1]), counts)
        self.shift_gyro(counts, lsb)
        model.temp_counts(k, t_us, self.temperature[0], self.temperature[1], counts)

    def _take(self, k, t_us):
        self.measure(k, t_us)
        data = words(self.counts, self.columns, self.high())
        at = self.data_register
        for column in self.columns:
            if column is not None:
                self.registers[at:at + 2] = data[at - self.data_register:][:2]
            at += 2

    def reachable(self):
        register, bits = self.no_i2c
        return self.spi or not bits or self.registers[register] & bits != bits

    def fifo_on(self):
        """Whether samples go into the memory, as the registers are set."""
        return False

    def fifo_frame(self, k):
        """Bytes of sample k, which is in self.counts."""
        return words(self.counts, self.columns, self.high())

    def read_memory(self, buf):
        """Whether the pointer stands at the memory; then buf is filled from it."""
        if not self.memory or self.pointer != self.driver.FIFO_DATA or not self.fifo_on():
            return False
        self.memory.fill()
        self.memory.take(buf)
        return True

    def shift(self, counts, lsb_per_g):
        """What offset registers add to the accelerometer's counts."""

    def shift_gyro(self, counts, lsb_per_dps):
        """What offset registers add to the gyro's counts."""

    def after_read(self, register, n):
        status, bits = self.driver.READY
        seen = self.data_register if self.cleared_by_data else status
        if register <= seen < register + n:
            self.registers[status] &= ~bits & 0xFF


def range_of(ranges, bits):
    """Counts per unit of the range with these bits; of the widest where there is none."""
    for row in ranges:
        if row[2] == bits:
            return row[1]
    return ranges[-1][1]


def rate_of(rates, bits):
    """Hz of the output rate with these bits; 0 where there is none."""
    for row in rates:
        if row[1] == bits:
            return row[0]
    return 0
