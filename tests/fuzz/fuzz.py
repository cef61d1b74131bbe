"""Fuzzing of one target, guided by coverage where atheris can be had:

    python -m tests.fuzz.fuzz capture_text [-max_total_time=600] [more of libFuzzer's options]

What libFuzzer finds to be new is kept beside the corpus only with -keep: the corpus in the tree
is small and chosen. A crash leaves its input as crash-* in the current folder: put it into
tests/fuzz/corpus/TARGET, so that every test run replays it. Without atheris (it has no package
for this Python or machine) the corpus is mutated blindly: -runs=N -seed=N.

    python -m tests.fuzz.fuzz --each < LINES

imports and instruments everything once, forks for each line of input, a JSON list of a target and
its options and a file for what it says, and answers with a line, its exit code.
"""

import json
import os
import random
import sys
from pathlib import Path

CORPUS = Path(__file__).resolve().parent / "corpus"
OURS = ["sixflip", "sixflip_host", "sixflip_device", "json", "tomllib"]


def mutated(data, dice):
    """A few bytes changed, cut out, repeated, or put in from a small dictionary."""
    words = (b"[", b"{", b'"', b",", b"\n", b"\0", b"-", b"1e308", b"NaN", b"\x1b[2J", b"\xff\xff",
             b"99999999999999999999", b"\xe2\x80\xae", b"null", b"0")
    out = bytearray(data)
    for _ in range(dice.randint(1, 6)):
        at, n = dice.randint(0, len(out)), dice.randint(1, 40)
        kind = dice.randrange(5)
        if kind == 0 and out:
            out[at % len(out)] = dice.randrange(256)
        elif kind == 1:
            del out[at:at + n]
        elif kind == 2:
            out[at:at] = out[at:at + n] * dice.randint(1, 5)
        elif kind == 3:
            out[at:at] = dice.choice(words)
        else:
            out[at:at + n] = dice.choice(words) * dice.randint(1, n)
    return bytes(out)


def blindly(target, seeds, options):
    """-runs=N mutations; the first that fails is kept as crash-N."""
    given = dict(word[1:].split("=") for word in options if "=" in word)
    dice = random.Random(int(given.get("seed", 1)))
    for run in range(int(given.get("runs", 1000))):
        data = mutated(dice.choice(seeds), dice)
        try:
            target(data)
        except BaseException:
            Path(given.get("artifact_prefix", "") + "crash-%d" % run).write_bytes(data)
            raise


def imported():
    """(atheris or None, the targets' module, instrumented where there is an atheris)."""
    try:
        import atheris
    except ImportError:
        from tests.fuzz import targets
        return None, targets
    with atheris.instrument_imports(include=OURS):
        from tests.fuzz import targets
    return atheris, targets


def run(atheris, targets, name, options):
    """Guided: never returns, libFuzzer ends the process."""
    folder = CORPUS / name
    if atheris is None:
        blindly(targets.TARGETS[name], [p.read_bytes() for p in sorted(folder.iterdir())], options)
        return
    # A folder in front is where libFuzzer writes: one of this run, thrown away.
    found = Path(targets.FOLDER) / ("found-" + name)
    found.mkdir()
    folders = [str(folder)] if "-keep" in options else [str(found), str(folder)]
    options = [word for word in options if word != "-keep"]
    atheris.Setup([sys.argv[0], *options, *folders], targets.TARGETS[name])
    atheris.Fuzz()


def each():
    """A process for each line of stdin, forked from this one; its exit code on stdout."""
    tools = imported()
    for line in sys.stdin:
        name, options, said = json.loads(line)
        child = os.fork()
        if not child:
            for number in (1, 2):       # atheris tells an exception on stdout
                os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT | os.O_APPEND), number)
            run(*tools, name, options)
            sys.exit(0)
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)


def main():
    if sys.argv[1] == "--each":
        each()
    else:
        run(*imported(), sys.argv[1], sys.argv[2:])


if __name__ == "__main__":
    main()
