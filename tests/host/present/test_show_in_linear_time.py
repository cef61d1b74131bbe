"""Withdrawn poses and notes by the thousand: the work grows with the file, not with its square."""

import json

from sixflip.capture.blocks import ACCEL
from sixflip.capture.reader import read
from sixflip.capture.writer import BlockWriter
from sixflip.poses.placement import Placement
from sixflip_host.cli import main

META = json.dumps({"sensor": "adxl345", "rate_hz": 100, "accel_lsb_per_g": 256}).encode()


class Counted(int):
    """A pose's code that counts how often it is compared or looked up."""

    looked = 0

    def __eq__(self, other):
        Counted.looked += 1
        return int(self) == int(other)

    def __hash__(self):
        Counted.looked += 1
        return hash(int(self))


def session(poses, withdrawn, notes=0):
    """A board's file with so many blocks of each kind."""
    data = bytearray()
    writer = BlockWriter(data.extend, META, ACCEL, 1)
    for _ in range(20):
        writer.add(10000, [0, 0, 256])
    for k in range(poses):
        writer.pose(Placement(1 + k % 12, k % 10, 5, [0] * 7, [1.0] * 6, 40000))
    for k in range(withdrawn):
        writer.withdraw(13 + k % 1000)
    for k in range(notes):
        writer.note("%d" % k)
    writer.end(True)
    return bytes(data)


def looks(poses, withdrawn, monkeypatch):
    """How often the reader looks at the code of a pose."""
    from sixflip.capture import reader as capture_reader
    monkeypatch.setattr(capture_reader, "Placement", lambda code, *more: Placement(
        Counted(code), *more))
    Counted.looked = 0
    assert len(read(session(poses, withdrawn)).placements) == poses
    return Counted.looked


def test_a_withdrawn_pose_costs_no_look_at_every_other(monkeypatch):
    few, many = looks(100, 100, monkeypatch), looks(1000, 1000, monkeypatch)
    assert few > 0 and many <= 20 * few


def test_what_comes_after_its_withdrawal_counts():
    data = bytearray()
    writer = BlockWriter(data.extend, META, ACCEL, 1)
    for k, code in enumerate((1, 2, 1, 3)):
        writer.pose(Placement(code, 10 * k, 5, [0] * 7, [1.0] * 6, 40000))
    writer.withdraw(1)
    writer.withdraw(3, 30)
    writer.pose(Placement(1, 50, 5, [0] * 7, [1.0] * 6, 40000))
    writer.withdraw(2, 99)
    writer.end(False)
    assert [(one.pose, one.first) for one in read(data).placements] == [(2, 10), (1, 50)]


def test_thousands_of_blocks_of_every_kind_are_shown(tmp_path, capsys):
    (tmp_path / "x.bin").write_bytes(session(3000, 20000, 3000))
    assert main(["show", str(tmp_path / "x.bin"), "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert shown["placements"] and len(shown["notes"]) == 3000
