"""A record from a file put onto a board, and a mounting that a board measures itself."""

import json

import pytest

from sixflip.record import correction_record
from sixflip_host import cli
from sixflip_host.board import ports
from sixflip_host.board.board_files import board_files
from sixflip_host.board.local_link import LocalLink
from sixflip_host.verbs import mount
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.board_session import leave_files, unlabelled

WORLD = {"sensor": "mpu6050", "seed": 3, "order": [], "ideal": True, "tilt_deg": 10.0,
         "accel_noise_mg": 3.0}


@pytest.fixture
def offered(tmp_path):
    """(path of a record file, its Record) with the numbers of an ideal sensor."""
    record = leave_files(tmp_path, unlabelled(1))
    record.who_am_i = (0x68, 0x68)
    record.accel["P"] = [[float(i == j) for j in range(4)] for i in range(4)]
    record.gyro_bias = {"bias_dps": [0.0, 0.0, 0.0], "temp_c": 25.0}
    path = tmp_path / "host.bin"
    path.write_bytes(correction_record.encode(record))
    return path, record


@pytest.fixture
def board(tmp_path, monkeypatch):
    """--port local:... is the firmware of a board with a simulated sensor."""
    folder = tmp_path / "flash"
    for name, path in board_files().items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(path.read_bytes())
    (folder / "sixflip.json").write_text(json.dumps({"grace_ms": 100}))
    real = ports.open_link

    def opened(port=None):
        return LocalLink(folder, WORLD) if port == "local:flash" else real(port)
    for module in ("sixflip_host.verbs.restore", "sixflip_host.verbs.mount"):
        monkeypatch.setattr(module + ".open_link", opened)
    return folder


def run(capsys, *words):
    code = cli.main(list(words))
    said = capsys.readouterr()
    return code, said.out, said.err


def test_a_record_from_a_file_and_a_mounting(board, offered, capsys):
    path, record = offered
    code, out, err = run(capsys, "restore", "--from", str(path), "--port", "local:flash")
    assert code == 0, err
    assert "restored: slot" in out
    held = [correction_record.decode(one.read_bytes()) for one in board.glob("record_*.bin")]
    assert [one.session for one in held] == [record.session]

    code, out, err = run(capsys, "mount", "--port", "local:flash", "--axes", "ned")
    assert code == 0, err
    assert "roll" in out and "forward, right, down; saved in slot" in out
    newest = max((correction_record.decode(one.read_bytes())
                  for one in board.glob("record_*.bin")), key=lambda one: one.sequence)
    assert newest.mounting["frame"] == "ned"
    assert abs(newest.mounting["roll_deg"]) + abs(newest.mounting["pitch_deg"]) > 9.0


def test_another_chips_record_is_refused_with_the_reason(board, offered, capsys):
    path, record = offered
    record.chip, record.accel_range_g, record.accel_lsb_per_g = "gy85", 16, 256
    record.gyro_range_dps, record.gyro_lsb_per_dps = 2000, 14.375
    path.write_bytes(correction_record.encode(record))
    code, _, err = run(capsys, "restore", "--from", str(path), "--port", "local:flash")
    assert code == 1
    assert "does not take this record: it is for gy85, the sensor is mpu6050" in err
    assert list(board.glob("*.bin")) == []


def test_a_file_that_is_no_record_goes_nowhere(board, tmp_path, capsys):
    path = tmp_path / "rubbish.bin"
    path.write_bytes(b"rubbish")
    code, _, err = run(capsys, "restore", "--from", str(path), "--port", "local:flash")
    assert code == 4
    assert "6FLP" in err
    assert list(board.glob("*.bin")) == []


class Spoken:
    """A board that answers a mount with this event."""

    port = "/dev/spoken"

    def __init__(self, *answers):
        self.answers = [json.dumps(one) for one in answers]

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def reset(self):
        self.said = [json.dumps({"event": "ready"})]

    def send(self, line):
        self.said = self.answers

    def lines(self, timeout):
        return iter(self.said)


def test_a_moving_vehicle(monkeypatch, capsys):
    monkeypatch.setattr(mount, "open_link", lambda port: Spoken(
        {"event": "not_mounted", "reason": "not at rest: moving", "mounting": "stored"}))
    code, out, err = run(capsys, "mount", "--port", "x")
    assert (code, out) == (1, "")
    assert "not at rest: moving; the board goes on with the one it has" in err


@pytest.mark.parametrize("words", [["--axes", "x=y,y=x,z=z"], ["rest.csv"],
                                   ["--vector", "0", "0", "1"], ["--both"]])
def test_wrong_command_lines(words, capsys):
    code, _, err = run(capsys, "mount", "--port", "x", *words)
    assert code == 2
    assert err.startswith("sixflip: ")


def test_the_port_of_the_environment_is_the_board_where_no_file_is_given(monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(mount, "open_link", lambda port: asked.append(port) or Spoken(
        {"event": "not_mounted", "reason": "not at rest: moving"}))
    monkeypatch.delenv("SIXFLIP_PORT", raising=False)
    assert run(capsys, "mount")[0] == 2
    monkeypatch.setenv("SIXFLIP_PORT", "/dev/ttyACM7")
    assert run(capsys, "mount")[0] == 1 and asked == [None]     # open_link() looks it up
    assert run(capsys, "mount", "rest.csv")[0] == 4 and len(asked) == 1


def test_on_micropython(micropython, offered, tmp_path, capsys):
    with VirtualBoard(WORLD, tmp_path / "flash.img", micropython=micropython) as one:
        assert cli.main(["provision", "--port", one.port]) == 0
        code, out, err = run(capsys, "restore", "--from", str(offered[0]), "--port", one.port)
        assert code == 0, err
        code, out, err = run(capsys, "mount", "--port", one.port, "--json")
        assert code == 0, err
        assert json.loads(out)["written"]
