"""make zoo: every documented defect, same and different motion, several seeds, the real side with
parameters of its own and one of five effects; a confusion table, and what simpler methods say."""
import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import defects  # noqa: E402
import engine  # noqa: E402

from sixflip_host.capture import capture_file  # noqa: E402
from sixflip_host.diagnosis.simulator import comparison, simulator_answer  # noqa: E402

IN_PARAMETERS = {"bandwidth": "smoothness", "noise": "noise_density"}
NOTHING, ONE_OF, WRONG = "(nothing)", "(one of)", "wrong"


def motions(kind, seeds, quick):
    return [engine.rover(s, "arm", 60.0) if kind == "rover" else engine.box(s, "arm", quick)
            for s in range(1, seeds + 2)]


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


def simple(logs):
    """What is done without a model: the largest correlation between channels, and the channel
    with the largest root mean square of what is left after subtraction."""
    n = min(len(logs[0].t_us), len(logs[1].t_us))
    a, b = (np.column_stack([x.accel, x.gyro])[:n].astype(float) for x in logs)
    left = (a - b).std(axis=0) / np.maximum(a.std(axis=0), 1e-9)
    return "channel %d" % int(left.argmax())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--kinds", default="box,rover")
    parser.add_argument("--quick", action="store_true", help="boxes of a minute")
    parser.add_argument("--defects", default="")
    args = parser.parse_args()
    table, counts, healthy, started = {}, Counter(), Counter(), time.process_time()
    names = args.defects.split(",") if args.defects else list(defects.DEFECTS)
    channels = Counter()
    for kind in args.kinds.split(","):
        made = motions(kind, args.seeds, args.quick)
        for seed in range(args.seeds):
            for same in (True, False):
                for name in names:
                    real, sim = made[seed], made[seed if same else seed + 1]
                    equal = name == "healthy"
                    found, logs = case(name, real, sim, 100 * seed + len(name), equal)
                    result = outcome(name, found)
                    visible = same or (defects.DEFECTS[name][4] and kind == "box")
                    row = table.setdefault((name, kind, "same" if same else "other"), Counter())
                    row.update(said(found, defects.DEFECTS[name][3]))
                    if equal:
                        quiet = simulator_answer.verdict("no gap", [found]) == "no gap"
                        healthy["no gap" if quiet else "a gap"] += 1
                    else:
                        counts["visible" if visible else "hidden", result] += 1
                    if same:
                        channels[simple(logs)] += 1
    show(table, counts, healthy, channels, time.process_time() - started)
    return 1 if counts["visible", WRONG] + counts["hidden", WRONG] else 0


def show(table, counts, healthy, channels, seconds):
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
    print("residual RMS alone points at: %s; it names no defect" % ", ".join(
        "%s %d" % pair for pair in channels.most_common()))
    print("%.0f s of processor time" % seconds)


if __name__ == "__main__":
    sys.exit(main())
