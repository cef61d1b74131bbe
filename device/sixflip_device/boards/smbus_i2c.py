"""smbus2 with machine.I2C's method names, so that the same drivers run on a Raspberry Pi.

Every read is one combined transfer (write the register, repeated start, read) by I2C_RDWR,
so a sample is never torn. Transfers are kept to 32 bytes, the SMBus block limit, although
I2C_RDWR itself could do more: no chip of ours needs more.
Errors of Linux's bus drivers come as machine.I2C gives them: 121 EREMOTEIO, 6 ENXIO and
5 EIO (no acknowledge, by bus driver) as ENODEV, 110 stays ETIMEDOUT.
"""

import errno

from smbus2 import i2c_msg

BLOCK = 32
NO_ANSWER = (121, 6, 5)


class SMBusI2C:
    """bus: an open smbus2.SMBus, or anything with its i2c_rdwr() and close()."""

    def __init__(self, bus):
        self._bus = bus

    def _transfer(self, *messages):
        try:
            self._bus.i2c_rdwr(*messages)
        except OSError as e:
            number = e.errno
            if number in NO_ANSWER:
                raise OSError(errno.ENODEV, "no acknowledge (Linux errno %d)" % number) from e
            raise

    def _check(self, n):
        if n > BLOCK:
            raise ValueError("a transfer of %d bytes, expected at most %d" % (n, BLOCK))

    def _register(self, memaddr, addrsize):
        if addrsize != 8:
            raise ValueError("addrsize %d, expected 8" % addrsize)
        return bytes([memaddr])

    def readfrom_mem_into(self, addr, memaddr, buf, addrsize=8):
        """Fills buf from register memaddr on, of the chip at addr."""
        self._check(len(buf))
        read = i2c_msg.read(addr, len(buf))
        self._transfer(i2c_msg.write(addr, self._register(memaddr, addrsize)), read)
        buf[:] = bytes(read)

    def readfrom_mem(self, addr, memaddr, nbytes, addrsize=8):
        """nbytes from register memaddr on, as bytes."""
        buf = bytearray(nbytes)
        self.readfrom_mem_into(addr, memaddr, buf, addrsize=addrsize)
        return bytes(buf)

    def writeto_mem(self, addr, memaddr, buf, addrsize=8):
        """Writes buf to register memaddr on."""
        self._check(len(buf))
        self._transfer(i2c_msg.write(addr, self._register(memaddr, addrsize) + bytes(buf)))

    def readfrom_into(self, addr, buf, stop=True):
        """Fills buf with what the chip at addr sends by itself."""
        self._check(len(buf))
        read = i2c_msg.read(addr, len(buf))
        self._transfer(read)
        buf[:] = bytes(read)

    def readfrom(self, addr, nbytes, stop=True):
        """nbytes that the chip at addr sends by itself, as bytes."""
        buf = bytearray(nbytes)
        self.readfrom_into(addr, buf)
        return bytes(buf)

    def writeto(self, addr, buf, stop=True):
        """Writes buf to the chip at addr; returns how many bytes it took."""
        self._check(len(buf))
        self._transfer(i2c_msg.write(addr, bytes(buf)))
        return len(buf)

    def scan(self):
        """Addresses that acknowledge a one-byte read (0x08 to 0x77)."""
        found = []
        for addr in range(0x08, 0x78):
            try:
                self._transfer(i2c_msg.read(addr, 1))
            except OSError:
                continue
            found.append(addr)
        return found

    def close(self):
        """Closes Linux's bus device."""
        self._bus.close()
