"""A flash whose every operation is written down, and the flash as a power cut left it.

Runs on MicroPython. What an operation does does not depend on a cut that comes later, so one
run of the firmware is enough: after_cut() is the flash with the first k operations done and
the next one torn. Whatever is mounted there works on a copy.
"""

ERASE, WRITE, SYNC = 0, 1, 2
IOCTL_SYNC, IOCTL_COUNT, IOCTL_SIZE, IOCTL_ERASE = 3, 4, 5, 6

# What a torn operation leaves: nothing of it, its first half, its second half, its first half
# and garbage behind it, garbage all over. A sync has nothing to tear.
WAYS = {"whole": ("before",), "halves": ("before", "first half", "second half"),
        "data": ("before", "first half", "second half", "garbage behind", "garbage"),
        "all": ("before", "first half", "second half", "garbage behind", "garbage")}


class Recorded:
    """A block device in memory. log: [(kind, block, offset, bytes)] since it was emptied.

    base    {block: bytes}, whose blocks are copied before they change; others are erased
    bare    FAT's protocol, whole sectors; else littlefs's, which erases and programs in parts
    """

    def __init__(self, blocks, size, bare=False, base=None):
        self.blocks = blocks
        self.size = size
        self.bare = bare
        self.base = base or {}
        self.own = {}
        self.log = []
        self.erased = bytes([0xFF]) * size

    def block(self, n):
        return self.own.get(n) or self.base.get(n) or self.erased

    def change(self, n, offset, data):
        if n not in self.own:
            self.own[n] = bytearray(self.block(n))
        self.own[n][offset:offset + len(data)] = data

    def image(self):
        """Every block, as base of another device."""
        all_of_it = dict(self.base)
        for n in self.own:
            all_of_it[n] = bytes(self.own[n])
        return all_of_it

    def readblocks(self, n, buf, offset=0):
        at = 0
        while at < len(buf):
            part = self.block(n)[offset:offset + len(buf) - at]
            buf[at:at + len(part)] = part
            at += len(part)
            n, offset = n + 1, 0

    def writeblocks(self, n, buf, offset=0):
        at = 0
        while at < len(buf):
            part = bytes(buf[at:at + self.size - offset])
            self.log.append((WRITE, n, offset, part))
            self.change(n, offset, part)
            at += len(part)
            n, offset = n + 1, 0

    def ioctl(self, operation, argument):
        if operation == IOCTL_COUNT:
            return self.blocks
        if operation == IOCTL_SIZE:
            return self.size
        if operation == IOCTL_ERASE and not self.bare:
            self.log.append((ERASE, argument, 0, self.erased))
            self.change(argument, 0, self.erased)
        elif operation == IOCTL_SYNC:
            self.log.append((SYNC, 0, 0, b""))
        return 0


class Random:
    """Bytes from a seed, the same on every machine (xorshift)."""

    def __init__(self, seed):
        self.state = seed * 2654435761 + 1 & 0xFFFFFFFF or 1

    def bytes(self, n):
        out = bytearray(n)
        x = self.state
        for i in range(n):
            x = (x ^ x << 13) & 0xFFFFFFFF
            x ^= x >> 17
            x = (x ^ x << 5) & 0xFFFFFFFF
            out[i] = x >> 9 & 0xFF
        self.state = x
        return out


def torn(data, old, how, random):
    """What is in the place of data, where old was, after the power went in between."""
    half = len(data) // 2
    if how == "first half":
        return data[:half] + old[half:]
    if how == "second half":
        return old[:half] + data[half:]
    if how == "garbage behind":
        return bytes(data[:half]) + bytes(random.bytes(len(data) - half))
    return random.bytes(len(data))


class Cuts:
    """All cuts of a recorded run, in order: advance() by one operation, after_cut() as often
    as there are ways to tear the next one."""

    def __init__(self, before, log, device):
        self.state = before        # {block: bytes} as it was when the log began
        self.log = log
        self.device = device
        self.done = 0

    def advance(self):
        kind, n, offset, data = self.log[self.done]
        if kind != SYNC:
            block = bytearray(self._block(n))
            block[offset:offset + len(data)] = data
            self.state[n] = block  # a new one: who looked at the old one keeps it
        self.done += 1

    def _block(self, n):
        return self.state.get(n) or self.device.erased

    def block_number(self):
        return self.log[self.done][1]

    def kind(self):
        """Of the operation that the next cut tears; None at the end."""
        return self.log[self.done][0] if self.done < len(self.log) else None

    def after_cut(self, how, random):
        """A device of its own, as the next power-up finds it."""
        like = self.device
        found = Recorded(like.blocks, like.size, like.bare, self.state)
        if how != "before":
            _, n, offset, data = self.log[self.done]
            old = self._block(n)[offset:offset + len(data)]
            found.change(n, offset, torn(data, old, how, random))
        return found
