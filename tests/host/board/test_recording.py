"""Captures written down on the host while the board takes them: whole, with gaps, cut off."""

import json
import random
import signal
import subprocess
import sys
import time
from array import array
from pathlib import Path

import numpy as np
import pytest

from sixflip.capture.pieces import PieceWriter
from sixflip.capture.reader import read as read_blocks
from sixflip.capture.writer import BlockWriter
from sixflip.poses.placement import Placement
from sixflip_host import cli
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.recording import Recording, RecordingLink, name_of
from sixflip_host.board.stream_reader import decode_piece
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.planning import plan_file, protocols
from sixflip_host.verbs import virtual_board_verb
from sixflip_host.virtual.virtual_board import VirtualBoard

META = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, "gyro_lsb_per_dps": 65.5,
        "temp_lsb_per_c": 340, "temp_offset_c": 36.53, "device_id": "e661", "session": 0x9F3C2A11}
SCENARIO = """sensor = "mpu6050"
plan = "plan.json"
seed = 4
[world]
tilt_deg = 1.5
first_rest_s = 45.0
"""


class Sender:
    """Lines of a board that is recorded: 400 samples, one pose of them."""

    def __init__(self, meta=META):
        self.lines = []
        rng = np.random.default_rng(3)
        self.counts = (rng.normal(0, 40, (400, 7)) + [0, 0, 16384, 9, -9, 0, -3700]).astype(int)
        text = bytearray()
        pieces = PieceWriter(text.extend)
        self.writer = None

        def write(data):
            pieces.send(self.writer.written if self.writer else 0, data)
            self.lines.append(bytes(text[:-1]))
            text.clear()
        self.writer = BlockWriter(write, json.dumps(meta).encode())
        for k, row in enumerate(self.counts.tolist()):
            self.writer.add(10000, array("h", row))
            if k == 299:
                sums = self.counts[100:300].sum(axis=0).tolist()
                self.writer.pose(Placement(1, 100, 200, sums, [1.0] * 6, 2000000))
        self.writer.end(True)


def recorded(tmp_path, lines, labelled=True):
    recording = Recording(tmp_path / "r.bin", labelled)
    for line in lines:
        recording.take(line)
    recording.close()
    return recording


def test_what_is_recorded_is_what_the_board_sent(tmp_path):
    sender = Sender()
    lines = [b'{"event": "state"}' + sender.lines[0], b'{"event": "pose"}', *sender.lines[1:]]
    recording = recorded(tmp_path, lines)
    data = (tmp_path / "r.bin").read_bytes()
    assert data == b"".join(decode_piece(line)[2] for line in sender.lines)
    capture = capture_binary.decode(data)
    assert (len(capture), capture.complete, capture.truncated) == (400, True, None)
    assert np.flatnonzero(capture.pose).tolist() == list(range(100, 300))
    assert recording.words() == ["recorded: %s, 400 samples" % (tmp_path / "r.bin")]


@pytest.mark.parametrize("gone", [[1], [5, 6], [2, 8, 12]])
def test_gaps_are_said_and_what_comes_behind_them_keeps_its_place(gone, tmp_path, capsys):
    sender = Sender()
    lines = list(sender.lines)
    for number in gone:
        lines[number] = lines[number][:40] + b"?" + lines[number][41:]
    recording = recorded(tmp_path, lines)
    capture = capture_file.read(tmp_path / "r.bin")
    assert recording.lost == 400 - len(capture) > 0
    assert "never came" in recording.words()[1] and "never came" in capture.notes[0]
    assert capture.complete and not capture.truncated
    at = np.rint(capture.t_us / 10000).astype(int) - 1
    assert (np.column_stack([capture.accel, capture.gyro, capture.temp])
            == sender.counts[at]).all()
    assert ((at >= 100) & (at < 300) == (capture.pose == 1)).all()


def test_lost_blocks_are_not_the_sensors_losses(tmp_path, capsys):
    sender = Sender()
    recorded(tmp_path, [line for k, line in enumerate(sender.lines) if k not in (4, 9)])
    capture_file.write(tmp_path / "r.csv", capture_file.read(tmp_path / "r.bin"))
    for name in ("r.bin", "r.csv"):
        cli.main(["diagnose", str(tmp_path / name), "--json"])
        answer = json.loads(capsys.readouterr().out)
        assert not [c for c in answer["causes"] if c["effect"] == "dropped_samples"]
        assert any("lost on the way" in remark for remark in answer["remarks"]), answer["remarks"]


def test_a_header_that_got_lost_is_asked_for_and_costs_no_sample(tmp_path):
    sender = Sender()

    class Link:
        sent = []

        def raw_lines(self, timeout):
            yield from sender.lines[1:4]
            yield sender.lines[0]
            yield from sender.lines[4:]

        def send(self, line):
            self.sent.append(json.loads(line))
    recording = Recording(tmp_path / "r.bin")
    assert set(RecordingLink(Link(), recording).lines(1)) == {""}
    recording.close()
    assert Link.sent == [{"cmd": "record"}]
    assert (recording.samples, recording.lost, recording.ended) == (400, 0, True)


def test_cut_off_at_any_piece_it_is_readable_to_the_last_whole_one(tmp_path):
    sender = Sender()
    for n in range(2, len(sender.lines)):
        recording = recorded(tmp_path, sender.lines[:n])
        capture = capture_file.read(tmp_path / "r.bin")
        assert len(capture) == recording.samples and capture.truncated
        assert "cut short" in recording.words()[-1]


@pytest.mark.parametrize("meta, name", [
    (META, "e661-9f3c2a11.bin"), ({}, "board-session.bin"),
    ({"device_id": "../../etc", "session": 1}, "etc-00000001.bin"),
    ({"device_id": ["x"], "session": -5}, "x-session.bin")])
def test_the_file_is_named_by_device_and_session(meta, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert name_of(meta) == name
    Path(name).write_text("")
    assert name_of(meta) == name[:-4] + "-2.bin"


# -- on a virtual board


@pytest.fixture
def resting(micropython, provisioned, tmp_path, monkeypatch):
    """start(**settings): a provisioned virtual board at rest, and --port of it."""
    boards = []
    monkeypatch.setenv("SIXFLIP_PATIENCE", "4")  # other tests run beside this one

    def start(**settings):
        image = tmp_path / "flash.img"
        provisioned(image, dict({"sensor": "mpu6050", "grace_ms": 100}, **settings))
        board = VirtualBoard({"sensor": "mpu6050", "seed": 3, "order": []}, image,
                             micropython=micropython)
        boards.append(board)
        board.__enter__()
        return board, ["--port", board.port]
    yield start
    for board in boards:
        board.close()


def test_a_log_of_twenty_minutes_is_as_long_as_the_clock_says(resting, tmp_path, capsys):
    """The board's microseconds wrap after 17.9 minutes; a board without a record began a session
    by itself, which is ended."""
    _, port = resting(rate_hz=10)
    log = tmp_path / "log.bin"
    assert cli.main(["record", *port, "--hours", "0.33", "-o", str(log), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    capture = capture_file.read(log)
    assert capture.t_us[-1] > 1 << 30 and (answer["lost"], answer["gaps"]) == (0, 0)
    assert (np.diff(capture.t_us) < 150000).all() and len(capture) == answer["samples"]
    assert capture.pose is None and capture.temp is not None and not capture.truncated
    assert abs(len(capture) - 0.33 * 36000) < 70
    assert cli.main(["stream", *port, "--raw", "--seconds", "1"]) == 0  # it streams lines again


def readable(path):
    """The capture of a recording that was cut off between two blocks, or in its last one."""
    data = path.read_bytes()
    blocks = read_blocks(data)
    assert len(data) - (blocks.truncated_at or len(data)) < 600
    return capture_file.read(path)


def recording_process(port, *words):
    return subprocess.Popen([sys.executable, "-m", "sixflip_host", *words, *port],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def wait_for_bytes(path, size, process):
    end = time.monotonic() + 60
    while not path.exists() or path.stat().st_size < size:
        assert time.monotonic() < end and process.poll() is None, process.stdout.read()
        time.sleep(0.02)


def test_killing_the_program_loses_the_last_block_at_most(resting, tmp_path):
    board, port = resting()
    path = tmp_path / "killed.bin"
    process = recording_process(port, "calibrate", "--record", str(path), "--plain")
    wait_for_bytes(path, 20000, process)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    capture = readable(path)
    assert len(capture) > 1500 and "end is missing" in capture.truncated
    assert cli.main(["show", str(path)]) == 0


@pytest.mark.long
def test_pulling_the_plug_loses_the_last_block_at_most(resting, tmp_path):
    board, port = resting()
    path = tmp_path / "pulled.bin"
    process = recording_process(port, "record", "-o", str(path))
    wait_for_bytes(path, 20000, process)
    board.unplug()
    said = process.communicate(timeout=60)[0]
    assert process.returncode == 3 and said.count("\n") == 1, said
    assert len(readable(path)) > 1500


def test_ctrl_c_ends_a_log_whole(resting, tmp_path):
    _, port = resting()
    path = tmp_path / "log.bin"
    process = recording_process(port, "record", "-o", str(path))
    wait_for_bytes(path, 9000, process)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[0]
    assert process.returncode == 130 and "stopped; recorded: " in said
    assert capture_file.read(path).truncated is None
    assert cli.main(["record", *port, "-o", str(path), "--seconds", "1"]) == 2  # it is there


def test_over_a_bad_cable_the_gaps_are_said(resting, tmp_path, capsys):
    board, port = resting()
    rng = random.Random(4)

    def bad_cable(data):
        data = bytearray(data)
        if rng.random() < 0.05 and b"\xa5" in data:
            data[rng.randrange(len(data))] ^= 1 + rng.randrange(255)
        return bytes(data)
    path = tmp_path / "bad.bin"
    with MpremoteLink(board.port) as link:
        link.restart_firmware()
    board.relay.corrupt = bad_cable
    code = cli.main(["record", *port, "-o", str(path), "--seconds", "120"])
    board.relay.corrupt = None
    out = capsys.readouterr()
    assert code == 0, out.err
    assert "never came, in" in out.out
    capture = capture_file.read(path)
    assert not capture.truncated and capture.notes[0].startswith("recorded over the port")
    assert abs(capture.t_us[-1] * 1e-6 - 120) < 2
    assert capture_binary.lost_on_the_way(capture)[0] > 0


@pytest.mark.long
def test_the_recommended_plan_leaves_every_sample_on_a_pico(micropython, tmp_path, capsys,
                                                        monkeypatch):
    """calibrate --plan recommended --record, then diagnose; what the documentation shows."""
    monkeypatch.chdir(tmp_path)
    Path("plan.json").write_text(json.dumps(plan_file.to_plan(protocols.named("recommended"))))
    Path("scenario.toml").write_text(SCENARIO)
    assert cli.main(["simulate", "scenario.toml", "-o", "a.csv", "b.csv", "--worlds",
                     "worlds.json"]) == 0
    world = virtual_board_verb.more_of_it("worlds.json", 2)
    with VirtualBoard(world, "flash.img", micropython=micropython) as board:
        port = ["--port", board.port]
        assert cli.main(["provision", *port]) == 0
        assert cli.main(["calibrate", *port, "--plan", "recommended", "--session", "2",
                         "--record", "two.bin"]) == 0
        capsys.readouterr()
        assert cli.main(["pull", *port]) == 0
    capture = capture_file.read("two.bin")
    assert capture.complete and not capture.truncated and not capture.sums_only
    assert len(capture) > 60000 and len(capture.placements()) == 39
    kept = capture_file.read(Path(board.unique_id) / "capture.bin")
    # beside the compiled firmware and the room for the records the flash has enough for it
    assert kept.complete and not kept.sums_only and kept.taken == len(kept) == len(capture)
    assert (kept.accel == capture.accel).all()
    assert [(p.pose, p.first, p.n, p.sums) for p in kept.placements()] == [
        (p.pose, p.first, p.n, p.sums) for p in capture.placements()]
    assert cli.main(["verify", "two.bin", str(Path(board.unique_id) / "record_a.bin")]) == 0
    capsys.readouterr()
    assert cli.main(["diagnose", "two.bin", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verdict"]
