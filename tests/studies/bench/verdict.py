"""What the verdict makes of sessions in which something goes wrong, and whether sigma is true.

    python -m tests.studies.bench.verdict [--runs 132] [--sessions 300]

Sessions of tests/worlds/hostile_sessions.py: tables tilted by 0 to 5 degrees, every box placed
to 0.05 degrees and flipped to 0.4, raw bias up to 120 mg. "worst" is the largest RMS error over
all directions of a correction that was called good. Exits with 1 when a claim does not hold.
"""

import argparse
import sys

from tests.worlds import hostile_sessions as hostile
from tests.worlds import sigma_coverage, verdict_table


def main():
    """Both tables for both sensors."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=132, help="sessions a fault (honest: thrice)")
    parser.add_argument("--sessions", type=int, default=300, help="for the coverage of sigma")
    args = parser.parse_args()
    broken = []
    for sensor in hostile.SENSORS:
        print("%s-like: %d sessions a fault" % (sensor, args.runs))
        print(verdict_table.HEAD)
        for case in verdict_table.CASES:
            runs = args.runs * (3 if case[0] == "honest" else 1)
            row = verdict_table.judge(case, sensor, range(runs))
            print(row.line(), flush=True)
            if not row.holds():
                broken += ["%s: %s, seed %d: %s: %s" % (sensor, case[0], *one)
                           for one in row.broken[:3]]
        print()
    for scatter in (0.0, hostile.SCATTER_DEG):
        print("true error within 1 and 2 sigma, %d sessions placed to %.2f degrees"
              % (args.sessions, scatter))
        for sensor in hostile.SENSORS:
            shares = sigma_coverage.coverage(sensor, range(args.sessions), scatter)
            print("  %-10s" % sensor + "   ".join("%s %4.1f %% %5.1f %%" % (
                name, 100 * one, 100 * two) for name, (one, two) in shares.items()), flush=True)
            broken += ["%s: sigma of %s" % (sensor, name) for name in shares
                       if not sigma_coverage.honest(shares[name])]
    for claim in broken:
        print("claim does not hold:", claim)
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
