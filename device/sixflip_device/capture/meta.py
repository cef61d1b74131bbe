"""What stands in a capture's header, the number of its session included."""

import binascii
import json
import os

import sixflip
from sixflip.capture import blocks as capture_blocks

from ..flash_files import GOOD, NEW, REFUSED, UNSAVED

HEAD = 1200  # bytes of a file: a capture's metadata, or a whole record
BEFORE = (GOOD, UNSAVED, REFUSED, "record_a.bin", "record_b.bin")


def session_number(board):
    """32 bits that name a new session in capture and record.

    By chance; where there is none (an emulator's urandom is constant, and its ticks) it differs
    all the same, for those of the sessions before go into it.
    """
    crc = binascii.crc32(os.urandom(8) + board.ticks_us().to_bytes(8, "little"))
    for name in BEFORE:
        try:
            with open(board.root + name, "rb") as f:
                crc = binascii.crc32(f.read(HEAD), crc)
        except OSError:
            pass  # none is there
    return crc & 0xFFFFFFFF


def meta_bytes(firmware, number, unasked=False):
    """The capture's metadata, JSON in bytes: what the driver says, and who and how.

    number: the session's; unasked: the board began it by itself
    """
    meta = firmware.sensor.imu.metadata()
    if unasked:
        meta["unasked"] = True
    meta.update({"g": firmware.settings["g"], "device_id": firmware.board.unique_id,
                 "board": firmware.board.name, "firmware": sixflip.__version__, "session": number,
                 "float_bits": 64 if 1.0 + 1e-9 != 1.0 else 32})
    return json.dumps(meta).encode()


def columns(imu):
    """The column mask (sixflip.capture.blocks) of what a sensor delivers."""
    mask = capture_blocks.ACCEL
    mask |= capture_blocks.GYRO if imu.has_gyro else 0
    mask |= capture_blocks.TEMP if imu.has_temp else 0
    return mask


def expected_bytes(samples, mask):
    """What so many samples take on the flash, as steps and with a quarter to spare: 9.5 bytes
    were measured of seven columns that take 16 when they are whole (the bench
    capture_size).
    """
    return samples * (2 + 2 * len(capture_blocks.places(mask))) * 3 // 4


def meta_of(root):
    """The metadata in the header of the session's file, or None."""
    from sixflip.capture.scan import Scan
    try:
        with open(root + NEW, "rb") as f:
            return Scan(f).blocks.meta_bytes
    except (OSError, ValueError):
        return None
