"""A failing bus over a whole calibration, by the thousand:

    python -m tests.studies.bench.bus_storm [--runs 10000] [--first 0] [--jobs 4] [--log FILE]

First every fault at every step of the protocol, for an MPU6050, an MPU6500 and both chips of a
GY-85; then noise, late, repeated, torn and lost samples all through a calibration, at six rates;
then random storms of one to three kinds of faults, each once or now and then, in the
calibration and in the power-up after it; the seeds are those from --first on. "wrong": a
correction called good that is off by more than it may be (tests/faults/storm.py says how much),
a bias measured wrongly, a stream that shows another g, a firmware that stops or hangs, a refusal
without a reason. Exits with 1 when there is one. A storm takes a third of a second; --log keeps
each as a line, and those in it are not run again.
"""

import argparse
import collections
import gc
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from tests.faults import fault_matrix, storm

WORDS = ("good", "doubtful", "refused", "no sensor", "wrong")
BEHIND = ((0, None), (1, 0x53), (1, 0x68), (2, None))  # sensor, address
LEFT = 20       # runs in a piece of work
EACH = 12       # runs of a kind at a rate


def matrix(step):
    """[(kind, word, reason)] of every fault at one step."""
    found = []
    for sensor, address in BEHIND:
        places = fault_matrix.places(sensor)
        for fault in fault_matrix.FAULTS:
            outcome, happened = fault_matrix.run(sensor, step, fault, places, address)
            if happened:
                found.append((fault["kind"], outcome.word, outcome.reason))
    return found


def throughout(kind):
    """[(rate, seed, word, reason)] of one kind at every rate."""
    found = []
    for rate in storm.RATES:
        for seed in range(EACH):
            outcome = storm.throughout(kind, rate, seed)
            found.append((rate, seed, outcome.word, outcome.reason))
    return found


def storms(seeds):
    """[(seed, kinds, word, reason, error in mg)] of some storms."""
    found = []
    for seed in seeds:
        outcome, kinds = storm.storm(seed)
        found.append((seed, kinds, outcome.word, outcome.reason, outcome.error_mg))
    return found


def every(pool, seeds, log):
    """Results of all storms as storms() gives them, those in a log first."""
    done = {}
    if log and log.exists():
        done = {one[0]: one for one in map(json.loads, log.read_text().splitlines())}
    yield [done[seed] for seed in seeds if seed in done]
    left = [seed for seed in seeds if seed not in done]
    for found in pool.map(storms, [left[i:i + LEFT] for i in range(0, len(left), LEFT)]):
        if log:
            with open(log, "a", encoding="utf-8") as f:
                f.writelines(json.dumps(one) + "\n" for one in found)
        yield found


def line(name, words, tail=""):
    print("%-16s" % name + "".join("%10d" % words[w] for w in WORDS) + tail, flush=True)


def main():
    """Both tables; exit code 1 when a run was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=10000)
    parser.add_argument("--first", type=int, default=0, help="seed of the first storm")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--log", type=Path, help="file of storms that were run")
    args = parser.parse_args()
    wrong = []
    head = "%-16s" % "" + "".join("%10s" % w for w in WORDS)
    with ProcessPoolExecutor(args.jobs, initializer=gc.freeze) as pool:
        print("One fault at a step of the protocol\n" + head)
        total = collections.Counter()
        for step, found in zip(fault_matrix.STEPS, pool.map(matrix, fault_matrix.STEPS)):
            words = collections.Counter(word for _, word, _ in found)
            total += words
            wrong += ["%s at %s: %s" % (kind, step, reason)
                      for kind, word, reason in found if word == "wrong"]
            line(step, words)
        line("all", total)
        print("\nAll through a calibration and the power-up after it\n" + head)
        total = collections.Counter()
        for kind, found in zip(storm.THROUGHOUT, pool.map(throughout, storm.THROUGHOUT)):
            words = collections.Counter(word for _, _, word, _ in found)
            total += words
            wrong += ["%s at a rate of %s, seed %d: %s" % (kind, rate, seed, reason)
                      for rate, seed, word, reason in found if word == "wrong"]
            line(kind, words)
        line("all", total)
        print("\nRandom storms with such a fault among theirs\n" + head + "  worst good, mg")
        named = storm.KINDS + ("noise",)
        kinds_seen = {kind: collections.Counter() for kind in named}
        total, worst = collections.Counter(), collections.Counter()
        seeds = range(args.first, args.first + args.runs)
        for found in every(pool, seeds, args.log):
            for seed, kinds, word, reason, error in found:
                total[word] += 1
                if word == "wrong":
                    wrong.append("storm %d, %s: %s" % (seed, " ".join(kinds), reason))
                for kind in kinds + ["all"]:
                    if kind in kinds_seen:
                        kinds_seen[kind][word] += 1
                    if word == "good":
                        worst[kind] = max(worst[kind], error)
        for kind in named:
            line(kind, kinds_seen[kind], "%16.2f" % worst[kind])
        line("all", total, "%16.2f" % worst["all"])
    for one in wrong:
        print("wrong:", one)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
