"""The flash of a Pico put together here: MicroPython's image and a littlefs from elsewhere.

Copying the firmware through the emulated port takes minutes. The virtual board writes the same
littlefs in seconds, and the Pico's MicroPython mounts it.
"""

from rp2040py.boards import BOARDS, resolve_layout
from rp2040py.device.load_flash import UF2_BLOCK_SIZE, decode_block
from rp2040py.memory_map import FLASH_START_ADDRESS

from sixflip_host.emulated.flash_chip import FLASH_BYTES
from sixflip_host.virtual.demo import PACE

SPEC = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0, **PACE["pico"].hand}
STILL = {"order": []}
LAST_FACE = ["Y-a", "Y-b"]
# for a board's REPL: the newest valid record
LOAD = """
from sixflip_device.record_slots import RecordSlots
slots = RecordSlots("/")
slot, record, refused = slots.load(lambda record: "")
print([slot, record.sequence, refused])
"""
LAYOUT = resolve_layout(BOARDS["pico"], "micropython")
FILES_BYTES = LAYOUT.fs_blockcount * LAYOUT.fs_blocksize


def flash(uf2, files):
    """The bytes of a Pico's flash: the image at path uf2, and files, a littlefs, behind it."""
    found = bytearray(b"\xff" * FLASH_BYTES)
    image = uf2.read_bytes()
    for start in range(0, len(image), UF2_BLOCK_SIZE):
        block = decode_block(image[start:start + UF2_BLOCK_SIZE])
        offset = block.flash_address - FLASH_START_ADDRESS
        found[offset:offset + len(block.payload)] = block.payload
    found[LAYOUT.fs_start:LAYOUT.fs_start + FILES_BYTES] = files
    return bytes(found)
