"""The register accesses of the Pico's I2C driver, made by hand.

As i2c_write_blocking_internal and i2c_read_blocking_internal of pico-sdk 1.5.1
(src/rp2_common/hardware_i2c/i2c.c), the errors as machine_i2c.c of MicroPython 1.21 to 1.25.
"""

EIO, ETIMEDOUT = 5, 110
CON, TAR, DATA_CMD, RAW_INTR = 0x00, 0x04, 0x10, 0x34
CLR_TX_ABRT, CLR_STOP_DET, ENABLE, RXFLR, ABRT_SOURCE = 0x54, 0x60, 0x6C, 0x78, 0x80
TX_EMPTY, STOP_DET = 1 << 4, 1 << 9
READ, STOP, RESTART = 1 << 8, 1 << 9, 1 << 10
NOBODY, DATA_REFUSED = 1 << 0, 1 << 3
MASTER = 0x165  # fast, restart, TX_EMPTY_CTRL, no slave
TIMEOUT_NS = 50000000


class Driver:
    """machine.I2C's readfrom_mem and writeto_mem on an RP2040 without a processor running.

    ns_a_poll  emulated time that passes with every look at a register
    """

    def __init__(self, mcu):
        self.mcu = mcu
        self.i2c = mcu.i2c[0]
        self.ns_a_poll = 400
        self.init()

    def init(self):
        self.i2c.write_uint32(ENABLE, 0)
        self.i2c.write_uint32(CON, MASTER)
        self.i2c.write_uint32(ENABLE, 1)
        self.restart = False

    def wait_us(self, us):
        self.mcu.clock.tick(us * 1000)

    def look(self, register):
        self.mcu.clock.tick(self.ns_a_poll)
        return self.i2c.read_uint32(register)

    def until(self, done):
        """Poll until done() is true; ETIMEDOUT when it does not become so."""
        end = self.mcu.clock.nanos + TIMEOUT_NS
        while not done():
            if self.mcu.clock.nanos > end:
                raise OSError(ETIMEDOUT, "the driver's time-out")

    def begin(self, address):
        self.i2c.write_uint32(ENABLE, 0)
        self.i2c.write_uint32(TAR, address)
        self.i2c.write_uint32(ENABLE, 1)

    def command(self, word, first, last, nostop):
        word |= RESTART if first and self.restart else 0
        self.i2c.write_uint32(DATA_CMD, word | (STOP if last and not nostop else 0))

    def write(self, address, data, nostop=False):
        """Number of bytes acknowledged."""
        self.begin(address)
        taken = 0
        for k, byte in enumerate(data):
            last = k == len(data) - 1
            self.command(byte, k == 0, last, nostop)
            self.until(lambda: self.look(RAW_INTR) & TX_EMPTY)
            reason = self.look(ABRT_SOURCE)
            if reason:
                self.look(CLR_TX_ABRT)
            if reason or (last and not nostop):
                self.until(lambda: self.look(RAW_INTR) & STOP_DET)
                self.look(CLR_STOP_DET)
            if reason & NOBODY:
                raise OSError(EIO, "nobody acknowledged")
            if reason & DATA_REFUSED:
                break
            taken += 1
        self.restart = nostop
        return taken

    def read(self, address, n):
        self.begin(address)
        found = bytearray()
        for k in range(n):
            self.command(READ, k == 0, k == n - 1, False)
            self.until(self.read_or_abort)
            if self.aborted:
                raise OSError(EIO, "nobody acknowledged")
            found.append(self.look(DATA_CMD) & 0xFF)
        self.restart = False
        return bytes(found)

    def read_or_abort(self):
        self.aborted = self.look(ABRT_SOURCE)
        self.look(CLR_TX_ABRT)
        return self.aborted or self.look(RXFLR)

    def read_mem(self, address, register, n):
        self.write(address, bytes([register]), nostop=True)
        return self.read(address, n)

    def write_mem(self, address, register, data):
        return self.write(address, bytes([register]) + data)
