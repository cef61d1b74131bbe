"""Samples that a chip took and nobody read, polled and through its FIFO, by a board as busy as a
Pico in a session: 7 ms at the end of each quarter of a second's window (instructions.py) and
45 ms for a block of flash every two seconds. Exits with 1 when a FIFO loses one.
"""

import sys
from array import array

from tests.worlds.numbered_chip import WITH, Running

WINDOW_US, BLOCK_US = 7000, 45000
SECONDS = 4         # a numbered sample counts to 9000
RATES = 100, 200, 400


def missed(sensor, rate_hz, by_fifo):
    """(%, of the chip's samples at the rate it is read with; that rate)."""
    board = Running(sensor, rate_hz, fifo=by_fifo)
    clock, sample, found = board.world.clock, array("h", [0] * 7), []
    rate = board.imu.rate_hz
    for i in range(SECONDS * rate):
        if board.paced.next(sample) >= 0:
            # by the time of the sample, in periods of the rate: the chip's own are finer if polled
            found.append((sample[0] - 1) * rate // round(board.imu.output_rate_hz))
        if i % (rate // 4) == 0:
            clock.sleep_us(WINDOW_US)
        if i % (2 * rate) == rate:
            clock.sleep_us(BLOCK_US)
    found = found[rate // 4:]
    return 100.0 * (1.0 - len(set(found)) / (found[-1] - found[0] + 1)), rate


def main():
    print("| chip | asked | polled: missed, % | FIFO: rate | missed, % |")
    print("|---|---|---|---|---|")
    worst = 0.0
    for sensor in WITH:
        for rate_hz in RATES:
            polled, _ = missed(sensor, rate_hz, False)
            kept, rate = missed(sensor, rate_hz, True)
            worst = max(worst, kept)
            print("| %s | %d | %.1f | %d | %.1f |" % (sensor, rate_hz, polled, rate, kept))
    return 1 if worst > 0 else 0


if __name__ == "__main__":
    sys.exit(main())
