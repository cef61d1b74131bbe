"""Damaged histories by seed, and what the verb `history` makes of each:

    python -m tests.fuzz.damaged_history [--runs 1000] [--first 0]

Values of other types and sizes put into the table by SQL, or bytes of the file changed, cut out
or cut off. It may end with 0 or 4, in one line. Prints how many ended how; exits with 1 when one
was an internal error, or two lines, or JSON that is none.
"""

import argparse
import collections
import contextlib
import io
import json
import os
import random
import sqlite3
import sys
import tempfile
from pathlib import Path

from sixflip_host import cli
from sixflip_host.history import store

BOARD = "00aa"
VALUES = (None, 0, -1, 1e308, float("inf"), 1 << 62, "", "x", "\x1b[2J", b"\xff", b"", "9" * 400,
          "{}", "[]", "null", '{"scale": [1, 2, 1%s]}' % ("0" * 400), "[" * 5000,
          '{"v": [1e308, 1e308, -1e308], "scale": [0, 0, 0]}', '{"scale": [NaN, 1, Infinity]}',
          '{"a":' + "[" * 900 + "]" * 900 + "}", '{"x":' + "9" * 5000 + "}", "refused", "check")


def whole(path):
    """A history with a dozen rows."""
    store.add(path, [store.Happened(
        BOARD, store.KINDS[k % 3], "calibrate", 1.7e9 + 86400.0 * k, "good", temp_c=20.0 + k,
        sequence=k, answer={"scale": [1.0] * 3, "v": [0.1] * 3}) for k in range(12)])


def by_hand(path, rng):
    """Other values in the table."""
    with contextlib.closing(sqlite3.connect(path)) as connection:
        for _ in range(rng.choice((1, 2, 6))):
            column = rng.choice(store.COLUMNS)
            with contextlib.suppress(sqlite3.Error), connection:
                connection.execute("UPDATE happened SET %s = ? WHERE id = ?" % column,
                                   (rng.choice(VALUES), rng.randint(1, 12)))
                if rng.random() < 0.3:
                    connection.execute("UPDATE happened SET %s = CAST(%s AS TEXT)" % (
                        column, column))


def by_chance(path, rng):
    """Other bytes in the file."""
    data = bytearray(path.read_bytes())
    for _ in range(rng.choice((1, 5, 50))):
        k = rng.randrange(len(data) - 100) if len(data) > 100 else 0
        kind = rng.randrange(4)
        if kind == 0:
            data[k:k + 1] = bytes([rng.randrange(256)])
        elif kind == 1:
            del data[k:k + rng.randint(1, 400)]
        elif kind == 2:
            data[k:k + 64] = rng.randbytes(64)
        elif rng.random() < 0.2:
            del data[k:]
    path.write_bytes(data)


def wrong(words):
    """(exit code, what is wrong or "") of the verb with these words."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        code = cli.main(["history", *words])
    if code not in (0, 4) and not (code == 2 and "expected one of" in error.getvalue()):
        return code, error.getvalue()
    if error.getvalue().count("\n") > 1:
        return code, "more than a line: " + error.getvalue()
    try:
        if code == 0 and "--json" in words:
            json.loads(out.getvalue(), parse_constant=lambda word: 1 / 0)
    except (ValueError, ZeroDivisionError):
        return code, "no JSON"
    return code, ""


def damaged(seed):
    """[(exit code, what is wrong or "")] of the history of a seed."""
    rng = random.Random(seed)
    before = os.environ.get(store.VARIABLE)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "history.sqlite"
        whole(path)
        rng.choice((by_hand, by_chance))(path, rng)
        os.environ[store.VARIABLE] = str(path)
        try:
            return [wrong(words) for words in ([], ["--json"], [BOARD], [BOARD, "--json"])]
        finally:
            os.environ[store.VARIABLE] = before or ""


def main():
    """The table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    args = parser.parse_args()
    codes, bad = collections.Counter(), 0
    for seed in range(args.first, args.first + args.runs):
        for code, why in damaged(seed):
            codes[code] += 1
            bad += bool(why)
            if why:
                print("wrong: seed %d: %s" % (seed, why.strip()[:300]))
    print("%d histories: " % args.runs + ", ".join(
        "exit %d %d times" % item for item in sorted(codes.items())) + ", %d wrong" % bad)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
