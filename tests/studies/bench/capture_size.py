"""What a raw capture takes: on the flash, on the wire to a host that records it, and in time.

Bytes of a sample as capture/writer.py writes them (steps of a byte, or the number itself) and as
they were written before (whole numbers), of real recordings and of simulated sessions; the
microseconds that keeping a sample takes on MicroPython's unix port; bytes a second on the wire.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from sixflip.capture.blocks import ACCEL, GYRO, TEMP, places
from sixflip.capture.pieces import PieceWriter
from sixflip.capture.writer import BlockWriter
from sixflip_host import cli
from sixflip_host.board.recording import EVENTS_BYTES, SHAKEN_BYTES, UART_BYTES
from sixflip_host.capture import capture_file, recordings
from sixflip_host.errors import BadFile
from sixflip_host.virtual import micropython_fetch

ROOT = Path(__file__).resolve().parents[3]
BLOCK = 32              # samples, as the firmware's
FRAME = 4 + 10 + 4      # bytes of a block around its samples
TIMED = """
import time
from array import array
from sixflip.capture.writer import BlockWriter
rows = [array("h", r) for r in %r]
writer = BlockWriter(lambda data: None, b"{}")
begun = time.ticks_us()
for _ in range(50):
    for row in rows:
        writer.add(10000, row)
print(time.ticks_diff(time.ticks_us(), begun) / 50 / len(rows))
"""


def sizes(intervals, counts, columns):
    """(bytes a sample whole, as steps, on the wire) of counts (n, columns)."""
    flash, wire = bytearray(), bytearray()
    pieces = PieceWriter(wire.extend)

    def write(data):
        flash.extend(data)
        pieces.send(0, data)
    writer = BlockWriter(write, b"{}", columns, BLOCK)
    sample = [0] * 10
    for dt, row in zip(intervals, counts):
        for place, value in zip(places(columns), row):
            sample[place] = value
        writer.add(dt, sample)
    writer.flush()
    n = len(counts)
    return 2 + 2 * len(places(columns)) + FRAME / BLOCK, len(flash) / n, len(wire) / n


def show(name, t_us, counts, columns):
    counts = np.clip(np.rint(counts), -32768, 32767).astype(int)
    whole, steps, wire = sizes(np.diff(t_us, prepend=t_us[0]).astype(int).tolist(),
                               counts.tolist(), columns)
    print("| %s | %.1f | %.1f | %.2f | %.2f |" % (name, whole, steps, steps / whole,
                                                 wire * 0.1))
    return counts, wire


def simulated(sensor, folder):
    scenario, output = Path(folder) / "s.toml", [Path(folder) / name for name in "ab"]
    scenario.write_text('sensor = "%s"\nscene = "recommended"\nseed = 4\n' % sensor)
    cli.main(["--quiet", "simulate", str(scenario), "-o", *["%s.csv" % path for path in output]])
    capture = capture_file.read("%s.csv" % output[0])
    return capture.t_us, np.column_stack([capture.accel, capture.gyro, capture.temp])


def real():
    """(name, times in us, counts, columns) of the recordings that are here."""
    try:
        place = recordings.folder()
    except BadFile as error:
        print(error, file=sys.stderr)
        return
    counts = recordings.suarez(place)
    yield "MPU6050 at rest (suarez)", np.arange(len(counts)) * 10000, counts, ACCEL | GYRO
    for name in ("ambient_1", "chainsaw_1"):
        counts, _, rate = recordings.tree(place, name)
        yield "MPU6050 on a tree, %s" % name, np.arange(len(counts)) * 1e6 / rate, counts, ACCEL
    accel, gyro = recordings.xsens(place)
    yield "Xsens, 38 poses by hand", np.arange(len(accel)) * 10000, np.hstack([accel, gyro]), \
        ACCEL | GYRO


def main():
    print("| capture | bytes a sample, whole | as steps | share | wire, KB/s at 100 Hz |")
    print("|---|---|---|---|---|")
    for one in real():
        show(*one)
    with tempfile.TemporaryDirectory() as folder:
        for sensor in ("mpu6050", "gy85"):
            t_us, counts = simulated(sensor, folder)
            counts, _ = show("%s, recommended session, simulated (%d samples)" % (
                sensor, len(counts)), t_us, counts, ACCEL | GYRO | TEMP)
    shaken = np.random.default_rng(1).integers(-32768, 32767, (5000, 7))
    _, wire = show("noise over the whole range", np.arange(5000) * 10000, shaken,
                   ACCEL | GYRO | TEMP)
    print("\nA port of 115200 baud carries %.1f KB/s, less %.1f for a session's events: enough "
          "for %d samples a second of the worst kind." % (
              UART_BYTES / 1e3, EVENTS_BYTES / 1e3, (UART_BYTES - EVENTS_BYTES) / SHAKEN_BYTES))
    micropython = micropython_fetch.find()
    if micropython:
        rows = counts[:200].tolist()
        took = subprocess.run([micropython, "-c", TIMED % rows], cwd=ROOT / "shared",
                              capture_output=True, text=True, check=True).stdout
        print("Keeping a sample takes %.1f us on MicroPython's unix port here." % float(took))
    return 0 if wire <= SHAKEN_BYTES else 1


if __name__ == "__main__":
    sys.exit(main())
