"""Eight boards in one jig, each a real MicroPython: good ones, and some that fail."""

import contextlib
import json
import threading

import pytest

from sixflip_host import cli
from sixflip_host.board import firmware_update, raw_repl
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.errors import NoBoard, UsageError
from sixflip_host.history import store
from sixflip_host.tray import tray_guide
from sixflip_host.virtual.jig_hand import WAYS, JigHand
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.terminal import Terminal

WORLD = {"sensor": "mpu6050", "tilt_deg": 2.0, "order": []}
QUICK = {"pose_samples": 100, "sensor": "mpu6050", "grace_ms": 100, "timeout_s": 3600}
GOOD = ["as the jig", "upside down", "a quarter on", "on edge", "as the jig, too"]
BAD = ["unplugged", "stuck", "older"]
PATIENCE = 8.0      # times as long as a person's, of boards that share a core with other tests
OF_EIGHT = 3.0      # the same where one hangs, which is waited for on three faces
OLD = b"__version__ = '0.0.1'\nSTANDARD_G = 9.80665\n"


@pytest.fixture(scope="module")
def flash(micropython, tmp_path_factory):
    """The flash of a board that was provisioned, for all of them."""
    image = tmp_path_factory.mktemp("provisioned") / "flash.img"
    with VirtualBoard(WORLD, image, micropython=micropython) as board, \
            MpremoteLink(board.port) as link:
        firmware_update.copy(link, QUICK, lambda line: None)
    return image.read_bytes()


@contextlib.contextmanager
def jig(names, folder, flash, micropython, kind=JigHand, patience=1.0, **worlds):
    """{name: VirtualBoard} of boards in one jig, in the ways in which they can lie in it."""
    hand = kind({name: WAYS[k % len(WAYS)] for k, name in enumerate(names)}, patience=patience)
    with contextlib.ExitStack() as all_of_them:
        boards = {}
        for seed, name in enumerate(names):
            image = folder / (name + ".img")
            image.write_bytes(flash)
            world = dict(WORLD, seed=seed, **hand.first(name), **worlds.get(name, {}))
            boards[name] = all_of_them.enter_context(VirtualBoard(
                world, image, micropython=micropython, speed=10, hand=hand.hand_for(name)))
        yield boards


def ports(boards):
    return [word for board in boards for word in ("--port", board.port)]


class Waiting(JigHand):
    """Leaves the jig as it lies when the half turn on a face is wanted, until let go."""

    waits_on = "X+"

    def pose(self):
        if (self.tray.face, self.tray.letter) == (self.waits_on, "b"):
            return self.lies
        return super().pose()


class Puller:
    """A board's hand that pulls its cable once the board has taken so many poses."""

    def __init__(self, board, poses):
        self.board, self.hand, self.poses = board, board.hand_asked, poses

    def hear(self, data):
        self.poses -= data.count(b'"event": "pose"')
        if self.poses <= 0 and self.board.hand_asked is self:
            self.board.hand_asked = self.hand
            threading.Thread(target=self.board.unplug).start()
        return self.hand.hear(data)


@pytest.mark.long
def test_eight_boards_of_which_three_fail(micropython, flash, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(raw_repl, "REOPEN_S", 0.5)
    monkeypatch.setenv(raw_repl.PATIENCE, "%g" % OF_EIGHT)
    monkeypatch.setenv("SIXFLIP_HISTORY", str(tmp_path / "history.sqlite"))
    stuck = {"faults": [{"kind": "frozen", "at_ms": 30000}]}
    with jig(GOOD + BAD, tmp_path, flash, micropython, patience=OF_EIGHT,
             stuck=stuck) as boards:
        with MpremoteLink(boards["older"].port) as link:
            link.put("sixflip/__init__.py", OLD)
        boards["unplugged"].hand_asked = Puller(boards["unplugged"], 3)
        nothing = tmp_path / "nothing"
        nothing.write_bytes(b"")
        assert cli.main(["calibrate", "--all", *ports(boards.values()),
                         "--port", str(nothing)]) == 1
        ids = [boards[name].unique_id for name in GOOD]
    out = capsys.readouterr().out
    assert "%s: is not a serial port; passed over" % nothing in out
    said = [line for line in out.splitlines() if "leaves the tray: " in line]
    assert len(said) == 3 and [line[0] for line in sorted(said)] == ["6", "7", "8"], out
    assert "went away" in sorted(said)[0]
    assert "3 faces in a row not taken: the readings do not change" in sorted(said)[1]
    assert "its firmware is 0.0.1, expected" in sorted(said)[2]
    assert out.count("saved: yes") == 5, out
    rows = store.read(tmp_path / "history.sqlite")
    kept = [row.board for row in rows if row.verdict in ("good", "doubtful")]
    assert sorted(kept) == sorted(ids)


@pytest.mark.long
def test_ctrl_c_loses_nothing(micropython, flash, tmp_path, monkeypatch):
    """On the screen; afterwards both boards go on where they were, in lines. A busy machine may
    take its time over each of them: neither the host nor the hand leads on past a face."""
    monkeypatch.setenv(raw_repl.PATIENCE, "%g" % PATIENCE)
    with jig(["one", "two"], tmp_path, flash, micropython, Waiting, PATIENCE) as boards:
        both = ports(boards.values())
        with Terminal("calibrate", "--all", *both) as terminal:
            terminal.wait("2 of 2 boards in the tray   X Y Z as on board 1",
                          "half a turn, flat on the table, X+ stays up", "✓✓  ✓·  ··")
            terminal.press("?")
            terminal.wait("any key closes this")
            terminal.press("\x03")
            assert terminal.ended() == 130
            assert terminal.words.count("sixflipcalibrate--all--continuegoeson") == 3
        boards["one"].hand_asked.hand.waits_on = None
        with Terminal("calibrate", "--all", "--continue", "--plain", *both) as terminal:
            terminal.wait("typed lines: redo FACE, undo, quit")
            assert terminal.ended() == 0
            assert terminal.words.count("saved:yes") == 2
            assert b"Z+ taken" not in terminal.sent and b"Y- taken by 2" in terminal.sent


@pytest.mark.parametrize("more", [["--plan", "paper"], ["--redo", "X+"], ["--record", "x.bin"]])
def test_what_is_for_one_board(more, capsys):
    assert cli.main(["calibrate", "--all", *more]) == UsageError.exit_code
    assert "--all: not with " in capsys.readouterr().err


def test_several_ports_are_for_all(capsys):
    assert cli.main(["calibrate", "--port", "a", "--port", "b"]) == UsageError.exit_code
    assert "expected one, or --all" in capsys.readouterr().err


def test_ports_that_are_asked_for_and_those_of_the_variable(monkeypatch):
    monkeypatch.setenv("SIXFLIP_PORT", "/dev/a /dev/b")
    assert tray_guide.ports_of(["/dev/c", "/dev/c"]) == ["/dev/c"]
    assert tray_guide.ports_of(None) == ["/dev/a", "/dev/b"]
    monkeypatch.delenv("SIXFLIP_PORT")
    monkeypatch.setattr(tray_guide.serial_ports, "boards", lambda: [{"port": "/dev/d"}])
    assert tray_guide.ports_of(None) == ["/dev/d"]
    monkeypatch.setattr(tray_guide.serial_ports, "boards", list)
    with pytest.raises(NoBoard, match="--boards 8"):
        tray_guide.ports_of(None)


def test_no_port_with_a_board(tmp_path, capsys):
    nothing = tmp_path / "nothing"
    nothing.write_bytes(b"")
    assert cli.main(["calibrate", "--all", "--port", str(nothing)]) == NoBoard.exit_code
    assert "no port has a Sixflip board" in capsys.readouterr().err


def test_virtual_boards_in_one_jig_say_how_to_go_on(micropython, tmp_path, monkeypatch):
    monkeypatch.setenv("SIXFLIP_MICROPYTHON", micropython)
    monkeypatch.chdir(tmp_path)
    boards = ["virtual-board", "--boards", "2", "--flash", "f.flash"]
    with Terminal(*boards, columns=200) as terminal:
        terminal.wait("sixflip calibrate --all", "export SIXFLIP_PORT='/dev/", "/f-2.flash")
        terminal.press("\x03")
        assert terminal.ended() == 0
    with Terminal(*boards, "--json", columns=600) as terminal:
        terminal.wait('"boards"')
        answer = json.loads(next(line for line in terminal.screen.display if "{" in line))
        assert len({row["port"] for row in answer["boards"]}) == 2


@pytest.mark.parametrize("argv", [["--boards", "0"], ["--boards", "2", "--world",
                                                      '{"order": ["Z+a"]}']])
def test_virtual_boards_that_cannot_be(argv, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["virtual-board", "--flash", "f", *argv]) == UsageError.exit_code
    assert "--boards" in capsys.readouterr().err
