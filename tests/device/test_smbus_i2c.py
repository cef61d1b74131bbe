"""The Raspberry Pi's adapter against smbus2's own message structures."""

import errno
import unittest

from smbus2 import i2c_msg

from sixflip_device.boards.smbus_i2c import SMBusI2C


class RegisterFile:
    """The far side of I2C_RDWR: reads smbus2's real i2c_msg structures as the kernel would."""

    M_RD = 0x0001

    def __init__(self, address, registers):
        self.address = address
        self.registers = registers
        self.pointer = 0
        self.transfers = []
        self.fail = None

    def i2c_rdwr(self, *messages):
        if self.fail:
            raise OSError(self.fail, "from the kernel")
        self.transfers.append([(m.addr, m.flags, m.len) for m in messages])
        for m in messages:
            assert isinstance(m, i2c_msg)
            if m.addr != self.address:
                raise OSError(121, "Remote I/O error")
            if m.flags & self.M_RD:
                for i in range(m.len):
                    m.buf[i] = bytes([self.registers[self.pointer + i]])
            else:
                data = bytes(m)
                if data:
                    self.pointer = data[0]
                for i, value in enumerate(data[1:]):
                    self.registers[self.pointer + i] = value

    def close(self):
        self.closed = True


class TestSMBusI2C(unittest.TestCase):
    def setUp(self):
        self.far = RegisterFile(0x68, list(range(256)))
        self.i2c = SMBusI2C(self.far)

    def test_read_is_one_combined_transfer(self):
        buf = bytearray(14)
        self.i2c.readfrom_mem_into(0x68, 0x3B, buf)
        self.assertEqual(buf, bytes(range(0x3B, 0x3B + 14)))
        self.assertEqual(self.far.transfers, [[(0x68, 0, 1), (0x68, 1, 14)]])

    def test_readfrom_mem(self):
        self.assertEqual(self.i2c.readfrom_mem(0x68, 0x75, 1), b"\x75")

    def test_write(self):
        self.i2c.writeto_mem(0x68, 0x6B, b"\x01\x02")
        self.assertEqual(self.far.registers[0x6B:0x6D], [1, 2])
        self.assertEqual(self.far.transfers, [[(0x68, 0, 3)]])

    def test_plain_reads_and_writes(self):
        self.assertEqual(self.i2c.writeto(0x68, b"\x10"), 1)
        self.assertEqual(self.i2c.readfrom(0x68, 2), b"\x10\x11")

    def test_high_bytes(self):
        self.assertEqual(self.i2c.readfrom_mem(0x68, 0xF0, 16), bytes(range(0xF0, 0x100)))

    def test_errors_have_the_boards_numbers(self):
        for linux, expected in ((121, errno.ENODEV), (6, errno.ENODEV), (5, errno.ENODEV),
                                (110, errno.ETIMEDOUT)):
            self.far.fail = linux
            with self.assertRaises(OSError) as caught:
                self.i2c.readfrom_mem(0x68, 0x75, 1)
            self.assertEqual(caught.exception.args[0], expected, linux)

    def test_long_transfers_are_refused(self):
        with self.assertRaises(ValueError):
            self.i2c.readfrom_mem(0x68, 0, 33)
        with self.assertRaises(ValueError):
            self.i2c.writeto_mem(0x68, 0, bytes(33))

    def test_scan_names_who_answers(self):
        self.assertEqual(self.i2c.scan(), [0x68])
