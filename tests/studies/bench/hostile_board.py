"""Boards that answer with malice, by the thousand, and every verb that talks to one:

    python -m tests.studies.bench.hostile_board [--runs 1000] [--first 0] [--jobs 4] [--verb pull]

Each run is one verb (its whole code, the raw REPL included) at a board that attacks in one way
from some word on: types, missing and extra fields, nested, huge, damaged, repeated, dripping,
endless. tests/faults/hostile_answers.py makes them from the seed. Time is the board's own, so
that an hour of dripping takes a second. "wrong": an internal error, an end that is too late, a
character that steers a terminal. Exits with 1 when there is one.
"""

import argparse
import collections
import os
import sys
from concurrent.futures import ProcessPoolExecutor

from tests.faults import hostile_board

COLUMNS = (0, 1, 3, 4)


def one(asked):
    """(verb, seed, kind, hits, exit code, seconds of the board, real seconds, wrong)"""
    verb, seed = asked
    result = hostile_board.attacked(verb, seed)
    return (verb, seed, result.attack.kind, result.attack.hits, result.code, result.seconds,
            result.real, result.wrong)


def main():
    """The table; exit code 1 when a run was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=1000, help="of each verb")
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--verb", choices=hostile_board.VERBS, action="append")
    args = parser.parse_args()
    verbs = args.verb or list(hostile_board.VERBS)
    seeds = range(args.first, args.first + args.runs)
    found = collections.defaultdict(list)
    print("%-18s%8s" % ("verb", "hit") + "".join("%8s" % ("exit %d" % c) for c in COLUMNS)
          + "%8s%14s" % ("wrong", "longest, s"))
    wrong = 0
    with ProcessPoolExecutor(args.jobs) as pool:
        for result in pool.map(one, [(verb, seed) for verb in verbs for seed in seeds],
                               chunksize=20):
            its = found[result[0]]
            its.append(result)
            if len(its) == args.runs:
                codes = collections.Counter(r[4] for r in its)
                bad = [r for r in its if r[7]]
                wrong += len(bad)
                print("%-18s%8d" % (result[0], sum(r[3] > 0 for r in its))
                      + "".join("%8d" % codes[c] for c in COLUMNS)
                      + "%8d%14.0f" % (len(bad), max(r[5] for r in its)), flush=True)
                for _, seed, kind, _, _, _, _, why in bad[:10]:
                    print("    wrong: seed %d, %s: %s" % (seed, kind, why))
    print("%d runs, %d wrong" % (len(verbs) * args.runs, wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
