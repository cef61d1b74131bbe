"""How long a command takes that computes nothing, beside mpremote, which talks to boards as well.

    python -m tests.studies.bench.command_start [--runs 10]

Each command is a process of its own, run in turn; the table has the least and the middle of the
seconds and of the processor seconds it took.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from sixflip.record import correction_record
from tests.worlds.written_records import of_a_gy85

COMMANDS = {
    "sixflip --version": ("sixflip_host", "--version"),
    "sixflip --help": ("sixflip_host", "--help"),
    "sixflip boards --help": ("sixflip_host", "boards", "--help"),
    "sixflip show RECORD": ("sixflip_host", "show", "RECORD"),
    "sixflip diagnose --help": ("sixflip_host", "diagnose", "--help"),
    "mpremote --version": ("mpremote", "--version"),
    "mpremote --help": ("mpremote", "--help"),
}


def taken(words):
    """(seconds, processor seconds) of `python -m` these words."""
    before, began = os.times(), time.perf_counter()
    done = subprocess.run([sys.executable, "-m", *words], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    wall, after = time.perf_counter() - began, os.times()
    if done.returncode:
        sys.exit("%s ended with %d: %s" % (" ".join(words), done.returncode, done.stderr.strip()))
    return wall, (after.children_user + after.children_system
                  - before.children_user - before.children_system)


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=10)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "record.bin"
        record.write_bytes(correction_record.encode(of_a_gy85()))
        found = {name: [] for name in COMMANDS}
        for _ in range(runs):
            for name, words in COMMANDS.items():
                found[name].append(taken([str(record) if w == "RECORD" else w for w in words]))
    print("| command, %d runs | least, s | middle, s | processor, least | middle |" % runs)
    print("|---|---|---|---|---|")
    for name, times in found.items():
        wall, cpu = zip(*times)
        print("| %s | %.2f | %.2f | %.2f | %.2f |" % (
            name, min(wall), statistics.median(wall), min(cpu), statistics.median(cpu)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
