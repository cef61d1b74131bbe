"""One effect at a time taken out of the library: no other name may confidently take its place.

    python -m tests.studies.robustness.left_out [--sizes 1 3] [--seeds 2] [--jobs 2]

Cases of the blind generator with one known effect, diagnosed with `--without` that effect. Right
is a verdict that something is not explained, or an alias class named as a class; honest where
the effect is faint: no gap, cannot tell; unavoidable where another effect is its exact alias, by
theory. Wrong is any other single name. Exits with 1 if there is one.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from .. import cases
from ..blind.generator.case import Case, Specification
from ..blind.generator.library import KNOWN
from ..blind.judged import judged
from . import ask

PROTOCOL = {"lever_arm": "driving", "filter_lag": "driving"}
# What no protocol of hands and tables shows, or what has no name of its own to take out.
NOT_ASKED = ("local_gravity", "stuck_bit")
ALIASED = 0.95
OPEN = ("unexplained", "partly explained")
KINDS = ("open", "class", "quiet", "alias", "wrong")


def things():
    """[(effect, sensor)] that are asked."""
    return [(name, sensor) for name, (_, sensors) in KNOWN.items() if name not in NOT_ASKED
            for sensor in sensors]


def specification(effect, sensor, times, seed):
    return Specification(seed, "mpu6050", PROTOCOL.get(effect, "recommended"),
                         [(effect, sensor, times)],
                         {"box_tilt_deg": 0.0})


def kind(answer, effect, also=(), aliases=()):
    """What an answer without the effect is worth, and the single names that are wrong.

    also: [(effect, sensor)] that come with it and may be named; aliases: names that cannot be
    told from it."""
    single = ["%s %s" % (c["sensor"], c["effect"]) for c in answer["causes"]
              if c["effect"] and (c["effect"], c["sensor"]) not in also]
    if single and answer["verdict"] == "explained":
        known = {c["effect"] for c in answer["causes"] if c["effect"]} <= {
            *aliases, *(name for name, _ in also)}
        return "alias" if known else "wrong", single
    if answer["verdict"] in OPEN:
        return "open", single
    if any(len(c["class"]) > 1 for c in answer["causes"]):
        return "class", []
    return "quiet", []


def asked(job):
    """(effect, sensor, size, seed, kind, wrong names, verdict) of one case."""
    effect, sensor, times, seed = job
    case = Case(specification(effect, sensor, times, seed))
    with tempfile.TemporaryDirectory() as folder:
        paths = case.write(str(Path(folder) / "case"))
        answer = ask.on_files(paths, "--without", effect, "--jobs", "1")
    also = [pair for e in case.effects for pair in map(tuple, e.also)]
    theory = judged(case)["effects"][0].get("aliases", {})
    aliases = [name for name, index in theory.items() if index > ALIASED]
    return (effect, sensor, times, seed, *kind(answer, effect, also, aliases), answer["verdict"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sizes", type=float, nargs="+", default=[1.0, 3.0],
                        help="of the typical size")
    parser.add_argument("--seeds", type=int, default=2)
    cases.add_arguments(parser)
    args = parser.parse_args()
    jobs = [(*thing, times, 9000 + 100 * number + seed) for number, thing in enumerate(things())
            for times in args.sizes for seed in range(args.seeds)]
    rows = cases.done(asked, jobs, cases.target(args), "left out")
    for row in rows:
        if row[5]:
            print("%s %s %gx, seed %d: %s beside %s" % (
                row[1], row[0], row[2], row[3], row[6], ", ".join(row[5])))
    print("%-24s %-7s" % ("taken out", "sensor") + "".join("%8s" % k for k in KINDS))
    for thing in things():
        mine = [row[4] for row in rows if row[:2] == thing]
        print("%-24s %-7s" % thing + "".join("%8d" % mine.count(k) for k in KINDS))
    wrong = sum(row[4] == "wrong" for row in rows)
    print("%d of %d: a confident wrong name; %d: a verdict of unexplained or partly, or a class"
          % (wrong, len(rows), sum(row[4] in ("open", "class") for row in rows)))
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
