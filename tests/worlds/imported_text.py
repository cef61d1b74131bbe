"""Tables of text that somebody imports: a log at rest, and what `sixflip import` makes of it."""

import numpy as np

from sixflip_host.capture import capture_file
from sixflip_host.cli import main

G = 9.80665
ROWS = 400
COUNTS = np.rint(np.random.default_rng(7).normal((100, -200, 16384), 40, (ROWS, 3)))
GYRO = np.rint(np.random.default_rng(8).normal((30, -50, 10), 9, (ROWS, 3)))
NAMES = "ax,ay,az,gx,gy,gz"
ENDS = ("--no-poses",)


def lines(values, form="%d"):
    return [",".join(form % value for value in row) for row in values]


def imported(tmp_path, capsys, text, *words, name="in.csv"):
    """(Capture, what was said) of a text."""
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), "-o", str(tmp_path / "out.csv"), *ENDS, *words]) == 0, \
        capsys.readouterr().err
    return capture_file.read(tmp_path / "out.csv", gyro_alone=True), capsys.readouterr().out


def refused(tmp_path, capsys, text, *words, code=4):
    path = tmp_path / "in.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), "-o", str(tmp_path / "out.csv"), *ENDS, *words]) == code
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and not (tmp_path / "out.csv").exists()
    return said


def table(times, head="t", accel=COUNTS, gyro=None, form="%d"):
    """A CSV with a column of times and the accelerometer's, and perhaps the gyro's."""
    values = accel if gyro is None else np.c_[accel, gyro]
    names = NAMES if gyro is not None else "ax,ay,az"
    return "%s,%s\n" % (head, names) + "".join(
        "%s,%s\n" % pair for pair in zip(times, lines(values, form)))


SECONDS = np.arange(ROWS) / 100
