"""Each export, read back and applied by the program it is for, is what the board does."""

import json

import imucal
import imufusion
import numpy as np
import pytest
import yaml

from sixflip.record import correction_record
from sixflip.record.correction import Correction, correction_of
from sixflip_host.cli import main
from tests.worlds.written_records import TERMS, make_record, with_terms

G = 9.80665
LSB, DPS = 8192.0, 65.5


@pytest.fixture(params=[(True, True), (False, False)], ids=["everything", "accelerometer only"])
def case(request, tmp_path):
    """(path of a record, counts (n, 7), what the board makes of them (n, 6))."""
    record = make_record(*request.param)
    path = tmp_path / "record_a.bin"
    path.write_bytes(correction_record.encode(record))
    counts = np.random.default_rng(8).integers(-32768, 32767, (50, 7))
    correction = Correction(record)
    board = np.array([correction.apply(row, [0.0] * 6) for row in counts.tolist()])
    return path, counts, board


def export(case, name, output):
    assert main(["export", str(case[0]), "--format", name, "-o", str(output)]) == 0
    return output.read_text()


def test_imu_calib(case, tmp_path):
    """As accel_calib.cpp of dpkoch/imu_calib does: SM_(i/3, i%3) = SM[i], SM_ raw - bias_."""
    text = export(case, "imu_calib", tmp_path / "imu_calib.yaml")
    assert "# formula of imu_calib: corrected = SM * raw - bias" in text and "m/s^2" in text
    node = yaml.safe_load(text)
    assert len(node["SM"]) == 9 and len(node["bias"]) == 3
    SM = np.zeros((3, 3))
    for i in range(9):
        SM[i // 3, i % 3] = node["SM"][i]
    raw = case[1][:, :3] / LSB * G
    corrected = np.array([SM @ one - np.array(node["bias"]) for one in raw])
    np.testing.assert_allclose(corrected, case[2][:, :3], rtol=0, atol=1e-11)


def test_imufusion(case, tmp_path):
    text = export(case, "imufusion", tmp_path / "calibration.py")
    assert "misalignment * (sensitivity o (raw - offset))" in text and "in g" in text
    names = {}
    exec(text, names)
    for sensor, at, unit in (("accelerometer", 0, 9.78), ("gyroscope", 3, np.radians(1))):
        for row, board in zip(case[1], case[2]):
            answer = imufusion.model_inertial(
                row[at:at + 3].astype(float), names[sensor + "_misalignment"],
                names[sensor + "_sensitivity"], names[sensor + "_offset"])
            # Fusion calculates in single precision
            np.testing.assert_allclose(answer * unit, board[at:at + 3], rtol=1e-5, atol=1e-5)


def test_imucal(case, tmp_path):
    path = tmp_path / "cal.json"
    text = export(case, "imucal", path)
    assert "R_a^-1 K_a^-1 (raw - b_a)" in json.loads(text)["comment"]
    info = imucal.FerrarisCalibrationInfo.from_json_file(path)
    assert isinstance(info, imucal.FerrarisCalibrationInfo)
    acc, gyr = info.calibrate(case[1][:, :3] / LSB * G, case[1][:, 3:6] / DPS, "m/s^2", "deg/s")
    np.testing.assert_allclose(acc, case[2][:, :3], rtol=0, atol=1e-10)
    np.testing.assert_allclose(np.radians(gyr), case[2][:, 3:], rtol=0, atol=1e-10)
    with pytest.raises(ValueError, match="unit"):
        info.calibrate(case[1][:, :3], case[1][:, 3:6], "g", "deg/s")


@pytest.mark.parametrize("name,key", [("imu_calib", "SM"), ("imufusion", "offset")])
def test_a_sensor_without_gyro(tmp_path, name, key):
    record = make_record(False, False)
    record.chip, record.gyro_lsb_per_dps, record.gyro_range_dps = "adxl345", 0.0, 0
    record.accel_range_g, record.accel_lsb_per_g = 16, 256
    (tmp_path / "r.bin").write_bytes(correction_record.encode(record))
    text = export((tmp_path / "r.bin",), name, tmp_path / "out")
    assert key in text and "gyroscope_" not in text and "raw rate" not in text


def test_imucal_needs_a_gyro(tmp_path, capsys):
    record = make_record(False, False)
    record.gyro_lsb_per_dps = 0.0
    (tmp_path / "r.bin").write_bytes(correction_record.encode(record))
    words = ["export", str(tmp_path / "r.bin"), "--format", "imucal", "-o", str(tmp_path / "o")]
    assert main(words) == 4
    assert "without a gyro" in capsys.readouterr().err and not (tmp_path / "o").exists()


def test_record_without_accelerometer(tmp_path, capsys):
    record = make_record()
    record.accel = None
    (tmp_path / "r.bin").write_bytes(correction_record.encode(record))
    assert main(["export", str(tmp_path / "r.bin"), "-o", str(tmp_path / "o.yaml")]) == 4
    assert "no accelerometer correction" in capsys.readouterr().err


@pytest.mark.parametrize("celsius", [None, 36.0])
@pytest.mark.parametrize("name", ["imu_calib", "imufusion", "imucal"])
def test_terms_frozen_at_a_temperature_are_what_the_board_does_there(tmp_path, name, celsius):
    path, record = with_terms(tmp_path / "r.bin")
    output = tmp_path / "out"
    words = [] if celsius is None else ["--temperature", str(celsius)]
    assert main(["export", str(path), "--format", name, "-o", str(output), *words]) == 0
    text = output.read_text()
    assert "HOLDS AT %.2f degC ONLY" % (celsius or 24.0) in text
    assert "accel_thermal_bias and gyro_thermal_bias" in text
    assert ("NOT in this file" in text) == (name != "imucal")
    counts = np.random.default_rng(8).integers(-32768, 32767, (50, 6))
    temp = round(((celsius or 24.0) - 36.53) * 340)
    correction = correction_of(record)
    board = np.array([correction.apply([*row, temp], [0.0] * 6) for row in counts.tolist()])
    if name == "imucal":
        info = imucal.FerrarisCalibrationInfo.from_json_file(output)
        acc, gyr = info.calibrate(counts[:, :3] / LSB * G, counts[:, 3:] / DPS, "m/s^2", "deg/s")
        np.testing.assert_allclose(acc, board[:, :3], rtol=0, atol=2e-4)
        np.testing.assert_allclose(np.radians(gyr), board[:, 3:], rtol=0, atol=2e-4)
    elif name == "imu_calib":
        node = yaml.safe_load(text)
        SM, bias = np.reshape(node["SM"], (3, 3)), np.array(node["bias"])
        np.testing.assert_allclose(counts[:, :3] / LSB * G @ SM.T - bias, board[:, :3], rtol=0,
                                   atol=2e-4)
    else:
        names = {}
        exec(text, names)
        answer = [imufusion.model_inertial(row.astype(float), names["accelerometer_misalignment"],
                                           names["accelerometer_sensitivity"],
                                           names["accelerometer_offset"]) * 9.78
                  for row in counts[:, :3]]
        np.testing.assert_allclose(answer, board[:, :3], rtol=1e-5, atol=5e-4)


def test_json_holds_every_term(tmp_path):
    path, record = with_terms(tmp_path / "r.bin")
    answer = json.loads(export((path,), "json", tmp_path / "r.json"))
    assert {name: fields["axes"] for name, fields in answer["terms"].items()} == dict.fromkeys(
        TERMS, [0, 1, 2])
    assert answer["terms"]["accel_thermal_bias"]["k1"] == TERMS["accel_thermal_bias"]["k1"]


def test_a_temperature_for_a_format_that_follows_it(tmp_path, capsys):
    path, _ = with_terms(tmp_path / "r.bin")
    assert main(["export", str(path), "--format", "json", "-o", str(tmp_path / "o"),
                 "--temperature", "30"]) == 2
    assert "--temperature" in capsys.readouterr().err and not (tmp_path / "o").exists()
