"""Time and memory of importing a long CSV, beside numpy.loadtxt of the same file.

    python -m tests.studies.bench.import_size [ROWS …]

The bounds: 2 million rows in 20 s and 500 MB, 10 million in 2 GB, on an idle computer.

Every line is a process of its own; MB are its largest resident size, with numpy and our modules
in it (the first line). Without --no-poses the rests are looked for, too.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROWS = 2_000_000
COUNTS = "t_us,ax,ay,az,gx,gy,gz,temp"
UNITS = "t,ax,ay,az,gx,gy,gz"
MEASURE = """
import resource, sys, time
start, cpu = time.monotonic(), time.process_time()
%s
print("%%8.1f %%8.1f %%8.0f" %% (time.monotonic() - start, time.process_time() - cpu,
                               resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024))
"""
LOADTXT = "import numpy; numpy.loadtxt(sys.argv[1], delimiter=',', skiprows=1)"
IMPORT = """
from sixflip_host import cli
from sixflip_host.capture import find_poses
from sixflip_host.verbs import import_recording
assert cli.main(["--quiet", *sys.argv[1:]]) == 0
"""
NOTHING = IMPORT.replace("assert", "# assert")


def write(folder, rows):
    """A session of rests on the six faces, 40 s each, as counts, in SI units of whole steps, and
    in SI units without steps."""
    generator = np.random.default_rng(1)
    faces = np.array([(0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)])
    with open(folder / "counts.csv", "w") as counts, open(folder / "units.csv", "w") as units, \
            open(folder / "float.csv", "w") as floats:
        print(COUNTS, file=counts)
        print(UNITS, file=units)
        print(UNITS, file=floats)
        for first in range(0, rows, 4000):
            n = min(4000, rows - first)
            accel = np.rint(16384 * faces[first // 4000 % 6] + generator.normal(0, 40, (n, 3)))
            gyro = np.rint(generator.normal(0, 10, (n, 3)))
            t_us = (first + np.arange(n)) * 10000
            np.savetxt(counts, np.c_[t_us, accel, gyro, np.full(n, -3700)], "%d", ",")
            np.savetxt(units, np.c_[t_us / 1e6, accel / 16384 * 9.80665, gyro / 131 * np.pi / 180],
                       "%.6f", ",")
            noise = generator.normal(0, 1e-3, (n, 6))
            np.savetxt(floats, np.c_[t_us / 1e6, accel / 16384 * 9.80665 + noise[:, :3],
                                     gyro / 131 * np.pi / 180 + 0.01 * noise[:, 3:]],
                       "%.9f", ",")


def measured(program, *words):
    done = subprocess.run([sys.executable, "-c", MEASURE % program, *map(str, words)],
                          capture_output=True, text=True, check=True)
    return done.stdout.rstrip()


def main(rows):
    print("%d rows%s%8s %8s %8s" % (rows, " " * 23, "s", "CPU s", "MB"))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        write(folder, rows)
        counts = ("import", folder / "counts.csv", "-o", folder / "out.csv", "--accel-lsb", 16384,
                  "--gyro-lsb", 131, "--time-column", "t_us", "--time-unit", "us")
        floats = ("import", folder / "float.csv", "-o", folder / "out.csv")
        units = ("import", folder / "units.csv", "-o", folder / "out.csv", "--units", "si",
                 "--time-column", "t", "--time-unit", "s")
        for name, program, words in (
                ("nothing", NOTHING, ()), ("numpy.loadtxt", LOADTXT, counts[1:2]),
                ("import, counts", IMPORT, (*counts, "--no-poses")),
                ("import, m/s² and rad/s", IMPORT, (*units, "--no-poses")),
                ("import, no steps, all told", IMPORT, (*floats, "--no-poses")),
                ("import, counts, rests found", IMPORT, counts)):
            print("%-30s %s" % (name, measured(program, *words)), flush=True)


if __name__ == "__main__":
    for number in sys.argv[1:] or [ROWS]:
        main(int(number))
