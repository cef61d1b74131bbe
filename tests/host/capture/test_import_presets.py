"""Files as other tools write them, told by their content and by --from; each is made by its
format's own writer where there is one for Python."""

import gc
import io
import json
import struct

import numpy as np
import pytest

from sixflip_host.capture import open_recording
from sixflip_host.cli import main
from sixflip_host.errors import BadFile

ROWS, RATE = 600, 100.0
T = np.arange(ROWS) / RATE
TURN = np.clip(T - 2.0, 0, 2.0) * 0.5                # rad about x, from 2 s to 4 s
NOISE = np.random.default_rng(5).normal(size=(ROWS, 6))
ACCEL = 9.81 * np.c_[np.zeros(ROWS), np.sin(TURN), np.cos(TURN)] + 0.02 * NOISE[:, :3]
GYRO = np.c_[np.gradient(TURN, T), np.zeros(ROWS), np.zeros(ROWS)] + 0.002 * NOISE[:, 3:]


def ulog_bytes(rows=ROWS):
    """A ULog with sensor_combined, by the format's description."""
    def message(kind, data):
        return struct.pack("<HB", len(data), ord(kind)) + data
    text = b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;"
    raw = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message("B", bytes(40)) \
        + message("F", text) + message("A", struct.pack("<BH", 0, 7) + b"sensor_combined")
    for t, gyro, accel in zip(T[:rows], GYRO, ACCEL):
        raw += message("D", struct.pack("<HQ6f", 7, int(5e6 + 1e6 * t), *gyro, *accel))
    return raw


def ulog(path):
    """sensor_combined, through pyulog's own writer."""
    pyulog = pytest.importorskip("pyulog", reason="pyulog is not installed: make setup")
    pyulog.ULog(io.BytesIO(ulog_bytes())).write_ulog(str(path))


def npz(path):
    np.savez(path, lin_acc_b=ACCEL, ang_vel_b=GYRO, time=T)


def mat(path):
    from scipy.io import savemat
    savemat(path, {"accelReadings": ACCEL, "gyroReadings": GYRO, "Fs": RATE,
                   "about": {"who": "a structure, passed over"}}, do_compression=True)


def gazebo_text(rows=ROWS):
    """As `gz topic -e` prints: fields that are 0 are left out."""
    def vector(name, values):
        return name + " {\n" + "".join("  %s: %.17g\n" % pair for pair in zip("xyz", values)
                                       if pair[1]) + "}\n"
    text = ""
    for t, gyro, accel in zip(T[:rows], GYRO, ACCEL):
        stamp = "".join("    %s: %d\n" % pair for pair in (
            ("sec", int(t)), ("nsec", round(t % 1 * 1e9))) if pair[1])
        text += 'header {\n  stamp {\n%s  }\n  data {\n    key: "seq"\n  }\n}\n' \
            'entity_name: "imu"\norientation {\n  w: 1\n}\n' % stamp
        text += vector("angular_velocity", gyro) + vector("linear_acceleration", accel) + "\n"
    return text


def gazebo(path):
    path.write_text(gazebo_text())


def gazebo_json(path):
    path.write_text("".join(json.dumps({
        "header": {"stamp": {"sec": str(int(t)), "nsec": round(t % 1 * 1e9)}},
        "angularVelocity": dict(zip("xyz", gyro)), "linearAcceleration": dict(zip("xyz", accel))})
        + "\n" for t, gyro, accel in zip(T, GYRO, ACCEL)))


def betaflight(path):
    """The Blackbox Explorer's CSV: quoted names behind a header of settings."""
    lines = ['"Product","Blackbox flight data recorder by Nicholas Sherlock"', '"acc_1G","2048"',
             '"gyro_scale","1"', '"loopIteration","time","gyroADC[0]","gyroADC[1]","gyroADC[2]",'
             '"accSmooth[0]","accSmooth[1]","accSmooth[2]","debug[0]"']
    rows = np.c_[np.arange(ROWS), 31000000 + 1e6 * T, np.rint(np.degrees(GYRO)),
                 np.rint(ACCEL / 9.80665 * 2048), np.zeros(ROWS)]
    path.write_text("\n".join(lines + [",".join("%d" % v for v in row) for row in rows]) + "\n")


def phyphox(path):
    rows = ["%.9E;%.9E;%.9E;%.9E" % (t, *accel) for t, accel in zip(T, ACCEL)]
    path.write_text('"Time (s)";"Acceleration x (m/s^2)";"Acceleration y (m/s^2)";'
                    '"Acceleration z (m/s^2)"\n' + "\n".join(rows).replace(".", ",") + "\n")


def ros_csv(path):
    """rostopic echo -p: nanoseconds, and columns that nobody asked for."""
    head = "%time,field.header.seq,field.header.stamp,field.header.frame_id," + ",".join(
        "field.%s.%s" % (name, axis) for name in ("angular_velocity", "linear_acceleration")
        for axis in "xyz")
    rows = ["%d,%d,%d,imu_link,%s" % (
        1.6e18 + 1e9 * t + 3e5, k, 1.6e18 + 1e9 * t, ",".join("%.9g" % v for v in (*gyro, *accel)))
        for k, (t, gyro, accel) in enumerate(zip(T, GYRO, ACCEL))]
    path.write_text(head + "\n" + "\n".join(rows) + "\n")


FORMATS = [("px4", "log.ulg", ulog), ("isaac", "log.npz", npz), ("matlab", "log.mat", mat),
           ("gazebo", "log.txt", gazebo), ("gazebo", "log.json", gazebo_json),
           ("betaflight", "log.csv", betaflight), ("phyphox", "log.csv", phyphox),
           ("ros2", "log.csv", ros_csv)]
NAMES = [form[2].__name__ for form in FORMATS]


@pytest.mark.parametrize("preset, name, write", FORMATS, ids=NAMES)
def test_a_file_is_told_by_its_content(preset, name, write, tmp_path):
    write(tmp_path / name)
    capture = open_recording.read_samples(tmp_path / name)
    assert len(capture) == ROWS
    assert capture.meta["rate_hz"] == pytest.approx(RATE, rel=1e-3)
    accel = capture.accel / capture.meta["accel_lsb_per_g"] * 9.80665
    assert np.abs(accel - ACCEL).max() < 0.01
    assert np.abs(accel.mean(axis=0) - ACCEL.mean(axis=0)).max() < 1e-3
    if preset != "phyphox":
        gyro = np.radians(capture.gyro / capture.meta["gyro_lsb_per_dps"])
        assert np.abs(gyro - GYRO).max() < np.radians(0.51)     # Betaflight logs whole deg/s
    assert all("imported" in line for line in capture.assumed)


@pytest.mark.parametrize("preset, name, write", FORMATS, ids=NAMES)
def test_from_says_the_same_and_refuses_another(preset, name, write, tmp_path, capsys):
    write(tmp_path / name)
    words = ["import", str(tmp_path / name), "-o", str(tmp_path / "out.csv"), "--no-poses"]
    assert main([*words, "--from", preset]) == 0
    capsys.readouterr()
    (tmp_path / "out.csv").unlink()
    other = "px4" if preset != "px4" else "gazebo"
    assert main([*words, "--from", other]) == 4
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "--from" in said and "expected" in said
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.filterwarnings("error::ResourceWarning",
                            "error::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name, write", [form[1:] for form in FORMATS[:4]], ids=NAMES[:4])
def test_a_file_cut_short_is_refused_in_one_line(name, write, tmp_path, capsys):
    write(tmp_path / name)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[:40])
    assert main(["import", str(tmp_path / name), "-o", str(tmp_path / "out.csv")]) == 4
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "out.csv").exists()
    gc.collect()        # a file left open warns when it goes


def test_a_file_that_is_no_recording_names_the_import_line(tmp_path, capsys):
    path = tmp_path / "some log.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(BadFile, match="sixflip import '.*some log.csv' -o capture.csv"):
        open_recording.read(path)
    for verb in ("diagnose", "solve", "refine"):
        assert main([verb, str(path)]) == 4
        assert "sixflip import" in capsys.readouterr().err


def test_verbs_and_programs_take_such_files_and_say_what_was_assumed(tmp_path, capsys):
    betaflight(tmp_path / "log.csv")
    path = str(tmp_path / "log.csv")
    assert main(["solve", path, "--json"]) in (0, 1)
    said = json.loads(capsys.readouterr().out)
    assert path + ": imported: times are in the column time" in said["assumed"]
    assert main(["refine", path]) == 4      # two rests are no session, but it was read
    said = capsys.readouterr().err
    assert "sixflip import" not in said and "rests" in said
    assert main(["show", path]) == 0
    assert "imported: times are in the column time" in capsys.readouterr().out
    assert main(["diagnose", path, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert any("imported: times are in the column time" in line for line in said["remarks"])
    assert said["clock"][0]["header_rate"] == "measured" and said["clock"][0]["expected"] == ROWS


def test_a_mat_file_of_version_7_3_says_how_to_save_it(tmp_path, capsys):
    (tmp_path / "a.mat").write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64" + bytes(200))
    assert main(["import", str(tmp_path / "a.mat"), "-o", str(tmp_path / "out.csv")]) == 4
    assert "expected one of save -v7" in capsys.readouterr().err
