"""What a board's raw capture is made of: a header, then blocks with a CRC each; little-endian.

header  magic b"6CAP", version u8, column mask u8, length u16, JSON metadata, CRC32 of it all
block   type u8, 0 u8, length u16, payload, CRC32 of all of it
  SAMPLES    first sample's time (s u32, us u32), count u16,
             then a sample each: us since the one before u16, int16 columns
  STEPS      begins likewise; then each number as a byte, -127 to 127, the step from that of the
             sample before (from 0 in the first), or as WIDE and the number itself in two bytes
  POSE       pose u16, first u32, n u32, duration_us u64, seven sums i64, six noises f32
  WITHDRAWN  pose u16: its placements so far do not count; followed by first u32: only that one
  NOTE       UTF-8 text
  7          first u32, n u32: samples that never came to whoever wrote the file down
  END        samples u32, flags u8 (COMPLETE, SUMS_ONLY)
A cut-off file is readable up to its last whole block. Version 1 had neither STEPS nor 7.
With STEPS a session takes 9 to 10 bytes a sample of seven columns instead of 16.6,
and no more time in the sampling loop: tests/studies/bench/capture_size.py.

The samples in a block of a capture, one after the other: whole counts, or steps of them.
"""

import binascii
import struct

MAGIC = b"6CAP"
VERSION = 2
ACCEL = 1
GYRO = 2
TEMP = 4
MAG = 8
GROUPS = ((ACCEL, 0, 3), (GYRO, 3, 3), (TEMP, 6, 1), (MAG, 7, 3))  # mask, place in sample, n

SAMPLES = 1
POSE = 2
WITHDRAWN = 3
NOTE = 4
END = 5
STEPS = 6
COMPLETE = 1
SUMS_ONLY = 2

HEAD = "<4sBBH"
BLOCK = "<BBH"
TIME = "<IIH"
PLACEMENT = "<HIIQ7q6f"
FINISH = "<IB"
MOST_SAMPLES = 2048  # in a block: its length is 16 bits
GAP_US = 65535
US = 1000000
WIDE = 128  # instead of a step: the number itself follows


def places(columns):
    """Indices into the sample of the columns in a mask, in the order of the file."""
    indices = []
    for mask, first, n in GROUPS:
        if columns & mask:
            indices.extend(range(first, first + n))
    return indices


def header(meta_bytes, columns):
    """The bytes that a capture begins with."""
    if len(meta_bytes) > 65535:
        raise ValueError("metadata of a capture has at most 65535 bytes")
    head = struct.pack(HEAD, MAGIC, VERSION, columns, len(meta_bytes)) + meta_bytes
    return head + struct.pack("<I", binascii.crc32(head))


def start(payload):
    """(seconds, us, samples) of a block: when its first one was taken, and how many it holds;
    ValueError when that contradicts itself."""
    if len(payload) < 10:
        raise ValueError("%d bytes of samples" % len(payload))
    seconds, us, count = struct.unpack(TIME, payload[:10])
    if us >= US or count == 0:
        raise ValueError("a block of samples contradicts itself")
    return seconds, us, count


def each(kind, payload, count, row):
    """Leaves one sample after the other in row, an array("h") of the columns, and yields the
    microseconds since the one before, 0 for the first. ValueError where bytes are missing, or
    left over."""
    try:
        at = 10
        dt = 0
        for i in range(len(row)):
            row[i] = 0
        for _ in range(count):
            for i in range(-1, len(row)):
                step = WIDE if kind == SAMPLES else payload[at]
                if step == WIDE:
                    at += kind != SAMPLES
                    value = payload[at] | payload[at + 1] << 8
                    at += 2
                    value = value if i < 0 else (value ^ 32768) - 32768
                else:
                    at += 1
                    value = (dt if i < 0 else row[i]) + (step ^ 128) - 128
                if i < 0:
                    dt = value
                elif -32768 <= value <= 32767:
                    row[i] = value
                else:
                    raise ValueError("a count beyond 16 bits")
            if dt < 0:
                raise ValueError("time runs backwards")
            yield dt
    except IndexError:
        at = -1
    if at != len(payload):
        raise ValueError("a block of samples has not the length it should have")
