"""Simulated chips on the wires of the emulated I2C peripheral: one object for all addresses.

The peripheral asks byte by byte. A transaction begins with START: there the world's clock is
set to the emulated time, and it stands still until the next START, so that a burst is of one
sample, as the shadow registers of the real chips keep it. Bytes take no emulated time.
"""

SDA, SCL = 4, 5  # GP4 and GP5, as in the firmware's file for the board
TX_EMPTY = 1 << 4  # IC_RAW_INTR_STAT, RP2040 datasheet 4.3.17
HELD_NS = 55000000  # a chip that stretches the clock beyond the driver's 50 ms


class ChipsOnI2C:
    """An external device of rp2040py: attach(rp2040) puts a world's chips on I2C0.

    Of the faults of sixflip_sim.faults those of whole transactions happen here; torn and
    repeated bursts do not, a byte at a time has no burst to compare with.

    transactions, refused  how many were begun, and how many nobody acknowledged
    """

    def __init__(self, world):
        self.mcu = None
        self.transactions = self.refused = 0
        self.power_up(world)

    def attach(self, rp2040):
        self.mcu = rp2040
        i2c = self.i2c = rp2040.i2c[0]
        i2c.on_start = self.start
        i2c.on_connect = self.connect
        i2c.on_write_byte = self.write_byte
        i2c.on_read_byte = self.read_byte
        i2c.on_stop = self.stop
        rp2040.gpio[SCL].add_listener(self.scl_changed)
        self.let_go = rp2040.clock.create_alarm(self.release)
        self.power_up(self.world)

    def power_up(self, world):
        """Chips after power-up, and the box where it lies in the beginning of its session."""
        self.world = world
        self.chip = None
        self.number_follows = False
        self.active = ()
        self.began_ns = self.mcu.clock.nanos if self.mcu else 0
        if self.mcu:
            self.let_go.cancel()
            for line in (SDA, SCL):
                self.pull(line, True)

    def now_us(self):
        """Emulated time since the world began."""
        return int(self.mcu.clock.nanos - self.began_ns) // 1000

    # -- what the peripheral asks

    def start(self, repeated):
        clock = self.world.clock
        clock.advance_ns(1000 * max(0, self.now_us() - clock.now_us()))
        self.transactions += 1
        self.i2c.complete_start()

    def connect(self, address, mode):
        chip = self.find(address)
        self.active = self.faults_due(address, chip, bool(mode))
        if self.held():
            return  # not completed: the driver runs into its time-out
        if chip is None or not chip.plugged or "nak" in self.active:
            self.refuse()
            return
        self.chip = chip
        self.number_follows = not mode
        self.i2c.complete_connect(True)

    def write_byte(self, value):
        if self.number_follows:
            self.chip.select(value)
            self.number_follows = False
        elif "data_nak" in self.active:
            self.i2c.complete_write(False)
            return
        else:
            self.chip.write(bytes((value,)))
        self.i2c.complete_write(True)

    def read_byte(self, acknowledged):
        byte = bytearray(1)
        self.chip.read_into(byte)
        if "wrong_id" in self.active:
            byte[0] = self.world.i2c.faults.wrong_id
        self.i2c.complete_read(byte[0])

    def stop(self):
        self.chip = None
        self.i2c.complete_stop()

    # -- what is on the wires

    def pull(self, line, level):
        """Up by the module's resistor, which is stronger than a pad's own, or down by a chip."""
        self.mcu.gpio[line].set_input_value(level)

    def find(self, address):
        for chip in self.world.chips:
            if chip.address == address:
                return chip
        return None

    def faults_due(self, address, chip, reading):
        """Kinds of faults that hit this transaction."""
        bus = self.world.i2c
        register = chip.pointer if chip and reading else -1
        active = bus.faults.due(bus, bus.transactions, address, register, 1, not reading)
        bus.transactions += 1
        return active

    def refuse(self):
        self.refused += 1
        # The FIFO was flushed, so it is empty; the emulator does not say so, and the driver
        # would wait for that bit until its time-out instead of seeing the refusal (EIO).
        self.i2c.int_raw |= TX_EMPTY
        self.i2c.complete_connect(False)

    def held(self):
        """True when a chip holds a line low, from now on if need be."""
        stuck = self.world.i2c.stuck_pulses
        if stuck:
            self.pull(SDA, False)
        elif "timeout" in self.active:
            self.let_go.schedule(HELD_NS)
        return bool(stuck or "timeout" in self.active)

    def scl_changed(self, level, before):
        """A clock pulse made by hand ends: after enough of them the chip lets go of SDA."""
        bus = self.world.i2c
        if bus.stuck_pulses and before == before.LOW:
            bus.pulse_scl()
            if not bus.stuck_pulses:
                self.pull(SDA, True)
                self.i2c.reset()  # as the driver does next, which the emulator does not notice

    def release(self):
        """SCL is let go of, and the peripheral goes on with what waits in its FIFO."""
        self.stop()
