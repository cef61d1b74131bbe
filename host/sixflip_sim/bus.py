"""An I2C bus with simulated chips, machine.I2C's method names, and its ways to fail."""

import errno

from sixflip import RAIL
from sixflip_sim import noise
from sixflip_sim.faults import Faults

EREMOTEIO = 121                     # Linux; MicroPython's errno does not know it
_TIMEOUT_NS = 50000000              # what machine.I2C waits by default
_SILENT = None
_SHAKEN = noise.key(1, 0x620)

# (nobody acknowledges the address, written data not acknowledged); a held line is always
# ETIMEDOUT by the name of the interpreter's errno. Sources: MicroPython 1.21-1.25
# ports/*/machine_i2c.c and extmod/machine_i2c.c, Linux Documentation/i2c/fault-codes.
FLAVOURS = {
    "rp2": (errno.EIO, errno.EIO),
    "esp32": (errno.ENODEV, errno.ENODEV),
    "stm32": (errno.ENODEV, errno.EIO),
    "soft": (errno.ENODEV, _SILENT),
    "linux": (EREMOTEIO, EREMOTEIO),
}


class SimulatedI2C:
    """chips: RegisterChips, each with an address. flavour: whose errors are raised.

    Time passes for every bit on the bus. faults: list of dicts, see faults.py. After a
    fault "stuck_sda" nothing works until pulse_scl() was called often enough.
    """

    def __init__(self, clock, chips, flavour="rp2", freq=400000, faults=()):
        if flavour not in FLAVOURS:
            raise ValueError("flavour is %r, expected one of %s"
                             % (flavour, " ".join(sorted(FLAVOURS))))
        self.clock = clock
        self.chips = list(chips)
        self.flavour = flavour
        self.faults = Faults(faults)
        self.transactions = 0
        self.stuck_pulses = 0       # SCL pulses which still must come to free SDA
        self._byte_ns = 9 * 1000000000 // freq
        self._nobody, self._data_nak = FLAVOURS[flavour]
        self._bursts = {}           # (address, register, length) -> last bytes read

    def pulse_scl(self):
        """One clock pulse made by hand: after enough of them a chip lets go of SDA."""
        self.clock.advance_ns(10000)
        if self.stuck_pulses:
            self.stuck_pulses -= 1

    def scan(self):
        if self.stuck_pulses:
            return list(range(8, 120)) if self.flavour == "soft" else []
        self.clock.advance_ns(112 * self._byte_ns)
        return sorted([c.address for c in self.chips if c.plugged])

    def readfrom_mem(self, address, register, n, addrsize=8):
        buf = bytearray(n)
        self.readfrom_mem_into(address, register, buf)
        return bytes(buf)

    def readfrom_mem_into(self, address, register, buf, addrsize=8):
        if self.flavour == "linux" and len(buf) > 32:
            raise OSError(errno.EINVAL, "block reads of at most 32 bytes")
        active = self._begin(address, register, len(buf), 3)
        chip = self._chip(address)
        if chip is None:
            self._zeros(buf)
            return
        chip.select(register)
        chip.read_into(buf)
        if self.faults.spoil_reads:
            self._spoil(active, chip, register, buf)

    def writeto_mem(self, address, register, data, addrsize=8):
        active = self._begin(address, register, len(data), 2, True)
        chip = self._chip(address)
        if chip is None:
            return
        if "data_nak" in active:
            self._refuse_data()
        else:
            chip.select(register)
            chip.write(data)

    def readfrom(self, address, n, stop=True):
        buf = bytearray(n)
        self.readfrom_into(address, buf)
        return bytes(buf)

    def readfrom_into(self, address, buf, stop=True):
        self._begin(address, -1, len(buf), 1)
        chip = self._chip(address)
        if chip is None:
            self._zeros(buf)
            return
        chip.read_into(buf)

    def writeto(self, address, data, stop=True):
        """Number of acknowledged bytes; the first one selects the register."""
        active = self._begin(address, -1, len(data), 1, True)
        chip = self._chip(address)
        if chip is None:
            return len(data)
        if "data_nak" in active:
            self._refuse_data()
            return 0
        if data:
            chip.select(data[0])
            chip.write(data[1:])
        return len(data)

    def _begin(self, address, register, n, overhead, writing=False):
        """Let the time pass, meet the faults that are due; a tuple of those that concern
        the transaction's data. Raises what the port raises."""
        self.clock.advance_ns((n + overhead) * self._byte_ns)
        number = self.transactions
        self.transactions = number + 1
        active = ()
        if self.faults.pending:
            active = self.faults.due(self, number, address, register, n, writing)
            if "timeout" in active:
                self._time_out()
            if "nak" in active:
                raise OSError(self._nobody)
        return active

    def _time_out(self):
        self.clock.advance_ns(_TIMEOUT_NS)
        raise OSError(errno.ETIMEDOUT)

    def _chip(self, address):
        """The chip, None when SDA is low and SoftI2C takes that for an acknowledgement."""
        if self.stuck_pulses:
            if self.flavour == "soft":
                return None
            self._time_out()
        for chip in self.chips:
            if chip.address == address and chip.plugged and chip.reachable():
                return chip
        raise OSError(self._nobody)

    def _zeros(self, buf):
        for i in range(len(buf)):
            buf[i] = 0

    def _refuse_data(self):
        if self._data_nak is not _SILENT:
            raise OSError(self._data_nak)

    def _shake(self, buf, high):
        """Noise on every word; high: which byte of a word is the high one."""
        for i in range(0, len(buf) - 1, 2):
            word = buf[i + high] << 8 | buf[i + 1 - high]
            off = noise.gauss(_SHAKEN, 16 * self.transactions + i)
            word = (word ^ 0x8000) - 0x8000 + int(self.faults.noise * off)
            word = max(-RAIL - 1, min(RAIL, word))
            buf[i + high] = word >> 8 & 0xFF
            buf[i + 1 - high] = word & 0xFF

    def _spoil(self, active, chip, register, buf):
        """Faults of the data read: torn, garbled, repeated, or a wrong identification."""
        key = (chip.address, register, len(buf))
        before = self._bursts.get(key)
        fresh = bytes(buf)
        if before is not None and "duplicate" in active:
            buf[:] = before
            return
        if before is not None and "torn" in active:
            n = self.faults.tear_at % len(buf)
            buf[:n] = before[:n]
        if "garbled" in active:
            at, bits = self.faults.garble
            buf[at % len(buf)] ^= bits
        if "noise" in active:
            self._shake(buf, chip.high_byte)
        if "wrong_id" in active:
            for i in range(len(buf)):
                buf[i] = self.faults.wrong_id
        self._bursts[key] = fresh
