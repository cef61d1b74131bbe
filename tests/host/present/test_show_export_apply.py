"""show, export and apply on what a board leaves behind."""

import csv
import json

import numpy as np
import pytest

from sixflip.record.correction import Correction
from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds.board_session import leave_files, unlabelled


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("board")
    return folder, leave_files(folder, unlabelled(), gyro=False)


def test_show_a_record(pulled, capsys):
    folder, record = pulled
    assert main(["show", str(folder / "record_a.bin")]) == 0
    out = capsys.readouterr().out
    assert "correction for a mpu6050 (who_am_i 0x68/0x00)" in out
    assert "%.5f" % record.accel["P"][0][0] in out
    assert "good: " in out and "gyro: not measured" in out
    assert main(["show", "--json", str(folder / "record_a.bin")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["accel"]["P"] == record.accel["P"] and answer["gyro"] is None


def test_show_a_capture(pulled, capsys):
    folder, _ = pulled
    assert main(["show", str(folder / "capture.bin")]) == 0
    out = capsys.readouterr().out
    assert "Y-b" in out and "longest interval 10.0 ms" in out
    assert main(["show", "--json", str(folder / "capture.bin")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert len(answer["placements"]) == 12 and answer["meta"]["rate_hz"] == 100


def test_what_a_file_says_cannot_steer_the_terminal(pulled, tmp_path, capsys):
    capture = capture_file.read(pulled[0] / "capture.bin")
    capture.meta["device_id"] = "\x1b[2J\x9b31m"
    capture_file.write(tmp_path / "nasty.csv", capture)
    assert main(["show", str(tmp_path / "nasty.csv")]) == 0
    out = capsys.readouterr().out
    assert "\x1b" not in out and "\x9b" not in out and "device_id" in out


def test_a_damaged_record(pulled, tmp_path, capsys):
    data = bytearray((pulled[0] / "record_a.bin").read_bytes())
    data[50] ^= 4
    (tmp_path / "record_a.bin").write_bytes(data)
    assert main(["show", str(tmp_path / "record_a.bin")]) == 4
    assert "CRC" in capsys.readouterr().err


def test_export_there_and_back(pulled, tmp_path):
    source = str(pulled[0] / "capture.bin")
    assert main(["export", source, "-o", str(tmp_path / "c.csv.gz")]) == 0
    assert main(["export", str(tmp_path / "c.csv.gz"), "-o", str(tmp_path / "c.bin")]) == 0
    assert main(["export", str(tmp_path / "c.bin"), "-o", str(tmp_path / "d.csv.gz")]) == 0
    assert (tmp_path / "c.csv.gz").read_bytes() == (tmp_path / "d.csv.gz").read_bytes()


def test_export_of_a_record(pulled, tmp_path):
    folder, record = pulled
    assert main(["export", str(folder / "record_a.bin"), "-o", str(tmp_path / "r.json")]) == 0
    answer = json.loads((tmp_path / "r.json").read_text())
    assert answer["gyro_bias"]["bias_dps"] == record.gyro_bias["bias_dps"]


@pytest.mark.parametrize("source,to", [("record_a.bin", "csv"), ("capture.bin", "json")])
def test_export_of_the_wrong_kind(pulled, tmp_path, capsys, source, to):
    output = tmp_path / "out"
    assert main(["export", str(pulled[0] / source), "-o", str(output), "--to", to]) == 2
    assert "expected --format" in capsys.readouterr().err and not output.exists()


def test_apply_is_what_the_board_does(pulled, tmp_path):
    folder, record = pulled
    output = tmp_path / "corrected.csv"
    assert main(["apply", str(folder / "record_a.bin"), str(folder / "capture.bin"),
                 "-o", str(output)]) == 0
    with open(output, newline="") as file:
        rows = list(csv.DictReader(file))
    capture = capture_file.read(folder / "capture.bin")
    assert len(rows) == len(capture)
    correction = Correction(record)
    for index in (0, 400, len(rows) - 1):
        sample = [*capture.accel[index].tolist(), *capture.gyro[index].tolist(), 0]
        expected = correction.apply(sample, [0.0] * 6)
        got = [float(value) for value in list(rows[index].values())[1:7]]
        assert got == pytest.approx(expected, rel=1e-6, abs=1e-9)
        assert int(rows[index]["t_us"]) == capture.t_us[index]
    still = np.array([[float(row["a%s_mps2" % axis]) for axis in "xyz"] for row in rows])[
        capture.pose == 1]
    assert np.linalg.norm(still.mean(axis=0)) == pytest.approx(9.80665, abs=0.005)


def test_apply_refuses_another_range(pulled, tmp_path, capsys):
    capture = capture_file.read(pulled[0] / "capture.bin")
    capture.meta["accel_lsb_per_g"] = 8192
    capture_file.write(tmp_path / "c.csv", capture)
    words = ["apply", str(pulled[0] / "record_a.bin"), str(tmp_path / "c.csv"),
             "-o", str(tmp_path / "out.csv")]
    assert main(words) == 4
    assert "expected a record of this sensor" in capsys.readouterr().err
    assert main([*words, "--other-sensor"]) == 0
