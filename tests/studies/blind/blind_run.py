"""The blind check of `sixflip diagnose`: `make blind`.

1. generate: cases are drawn, captures written, labels sealed (generator/, seal.py);
2. diagnose: the product's verb on the files alone, its JSON kept;
3. score: the seals are opened and the answers held against them (scoring.py, target_tables.py).

Exit code 1 when something that must never happen happened, 0 otherwise.
"""

import argparse
import contextlib
import io
import json
import os
import shutil
import sys
import time
from pathlib import Path

from .. import cases
from . import seal, suites
from .baselines import beside
from .generator.case import Case
from .generator.held_out import HELD_OUT
from .judged import judged

COMPARED = ("null", "single", "pair", "stranger")    # what the baselines are put to
PART = "answers.part"
DEFAULT_COUNT = 220     # about 25 minutes on two cores


def generated(job):
    """Worker of step 1: writes a case's files; returns (public, label)."""
    name, suite, spec, folder, compare = job
    case = Case(spec)
    files = case.write(str(Path(folder) / name))
    twin = case.write_twin(str(Path(folder) / (name + "-twin"))) if spec.twin else []
    words = list(spec.options) + ["--certified-box"] * spec.certified
    label = {"suite": suite, **case.label(), "judged": judged(case)}
    return {"id": name, "files": [Path(f).name for f in files], "words": words,
            "twin": [Path(f).name for f in twin], "compare": compare}, label


def asked(paths, words):
    """(exit code, answer or None, what was said on stderr) of the verb."""
    from sixflip_host import cli
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main(["diagnose", *paths, *words, "--json", "--jobs", "1"])
    try:
        return code, json.loads(out.getvalue()), err.getvalue().strip()[:500]
    except ValueError:
        return code, None, err.getvalue().strip()[:500]


def diagnosed(job):
    """Worker of step 2: what the verb answers on the files; knows nothing else."""
    public, folder, keep = job
    paths, twin = ([str(Path(folder) / f) for f in public[which]] for which in ("files", "twin"))
    begin, busy = time.perf_counter(), time.process_time()
    code, answer, error = asked(paths, public["words"])
    outcome = {"id": public["id"], "code": code, "answer": answer, "error": error,
               "seconds": time.perf_counter() - begin, "cpu_s": time.process_time() - busy,
               "twin": asked(twin, public["words"])[1] if twin else None, "baselines": None}
    if public["compare"] and answer is not None:
        outcome["baselines"] = beside.answers(paths)
    if not keep:
        for path in paths + twin:
            os.remove(path)
    return outcome


def make(specifications, folder, where, compare=0):
    """Step 1 into a folder: captures, manifest, sealed labels; where: cluster.Target; `compare`
    cases of the suites COMPARED, evenly, are put to the baselines too."""
    captures = folder / "captures"
    captures.mkdir(parents=True, exist_ok=True)
    fair = [k for k, (suite, _) in enumerate(specifications) if suite in COMPARED]
    chosen = set(fair[::max(1, len(fair) // compare)][:compare]) if compare else ()
    jobs = [("case-%04d" % k, suite, spec, str(captures), k in chosen)
            for k, (suite, spec) in enumerate(specifications)]
    seal.write(folder, cases.done(generated, jobs, where, "generated"), sorted(HELD_OUT))


def diagnose(folder, where, keep, minutes=0.0):
    """Step 2: answers.json from the manifest and the captures; minutes: as cases.done() has it.
    Each answer is kept in a line of answers.part when it comes, and not asked for again."""
    order = json.loads((folder / seal.MANIFEST).read_text())["cases"]
    part = folder / PART
    answers = {one["id"]: one for one in _whole_lines(part)}
    jobs = [(public, str(folder / "captures"), keep) for public in order
            if public["id"] not in answers]
    with open(part, "a") as file:
        def kept(answer):
            print(json.dumps(answer), file=file, flush=True)
        for one in cases.done(diagnosed, jobs, where, "diagnosed", minutes, kept):
            answers[one["id"]] = one
    answers = [answers[public["id"]] for public in order if public["id"] in answers]
    (folder / "answers.json").write_text(json.dumps(answers))
    part.unlink()
    return answers


def _whole_lines(path):
    """The answers in a file to which the last was perhaps not written to its end."""
    if path.exists():
        *lines, cut = path.read_text().split("\n")
        path.write_text("".join(line + "\n" for line in lines))
        yield from map(json.loads, lines)


def score(folder):
    """Step 3: open the seals, print the tables, draw the pictures; the exit code."""
    from . import target_tables
    from .scoring import scored
    answers = json.loads((folder / "answers.json").read_text())
    labels = seal.opened(folder)
    results = [scored(labels[a["id"]], a) for a in answers]
    (folder / "scores.json").write_text(json.dumps(results))
    text, never = target_tables.report(results)
    if len(answers) < len(labels):
        text = "The first %d of %d cases (their order is random): no more fitted into the time " \
               "given.\n\n\n" % (len(answers), len(labels)) + text
    both = [a for a in answers if a["baselines"]]
    if both:
        text += "\n\n\nBaselines on the same cases\n\n" + beside.report(labels, both)
    (folder / "tables.txt").write_text(text)
    print(text)
    from . import score_pictures
    for path in score_pictures.draw(results, folder):
        print("wrote", path)
    return 1 if never else 0


def arguments(argv):
    parser = argparse.ArgumentParser(prog="make blind", description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=DEFAULT_COUNT, help="cases in all")
    cases.add_arguments(parser)
    parser.add_argument("--suite", action="append", choices=list(suites.SUITES),
                        help="only these (may be given again)")
    parser.add_argument("--effect", help="only cases with this effect")
    parser.add_argument("--compare", type=int, default=16, metavar="N",
                        help="put N of the cases to the baselines too (half a minute each)")
    parser.add_argument("--minutes", type=float, default=0.0, metavar="N",
                        help="diagnose as many of the cases, in their random order, as fit into "
                             "N minutes (0: all)")
    parser.add_argument("-o", "--output", type=Path, default=Path("blind-output"))
    parser.add_argument("--keep", action="store_true", help="keep the captures")
    parser.add_argument("--go-on", action="store_true",
                        help="diagnose what the last run, which was interrupted, left")
    parser.add_argument("--score-only", action="store_true",
                        help="score the answers of the last run again")
    return parser.parse_args(argv)


def main(argv=None):
    args = arguments(argv)
    where = cases.target(args)
    if not (args.score_only or args.go_on):
        (args.output / PART).unlink(missing_ok=True)
        shutil.rmtree(args.output / "captures", ignore_errors=True)
        chosen = suites.specifications(args.seed, args.count, args.suite or list(suites.SUITES))
        if args.effect:
            chosen = [(s, spec) for s, spec in chosen
                      if any(name == args.effect for name, _, _ in spec.effects)]
        make(chosen, args.output, where, args.compare)
    if not args.score_only:
        diagnose(args.output, where, args.keep, args.minutes)
    return score(args.output)


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
