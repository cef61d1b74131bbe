"""How much memory the population of `sixflip fleet` takes, by the number of boards.

    python -m tests.studies.bench.fleet_memory [--boards 200 2000 10000]

The boards are estimates drawn (tests/worlds/drawn_fleet.py) and written as the data set that an
earlier run left, all of them in one batch, which is the worst case; the command itself makes the
population of them. Memory is the largest that the process had at any time.
"""
import argparse
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from sixflip_host.fleet import analysis, dataset
from tests.worlds import drawn_fleet

SESSIONS_OF = 12  # boards that errors are taken from: here only their size matters
PART = 64  # boards of a Parquet part, as run_fleet writes them


def made(folder, number, errors):
    """Write a data set of so many boards."""
    rng, data = np.random.default_rng(4), dataset.DataSet(folder)
    about = {"version": analysis.VERSION, "stamps": "s" * 80, "content": "", "written": 1.0,
             "paths": ["captures/board/warming.csv", "captures/board/cooling.csv"]}
    for first in range(0, number, PART):
        data.write([dict(errors.row(rng, "board %06d" % k, batch="lot"), **dict(
            about, content="%064d" % k)) for k in range(first, min(number, first + PART))])


def measured(folder, out):
    """(seconds, largest memory MB, processor seconds, exit code) of the command."""
    start = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, "-m", "sixflip_host", "fleet", folder, "-o", out],
        stdout=subprocess.DEVNULL, env=dict(os.environ, OPENBLAS_NUM_THREADS="1"))
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return (time.monotonic() - start, used.ru_maxrss / 1024.0,
            used.ru_utime + used.ru_stime, process.returncode)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--boards", type=int, nargs="+", default=[200, 2000, 10000])
    args = parser.parse_args()
    errors = drawn_fleet.Errors(np.random.default_rng(4), SESSIONS_OF)
    for number in args.boards:
        with tempfile.TemporaryDirectory() as top:
            made(os.path.join(top, "in"), number, errors)
            seconds, most, cpu, code = measured(os.path.join(top, "in"),
                                                os.path.join(top, "out"))
        print("%7d boards: %4.0f MB, %.1f s of processor, %.1f s%s" % (
            number, most, cpu, seconds, ", exit code %d" % code if code else ""), flush=True)


if __name__ == "__main__":
    main()
