"""The baselines beside `sixflip diagnose` on the same sealed cases, scored by the same scorer.

`answers` runs them on the files of a case, before its label is known; `report` counts what was
right and wrong once the seals are open. By hand, on a run that kept its captures:

    python -m tests.studies.blind.blind_run --keep --count 60 -o OUT
    python -m tests.studies.blind.baselines.beside OUT
"""

import json
import sys
from pathlib import Path

from ... import cases
from . import BASELINES

PRODUCT = "sixflip diagnose"
SILENT = ("no gap", "cannot tell")
TOLD = ("clear", "aliased")  # effects that show in the means of the poses
UNKNOWN = ("stranger", "held out", "left out")
HEAD = "%-18s %13s %13s %13s %13s %13s %13s %13s %5s" % (
    "", "false alarms", "right class", "right name", "false names", "unknown", "gap closed",
    "gap closed", "")
HEAD2 = "%-18s %13s %13s %13s %13s %13s %13s %13s %5s" % (
    "", "on nulls, %", "%", "(clear), %", "a run", "explained, %", "median, %", "on nulls, %",
    "cases")


def answers(paths):
    """{baseline: its answer} on the capture files of one case."""
    from sixflip_host.capture import capture_file
    captures = [capture_file.read(path) for path in paths]
    return {name: baseline(captures) for name, baseline in BASELINES.items()}


class Tally:
    """What one method did over all cases."""

    def __init__(self):
        self.alarms, self.classes, self.names, self.false = [], [], [], []
        self.unknown, self.closed, self.on_nulls = [], [], []
        self.cases = 0

    def add(self, label, answer, result):
        """result: what scoring.scored makes of the answer."""
        self.cases += 1
        suite = label["suite"]
        if suite == "null":
            # a crooked box that is called so is no false alarm
            self.alarms.append(bool(result["false"]) or (
                answer["verdict"] not in SILENT and not result["named"]))
            self.on_nulls += [closed(gap) for gap in answer["gap"].values()]
        elif suite in UNKNOWN:
            self.unknown.append(answer["verdict"] == "explained" and not _open(answer))
        elif suite in ("single", "pair"):
            self.false.append(len(result["false"]))
            for effect in result["effects"]:
                if effect["expected"] in TOLD:
                    self.classes.append(effect["class_right"])
                    self.closed.append(closed(answer["gap"].get(effect["sensor"])))
                if effect["expected"] == "clear":
                    self.names.append(effect["name_right"])

    def line(self, name):
        cells = [percent(self.alarms), percent(self.classes), percent(self.names),
                 "%.2f" % mean(self.false) if self.false else "-", percent(self.unknown),
                 median(self.closed), median(self.on_nulls)]
        return "%-18s %13s %13s %13s %13s %13s %13s %13s %5d" % (name, *cells, self.cases)


def _open(answer):
    """True when every name is one of a class left open."""
    return all(len(c["class"]) > 1 for c in answer["causes"])


def closed(gap):
    """Share of the squared gap on what was held out that is gone; None without figures."""
    if not gap or not gap["before"]:
        return None
    return 1.0 - (gap["after"] / gap["before"]) ** 2


def mean(values):
    return sum(values) / len(values)


def percent(flags):
    return "%.0f of %d" % (100.0 * mean(flags), len(flags)) if flags else "-"


def median(values):
    known = sorted(v for v in values if v is not None)
    if not known:
        return "-"
    half = len(known) // 2
    middle = known[half] if len(known) % 2 else 0.5 * (known[half - 1] + known[half])
    return "%.0f" % (100.0 * middle)


def report(labels, outcomes):
    """The table as text. labels {id: label}; outcomes: those of blind_run.diagnosed, each with
    "baselines": {name: answer}."""
    from ..scoring import scored
    tallies = {name: Tally() for name in (PRODUCT, *BASELINES)}
    for outcome in outcomes:
        label = labels[outcome["id"]]
        for name, tally in tallies.items():
            answer = outcome["answer"] if name == PRODUCT else outcome["baselines"][name]
            if answer is not None:
                tally.add(label, answer, scored(label, dict(outcome, answer=answer)))
    return "\n".join([HEAD, HEAD2, *[t.line(name) for name, t in tallies.items()]])


def main():
    from sixflip_host.fleet import cluster

    from .. import seal
    folder = Path(sys.argv[1])
    outcomes = json.loads((folder / "answers.json").read_text())
    files = {case["id"]: [str(folder / "captures" / f) for f in case["files"]]
             for case in json.loads((folder / seal.MANIFEST).read_text())["cases"]}
    found = cases.done(answers, [files[o["id"]] for o in outcomes], cluster.Target(None, 2),
                       "baselines")
    for outcome, one in zip(outcomes, found):
        outcome["baselines"] = one
    print(report(seal.opened(folder), outcomes))
    return 0


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
