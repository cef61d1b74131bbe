"""What the terms of a record take out: a part with known terms, diagnosed, its record put onto a
simulated board, and the board's corrected stream while it warms by 8 degrees, with and without.

    python -m tests.studies.bench.correction_terms
"""

import contextlib
import io
import json
import tempfile
from pathlib import Path

import numpy as np

from sixflip_host import cli
from sixflip_host.board.board_files import board_files
from sixflip_host.board.local_link import LocalLink
from sixflip_host.verbs import restore, stream
from tests.worlds import drifting_part


def streamed(folder, record):
    """(mg, deg/s) errors of each second at rest of a board with this record."""
    flash = folder / "flash"
    for name, path in board_files().items():
        (flash / name).parent.mkdir(parents=True, exist_ok=True)
        (flash / name).write_bytes(path.read_bytes())
    (flash / "sixflip.json").write_text(json.dumps({"grace_ms": 100}))
    world = drifting_part.used_in(drifting_part.TERMS)
    restore.open_link = stream.open_link = lambda port=None: LocalLink(flash, world)
    output = folder / "stream.csv"
    quiet(["restore", "--from", str(record)])
    quiet(["stream", "--hz", "100", "--seconds", "85", "-o", str(output)])
    return drifting_part.errors(output)


def quiet(words):
    """Run a verb; what it prints is of no interest here."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        code = cli.main(words)
    assert code == 0, words


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record = drifting_part.calibrated(folder, drifting_part.TERMS)
        terms = folder / "terms.bin"
        quiet(["diagnose", *drifting_part.captures(folder, drifting_part.TERMS), "--record",
               record, "-o", str(terms)])
        print("calibrated at 25, switched on at 23, warming to 31 degC; worst second at rest")
        print("%-22s %28s %28s" % ("", "accelerometer x y z, mg", "gyro x y z, deg/s"))
        for what, path in (("record alone", record), ("with the terms found", terms)):
            mg, dps = [np.abs(one).max(axis=0) for one in streamed(folder, path)]
            print("%-22s %28s %28s" % (what, " ".join("%8.2f" % x for x in mg),
                                       " ".join("%8.3f" % x for x in dps)))


if __name__ == "__main__":
    main()
