"""Captures as Parquet, NPZ, MCAP and out of ROS bags, each opened with the real reader."""

import csv
import json
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from sixflip.record.correction import Correction
from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds.board_session import leave_files, unlabelled

G = 9.80665


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    """(folder with capture.csv and record_a.bin, the capture, what the board makes of it)."""
    folder = tmp_path_factory.mktemp("board")
    record = leave_files(folder, unlabelled(), gyro=True)
    whole = capture_file.read(folder / "capture.bin")
    few = slice(0, None, 5)
    capture = capture_file.Capture(whole.meta, *(block[few] for block in (
        whole.t_us, whole.accel, whole.gyro, whole.temp)), pose=whole.pose[few])
    capture_file.write(folder / "capture.csv", capture)
    correction = Correction(record)
    rows = np.hstack([capture.accel, capture.gyro, capture.temp[:, None]]).tolist()
    return folder, capture, np.array([correction.apply(row, [0.0] * 6) for row in rows])


def export(pulled, tmp_path, name):
    output = tmp_path / name
    assert main(["export", str(pulled[0] / "capture.csv"), "-o", str(output)]) == 0
    return output


def apply(pulled, tmp_path, name):
    output = tmp_path / name
    assert main(["apply", str(pulled[0] / "record_a.bin"), str(pulled[0] / "capture.csv"),
                 "-o", str(output)]) == 0
    return output


def test_parquet(pulled, tmp_path):
    table = pq.read_table(export(pulled, tmp_path, "c.parquet"))
    capture = pulled[1]
    assert table.column_names == capture.columns()
    assert str(table.schema.field("ax").type) == "int16"
    assert (np.stack([table[name].to_numpy() for name in ("gx", "gy", "gz")], axis=1)
            == capture.gyro).all()
    assert (table["t_us"].to_numpy() == capture.t_us).all()
    assert set(table["pose"].to_pylist()) >= {"", "Z+a", "Y-b"}
    said = json.loads(table.schema.metadata[b"sixflip"])
    assert said["capture"] == capture.meta and said["kind"] == "sixflip capture"


def test_parquet_corrected(pulled, tmp_path):
    table = pq.read_table(apply(pulled, tmp_path, "c.parquet"))
    names = ["ax_mps2", "ay_mps2", "az_mps2", "gx_radps", "gy_radps", "gz_radps"]
    got = np.stack([table[name].to_numpy() for name in names], axis=1)
    np.testing.assert_allclose(got, pulled[2], rtol=0, atol=1e-12)
    assert table["temp_c"][0].as_py() == pytest.approx(25.6, abs=0.2)
    said = json.loads(table.schema.metadata[b"sixflip"])
    assert said["record"]["accel"]["verdict"] == "good"


def test_npz(pulled, tmp_path):
    capture = pulled[1]
    with np.load(export(pulled, tmp_path, "c.npz"), allow_pickle=False) as raw:
        assert (raw["accel"] == capture.accel).all() and raw["accel"].dtype == np.int16
        assert (raw["temp"] == capture.temp).all()
        assert raw["pose"][capture.pose == 1][0] == "Z+a"
        assert json.loads(str(raw["about"]))["capture"]["rate_hz"] == 100
    with np.load(apply(pulled, tmp_path, "d.npz"), allow_pickle=False) as corrected:
        np.testing.assert_allclose(corrected["gyro_radps"], pulled[2][:, 3:], atol=1e-12)
        assert "accel" not in corrected.files


def imu_of(path, reader):
    """(stamps in ns, accel (n, 3), gyro (n, 3)) by a reader's own messages."""
    rows = []
    for topic, message in reader(path):
        if topic == "/imu/data_raw":
            a, w = message.linear_acceleration, message.angular_velocity
            stamp = message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec
            assert message.orientation_covariance[0] == -1
            rows.append((stamp, a.x, a.y, a.z, w.x, w.y, w.z))
    table = np.array(rows)
    return table[:, 0], table[:, 1:4], table[:, 4:]


def by_mcap(path):
    with open(path, "rb") as file:
        for _, channel, _, message in make_reader(
                file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            yield channel.topic, message


def by_rosbags(path):
    with AnyReader([path]) as reader:
        for connection, _, data in reader.messages():
            yield connection.topic, reader.deserialize(data, connection.msgtype)


@pytest.mark.parametrize("reader", [by_mcap, by_rosbags])
def test_mcap(pulled, tmp_path, reader):
    capture = pulled[1]
    stamps, accel, gyro = imu_of(export(pulled, tmp_path, "c.mcap"), reader)
    assert (stamps == capture.t_us * 1000).all()
    np.testing.assert_allclose(accel, capture.accel / 16384 * G, rtol=1e-12)
    np.testing.assert_allclose(gyro, np.radians(capture.gyro / 65.5), rtol=1e-12)
    _, accel, gyro = imu_of(apply(pulled, tmp_path, "d.mcap"), reader)
    np.testing.assert_allclose(np.hstack([accel, gyro]), pulled[2], rtol=0, atol=1e-12)


def test_what_else_is_in_the_mcap(pulled, tmp_path):
    path = export(pulled, tmp_path, "c.mcap")
    with open(path, "rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        kept = {one.name: one.metadata for one in reader.iter_metadata()}
    assert {one.topic for one in summary.channels.values()} == {
        "/imu/data_raw", "/imu/temperature"}
    assert {one.name for one in summary.schemas.values()} == {
        "sensor_msgs/msg/Imu", "sensor_msgs/msg/Temperature"}
    assert json.loads(kept["sixflip"]["about"])["capture"] == pulled[1].meta
    celsius = [message.temperature for topic, message in by_mcap(path)
               if topic == "/imu/temperature"]
    assert len(celsius) == len(pulled[1]) and celsius[0] == pytest.approx(25.6, abs=0.2)


def test_mcap_and_back(pulled, tmp_path, capsys):
    path = export(pulled, tmp_path, "c.mcap")
    assert main(["import", str(path), "-o", str(tmp_path / "back.csv"), "--sensor", "mpu6050",
                 "--no-poses"]) == 0
    assert "whole steps of 1/16384 g" in capsys.readouterr().out
    back, capture = capture_file.read(tmp_path / "back.csv"), pulled[1]
    assert (back.accel == capture.accel).all() and (back.gyro == capture.gyro).all()
    assert (back.t_us == capture.t_us - capture.t_us[0]).all()
    assert back.meta["gyro_lsb_per_dps"] == pytest.approx(65.5, rel=1e-6)


def test_csv_of_a_sensor_without_gyro_and_temperature(tmp_path):
    capture = unlabelled()
    alone = capture_file.Capture({"sensor": "adxl345", "rate_hz": 100, "accel_lsb_per_g": 256},
                                 capture.t_us[:50] - 70000, capture.accel[:50] // 64)
    capture_file.write(tmp_path / "a.csv", alone)
    assert main(["export", str(tmp_path / "a.csv"), "-o", str(tmp_path / "a.mcap")]) == 0
    messages = [message for _, message in by_mcap(tmp_path / "a.mcap")]
    assert len(messages) == 50 and messages[0].angular_velocity_covariance[0] == -1
    assert main(["import", str(tmp_path / "a.mcap"), "-o", str(tmp_path / "b.csv"), "--no-poses",
                 "--accel-lsb", "256"]) == 0
    back = capture_file.read(tmp_path / "b.csv")
    assert back.gyro is None and (back.accel == alone.accel).all()


# -- bags that others made


def messages(store, n=300, stamped=True):
    """[(ns, bytes)] of Imu messages as a driver of ROS publishes them."""
    types = store.types
    rng = np.random.default_rng(2)
    vector, header = types["geometry_msgs/msg/Vector3"], types["std_msgs/msg/Header"]
    out = []
    for k in range(n):
        ns = 1700000000123456789 + k * 5000000
        stamp = types["builtin_interfaces/msg/Time"](
            ns // 10 ** 9 if stamped else 0, ns % 10 ** 9 if stamped else 0)
        counts = rng.integers(-9, 9, 3) + [0, 0, 4096]
        more = {"seq": k} if "seq" in header.__dataclass_fields__ else {}
        message = types["sensor_msgs/msg/Imu"](
            header=header(stamp=stamp, frame_id="imu", **more),
            orientation=types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
            orientation_covariance=np.zeros(9),
            angular_velocity=vector(0.01 * k, 0.0, -0.5), angular_velocity_covariance=np.zeros(9),
            linear_acceleration=vector(*(counts / 4096 * G)),
            linear_acceleration_covariance=np.zeros(9))
        out.append((ns + 777, message))
    return out


def bag(folder, plugin, topics=("/imu",), stamped=True):
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        for topic in topics:
            connection = writer.add_connection(topic, "sensor_msgs/msg/Imu", typestore=store)
            for ns, message in messages(store, stamped=stamped):
                writer.write(connection, ns, store.serialize_cdr(message, connection.msgtype))
    return folder


ARGS = ["--gyro-lsb", "131", "--no-poses"]


@pytest.mark.parametrize("plugin", list(StoragePlugin))
@pytest.mark.parametrize("what", ["folder", "file"])
def test_a_rosbag2(tmp_path, plugin, what):
    path = bag(tmp_path / "bag", plugin)
    if what == "file":
        path, = [one for one in path.iterdir() if one.suffix in (".db3", ".mcap")]
    output = tmp_path / "c.csv.gz"
    assert main(["import", str(path), "-o", str(output), *ARGS]) == 0
    capture = capture_file.read(output)
    assert capture.meta["accel_lsb_per_g"] == pytest.approx(4096, rel=1e-9)
    assert capture.meta["rate_hz"] == 200 and len(capture) == 300
    assert capture.accel[:, 2].mean() == pytest.approx(4096, abs=2)
    assert capture.gyro[100].tolist() == [round(np.degrees(1.0) * 131), 0,
                                          round(np.degrees(-0.5) * 131)]
    assert (np.diff(capture.t_us) == 5000).all()


def test_a_bag_of_ros_1(tmp_path):
    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer1(tmp_path / "old.bag") as writer:
        connection = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
        for ns, message in messages(store):
            writer.write(connection, ns, store.serialize_ros1(message, connection.msgtype))
    assert main(["import", str(tmp_path / "old.bag"), "-o", str(tmp_path / "c.csv"), *ARGS]) == 0
    assert len(capture_file.read(tmp_path / "c.csv")) == 300


def test_messages_without_stamps_take_the_recorders_time(tmp_path):
    path = bag(tmp_path / "bag", StoragePlugin.SQLITE3, stamped=False)
    assert main(["import", str(path), "-o", str(tmp_path / "c.csv"), *ARGS]) == 0
    assert (np.diff(capture_file.read(tmp_path / "c.csv").t_us) == 5000).all()


def test_the_topic(tmp_path, capsys):
    path = bag(tmp_path / "bag", StoragePlugin.MCAP, ("/front/imu", "/rear/imu"))
    output = str(tmp_path / "c.csv")
    assert main(["import", str(path), "-o", output, *ARGS]) == 2
    assert "2 Imu topics, expected --topic with one of /front/imu /rear" in capsys.readouterr().err
    assert main(["import", str(path), "-o", output, *ARGS, "--topic", "/side"]) == 2
    assert "no Imu topic /side" in capsys.readouterr().err
    assert main(["import", str(path), "-o", output, *ARGS, "--topic", "/rear/imu"]) == 0
    (tmp_path / "x.csv").write_text("ax,ay,az\n1,2,3\n")
    assert main(["import", str(tmp_path / "x.csv"), "-o", output, "--rate", "9",
                 "--topic", "/a"]) == 2


def test_values_that_are_no_counts(pulled, tmp_path, capsys):
    """Corrected data has no steps: it is kept as it is, or rounded to an LSB that is given."""
    path = str(apply(pulled, tmp_path, "d.mcap"))
    words = ["import", path, "-o", str(tmp_path / "c.csv"), "--no-poses"]
    assert main(words) == 0
    assert "accelerometer values are no whole steps" in capsys.readouterr().out
    assert capture_file.read(tmp_path / "c.csv").meta["accel_values"] == "float"
    assert main([*words, "--accel-lsb", "8192", "--gyro-lsb", "65.5"]) == 0
    assert "rounded by up to 0.5" in capsys.readouterr().out


def cut(path):
    path.write_bytes(path.read_bytes()[:-len(path.read_bytes()) // 3])


@pytest.mark.parametrize("plugin", list(StoragePlugin))
@pytest.mark.parametrize("harm", [cut, lambda path: path.write_bytes(b"nonsense" * 99),
                                  lambda path: path.write_bytes(b""),
                                  lambda path: path.unlink()], ids=["cut", "no", "empty", "gone"])
def test_damaged_bags(tmp_path, capsys, plugin, harm):
    path, = [one for one in bag(tmp_path / "bag", plugin).iterdir()
             if one.suffix in (".db3", ".mcap")]
    harm(path)
    for name in (path, tmp_path / "bag"):
        assert main(["import", str(name), "-o", str(tmp_path / "c.csv"), *ARGS]) == 4
        error = capsys.readouterr().err
        assert error.startswith("sixflip: " + str(name)) and error.count("\n") == 1
    assert not (tmp_path / "c.csv").exists()


def test_a_bag_without_imu(tmp_path, capsys):
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/chat", "std_msgs/msg/String", typestore=store)
        message = store.types["std_msgs/msg/String"]("hello")
        writer.write(connection, 5, store.serialize_cdr(message, connection.msgtype))
    assert main(["import", str(tmp_path / "bag"), "-o", str(tmp_path / "c.csv")]) == 4
    assert "expected one beside /chat (std_msgs/msg/String)" in capsys.readouterr().err


@pytest.mark.parametrize("library,words", [
    ("pyarrow", ["export", "capture.csv", "-o", "c.parquet"]),
    ("mcap_ros2.writer", ["apply", "record_a.bin", "capture.csv", "-o", "c.mcap"]),
    ("rosbags.highlevel", ["import", "c.mcap", "-o", "c.csv"])])
def test_a_library_that_is_not_installed(pulled, tmp_path, monkeypatch, capsys, library, words):
    monkeypatch.chdir(pulled[0])
    monkeypatch.setitem(sys.modules, library, None)
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "-m pip install 'pyarrow>=14' 'mcap-ros2-support" in error and "sixflip[" not in error


def test_corrected_csv_is_as_before(pulled, tmp_path):
    with open(apply(pulled, tmp_path, "c.csv"), newline="") as file:
        row = next(csv.DictReader(file))
    assert float(row["az_mps2"]) == pytest.approx(pulled[2][0, 2], rel=1e-6)
