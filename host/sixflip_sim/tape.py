"""A chip that plays bursts computed beforehand: for tests of memory and of speed.

Nothing here allocates while sampling, so a sampling loop can run under
micropython.heap_lock(), and a whole session needs no simulator in the heap: record() on one
machine (or interpreter), play the file on another.
"""

from sixflip_sim.chips.register_chip import RegisterChip


class TapeChip(RegisterChip):
    """Answers bursts of `length` at data_register from tape, an object with readinto (an
    open binary file, io.BytesIO); the last burst is repeated when the tape ends. Other
    registers keep what is written, bits of self_clearing excepted.

    identity: {register: value}; self_clearing: {register: mask}, a reset that is over at once.
    """

    def __init__(self, address, data_register, length, tape, identity, self_clearing):
        self.data_register = data_register
        self.length = length
        self.identity = identity
        self.self_clearing = self_clearing
        self.played = 0
        self._tape = tape
        self._burst = bytearray(length)
        RegisterChip.__init__(self, address, None)

    def power_on(self):
        RegisterChip.power_on(self)
        for register in self.identity:
            self.registers[register] = self.identity[register]

    def write_register(self, register, value):
        self.registers[register] = value & ~self.self_clearing.get(register, 0) & 0xFF

    def read_into(self, buf):
        if self.pointer == self.data_register and len(buf) == self.length:
            if self._tape.readinto(self._burst) == self.length:
                self.played += 1
            source = self._burst
            start = 0
        else:
            source = self.registers
            start = self.pointer
        for i in range(len(buf)):
            buf[i] = source[start + i]


class TapeI2C:
    """machine.I2C's methods, as far as drivers and probe use them, over TapeChips."""

    def __init__(self, chips):
        self.chips = chips

    def _chip(self, address):
        for chip in self.chips:
            if chip.address == address:
                return chip
        raise OSError(19)       # ENODEV

    def readfrom_mem_into(self, address, register, buf):
        chip = self._chip(address)
        chip.pointer = register
        chip.read_into(buf)

    def readfrom_mem(self, address, register, n):
        buf = bytearray(n)
        self.readfrom_mem_into(address, register, buf)
        return bytes(buf)

    def writeto_mem(self, address, register, data):
        chip = self._chip(address)
        chip.pointer = register
        chip.write(data)

    def pulse_scl(self):
        """A tape's bus is never stuck."""


def described(sensor):
    """[(address, data register, bytes of a burst, {register: identification}, {register: bits
    that clear themselves})] of a sensor's chips, accelerometer first."""
    from sixflip.chips import catalogue
    from sixflip_sim import worlds
    found = []
    for name in worlds.parts_of(sensor):
        chip, row = worlds.simulated(name), catalogue.row_of(name)
        found.append((row[2][0], chip.data_register, chip.data_length,
                      {chip.id_register: min(row[4])},
                      dict([chip.self_clearing]) if chip.self_clearing else {}))
    return found


def open_tape(sensor, files):
    """TapeI2C of a sensor; files: one for each of its chips, accelerometer first."""
    return TapeI2C([TapeChip(address, data_register, length, file, identity, clearing)
                    for (address, data_register, length, identity, clearing), file
                    in zip(described(sensor), files)])


def record(world, files, rate_hz=100, seconds=None):
    """Poll a world as the drivers would and write the bursts of each chip to its file (or
    io.BytesIO); number of samples. seconds: None is until the operator has finished."""
    from sixflip.chips import probe
    clock = world.clock
    imu = probe.find(world.i2c, clock.sleep_ms)[0]
    imu.configure(rate_hz)
    chips = [c for c in world.chips if hasattr(c, "model")]
    registers = [(c, c.data_register, bytearray(c.data_length)) for c in chips]
    start = clock.now_us()
    end = world.end_us if seconds is None else start + int(seconds * 1e6)
    n = 0
    while clock.now_us() < end:
        n += 1
        clock.sleep_us(start + n * 1000000 // rate_hz - clock.now_us())
        for i, (chip, register, burst) in enumerate(registers):
            world.i2c.readfrom_mem_into(chip.address, register, burst)
            files[i].write(burst)
    return n
