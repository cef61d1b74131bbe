"""sixflip stream --ros2 and --foxglove: what another program on the loopback reads of it."""

import csv
import json
import math
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from sixflip.record import correction_record
from sixflip_host import cli
from sixflip_host.board import firmware_update
from sixflip_host.board.local_link import LocalLink
from sixflip_host.errors import CheckFailed, NoBoard
from sixflip_host.streaming import imu_message, publishing, ros2_publisher
from sixflip_host.verbs import stream as verb
from sixflip_sim.worlds import usual_noise
from tests.worlds import dds_loopback
from tests.worlds.written_records import of_a_gy85

SAMPLES = 300
G = 9.80665
SECOND = Path(dds_loopback.__file__).with_name("second_participant.py")


@pytest.fixture
def loopback(monkeypatch, worker_id):
    """The domain of this worker of the test run."""
    monkeypatch.setenv("CYCLONEDDS_URI", dds_loopback.LOOPBACK)
    return 100 + (int(worker_id[2:]) if worker_id.startswith("gw") else 0)


@pytest.fixture
def board(tmp_path, monkeypatch):
    """A simulated board at rest with a record, as the verb finds it."""
    link = LocalLink(tmp_path / "flash", {"sensor": "gy85", "order": [], "ideal": True})
    firmware_update.copy(link, {"sensor": "gy85", "rest_s": 1, "grace_ms": 100}, lambda text: None)
    link.put("record_a.bin", correction_record.encode(of_a_gy85()))
    monkeypatch.setattr(verb, "open_link", lambda port: link)
    return link


def other(*words):
    """The other program, listening."""
    process = subprocess.Popen([sys.executable, str(SECOND), *words], stdout=subprocess.PIPE,
                               text=True, env=dict(os.environ))
    assert process.stdout.readline() == "ready\n"
    return process


def heard(process):
    """What it heard."""
    out, _ = process.communicate(timeout=90)
    assert process.returncode == 0
    return json.loads(out)


def check(rows, path, frame):
    """Every sample came, in order, as the board sent it; prints how long it took."""
    with open(path, newline="") as file:
        sent = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == SAMPLES == len(sent)
    for row, own in zip(rows, sent):
        assert row["force"] == pytest.approx([own[k] for k in ("ax_mps2", "ay_mps2", "az_mps2")],
                                             rel=1e-6, abs=1e-6)
        assert row["rate"] == pytest.approx([own[k] for k in ("gx_radps", "gy_radps", "gz_radps")],
                                            rel=1e-6, abs=1e-6)
        assert row["stamp_ns"] - rows[0]["stamp_ns"] == 1000 * (own["t_us"] - sent[0]["t_us"])
        assert row["frame_id"] == frame
    rate, force = imu_message.covariances(of_a_gy85())
    assert rows[0]["rate_covariance"] == pytest.approx(rate)
    assert rows[0]["force_covariance"] == pytest.approx(force)
    assert rows[0]["orientation_covariance"] == list(imu_message.ABSENT)
    late = sorted(1e-6 * (row["received_ns"] - row["sent_ns"]) for row in rows)
    print("%d of %d messages, latency %.2f ms (median), %.2f ms (worst)" % (
        len(rows), SAMPLES, late[len(late) // 2], late[-1]))
    assert late[0] > 0.0


def test_ros2(loopback, board, tmp_path, capsys):
    out = tmp_path / "sent.csv"
    listener = other("dds", str(loopback), "/robot/imu", str(SAMPLES))
    code = cli.main(["stream", "--ros2", "--topic", "/robot/imu", "--domain", str(loopback),
                     "--frame-id", "base", "--hz", "100", "--seconds", "2.995", "-o", str(out)])
    rows, said = heard(listener), capsys.readouterr()
    assert code == 0 and said.out == ""
    assert "publishing /robot/imu in DDS domain %d" % loopback in said.err
    check(rows, out, "base")


def test_foxglove(board, tmp_path, capsys):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    out = tmp_path / "sent.csv"
    listener = other("foxglove", port, "/imu/data_raw", str(SAMPLES))
    code = cli.main(["stream", "--foxglove", "--foxglove-port", port, "--hz", "100",
                     "--seconds", "2.995", "-o", str(out)])
    rows, said = heard(listener), capsys.readouterr()
    assert code == 0
    assert "serving /imu/data_raw at ws://127.0.0.1:" + port in said.err
    check(rows, out, "imu_link")


def test_a_second_publisher_on_the_topic(loopback, monkeypatch):
    first = ros2_publisher.Ros2Publisher("/imu/data_raw", loopback)
    with pytest.raises(CheckFailed, match="/imu/data_raw has a publisher already in domain"):
        ros2_publisher.Ros2Publisher("/imu/data_raw", loopback)
    first.close()


def test_a_domain_that_cannot_be_opened():
    """In a process of its own: a domain keeps its settings as long as a process has it."""
    code = ("from sixflip_host.streaming import ros2_publisher as r\n"
            "try: r.Ros2Publisher('/imu', 7)\n"
            "except Exception as e: print(type(e).__name__, e.exit_code, e)")
    uri = dds_loopback.LOOPBACK.replace("'lo'", "'none0'")
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60,
                         env=dict(os.environ, CYCLONEDDS_URI=uri)).stdout
    assert out.startswith("NoBoard 3 DDS domain 7 cannot be opened: ")
    assert "expected a network interface" in out


def test_a_port_that_is_taken():
    from sixflip_host.streaming.foxglove_server import FoxgloveServer
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(NoBoard, match="cannot be opened for Foxglove"):
            FoxgloveServer("/imu", taken.getsockname()[1])


@pytest.mark.parametrize("words, what", [
    (["--raw", "--ros2"], "take the corrected samples"),
    (["--topic", "/imu"], "--topic is an option of --ros2 and --foxglove"),
    (["--foxglove", "--domain", "3"], "--domain is an option of --ros2"),
    (["--ros2", "--foxglove-port", "3"], "--foxglove-port is an option of --foxglove"),
    (["--ros2", "--domain", "233"], "DDS domain 233: expected 0 to 232"),
    (["--ros2", "--domain", "x"], "DDS domain x: expected 0 to 232"),
    (["--ros2", "--topic", "imu data"], "expected a name like /imu/data_raw"),
    (["--foxglove", "--foxglove-port", "70000"], "expected 0 to 65535")])
def test_wrong_words(board, words, what, capsys):
    assert cli.main(["stream", *words]) == 2
    said = capsys.readouterr().err
    assert what in said and said.count("\n") == 1


def test_without_the_library(board, monkeypatch, capsys):
    for module in ("cyclonedds.domain", "foxglove"):
        monkeypatch.setitem(sys.modules, module, None)
    for word in ("--ros2", "--foxglove"):
        assert cli.main(["stream", word]) == 2
        assert word + " needs " in capsys.readouterr().err


def test_covariances_from_the_record():
    rate, force = imu_message.covariances(of_a_gy85())
    noise = (3e-3 * G) ** 2 + G ** 2 * 1e-6
    assert force[::4] == pytest.approx([noise + x ** 2 for x in (2e-2, 3e-2, 4e-2)])
    assert rate[::4] == pytest.approx([math.radians(usual_noise("gy85")[1]) ** 2 + x ** 2
                                       for x in (2e-2, 3e-2, 4e-2)])
    assert imu_message.covariances(None) == (imu_message.UNKNOWN,) * 2
    unknown = of_a_gy85()
    unknown.accel["sigma_P"][3][1] = math.nan
    unknown.gyro = None
    assert imu_message.covariances(unknown) == (imu_message.UNKNOWN,) * 2


def test_stamps_are_the_devices_and_jumps_are_said():
    said = []
    clock = imu_message.DeviceClock(said.append, lambda: 5_000_000_000)
    times = [1_000_000, 1_010_000, 1_020_000, 9_020_000, 9_030_000, 30_000, 40_000]
    stamps = [clock.stamp(t) for t in times]
    assert stamps == [5_000_000_000 + 1000 * (t - 1_000_000) for t in times]
    assert said == ["the board's clock jumped by +8 s, expected steps of 0.01 s",
                    "the board's clock jumped by -9 s, expected steps of 0.01 s"]


def test_a_sensor_without_a_gyro_has_no_rate():
    messages = imu_message.ImuMessages(of_a_gy85(), "imu", print, lambda: 0)
    message = messages.message(0, (0.0, 0.0, G, math.nan, math.nan, math.nan))
    assert message.rate is None and message.rate_covariance == imu_message.ABSENT
    assert message.force_covariance != imu_message.UNKNOWN
    assert len(message.cdr()) == 4 + 16 + 37 * 8


def test_a_board_without_a_record_publishes_unknown_covariances(tmp_path):
    with LocalLink(tmp_path / "flash", {"sensor": "gy85", "order": []}) as link:
        firmware_update.copy(link, {"sensor": "gy85", "grace_ms": 100}, lambda text: None)
        assert publishing.record_of(link) is None
