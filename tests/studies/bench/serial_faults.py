"""A cable that fails while a board is provisioned, calibrated or pulled:

    python -m tests.studies.bench.serial_faults [--every 1] [--pulls 30] [--sessions 12]

A provisioning with a new firmware is cut off by a power failure in each block operation of the
flash in turn; then the board is started, provisioned again and started again. A pull goes over
a cable that damages bytes, loses and adds some, and cuts lines; then a second one over a good
cable. A calibration loses its cable, and the board its supply, at each of the things it says; and
goes over a bad cable. Then the board starts, has kept every pose it told of, or a record that is
right (as tests/faults/storm.py judges). Exits with 1 when the board starts neither the old nor
the new firmware, when anything does not mend, or when a file here is not the board's.
"""

import argparse
import collections
import sys
import tempfile
from pathlib import Path

from sixflip_host.virtual import micropython_fetch
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.faults import serial_faults as faults

STARTED = {(1, 1, 1): "the old firmware", (2, 2, 2): "the new firmware"}


def provisioned(micropython, every):
    """Counts of what a board starts after each cut; sentences on what is wrong."""
    counts, wrong = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        board = faults.Provisioned(micropython, Path(folder))
        operation, cut = 0, True
        while cut:
            started, cut, after, left = board.cut_at(operation)
            counts["cuts"] += cut
            what = STARTED.get(tuple(started or ()), "neither, but %s" % started)
            counts[what] += cut
            if started is None or what not in STARTED.values():
                wrong.append("cut at operation %d: the board starts %s" % (operation, what))
            if after != [2, 2, 2] or left:
                wrong.append("cut at operation %d: then %s, left %s" % (operation, after, left))
            operation += every
    return counts, wrong


def pulled(micropython, pulls):
    """Counts of exit codes; sentences on what is wrong."""
    counts, wrong = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder, VirtualBoard(
            faults.STILL, Path(folder) / "f.img", micropython=micropython) as board:
        pull = faults.Pulled(board, Path(folder) / "here")
        for seed in range(pulls):
            cable = faults.BadCable(seed, (0.01, 0.05, 0.2)[seed % 3], 150 * seed)
            code, error, found = pull.pull(cable)
            counts["exit code %d" % code] += 1
            if found or code not in faults.ENDS or "Traceback" in error:
                wrong.append("pull %d: exit code %d, %s %s" % (seed, code, error.strip(), found))
    return counts, wrong


def calibrated(micropython, sessions):
    """Counts of exit codes, cable pulled out or bad; sentences on what is wrong."""
    counts, wrong = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        board = faults.Calibrated(micropython, Path(folder))
        cables = [("pulled out", when, lambda b, w=when: faults.PullOut(b, w.encode()))
                  for when in faults.CALIBRATING]
        cables += [("bad cable", "seed %d" % seed, lambda b, s=seed: faults.BadCable(
            s, (0.002, 0.01, 0.05)[s % 3], 1000 * s)) for seed in range(sessions)]
        for kind, name, cable in cables:
            code, error, found = board.calibrate(cable)
            counts["%s: exit %d" % (kind, code)] += 1
            if found:
                wrong.append("calibrate, %s, %s: %s %s" % (kind, name, found, error.strip()))
    return counts, wrong


def main():
    """All tables; exit code 1 when something was lost."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--every", type=int, default=1, help="each n-th operation is cut")
    parser.add_argument("--pulls", type=int, default=30)
    parser.add_argument("--sessions", type=int, default=12, help="calibrations over a bad cable")
    args = parser.parse_args()
    micropython = micropython_fetch.find()
    if micropython is None:
        raise SystemExit(micropython_fetch.MISSING)
    broken = []
    with faults.impatient():
        for title, (counts, wrong) in (
                ("provisioning cut off", provisioned(micropython, args.every)),
                ("calibrate", calibrated(micropython, args.sessions)),
                ("pull over a bad cable", pulled(micropython, args.pulls))):
            print(title)
            for what, n in sorted(counts.items()):
                print("  %-24s%6d" % (what, n))
            print("  %-24s%6d" % ("wrong", len(wrong)), flush=True)
            broken += wrong
    for one in broken:
        print("wrong:", one)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
