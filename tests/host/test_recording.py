"""Captures written down on the host while the board takes them: whole, with gaps, cut off."""

import json
from array import array
from pathlib import Path

import numpy as np
import pytest

from sixflip.capture_pieces import PieceWriter, decode
from sixflip.capture_writer import BlockWriter
from sixflip.placement import Placement
from sixflip_host import cli
from sixflip_host.board.recording import Recording, RecordingLink, name_of
from sixflip_host.capture import capture_binary, capture_file

META = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, "gyro_lsb_per_dps": 65.5,
        "temp_lsb_per_c": 340, "temp_offset_c": 36.53, "device_id": "e661", "session": 0x9F3C2A11}
SCENARIO = """sensor = "mpu6050"
scene = "recommended"
seed = 4
[world]
tilt_deg = 1.5
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
    assert data == b"".join(decode(line)[2] for line in sender.lines)
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
