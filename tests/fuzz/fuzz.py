"""Fuzzing of one target, guided by coverage where atheris can be had:

    python -m tests.fuzz.fuzz capture_text [-max_total_time=600] [more of libFuzzer's options]

What libFuzzer finds to be new is kept beside the corpus only with -keep: the corpus in the tree
is small and chosen. A crash leaves its input as crash-* in the current folder: put it into
tests/fuzz/corpus/TARGET, so that every test run replays it. Without atheris (it has no package
for this Python or machine) the corpus is mutated blindly: -runs=N -seed=N.
"""

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


def main():
    """Guided: never returns, libFuzzer ends the process."""
    name, options = sys.argv[1], sys.argv[2:]
    folder = CORPUS / name
    try:
        import atheris
    except ImportError:
        from tests.fuzz import targets
        blindly(targets.TARGETS[name], [p.read_bytes() for p in sorted(folder.iterdir())], options)
        return
    with atheris.instrument_imports(include=OURS):
        from tests.fuzz import targets
    # A folder in front is where libFuzzer writes: one of this process, thrown away.
    found = Path(targets.FOLDER) / "found"
    found.mkdir()
    folders = [str(folder)] if "-keep" in options else [str(found), str(folder)]
    options = [word for word in options if word != "-keep"]
    atheris.Setup([sys.argv[0], *options, *folders], targets.TARGETS[name])
    atheris.Fuzz()


if __name__ == "__main__":
    main()
