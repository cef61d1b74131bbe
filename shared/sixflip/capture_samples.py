"""The samples in a block of a capture, one after the other: whole counts, or steps of them."""

import struct

from sixflip.capture_blocks import SAMPLES, TIME, US, WIDE


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
