"""A chip on SPI with machine.I2C's method names, so that probe and drivers are the same.

There is one chip, behind its own select line, and no address: it stands at 0. A transfer is the
register's number, bit 7 set for a read, and its bytes; the register counts up. All the chips that
are driven on SPI take modes 0 and 3. Nobody acknowledges: a chip that is not there reads as 0x00
or 0xff.
"""

import errno

ADDRESS = 0
READ = 0x80
FREQ = 1000000
MODE = 3
KEYS = ("bus", "sck", "mosi", "miso", "cs", "mode", "freq")


class SPIBus:
    """port: write(data) and readinto(buf) between select(0) and select(1)."""

    spi = True

    def __init__(self, port, mode=MODE):
        self._port = port
        self.mode = mode
        self._head = bytearray(1)

    def _begin(self, address, head):
        if address != ADDRESS:
            raise OSError(errno.ENODEV)
        self._head[0] = head
        self._port.select(0)
        self._port.write(self._head)

    def readfrom_mem_into(self, address, register, buf):
        """Fills buf from a register on; OSError (ENODEV) at any address but ADDRESS."""
        self._begin(address, register | READ)
        self._port.readinto(buf)
        self._port.select(1)

    def readfrom_mem(self, address, register, n):
        """n bytes from a register on."""
        buf = bytearray(n)
        self.readfrom_mem_into(address, register, buf)
        return bytes(buf)

    def writeto_mem(self, address, register, data):
        """Writes data to a register on."""
        self._begin(address, register & 0x7F)
        self._port.write(data)
        self._port.select(1)

    def scan(self):
        """No address: on SPI nobody acknowledges."""
        return []

    def close(self):
        """Gives the port back, where it is one that can be."""
        if hasattr(self._port, "close"):
            self._port.close()


class MachinePort:
    """machine.SPI and the pin that selects the chip."""

    def __init__(self, spi, cs):
        self.write = spi.write
        self.readinto = spi.readinto
        self.select = cs


class SpidevPort:
    """Linux's spidev: one transfer of everything between two selects, by its kernel driver."""

    def __init__(self, device):
        self._device = device
        self._sent = []

    def select(self, level):
        """The chip's select line, 0 or 1; at 1 what was written is sent."""
        if level and self._sent:
            self._device.xfer2(self._sent)
        self._sent = []

    def write(self, data):
        """Bytes for the transfer that is sent at the next select or read."""
        self._sent.extend(data)

    def readinto(self, buf):
        """Sends what was written and fills buf with the bytes that the chip answers after it."""
        sent, self._sent = self._sent, []
        buf[:] = bytes(self._device.xfer2(sent + [0] * len(buf)))[len(sent):]

    def close(self):
        """Closes the device file."""
        self._device.close()


def values_of(spi, usual):
    """The settings of "spi", completed; ValueError naming what is wrong. usual: {key: value}."""
    for name in spi:
        if name not in KEYS:
            raise ValueError("spi has a key %s, expected %s" % (name, " ".join(KEYS)))
    values = {"mode": MODE, "freq": FREQ}
    values.update(usual)
    values.update(spi)
    if values["mode"] not in (0, 1, 2, 3):
        raise ValueError("spi has the mode %s, expected 0 to 3 (the chips take 0 and 3)"
                         % values["mode"])
    return values


def machine_spi(spi, usual, fixed_pins=False):
    """make() -> a new SPIBus over machine.SPI. fixed_pins: the bus number says which."""
    import machine
    v = values_of(spi, usual)

    def make():
        pins = {} if fixed_pins else {"sck": machine.Pin(v["sck"]), "mosi": machine.Pin(v["mosi"]),
                                      "miso": machine.Pin(v["miso"])}
        port = machine.SPI(v["bus"], baudrate=v["freq"], polarity=v["mode"] >> 1,
                           phase=v["mode"] & 1, **pins)
        cs = machine.Pin(v["cs"], machine.Pin.OUT, value=1)
        return SPIBus(MachinePort(port, cs), v["mode"])
    return make
