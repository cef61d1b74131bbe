"""A capture played through the firmware's own session gives the session it is of."""

import numpy as np
import pytest

from sixflip_host import cli
from sixflip_host.board.board_events import events
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.errors import BadFile, UsageError
from sixflip_host.guide import replay_chips
from sixflip_host.guide.replay_link import ReplayLink
from tests.worlds.board_session import unlabelled

SIMULATED = """seed = 6
sensor = "%s"
[world]
tilt_deg = 2.0
flip_error_deg = 0.3
"""


def simulated(folder, sensor="mpu6050"):
    """A capture file as sixflip simulate makes it."""
    scenario, path = folder / "scenario.toml", folder / "simulated.csv"
    scenario.write_text(SIMULATED % sensor)
    assert cli.main(["simulate", str(scenario), "-o", str(path)]) == 0
    return path


def replayed(path):
    """(events, bytes of the capture the replay leaves) of a whole session."""
    found = []
    with ReplayLink(path, None) as link:
        link.put("calibrate.flag", b"")
        link.reset()
        for event in events(link, 30, 120):
            found.append(event)
            if event["event"] == "ready":
                break
        names = link.files([])
        left = link.get("capture.bin" if "capture.bin" in names else "refused.bin")
    return found, capture_binary.decode(left)


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85", "adxl345"])
def test_samples_times_and_poses_come_out_as_they_went_in(tmp_path, sensor):
    path = simulated(tmp_path, sensor)
    given = capture_file.read(path)
    told, left = replayed(path)
    n = len(left)
    assert n > 0.9 * len(given)
    assert (left.accel == given.accel[:n]).all()
    assert (left.t_us - left.t_us[0] == given.t_us[:n] - given.t_us[0]).all()
    if sensor == "adxl345":     # without a gyro so smooth a half turn is no move
        return
    assert (left.gyro == given.gyro[:n]).all() and (left.temp == given.temp[:n]).all()
    assert [e for e in told if e["event"] == "solved"][0]["verdict"] in ("good", "doubtful")
    assert len(left.board_placements) == 12

    # and what the board itself has captured gives the very same placements again
    again = tmp_path / "capture.bin"
    again.write_bytes(capture_binary.encode(left))
    placements = replayed(again)[1].board_placements
    assert [(p.pose, p.first, p.n, p.sums) for p in placements] == \
        [(p.pose, p.first, p.n, p.sums) for p in left.board_placements]


def test_a_capture_that_ends_too_soon_is_refused_and_says_what_is_missing(tmp_path, capsys):
    capture = unlabelled()
    half = tmp_path / "half.csv"
    keep = capture.t_us < capture.t_us[0] + 45e6
    capture_file.write(half, capture_file.Capture(
        capture.meta, capture.t_us[keep], capture.accel[keep], capture.gyro[keep],
        capture.temp[keep]))
    assert cli.main(["calibrate", "--replay", str(half)]) == 1
    out = capsys.readouterr().out
    assert "Z+a taken" in out and "verdict: refused: stopped by the host" in out


@pytest.mark.parametrize("change, kind, words", [
    ({"sensor": "other"}, UsageError, "sensor 'other'"),
    ({"accel_lsb_per_g": 8000}, UsageError, "8000 counts per g"),
    ({"rate_hz": 2000}, UsageError, "2000 samples a second")])
def test_captures_the_firmware_would_never_take(change, kind, words):
    capture = unlabelled()
    capture.meta.update(change)
    with pytest.raises(kind, match=words):
        replay_chips.settings_of(capture)


def test_a_capture_without_samples():
    capture = unlabelled()
    none = capture_file.Capture(capture.meta, capture.t_us[:0], np.zeros((0, 3), np.int16))
    with pytest.raises(BadFile, match="no samples to replay"):
        replay_chips.settings_of(none)


@pytest.mark.parametrize("argv, line, code", [
    (["--replay", "x", "--redo", "X+"], "as it was taken", 2),
    (["--replay", "x", "--continue"], "as it was taken", 2),
    (["--replay", "x", "--port", "y"], "not allowed with", 2),
    (["--speed", "2"], "with --replay", 2), (["--replay", "x", "--speed", "0"], "above 0", 2),
    (["--replay", "no_such_file"], "No such file", 4)])
def test_command_lines_that_cannot_be(argv, line, code, capsys):
    assert cli.main(["calibrate", *argv]) == code
    assert line in capsys.readouterr().err
