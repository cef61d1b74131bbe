"""A log that runs faster than what it hears: rows with one stamp are a burst of readings, or one
message written over and over."""

import numpy as np
import pytest

from sixflip_host.cli import main
from tests.worlds.imported_text import G, imported, table

MESSAGES, TIMES = 300, 25


def log(fresh, coarse=False):
    """A log of a message every quarter of a second, written TIMES times; fresh: or of as many
    readings as it has rows, handed over together; coarse: of a board at rest whose codes are
    wider than its noise."""
    rng = np.random.default_rng(6)
    number = MESSAGES * TIMES if fresh else MESSAGES
    t = np.arange(number) * (0.25 / TIMES if fresh else 0.25)
    sway = np.sin(2 * np.pi * 0.11 * t)[:, None] * [0.4, -0.3, 0.2]
    noise = rng.normal(size=(number, 6))
    accel = [0.0, 0.0, G] + (0.05 * sway[:, :3] + 0.02 * noise[:, :3]) * (not coarse)
    gyro = 0.3 * sway * (not coarse) + 0.004 * noise[:, 3:]
    if coarse:
        gyro = np.where(np.abs(gyro) > 0.01, np.sign(gyro) * 0.02, 0.0)
    rows = np.arange(MESSAGES * TIMES)
    stamps = 0.25 * (rows // TIMES) + 1e-3 * (7 * (rows // TIMES) % 11)  # on no grid
    which = rows if fresh else rows // TIMES
    return table(["%.4f" % x for x in stamps], accel=accel[which], gyro=gyro[which], form="%.6f")


@pytest.mark.parametrize("coarse", [False, True])
def test_one_message_that_is_written_over_and_over_is_one_reading(tmp_path, capsys, coarse):
    capture, said = imported(tmp_path, capsys, log(False, coarse), "--time-unit", "s")
    assert "%d rows are %d readings" % (MESSAGES * TIMES, MESSAGES) in said
    assert "came late" not in said
    assert capture.meta["rate_hz"] == pytest.approx(4.0, rel=0.01)
    assert len(capture.t_us) == MESSAGES


@pytest.mark.parametrize("coarse", [False, True])
def test_readings_that_are_handed_over_together_stay(tmp_path, capsys, coarse):
    capture, said = imported(tmp_path, capsys, log(True, coarse), "--time-unit", "s")
    assert "left out" not in said
    assert len(capture.t_us) == MESSAGES * TIMES


def test_no_line_above_half_the_rate_at_which_a_log_says_something_new(tmp_path, capsys):
    """Held for six rows under a clock of its own, a gyro that turns slowly to and fro makes
    stairs, whose steps come at its own rate."""
    rng = np.random.default_rng(8)
    t = np.repeat(np.arange(4000) * 0.06, 6)
    turn = np.sin(2 * np.pi * 0.9 * t)[:, None] * [40.0, -25.0, 60.0]
    gyro = turn + np.repeat(rng.normal(0, 0.05, (4000, 3)), 6, axis=0)
    accel = [0.0, 0.0, 1.0] + rng.normal(0, 0.02, (len(t), 3))
    (tmp_path / "in.csv").write_text(table(["%.2f" % (k / 100) for k in range(len(t))],
                                           accel=accel, gyro=gyro, form="%.6f"))
    assert main(["import", str(tmp_path / "in.csv"), "-o", str(tmp_path / "out.csv"),
                 "--no-poses", "--units", "g,dps"]) == 0
    capsys.readouterr()
    main(["diagnose", str(tmp_path / "out.csv"), "--jobs", "1"])
    said = capsys.readouterr().out
    assert "gyro gives each value 6 times" in said
    assert "gyro is shaken" not in said and "a line at 1" not in said
