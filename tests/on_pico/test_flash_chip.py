"""The emulated flash with a supply that fails: whole operations before it, then half of one."""

import pytest

pytest.importorskip("rp2040py")
from rp2040py.memory_map import FLASH_START_ADDRESS  # noqa: E402
from rp2040py.rp2040 import RP2040  # noqa: E402

from sixflip_host.emulated.flash_chip import fit  # noqa: E402

SSI = 0x18000000
SSIENR, DR0 = 0x08, 0x60
ENABLE_WRITE, ERASE, WRITE = 0x06, 0x20, 0x02
LOW, HIGH = 2 << 8, 3 << 8  # output override of the chip select


class Bench:
    """Commands over the memory bus, as the boot ROM gives them."""

    def __init__(self):
        self.mcu = RP2040()
        self.cuts = 0
        self.flash = fit(self.mcu, self.cut)
        self.mcu.write_uint32(SSI + SSIENR, 1)
        self.select(HIGH)

    def cut(self):
        self.cuts += 1

    def select(self, level):
        self.mcu.qspi[1].ctrl = level
        self.mcu.qspi[1].check_for_updates()

    def command(self, *data):
        self.select(LOW)
        for byte in data:
            self.mcu.write_uint32(SSI + DR0, byte)
        self.select(HIGH)
        self.mcu.clock.tick(1000)

    def change(self, operation, sector, data=()):
        self.command(ENABLE_WRITE)
        self.command(operation, 0, sector << 4, 0, *data)

    def read(self, sector, n):
        start = sector * 4096
        words = [self.mcu.read_uint32(FLASH_START_ADDRESS + start + i) for i in range(0, n, 4)]
        return b"".join(word.to_bytes(4, "little") for word in words)


PAGE = bytes(range(1, 129)) * 2


def test_without_a_cut_it_is_the_emulators_own_flash():
    bench = Bench()
    bench.change(WRITE, 1, PAGE)
    assert bench.read(1, 260) == PAGE + b"\xff" * 4
    bench.change(ERASE, 1)
    assert bench.read(1, 256) == b"\xff" * 256
    assert (bench.flash.operations, bench.cuts) == (2, 0)


def test_a_command_without_write_enable_is_no_operation():
    bench = Bench()
    bench.command(WRITE, 0, 16, 0, *PAGE)
    assert (bench.flash.operations, bench.read(1, 4)) == (0, b"\xff" * 4)


def test_the_page_at_which_the_supply_fails_is_written_by_half():
    bench = Bench()
    bench.flash.cut_after = 1
    bench.change(WRITE, 1, PAGE)
    assert (bench.read(1, 256), bench.cuts) == (PAGE, 0)
    bench.change(WRITE, 2, PAGE)
    assert bench.read(2, 256) == PAGE[:128] + b"\xff" * 128
    assert bench.cuts == 1


def test_the_sector_at_which_the_supply_fails_is_erased_by_half():
    bench = Bench()
    bench.mcu.flash[4096:8192] = bytes(4096)
    bench.flash.cut_after = 0
    bench.change(ERASE, 1)
    assert bench.read(1, 4096) == b"\xff" * 2048 + bytes(2048)
    assert bench.cuts == 1


def test_after_the_cut_nothing_is_written_until_the_supply_is_back():
    bench = Bench()
    bench.flash.cut_after = 0
    bench.change(WRITE, 1, PAGE)
    bench.change(WRITE, 2, PAGE)
    assert bench.read(2, 4) == b"\xff" * 4
    bench.mcu.reset(preserve_flash=True)
    bench.mcu.write_uint32(SSI + SSIENR, 1)
    bench.select(HIGH)
    bench.change(WRITE, 2, PAGE)
    assert bench.read(2, 256) == PAGE
    assert bench.cuts == 1
