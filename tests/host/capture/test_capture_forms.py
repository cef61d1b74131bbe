"""A board's capture and its text say the same, however the session was cut or continued."""

import json
import random

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sixflip.capture.blocks import ACCEL, GYRO, TEMP
from sixflip.capture.writer import BlockWriter
from sixflip.poses.placement import Placement
from sixflip_host import cli
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.errors import BadFile

META = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, "gyro_lsb_per_dps": 65.5,
        "temp_lsb_per_c": 340, "temp_offset_c": 36.53}
STEPS = ("pose", "pose", "pose", "withdraw", "pause", "sums only", "note", "move")


def written(steps, seed):
    """The bytes of a session of those steps, as the firmware writes it, without its end."""
    data, chance = bytearray(), random.Random(seed)
    writer = BlockWriter(data.extend, json.dumps(META).encode(), ACCEL | GYRO | TEMP, 32)
    rows, poses = [], []

    def feed(n, dt_us=10000):
        for _ in range(n):
            rows.append([chance.randint(-20000, 20000) for _ in range(7)])
            writer.add(dt_us, rows[-1])
    for step in steps:
        feed(chance.randint(1, 40))
        if step == "pose":
            first, n = len(rows), chance.randint(2, 70)
            feed(n)
            sums = [sum(column) for column in zip(*rows[first:])]
            poses.append(1 + chance.randrange(12))
            writer.pose(Placement(poses[-1], first, n, sums, [1.5] * 6, 10000 * n))
        elif step == "withdraw" and poses:
            writer.withdraw(chance.choice(poses))
        elif step == "pause":
            feed(1, 60000000)
        elif step == "sums only":
            writer.flush()
            writer.sums_only = True
        elif step == "note":
            writer.note("a note")
    return data, writer


def said(capture):
    return ([(p.pose, p.first, p.n, p.sums) for p in capture.placements()], capture.notes,
            capture.complete, capture.truncated, capture.sums_only, capture.taken,
            [(m.before, m.after, m.n, m.gyro_sums) for m in capture.moves()])


@settings(max_examples=150, deadline=None)
@given(st.lists(st.sampled_from(STEPS), min_size=1, max_size=14), st.integers(0, 999),
       st.sampled_from(["whole", "incomplete", "no end", "cut", "damaged"]))
@example(["pose", "pause", "pose"], 0, "whole")     # a turn through far more than a path can tell
def test_text_and_binary_agree(steps, seed, how):
    data, writer = written(steps, seed)
    if how in ("whole", "incomplete"):
        writer.end(how == "whole")
    elif how == "cut":
        data = data[:random.Random(seed).randrange(300, 301 + len(data))]
    elif how == "damaged":
        data[random.Random(seed).randrange(len(data))] ^= 4
    try:
        binary = capture_binary.decode(bytes(data))
    except BadFile:
        return  # there is nothing, or no header
    if not len(binary):
        return
    text = capture_file.parse("x.csv", capture_file.text(binary))
    assert said(text) == said(binary)
    if not binary.sums_only:
        assert [p[:4] for p in said(binary)[0]] == [
            (p.pose, p.first, p.n, p.sums) for p in binary.board_placements]
    for p in text.placements():
        if p.first + p.n <= len(text):
            sums = [int(s) for s in text.accel[p.first:p.first + p.n].sum(axis=0, dtype=int)]
            assert p.sums[:3] == sums
    again = capture_binary.decode(capture_binary.encode(text))
    assert said(again)[0] == said(binary)[0] and again.sums_only == binary.sums_only


def test_a_session_whose_last_samples_were_not_kept(tmp_path, capsys):
    """Of a flash that ran full before the power was cut: both forms give the same answer."""
    data, _ = written(["pose"] * 3 + ["sums only"] + ["pose"] * 2, 1)
    decoded = capture_binary.decode(bytes(data))
    assert decoded.sums_only and decoded.taken > decoded.placements()[-1].first > len(decoded)
    (tmp_path / "capture.bin").write_bytes(data)
    capture_file.write(tmp_path / "capture.csv", decoded)
    answers = []
    for name in ("capture.bin", "capture.csv"):
        answers.append((cli.main(["solve", str(tmp_path / name)]),
                        capsys.readouterr().err.replace(name, "")))
    assert answers[0] == answers[1] and answers[0][0] in (1, 4)


@pytest.mark.parametrize("extras", [
    [1], {"placements": 3}, {"placements": [{}]}, {"notes": 5}, {"taken": "x"},
    {"withdrawn": [None]}, {"placements": [{"pose": "Q", "first": 0, "n": 1, "duration_us": 1,
                                            "sums": [0] * 7, "noise": [0] * 6}]}])
def test_extras_that_make_no_sense_are_one_line(extras):
    head = json.dumps(dict(META, samples=1, board_capture=extras))
    data = "# sixflip-capture 1\n# %s\nt_us,ax,ay,az\n0,1,2,3\n" % head
    with pytest.raises(BadFile, match="board_capture makes no sense"):
        capture_file.parse("x.csv", data.encode())
