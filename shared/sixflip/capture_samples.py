"""The samples in a block of a capture, one after the other: whole counts, or steps of them."""

import struct

from sixflip.capture_blocks import SAMPLES, TIME, US, WIDE


def start(payload):
    """(us, samples) of a block: its first sample's time since the session began, seconds and
    microseconds apart, and how many it holds; ValueError when that contradicts itself."""
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
    whole = 2 + 2 * len(row)
    size = len(payload)
    at = 10
    dt = 0
    for k in range(count):
        if k == 0 or kind == SAMPLES:
            if at + whole > size:
                raise ValueError("a block of samples is too short")
            dt = payload[at] | payload[at + 1] << 8
            for i in range(len(row)):
                at += 2
                row[i] = struct.unpack_from("<h", payload, at)[0]
            at += 2
        else:
            for i in range(-1, len(row)):
                step = payload[at] if at < size else WIDE
                at += 1
                if step == WIDE:
                    at += 2
                    if at > size:
                        raise ValueError("a block of samples is too short")
                    if i < 0:
                        dt = payload[at - 2] | payload[at - 1] << 8
                    else:
                        row[i] = struct.unpack_from("<h", payload, at - 2)[0]
                else:
                    step = (step ^ 128) - 128
                    if i < 0:
                        dt += step
                    elif -32768 <= row[i] + step <= 32767:
                        row[i] += step
                    else:
                        raise ValueError("a count beyond 16 bits")

            if dt < 0:
                raise ValueError("time runs backwards")
        yield dt
    if at != size:
        raise ValueError("a block of samples is too long")
