"""calibrate --plan, --redo, Ctrl-C and typed lines, against a virtual board and a local one."""

import io
import json
import os
import pty
import select
import sys
import time

import numpy as np
import pytest

from sixflip_host import cli
from sixflip_host.board import console, event_words, firmware_update, typed_lines
from sixflip_host.board.local_link import LocalLink
from sixflip_host.capture import capture_file
from sixflip_host.errors import UsageError
from sixflip_host.planning import plan_file
from sixflip_host.planning.plan_file import from_plan
from sixflip_host.simulation import simulator
from sixflip_host.verbs import calibrate, virtual_board_verb
from sixflip_host.virtual.virtual_board import VirtualBoard
from sixflip_sim import worlds

NAMES = ("Y-a Y-b Z+b Z+a X+a X+b Z-a Z-b X-a X-b Y+a Y+b L1 L2 Y+b X-a Z+b Z+b Y-a").split()
TIMING = {"dwell_s": 2.5, "move_s": 1.5}
PLAN = {"sixflip_plan": 1, "name": "short", "sessions": [{"rest_s": 6, "poses": [
    dict(TIMING, pose=name, turn="right" if k // 2 % 2 else "left")
    for k, name in enumerate(NAMES)]}]}
SCENARIO = """plan = "%s"
seed = 5
flicker = false
[world]
tilt_deg = 1.5
first_rest_s = 10.0
placement_scatter_deg = 0.03
flip_error_deg = 0.3
[[effects]]
effect = "thermal_bias"
sensor = "accel"
z = 0.9
[[effects]]
effect = "quantisation"
sensor = "accel"
x = 4
y = 4
z = 4
"""


@pytest.fixture
def plan(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # what is recorded by itself is left here
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(PLAN))
    return path


@pytest.fixture
def world(tmp_path, plan, capsys):
    """The world of the scenario of that plan, as simulate writes it for a virtual board."""
    path = tmp_path / "scenario.toml"
    path.write_text(SCENARIO % plan)
    assert cli.main(["simulate", str(path), "-o", str(tmp_path / "simulated.csv"),
                     "--worlds", str(tmp_path / "worlds.json")]) == 0
    capsys.readouterr()
    return virtual_board_verb.more_of_it(str(tmp_path / "worlds.json"), 1)


def counts_of(world, capture):
    """What the numpy simulator counts, beginning with the sample the capture begins with."""
    made = worlds.make(world)
    from sixflip.chips import probe
    imu, _ = probe.find(made.i2c)
    imu.configure(100)
    simulator.vectorise(made.model)
    last = int(capture.t_us[-1] * 1e-6 * 1000) + 20000
    k = np.arange(last)
    return np.concatenate([simulator.counts(made.model, output, k)
                           for output in simulator.outputs_of(made.chips)]).T


def check_session(capsys, folder, world):
    out = capsys.readouterr().out
    assert "calibrating by a plan of 19 placements" in out
    assert "Y-a taken (1 of 19); next Y-b: half a turn to the left (anticlockwise" in out
    assert "next L1: lean the box on something" in out
    assert "next Y+b: Y+ up, turned as it lay for Y+b before" in out
    assert "next Z+b: lift the box and put it back just as it lay" in out
    assert "leave the box alone for 6 s" in out
    capture = capture_file.read(folder / "capture.bin")
    runs = [p.pose for p in capture.board_placements]
    assert runs == [board_code(name) for name in NAMES]
    assert capture.temp is not None
    assert cli.main(["verify", str(folder)]) == 0
    return capture


def board_code(name):
    from sixflip.poses.faces import pose_code
    return pose_code(name)


@pytest.mark.long
def test_a_plan_through_micropython(micropython, tmp_path, plan, world, capsys):
    """Leaning poses, repeats, rests and effects: led, captured, solved, verified, and sample
    by sample what the numpy simulator counts."""
    with VirtualBoard(world, tmp_path / "flash.img", micropython=micropython) as board:
        port = ["--port", board.port]
        assert cli.main(["provision", *port]) == 0
        capsys.readouterr()
        assert cli.main(["calibrate", *port, "--plan", str(plan)]) == 0
        out = capsys.readouterr().out
        assert cli.main(["pull", *port, "-o", str(tmp_path)]) == 0
        capsys.readouterr()
        print(out)
        capture = check_session(capsys, tmp_path / board.unique_id, world)
    assert (capture.accel % 4 == 0).all()  # the quantisation went through the firmware
    rows = counts_of(world, capture)
    kept = np.column_stack([capture.accel, capture.gyro, capture.temp])
    # Every sample the board took is one that numpy counts, in the same order.
    at = 0
    for row in kept[::97]:
        found = np.flatnonzero((rows[at:at + 20000] == row).all(axis=1))
        assert len(found), "a sample that the simulator does not know"
        at += int(found[0]) + 1


@pytest.fixture
def local(tmp_path, monkeypatch):
    """calibrate(world, *argv) -> exit code, on the firmware under CPython."""
    with LocalLink(tmp_path / "flash", world={"order": []}) as link:
        firmware_update.copy(link, {"timeout_s": 15, "pose_samples": 100}, lambda text: None)

    def run(world, *argv):
        monkeypatch.setattr(calibrate, "open_link",
                            lambda port: LocalLink(tmp_path / "flash", world=world))
        return cli.main(["calibrate", *argv])
    return run


def test_a_plan_under_cpython(local, tmp_path, plan, world, capsys):
    assert local(world, "--plan", str(plan)) == 0
    check_session(capsys, tmp_path / "flash", world)


def test_redo_after_the_end_repairs_a_session(local, tmp_path, capsys):
    short = {"seed": 4, "dwell_s": 2.5, "move_s": 1.5, "tilt_deg": 2.0, "flip_error_deg": 0.3}
    assert local(dict(short, mishaps=[{"kind": "missing", "pose": "X+"}])) == 1
    assert "X+" in capsys.readouterr().out
    assert local(dict(short, order=["X+a", "X+b"]), "--redo", "X+") == 0
    out = capsys.readouterr().out
    assert "left: X+ and its flip" in out and "verdict: good" in out
    assert cli.main(["verify", str(tmp_path / "flash")]) == 0
    assert cli.main(["calibrate", "--redo", "Q+"]) == 2


def test_typed_lines_and_ctrl_c_in_a_terminal(micropython, tmp_path):
    """redo X+ typed reaches the board; Ctrl-C: exit code 130, one line, and what was captured
    is there to go on with."""
    spec = {"sensor": "mpu6050", "seed": 3, "tilt_deg": 2.0}
    with VirtualBoard(spec, tmp_path / "flash.img", micropython=micropython) as board:
        port = ["--port", board.port]
        assert cli.main(["provision", *port]) == 0
        child, terminal = pty.fork()
        if child == 0:
            os.execv(sys.executable, [sys.executable, "-m", "sixflip_host", "calibrate", "--plain",
                                      *port])
        said = Said(terminal)
        said.wait("Z+b taken")
        os.write(terminal, b"redo Q\nredoo\x7f Z+\n")
        said.wait("expected redo and a face")
        said.wait("Z+ again")
        said.wait("Z-b taken")
        os.write(terminal, b"\x03")
        said.wait("samples so far stay on the board")
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 130
        assert said.text.strip().splitlines()[-1].startswith("sixflip: stopped; the ")
        os.close(terminal)
        assert cli.main(["pull", *port, "-o", str(tmp_path)]) == 0
        folder = tmp_path / board.unique_id
    kept = capture_file.read(folder / "refused.bin")
    poses = [p.pose for p in kept.board_placements]
    # The board goes on until it hears of it: a pose more may be in the file.
    assert poses[:2] == [3, 4] and len(poses) <= 4 and kept.withdrawn == [1, 2]
    assert not kept.truncated and not (folder / "record_a.bin").exists()


class Said:
    """What a program prints to its terminal."""

    def __init__(self, terminal):
        self.terminal, self.text = terminal, ""

    def wait(self, words, seconds=60):
        end = time.monotonic() + seconds
        while words not in self.text:
            assert time.monotonic() < end, self.text[-2000:]
            if select.select([self.terminal], [], [], 0.5)[0]:
                try:
                    self.text += os.read(self.terminal, 4096).decode()
                except OSError:  # the program has ended
                    assert words in self.text, self.text[-2000:]


def test_the_request_of_a_plan_fits_the_board():
    session = from_plan(PLAN).sessions[0]
    asked = plan_file.request(session, 100)
    assert asked == {"poses": " ".join(NAMES), "samples": 150, "rest_s": 6}
    recommended = plan_file.session_of("recommended", 2)
    assert len(json.dumps(plan_file.request(recommended, 100))) < plan_file.MOST_TEXT
    assert plan_file.request(recommended, 100)["samples"] == 400
    assert len(plan_file.session_of("paper", 1).rests) == 12


@pytest.mark.parametrize("argv, line", [
    (["--plan", "turntable"], "is a motion"), (["--plan", "soak"], "most a board takes"),
    (["--plan", "recommended", "--session", "3"], "has 2"), (["--session", "2"], "only with"),
    (["--plan", "no_such_file.json"], "No such file"),
    (["--plan", "paper", "--redo", "Z+"], "not allowed with")])
def test_plans_that_cannot_be(argv, line, tmp_path, capsys, board_folder):
    assert cli.main(["calibrate", "--port", "local:%s" % board_folder, *argv]) in (2, 4)
    assert line in capsys.readouterr().err


@pytest.fixture
def board_folder(tmp_path):
    folder = tmp_path / "flash"
    folder.mkdir()
    (folder / "main.py").write_text("")
    return folder


def test_too_many_placements():
    with pytest.raises(UsageError, match="200 is the most"):
        plan_file.request(from_plan(["Z+a", "X+a"] * 101).sessions[0], 100)


def test_typed_lines():
    assert typed_lines.command("redo x+") == {"cmd": "redo", "face": "X+"}
    assert typed_lines.command("undo") == {"cmd": "undo"}
    assert typed_lines.command("quit") == {"cmd": "stop"}
    for line in ("redo", "redo Q", "help", "redo X+ now"):
        with pytest.raises(ValueError, match="expected redo"):
            typed_lines.command(line)


def test_the_wrong_face_says_which():
    event = {"event": "refused", "pose": "Y-", "reason": "wrong face", "value": 5, "limit": 2,
             "unit": "face"}
    assert event_words.words(event) == "Y- not taken: this is Y-, the plan wants X+ up"


def test_what_is_typed_stands_behind_the_live_state():
    class Terminal(io.StringIO):
        def isatty(self):
            return True
    out = Terminal()
    shown = console.Console(out)
    shown.show({"event": "state", "state": "moving"})
    shown.echo("redo X")
    assert out.getvalue().endswith("\rmoving   > redo X")
