"""The emulated flash chip: it takes its time, and its supply can fail between and within
operations."""

from rp2040py.peripherals.ssi import CMD_BLOCK_ERASE, CMD_PAGE_PROGRAM, CMD_SECTOR_ERASE, RPSSI

from sixflip_sim.flash_times import BLOCK_ERASE_US, PAGE_US, SECTOR_ERASE_US

FLASH_BYTES = 2 * 1024 * 1024  # of a Pico
ADDRESS_END = 4  # command byte and three of the address
BUSY_US = {CMD_SECTOR_ERASE: SECTOR_ERASE_US, CMD_BLOCK_ERASE: BLOCK_ERASE_US,
           CMD_PAGE_PROGRAM: PAGE_US}


class FlashChip(RPSSI):
    """In place of the emulator's own flash interface.

    cut_after   erases and page writes that still succeed; of the next only half is done, and
                cut() is called. None: the supply does not fail.
    operations  erases and page writes so far
    """

    def __init__(self, rp2040, cut):
        super().__init__(rp2040, "SSI")
        self.cut_after = None
        self.operations = 0
        # Later by an alarm: the chip select's change is still being dealt with.
        self.fail = rp2040.clock.create_alarm(cut)
        self.dead = False

    def _apply_command(self):
        """Called by the emulator when chip select rises: a command is complete."""
        command = bytes(self._tx_buffer)
        busy_us = 0
        if self._write_enabled and command[:1] and command[0] in BUSY_US:
            if self.dead:
                self._tx_buffer = bytearray()
            elif self.cut_after == 0:
                self.tear(command)
            elif self.cut_after:
                self.cut_after -= 1
            self.operations += 1
            busy_us = 0 if self.dead else BUSY_US[command[0]]
        super()._apply_command()
        if busy_us:
            # The boot ROM would ask for the chip's state until it is done.
            self.rp2040.clock.tick(1000 * busy_us)

    def tear(self, command):
        """Half of the operation, then the supply is gone."""
        self.cut_after = None
        self.dead = True
        self.fail.schedule(0)
        data = command[ADDRESS_END:]
        if data:
            self._tx_buffer = bytearray(command[:ADDRESS_END] + data[:len(data) // 2])
            return
        start = int.from_bytes(command[1:ADDRESS_END], "big")
        self._tx_buffer = bytearray()
        self.rp2040.flash[start:start + 2048] = b"\xff" * 2048

    def reset(self):
        super().reset()
        self.dead = False


def fit(mcu, cut):
    """Put a FlashChip into an RP2040 in the place of its own; answers it."""
    chip = FlashChip(mcu, cut)
    for base, peripheral in mcu.peripherals.items():
        if peripheral is mcu.ssi:
            mcu.peripherals[base] = chip
    mcu.ssi = chip
    return chip
