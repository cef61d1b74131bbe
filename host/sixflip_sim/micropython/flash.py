"""Flash as a block device over an image file; power can be cut at any write or erase."""

from raw_repl import Restart

IOCTL_SYNC, IOCTL_BLOCK_COUNT, IOCTL_BLOCK_SIZE, IOCTL_ERASE = 3, 4, 5, 6
BLOCK_SIZE = 4096  # the Pico's erase sector
EIO = 5


class PowerCut(Restart):
    """The supply failed in the middle of a block operation."""


class FlashImage:
    """Extended block protocol (readblocks and writeblocks with offset) for vfs.VfsLfs2.

    file   an image opened "r+b", a whole number of blocks, erased blocks read 0xFF
    cut_after  number of writes and erases that still succeed; the next one is torn in the
               middle and nothing is written from then on. None: never.
    wait_us    passes the time that erasing and writing take, if any
    times      us of an erase and of writing a page, bytes in a page (sixflip_sim.flash_times)
    """

    def __init__(self, file, blocks, cut_after=None, wait_us=None, times=(0, 0, 1)):
        self.file = file
        self.blocks = blocks
        self.cut_after = cut_after
        self.wait_us = wait_us
        self.erase_us, self.page_us, self.page = times
        self.operations = 0
        self.dead = False
        self.erased = b"\xff" * BLOCK_SIZE

    def readblocks(self, block, buffer, offset=0):
        self.file.seek(block * BLOCK_SIZE + offset)
        self.file.readinto(buffer)

    def writeblocks(self, block, buffer, offset=None):
        if offset is None:
            self.ioctl(IOCTL_ERASE, block)
            offset = 0
        self._store(block * BLOCK_SIZE + offset, buffer)
        self._wait(-(-len(buffer) // self.page) * self.page_us)

    def _wait(self, us):
        if self.wait_us:
            self.wait_us(us)

    def ioctl(self, operation, argument):
        if operation == IOCTL_BLOCK_COUNT:
            return self.blocks
        if operation == IOCTL_BLOCK_SIZE:
            return BLOCK_SIZE
        if operation == IOCTL_ERASE:
            self._store(argument * BLOCK_SIZE, self.erased)
            self._wait(self.erase_us)
            return 0
        if operation == IOCTL_SYNC:
            self.file.flush()
            return 0
        return None

    def _store(self, position, data):
        if self.dead:
            raise PowerCut(EIO)
        self.file.seek(position)
        if self.cut_after is not None and self.operations >= self.cut_after:
            self.file.write(data[: len(data) // 2])
            self.file.flush()
            self.dead = True
            raise PowerCut(EIO)
        self.operations += 1
        self.file.write(data)
