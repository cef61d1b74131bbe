"""Power cuts at every block operation of saving a record and of writing a capture, on real
littlefs and FAT in MicroPython's unix port:

    python -m tests.studies.bench.power_cuts [--jobs 4] [--samples 60]

A cut is undone in part ("halves" of a write, of an erase) or leaves garbage. After each the flash
is mounted, the firmware's power-up looks at it, and the next save has to work. "twice": the
power fails again at each operation of that power-up. A loss is a record that is neither the old
nor the new one, a capture that is not readable up to its last whole block or lacks a pose that
was flushed, a next save that fails, a file nobody wrote that has changed, or a leftover that
stays. Exits with 1 when one occurs where none is promised.
"""

import argparse
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from sixflip_host.virtual.micropython_fetch import MISSING, find

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "tests" / "on_micropython" / "power_cuts.py"
SCENARIOS = {
    "save0": "first record", "save1": "second record", "save2": "third record",
    "save3": "fourth record", "restore": "record restored", "session": "session, capture kept",
    "refused": "session, refused", "redo": "one face again"}
LONG = ("session", "refused", "redo")
# file system, what a torn operation leaves, losses that may occur (None: any)
TIERS = (
    ("lfs2", "all", (), "littlefs: garbage in any torn write or erase"),
    ("fat", "whole", (), "FAT: a sector is written or not"),
    ("fat", "halves", (), "FAT: half a sector is old, half of it new"),
    ("fat", "data", ("last pose",), "FAT: garbage in a torn sector of a file"),
    ("fat", "all", None, "FAT: garbage in its table or root folder too (nothing is promised)"))


def cut(micropython, fs, scenario, ways, samples, twice):
    """What power_cuts.py found."""
    done = subprocess.run(
        [micropython, "-X", "heapsize=64m", str(SCRIPT), fs, scenario, ways, "1", str(samples),
         *["twice"] * twice], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        raise SystemExit("%s %s %s: %s" % (fs, scenario, ways, done.stderr[-500:]))
    return json.loads(done.stdout.splitlines()[-1])


def main():
    """The table; exit code 1 when something was lost that must not be."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--samples", type=int, default=60, help="of a pose in the captures")
    args = parser.parse_args()
    micropython = find()
    if micropython is None:
        raise SystemExit(MISSING)
    broken = []
    with ThreadPoolExecutor(args.jobs) as pool:
        runs = {}
        for fs, ways, allowed, _ in TIERS:
            for scenario in SCENARIOS:
                for twice in (False, True):
                    if not twice or allowed is not None and scenario not in LONG:
                        runs[fs, ways, scenario, twice] = pool.submit(
                            cut, micropython, fs, scenario, ways, args.samples, twice)
        for fs, ways, allowed, title in TIERS:
            print("\n%s\n  %-24s%12s%8s  %s" % (title, "", "operations", "cuts", "losses"))
            total = 0
            for (a_fs, a_ways, scenario, twice), run in runs.items():
                if (a_fs, a_ways) != (fs, ways):
                    continue
                found = run.result()
                name = SCENARIOS[scenario] + (", twice" if twice else "")
                total += found["cuts"]
                print("  %-24s%12d%8d  %s" % (name, found["operations"], found["cuts"], ", ".join(
                    "%s %d" % item for item in sorted(found["losses"].items())) or "0"),
                    flush=True)
                if allowed is not None and set(found["losses"]) - set(allowed):
                    broken.append("%s: %s: %s" % (title, name, found["losses"]))
            print("  %-24s%12s%8d" % ("all", "", total), flush=True)
    for claim in broken:
        print("claim does not hold:", claim)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
