"""/dev/i2c-1 of a Raspberry Pi with simulated chips behind it, for processes under umockdev.

    umockdev-wrapper /usr/bin/python3 fake_i2c.py SPEC.json

SPEC: {"world": for worlds.make, "clock": file of the time both processes share (shared_time.py)
or null, "errnos": [[n-th transfer, errno, how many], …]}. Prints the folder of the fake devices;
serves until its standard input ends; then prints what came: {"transfers", "longest", "requests"}.

The messages are the kernel's: struct i2c_rdwr_ioctl_data, i2c_msg and i2c_smbus_ioctl_data of
linux/i2c.h and linux/i2c-dev.h, read out of the caller's memory by umockdev.
"""

import json
import struct
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "host"), str(HERE.parents[1] / "shared")]

import gi  # noqa: E402  Debian's python3-gi

gi.require_version("UMockdev", "1.0")
from gi.repository import GLib, UMockdev  # noqa: E402
from shared_time import RealTime, SharedTime  # noqa: E402

from sixflip_sim import worlds  # noqa: E402

I2C_SLAVE, I2C_FUNCS, I2C_RDWR, I2C_SMBUS = 0x0703, 0x0705, 0x0707, 0x0720
I2C_M_RD = 1
FUNCTIONALITY = 0x0EFF0009  # what i2c-bcm2835 answers: I2C and the emulated SMBus
POINTER = struct.calcsize("P")
MESSAGE = struct.calcsize("HHHP")
BUFFER_AT = MESSAGE - POINTER
MOST_MESSAGES = 42  # I2C_RDWR_IOCTL_MAX_MSGS
SMBUS_READ, SMBUS_BYTE_DATA = 1, 2
EINVAL, ENOTTY = 22, 25
DEVICE = """P: /devices/platform/soc/i2c-1/i2c-dev/i2c-1
N: i2c-1
E: DEVNAME=/dev/i2c-1
E: SUBSYSTEM=i2c-dev
A: name=bcm2835 (i2c@7e804000)\\n
"""


class Bus(UMockdev.IoctlBase):
    """The kernel's side of the device node."""

    def __init__(self, spec):
        super().__init__()
        self.world = worlds.make(spec["world"])
        self.time = SharedTime(spec["clock"]) if spec["clock"] else RealTime()
        self.errnos = spec["errnos"]
        self.slave = None
        self.transfers = 0
        self.longest = 0
        self.requests = {}

    def do_handle_ioctl(self, client):
        request = client.get_request()
        self.requests[hex(request)] = self.requests.get(hex(request), 0) + 1
        answer = {I2C_FUNCS: self.functions, I2C_SLAVE: self.select, I2C_RDWR: self.combined,
                  I2C_SMBUS: self.smbus}.get(request)
        clock = self.world.clock
        try:
            if answer is None:
                raise OSError(ENOTTY, "unknown request")
            clock.advance_ns(max(0, self.time.us() - clock.now_us()) * 1000)
            result = answer(client)
            client.complete(result, 0)
        except OSError as error:
            client.complete(-1, error.args[0])  # of OSError(121) errno is None
        self.time.set(clock.now_us())
        return True

    def functions(self, client):
        client.get_arg().resolve(0, POINTER).update(0, struct.pack("L", FUNCTIONALITY))
        return 0

    def select(self, client):
        self.slave = struct.unpack("P", client.get_arg().retrieve())[0]
        return 0

    def due(self):
        """The errno that a schedule wants for this transfer."""
        self.transfers += 1
        for first, number, count in self.errnos:
            if first <= self.transfers < first + count:
                raise OSError(number, "scheduled")

    def combined(self, client):
        """I2C_RDWR: messages with a repeated start between them."""
        self.due()
        pointer = client.get_arg().resolve(0, 2 * POINTER)
        count = struct.unpack_from("I", pointer.retrieve(), POINTER)[0]
        if not 0 < count <= MOST_MESSAGES:
            raise OSError(EINVAL, "messages")
        messages = pointer.resolve(0, count * MESSAGE)
        raw = messages.retrieve()
        register = None
        for i in range(count):
            address, flags, length = struct.unpack_from("HHH", raw, i * MESSAGE)
            self.longest = max(self.longest, length)
            buffer = messages.resolve(i * MESSAGE + BUFFER_AT, length)
            register = self.message(address, flags, length, buffer, register, i + 1 < count)
        return count

    def message(self, address, flags, length, buffer, register, more):
        """One message; the register that a write of one byte has chosen for the next."""
        i2c = self.world.i2c
        if flags & I2C_M_RD:
            data = (i2c.readfrom(address, length) if register is None
                    else i2c.readfrom_mem(address, register, length))
            buffer.update(0, data)
            return None
        data = bytes(buffer.retrieve())
        if more and length == 1:
            return data[0]
        i2c.writeto(address, data)
        return None

    def smbus(self, client):
        """I2C_SMBUS, byte data only: what smbus2's read_byte_data and write_byte_data send."""
        self.due()
        request = client.get_arg().resolve(0, 8 + POINTER)
        read, register, size = struct.unpack_from("BBxxI", request.retrieve())
        if size != SMBUS_BYTE_DATA:
            raise OSError(EINVAL, "size")
        data = request.resolve(8, 34)
        if read == SMBUS_READ:
            data.update(0, self.world.i2c.readfrom_mem(self.slave, register, 1))
        else:
            self.world.i2c.writeto_mem(self.slave, register, bytes(data.retrieve())[:1])
        return 0


def main(path):
    bus = Bus(json.loads(Path(path).read_text()))
    testbed = UMockdev.Testbed.new()
    testbed.add_from_string(DEVICE)
    testbed.attach_ioctl("/dev/i2c-1", bus)
    loop = GLib.MainLoop()
    GLib.io_add_watch(0, GLib.IO_HUP, lambda *_: loop.quit())
    print(testbed.get_root_dir(), flush=True)
    loop.run()
    print(json.dumps({"transfers": bus.transfers, "longest": bus.longest,
                      "requests": bus.requests}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
