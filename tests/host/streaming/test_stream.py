"""sixflip stream: raw, corrected and heading, as lines and frames, from real MicroPython."""

import csv
import json
import math
import random
import re
import time

import pytest

from sixflip.record import correction_record
from sixflip_host import cli
from sixflip_host.board import firmware_update
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.local_link import LocalLink
from sixflip_host.board.stream_session import StreamSession
from sixflip_host.errors import CheckFailed, NoBoard
from sixflip_host.virtual.virtual_board import VirtualBoard
from sixflip_sim import worlds

G = 9.80665
STILL = {"sensor": "mpu6050", "seed": 3, "order": [], "ideal": True}
# A box that rests for a minute and is then turned by half a turn.
TURN = dict(STILL, order=["Z+a", "Z+b"], first_rest_s=60.0, flip_error_deg=3.0)
SCALE = 1.15
SHIFT = 0.5  # m/s2, of z


def record(sensor="mpu6050", who_am_i=(0x68, 0x68), gyro=True):
    """A correction nobody could take for none: x is 1.25 times what is read."""
    r = correction_record.Record()
    r.chip, r.who_am_i, r.sequence, r.session = sensor, who_am_i, 1, 7
    r.accel_range_g, r.accel_lsb_per_g = (2, 16384) if sensor == "mpu6050" else (16, 256)
    r.gyro_range_dps, r.gyro_lsb_per_dps = (500, 65.5) if gyro else (0, 0.0)
    P = [[float(i == j) for j in range(4)] for i in range(4)]
    P[0][0], P[3][2] = SCALE, SHIFT
    r.accel = {"P": P, "sigma_P": P, "tilt_deg": 0.0, "tilt_spread_deg": 0.0,
               "residual_rms_g": 1e-4, "noise_g": 3e-3, "level": "tilt solved",
               "verdict": "good", "reason": ""}
    return correction_record.encode(r)


@pytest.fixture
def running(micropython, provisioned, tmp_path):
    """A function: a virtual board in a world, with the firmware and a record; (board, port)."""
    boards = []

    def start(world, speed=None):
        image = tmp_path / "flash.img"
        provisioned(image, {"sensor": world["sensor"], "rest_s": 1, "grace_ms": 100})
        board = VirtualBoard(world, image, micropython=micropython, speed=speed)
        boards.append(board)
        board.__enter__()
        with MpremoteLink(board.port) as link:
            link.put("record_a.bin", record())
        board.power_cycle()
        return board
    yield start
    for board in boards:
        board.close()


def rows(path):
    with open(path, newline="") as file:
        return [{key: float(value) if value else math.nan for key, value in row.items()}
                for row in csv.DictReader(file)]


def stream(board, tmp_path, *words):
    output = tmp_path / "stream.csv"
    code = cli.main(["stream", "--port", board.port, "-o", str(output), *words])
    return code, rows(output) if code == 0 else None


def mean(table, name):
    return sum(row[name] for row in table) / len(table)


def test_lines_and_frames_are_the_same_samples(running, tmp_path, capsys):
    board = running(STILL)
    for wire in ([], ["--binary"]):
        code, raw = stream(board, tmp_path, "--raw", "--hz", "100", "--seconds", "3", *wire)
        assert code == 0 and len(raw) == pytest.approx(300, abs=3)
        assert list(raw[0]) == ["t_us", "ax", "ay", "az", "gx", "gy", "gz", "temp"]
        assert mean(raw, "az") == pytest.approx(16384, abs=30)
        assert all(row["az"] == int(row["az"]) for row in raw)
        steps = [b["t_us"] - a["t_us"] for a, b in zip(raw, raw[1:])]
        assert sum(steps) / len(steps) == pytest.approx(10000, abs=100)
        code, si = stream(board, tmp_path, "--hz", "50", "--seconds", "2", *wire)
        assert code == 0 and len(si) == pytest.approx(100, abs=3)
        assert mean(si, "az_mps2") == pytest.approx(G + SHIFT, abs=0.03)
        assert abs(mean(si, "gz_radps")) < 0.002
        said = capsys.readouterr().err
        assert "%d samples" % len(raw) in said
        assert said.count(", 0 frames lost") == (2 if wire else 0)


def test_a_calibration_that_no_longer_holds_is_said_beside_the_samples(running, tmp_path, capsys):
    board = running(STILL)
    code, table = stream(board, tmp_path, "--hz", "10", "--seconds", "13")
    assert code == 0 and len(table) == pytest.approx(130, abs=3)
    said = capsys.readouterr().err
    # 0.5 m/s² are 51.0 mg
    assert len(re.findall(r"\|a\| at rest is \+5[01]\.\d mg off, 5 is the limit: calibrate again",
                          said)) == 1, said


def test_the_board_is_left_as_it_was(running, tmp_path, capsys):
    board = running(STILL)
    assert stream(board, tmp_path, "--raw", "--binary", "--hz", "40", "--seconds", "1")[0] == 0
    with MpremoteLink(board.port) as link:
        info = StreamSession(link, "raw")._ask("info", "info")
    assert (info["stream_hz"], info["raw"], info["heading"], info["binary"]) == (
        10, False, False, False)


def test_heading_as_frames(running, tmp_path):
    board = running(TURN, speed=20)
    code, table = stream(board, tmp_path, "--heading", "--binary", "--hz", "10",
                         "--seconds", "72")
    assert code == 0
    truth = worlds.make(TURN).truth.flips_deg
    (turned,) = truth.values()
    assert abs(table[0]["yaw_deg"]) < 0.5
    assert (table[-1]["yaw_deg"] - turned + 180) % 360 - 180 == pytest.approx(0, abs=0.5)
    assert max(abs(row["roll_deg"]) for row in table[:20]) < 0.5


def test_noise_on_the_cable(running, tmp_path, capsys):
    """Bytes are changed, lost and added; whole frames come through, the others are counted."""
    board = running(STILL)
    rng = random.Random(4)

    def bad_cable(data):
        data = bytearray(data)
        if rng.random() < 0.2:
            at = rng.randrange(len(data) or 1)
            data[at:at + rng.randrange(3)] = rng.randbytes(rng.randrange(4))
        return bytes(data)

    with MpremoteLink(board.port) as link:
        session = StreamSession(link, "raw", binary=True, hz=100)
        seen = []
        for t_us, values in session.samples(8):
            board.relay.corrupt = bad_cable
            seen.append((t_us, values))
        board.relay.corrupt = None
        session.close()
    assert session.lost > 0 and session.damaged > 0
    assert len(seen) + session.lost == pytest.approx(800, abs=15)
    assert all(abs(values[2] - 16384) < 400 for _, values in seen)
    times = [t_us for t_us, _ in seen]
    assert times == sorted(times)


def test_a_sensor_without_a_gyro_has_no_heading(tmp_path):
    world = {"sensor": "adxl345", "order": [], "ideal": True}
    with LocalLink(tmp_path / "flash", world) as link:
        firmware_update.copy(link, {"rest_s": 1, "grace_ms": 100}, lambda text: None)
        link.put("record_a.bin", record("adxl345", (0xE5, 0), gyro=False))
        link.reset()
        with pytest.raises(CheckFailed, match="the adxl345 has no gyro"):
            next(StreamSession(link, "heading").samples(1))
        for binary in (False, True):
            session = StreamSession(link, "corrected", binary)
            _, values = next(session.samples(1))
            assert all(math.isnan(x) for x in values[3:])
            assert values[2] == pytest.approx(G + SHIFT, abs=0.3)  # noise 0.04, a count 0.038
        session.close()


def test_while_calibrating_nothing_is_streamed(tmp_path):
    with LocalLink(tmp_path / "flash", {"sensor": "mpu6050", "order": []}) as link:
        firmware_update.copy(link, {"grace_ms": 100}, lambda text: None)
        link.reset()
        end = time.monotonic() + 20
        for line in link.lines(10):
            if '"state"' in line or time.monotonic() > end:
                break
        with pytest.raises(CheckFailed, match="a calibration is under way"):
            next(StreamSession(link, "raw").samples(1))


class Answers:
    """A link that says prepared lines."""

    port = "test"

    def __init__(self, *lines):
        self.list = list(lines)
        self.sent = []

    def send(self, line):
        self.sent.append(json.loads(line))

    def raw_lines(self, timeout):
        while self.list:
            yield self.list.pop(0)


READY = [b'{"event": "info", "stream_hz": 10}', b'{"event": "stream", "hz": 10}']


@pytest.mark.parametrize("lines,what", [
    ([], "nothing answers"), ([b">>> "], "nothing answers"),
    ([READY[0], b'{"event": "stream", "hz": 0}'], "set to stream nothing"),
    (READY, "has stopped streaming"),
    ([*READY, b'{"event": "hello"}'], "started anew"),
    ([*READY, b'{"event": "state"}'], "a calibration is under way"),
    ([READY[0], b'{"event": "error", "what": "no", "expected": "yes"}'], "no, expected yes")])
def test_boards_that_do_not_stream(lines, what):
    with pytest.raises((NoBoard, CheckFailed), match=what):
        list(StreamSession(Answers(*lines), "raw").samples())


def test_time_beyond_32_bits():
    from sixflip.capture.stream_frame import RAW, FrameWriter
    writer = FrameWriter(RAW)
    times = [2 ** 32 - 20000, 2 ** 32 - 10000, 2 ** 32, 2 ** 32 + 10000]
    frames = [bytes(writer.frame(t, [0] * 7))[:-1] for t in times]
    session = StreamSession(Answers(*READY, *frames), "raw", binary=True)
    taken = session.samples()
    assert [next(taken)[0] for _ in times] == times


@pytest.mark.parametrize("words", [["--hz", "0"], ["--seconds", "-1"], ["--raw", "--heading"],
                                   ["--hz", "nan"]])
def test_wrong_words(words, capsys):
    assert cli.main(["stream", "--port", "/dev/null", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1
