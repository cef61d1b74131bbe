"""The flash of a Pico put together here: MicroPython's image and a littlefs from elsewhere.

Copying the firmware through the emulated port takes minutes. The virtual board writes the same
littlefs in seconds, and the Pico's MicroPython mounts it.
"""

import posixpath

from littlefs import LittleFS, UserContext
from rp2040py.boards import BOARDS, resolve_layout
from rp2040py.device.load_flash import UF2_BLOCK_SIZE, decode_block
from rp2040py.memory_map import FLASH_START_ADDRESS

from sixflip_host.emulated.flash_chip import FLASH_BYTES
from sixflip_host.virtual.demo_bench import PACE

SPEC = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0, **PACE["pico"].hand}
STILL = {"order": []}
LAST_FACE = ["Y-a", "Y-b"]
# for a board's REPL: the newest valid record
LOAD = """
from sixflip_device.record.record_slots import RecordSlots
slots = RecordSlots("/")
slot, record, refused = slots.load(lambda record: "")
print([slot, record.sequence, refused])
"""
LAYOUT = resolve_layout(BOARDS["pico"], "micropython")
FILES_BYTES = LAYOUT.fs_blockcount * LAYOUT.fs_blocksize
# littlefs on disk: MicroPython 1.22 brought 2.1, and 1.21 formats away what it cannot mount
OLDEST_DISK = 0x00020000
PAGE_BYTES = 256  # what the Pico's port writes at a time


def littlefs(content, **options):
    """The littlefs in content, a bytearray that it changes; not mounted yet."""
    return LittleFS(UserContext(buffer=content), mount=False, block_size=LAYOUT.fs_blocksize,
                    block_count=LAYOUT.fs_blockcount, prog_size=PAGE_BYTES, **options)


def in_oldest_disk_version(files):
    """A littlefs with the folders and files of files, which is one of any version."""
    source = littlefs(bytearray(files))
    source.mount()
    content = bytearray(b"\xff" * FILES_BYTES)
    made = littlefs(content, disk_version=OLDEST_DISK)
    made.format()
    made.mount()
    for folder, folders, names in source.walk("/"):
        for name in folders:
            made.mkdir(posixpath.join(folder, name))
        for name in names:
            path = posixpath.join(folder, name)
            with source.open(path, "rb") as old, made.open(path, "wb") as new:
                new.write(old.read())
    made.unmount()
    return content


def flash(uf2, files):
    """The bytes of a Pico's flash: the image at path uf2, and files, a littlefs, behind it."""
    found = bytearray(b"\xff" * FLASH_BYTES)
    image = uf2.read_bytes()
    for start in range(0, len(image), UF2_BLOCK_SIZE):
        block = decode_block(image[start:start + UF2_BLOCK_SIZE])
        offset = block.flash_address - FLASH_START_ADDRESS
        found[offset:offset + len(block.payload)] = block.payload
    found[LAYOUT.fs_start:LAYOUT.fs_start + FILES_BYTES] = in_oldest_disk_version(files)
    return bytes(found)
