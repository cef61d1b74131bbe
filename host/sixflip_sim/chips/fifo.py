"""The memory of a simulated chip: every sample goes in, the oldest are lost when it is full.

Formats are the makers', byte for byte; sixflip/chips/fifo.py names the documents.
"""


class Memory:
    """chip: a SimulatedSixAxis whose fifo_on() says whether samples go in, and whose
    fifo_frame(k) makes the bytes of sample k out of its counts. size: bytes of it.

    lost: samples were overwritten since somebody looked.
    """

    def __init__(self, chip, size, frame_bytes):
        self.chip = chip
        self.size = size
        self.frame_bytes = frame_bytes
        self.clear()

    def clear(self):
        self.bytes = bytearray()
        self.lost = False
        self._next = -1             # number of the sample that goes in next

    def fill(self):
        """Everything that was measured until now."""
        chip = self.chip
        period_ns = chip.period_ns()
        if not period_ns or chip.frozen or chip.resetting() or not chip.fifo_on():
            return
        now = chip.clock.now_us() * 1000 // period_ns
        if self._next < 0:
            self._next = now + 1
        fits = self.size // self.frame_bytes + 1
        if now - self._next > fits:     # the rest would be overwritten before anybody saw it
            self._next = now - fits
            self.lost = True
        while self._next <= now:
            k = self._next
            chip.measure(k, k * period_ns // 1000)
            self.bytes.extend(chip.fifo_frame(k))
            self._next = k + 1
        over = len(self.bytes) - self.size
        if over > 0:
            self.bytes = self.bytes[over:]
            self.lost = True

    def take(self, buf):
        """The oldest bytes; 0xFF where there are none."""
        n = min(len(buf), len(self.bytes))
        buf[:n] = self.bytes[:n]
        for i in range(n, len(buf)):
            buf[i] = 0xFF
        self.bytes = self.bytes[n:]


def words(counts, columns, high):
    """Two bytes of each of these counts (None: of nothing); high: which is the high one."""
    found = bytearray(2 * len(columns))
    for i, column in enumerate(columns):
        if column is None:
            continue
        found[2 * i + high] = counts[column] >> 8 & 0xFF
        found[2 * i + 1 - high] = counts[column] & 0xFF
    return found


def packet(counts, high, k):
    """Packet 3 of TDK's newer chips: header, six numbers, temperature in one byte, time stamp."""
    celsius = max(-128, min(127, (counts[6] + 32) >> 6))
    return b"\x68" + words(counts, (0, 1, 2, 3, 4, 5), high) + bytes(
        [celsius & 0xFF, k >> 8 & 0xFF, k & 0xFF])


def tagged(tag, counts, columns, k):
    """A word of STMicroelectronics' chips: tag, a counter of two bits, parity, three numbers."""
    head = tag << 3 | (k & 3) << 1
    odd = bin(head).count("1") & 1
    return bytes([head | odd]) + words(counts, columns, 1)
