"""Every real recording through import, solve and diagnose, each claim beside a plain figure.

    python -m tests.studies.real.real_run [--only NAME] [--short]

Prints the table claim | independent figure | right. Exits with 1 when a claim is wrong, or
something that the plain figures show at five standard errors is not said.
"""
import argparse
import contextlib
import io
import json
import sys
import tempfile
from pathlib import Path

from sixflip_host import cli
from sixflip_host.capture import capture_file, recordings

from .. import cases
from . import claims, real_recordings

BY_NAME = {one.name: one for one in real_recordings.RECORDINGS}


def sixflip(*words):
    """(exit code, output) of the command."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        code = cli.main([str(word) for word in words])
    return code, out.getvalue()


def captured(recording, place, folder):
    """Path of the capture that `sixflip import` makes of a recording; of one that is no table,
    of its decoded samples written as one."""
    path, source = folder / (recording.name.replace(" ", "_") + ".csv"), place / recording.file
    options = recording.options
    if not options:
        source, options = decoded(recording, source, folder)
    code, said = sixflip("import", source, "-o", path, *options)
    if code:
        raise RuntimeError("import of %s: exit %d: %s" % (recording.name, code, said))
    if recording.rows:
        cut(path, *recording.rows)
    return path


def decoded(recording, source, folder):
    """(CSV of whole counts with times in µs, options of import)."""
    plain = recording.read(source)
    path = folder / (recording.name.replace(" ", "_") + ".decoded.csv")
    rows = ["t,ax,ay,az,gx,gy,gz"]
    for t, a, w in zip(plain.t, plain.counts["accel"], plain.counts["gyro"]):
        rows.append("%d,%d,%d,%d,%d,%d,%d" % (round(t * 1e6), *a, *w))
    path.write_text("\n".join(rows) + "\n")
    lsb = [plain.counts[s][100:, 0].mean() / plain.of(s)[100:, 0].mean() for s in
           ("accel", "gyro")]
    return path, ("--time-column", "t", "--time-unit", "us", "--accel-lsb",
                  "%.9g" % (1000.0 * lsb[0]), "--gyro-lsb", "%.9g" % lsb[1])


def cut(path, first, end):
    """Leave only these samples in a capture file."""
    capture = capture_file.read_samples(str(path))
    capture.t_us = capture.t_us[first:end] - capture.t_us[first]
    for name in ("accel", "gyro", "temp"):
        values = getattr(capture, name)
        setattr(capture, name, None if values is None else values[first:end])
    capture.pose = None
    capture_file.write(str(path), capture)


def judged(recording, place, folder):
    """(answer of diagnose, list of Row)."""
    plain = recording.read(place / recording.file)
    if recording.rows:
        plain = plain.part(*recording.rows)
    paths = [captured(BY_NAME[name], place, folder) for name in
             (recording.name, *recording.others)]
    found = []
    code, said = sixflip("solve", paths[0])
    if code not in (0, 1) or "Traceback" in said:
        found.append(claims.Row("solve", said.strip().splitlines()[-1], False))
    code, said = sixflip("diagnose", *paths, "--json")
    if code:
        raise RuntimeError("diagnose of %s: exit %d: %s" % (recording.name, code, said))
    answer = json.loads(said)
    others = [BY_NAME[name].read(place / BY_NAME[name].file) for name in recording.others]
    return answer, found + claims.rows(plain, answer, others)


def show(recording, answer, rows):
    """Print the table of one recording; the number of rows that do not hold."""
    print("\n%s: %s" % (recording.name, answer["verdict"]), flush=True)
    for kind, gap in answer["gap"].items():
        print("    gap of the %s: %s -> %s, floor %s %s" % (
            kind, gap["before"], gap["after"], gap["floor"], gap["unit"]))
    for row in rows:
        word = {True: "right", False: "WRONG", None: "-"}[
            None if row.right is None else bool(row.right)]
        print("    %-5s  %s | %s" % (word, row.claim, row.figure), flush=True)
    return sum(row.right is not None and not row.right for row in rows)


def answered(name):
    """What a worker does: judged() of the recording of a name."""
    with tempfile.TemporaryDirectory() as folder:
        return judged(BY_NAME[name], recordings.folder(), Path(folder))


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="recordings whose name contains this")
    parser.add_argument("--short", action="store_true", help="those of `make test` only")
    cases.add_arguments(parser)
    args = parser.parse_args(argv)
    wanted = [one for one in real_recordings.RECORDINGS
              if args.only in one.name and (one.short or not args.short)]
    wrong, number = 0, 0
    for one, (answer, rows) in zip(wanted, cases.done(
            answered, [one.name for one in wanted], cases.target(args), "recordings")):
        wrong += show(one, answer, rows)
        number += len(rows)
    print("\n%d of %d rows do not hold" % (wrong, number))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
