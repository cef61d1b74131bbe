"""The product's own verb on captures: its JSON, and what it prints."""

import contextlib
import io
import json
from pathlib import Path
from tempfile import TemporaryDirectory

from sixflip_host import cli
from sixflip_host.capture import capture_file


def diagnose(captures, *words):
    """The JSON of `sixflip diagnose` on captures in memory; RuntimeError if it gave none."""
    with TemporaryDirectory() as folder:
        paths = [str(Path(folder) / ("%d.csv" % k)) for k in range(len(captures))]
        for path, capture in zip(paths, captures):
            capture_file.write(path, capture)
        return on_files(paths, *words)


def on_files(paths, *words):
    """The same on capture files."""
    return json.loads(printed([*paths, *words, "--json"]))


def said(captures, *words):
    """What a person is told: the terminal output."""
    with TemporaryDirectory() as folder:
        paths = [str(Path(folder) / ("%d.csv" % k)) for k in range(len(captures))]
        for path, capture in zip(paths, captures):
            capture_file.write(path, capture)
        return printed([*paths, *words])


def printed(words):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main(["diagnose", *words])
    if code:
        raise RuntimeError("diagnose ended with code %d: %s" % (code, err.getvalue().strip()))
    return out.getvalue()


def brief(answer):
    """One line: the verdict, then each cause with sensor, axes and largest size."""
    causes = []
    for c in sorted(answer["causes"], key=lambda c: -c["score_nats"]):
        sizes = [v for v in c["value"].values() if v is not None]
        size = " %.3g %s" % (max(sizes, key=abs), c["unit"]) if sizes else ""
        causes.append("%s %s %s%s" % (c["sensor"], "".join(c["axes"]), " or ".join(c["class"]),
                                      size))
    return "; ".join([answer["verdict"], *causes])
