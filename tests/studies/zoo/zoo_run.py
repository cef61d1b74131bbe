"""make zoo: every documented defect, same and different motion, several seeds, the real side with
parameters of its own and one of five effects; a confusion table, and what simpler methods say."""
import argparse
import functools
import sys
import time
from collections import Counter
from dataclasses import dataclass

from sixflip_host.capture import capture_file
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, traces

from .. import cases
from . import baselines, defects, engine

IN_PARAMETERS = {"bandwidth": "smoothness", "noise": "noise_density"}
NOTHING, ONE_OF, WRONG = "(nothing)", "(one of)", "wrong"


@functools.cache
def motion(kind, seed, quick):
    """A run of an engine; made once in each worker."""
    return engine.rover(seed, "arm", 60.0) if kind == "rover" else engine.box(seed, "arm", quick)


@dataclass(frozen=True)
class Pair:
    """A defect, the engine's kind of motion, its seed, whether real and simulated motion are the
    same, and whether the boxes are those of a minute."""

    name: str
    kind: str
    seed: int
    same: bool
    quick: bool


def answered(pair):
    """{outcome, said, quiet, simple} of a Pair: what a worker does. simple: {method of baselines:
    right, nothing or wrong}, of the first seed and one motion; quiet: the whole diagnosis of a
    healthy simulator says that there is no gap."""
    name, first = pair.name, pair.seed + 1
    real = motion(pair.kind, first, pair.quick)
    sim = real if pair.same else motion(pair.kind, first + 1, pair.quick)
    found, logs = case(name, real, sim, 100 * pair.seed + len(name), name == "healthy")
    return {"outcome": outcome(name, found), "said": said(found, defects.DEFECTS[name][3]),
            "quiet": name == "healthy" and diagnose(
                [("real", logs[0])], [("sim", logs[1])]).verdict == "no gap",
            "simple": simple(name, logs, found) if pair.same and not pair.seed else {}}


def case(name, real, sim, seed, healthy_equal=False):
    """(Comparison, real and simulated (force, rate) for the simple methods)."""
    effect = "" if healthy_equal else defects.EFFECTS[seed % 5]
    own = not healthy_equal and defects.DEFECTS[name][3] != "parameters"
    texts = defects.pair(name, real, sim, seed, effect if own else "", own)
    logs = [capture_file.parse("log", text.encode()) for text in texts]
    return comparison.compare([("real", logs[0])], "sim", logs[1]), logs


def said(found, layer):
    """The names said: conventions, or the parameters of a simulator that has no other defect."""
    names = []
    for c in found.conventions:
        names.append(ONE_OF if c.one_of else c.name)
    if layer == "parameters":
        names += sorted({p.name for p in found.differs})
    return names or [NOTHING]


def outcome(name, found):
    """right, one of, nothing or wrong."""
    _, _, right, layer, _ = defects.DEFECTS[name]
    right = {IN_PARAMETERS.get(n, n) for n in right}
    names = said(found, layer)
    if not right:
        return "right" if names == [NOTHING] else WRONG
    if set(names) & right and set(names) <= right | {ONE_OF}:
        return "right"
    if any(set(c.one_of) & right for c in found.conventions):
        return ONE_OF
    return NOTHING if names == [NOTHING] else WRONG


def judged_simply(name, said_one):
    """right, nothing or wrong: what a simple method says of a defect; of a healthy simulator
    silence is right; a channel is no name."""
    right = defects.DEFECTS[name][2]
    said_one = "" if said_one.startswith("channel") else said_one
    if said_one in right or not said_one and not right:
        return "right"
    return WRONG if said_one else NOTHING


def simple(name, logs, found):
    """{method of baselines: what it is worth} on a pair of one motion."""
    if not found.alignment.same:
        return {}
    pair = baselines.paired(*(traces.trace_from_capture("log", log) for log in logs),
                            found.alignment)
    told = {method: ask(pair) for method, ask in baselines.METHODS.items()}
    return {method: judged_simply(name, answer) for method, answer in told.items()
            if answer is not None}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--kinds", default="box,rover")
    parser.add_argument("--quick", action="store_true", help="boxes of a minute")
    parser.add_argument("--defects", default="")
    cases.add_arguments(parser)
    args = parser.parse_args()
    names = args.defects.split(",") if args.defects else list(defects.DEFECTS)
    pairs = [Pair(name, kind, seed, same, args.quick) for kind in args.kinds.split(",")
             for seed in range(args.seeds) for same in (True, False) for name in names]
    started = time.monotonic()
    table, counts, healthy, simply = {}, Counter(), Counter(), {}
    for pair, one in zip(pairs, cases.done(answered, pairs, cases.target(args), "zoo")):
        row = table.setdefault((pair.name, pair.kind, "same" if pair.same else "other"), Counter())
        row.update(one["said"])
        if pair.name == "healthy":
            healthy["no gap" if one["quiet"] else "a gap"] += 1
        else:
            visible = pair.same or (defects.DEFECTS[pair.name][4] and pair.kind == "box")
            counts["visible" if visible else "hidden", one["outcome"]] += 1
        for method, worth in one["simple"].items():
            simply.setdefault(method, Counter())[worth] += 1
    show(table, counts, healthy, simply, time.monotonic() - started)
    return 1 if counts["visible", WRONG] + counts["hidden", WRONG] else 0


def show(table, counts, healthy, simply, seconds):
    print("%-24s %-6s %-6s %s" % ("defect", "motion", "", "said"))
    for (name, kind, same), row in table.items():
        print("%-24s %-6s %-6s %s" % (name, kind, same, ", ".join(
            "%s %d" % pair for pair in row.most_common())))
    for part, words in (("visible", "that these logs can show"),
                        ("hidden", "that another motion hides")):
        total = sum(v for (p, _), v in counts.items() if p == part)
        if total:
            print("of %d defects %s: right %d (%.0f %%), one of several %d, nothing said %d, "
                  "a wrong name %d" % (total, words, counts[part, "right"],
                                       100.0 * counts[part, "right"] / total,
                                       counts[part, ONE_OF], counts[part, NOTHING],
                                       counts[part, WRONG]))
    if healthy:
        total = sum(healthy.values())
        print("healthy simulators: no gap %d of %d" % (healthy["no gap"], total))
    print("simpler methods on the pairs of one motion of the first seed, aligned for them "
          "(silence is right of a healthy simulator only):")
    for method in baselines.METHODS:
        row = simply.get(method)
        print("  %-22s %s" % (method, "not installed" if row is None else
                              "right %d, nothing %d, wrong %d" % (
                                  row["right"], row[NOTHING], row[WRONG])))
    print("%.0f s" % seconds)


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
