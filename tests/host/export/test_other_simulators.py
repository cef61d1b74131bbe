"""Exports to other simulators give back the noise and bias that were put in."""
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import yaml

from sixflip_host.capture import capture_file
from sixflip_host.capture.capture_file import Capture
from sixflip_host.errors import CheckFailed
from sixflip_host.export import other_simulators
from sixflip_host.export.noise_model import measure
from sixflip_host.simulation import scenario, simulated_session

BIAS_MG, BIAS_DPS = [20.0, -30.0, 50.0], [1.0, -0.5, 0.2]
WORLD = {"accel_bias_mg": BIAS_MG, "gyro_bias_dps": BIAS_DPS, "accel_noise_mg": 4.0,
         "gyro_noise_dps": 0.06, "flip_error_deg": 0.1, "placement_scatter_deg": 0.0,
         "accel_matrix": [[1.01, 0.002, 0], [0, 0.99, 0], [0, 0.003, 1.0]]}


@pytest.fixture(scope="module")
def capture():
    plan = scenario.from_dict({"world": dict(WORLD, dwell_s=8.0), "seed": 3})
    return simulated_session.session(plan, 0)


def test_noise_density_bias_and_matrix(capture):
    found = measure(capture)
    g = 9.80665
    assert found["accel"].density == pytest.approx([4e-3 * g / 10] * 3, rel=0.06)
    assert found["gyro"].density == pytest.approx([np.radians(0.06) / 10] * 3, rel=0.06)
    assert found["accel"].bias == pytest.approx(np.array(BIAS_MG) * 1e-3 * g, abs=0.006)
    assert np.degrees(found["gyro"].bias) == pytest.approx(BIAS_DPS, abs=0.02)
    assert found["accel"].matrix == pytest.approx(np.array(WORLD["accel_matrix"]), abs=6e-4)
    assert found["accel"].walk is None
    assert found["accel"].step == pytest.approx([g / 16384] * 3)


def test_gazebo_sdf_is_read_back(capture):
    text = other_simulators.sdf(measure(capture), capture.meta)
    root = ElementTree.fromstring(text)
    noise = root.find("./sensor/imu/linear_acceleration/z/noise")
    assert noise.get("type") == "gaussian_quantized"
    assert float(noise.find("stddev").text) == pytest.approx(4e-3 * 9.80665, rel=0.06)
    assert float(noise.find("mean").text) == pytest.approx(0.050 * 9.80665, abs=0.006)
    y = root.find("./sensor/imu/linear_acceleration/y/noise")  # the sign is kept, never drawn
    assert float(y.find("mean").text) == pytest.approx(-0.030 * 9.80665, abs=0.006)
    assert float(y.find("bias_mean").text) == float(y.find("bias_stddev").text) == 0.0
    gyro = root.find("./sensor/imu/angular_velocity/x/noise")
    assert float(gyro.find("stddev").text) == pytest.approx(np.radians(0.06), rel=0.06)


def test_kalibr_yaml_is_read_back(capture):
    content = yaml.safe_load(other_simulators.kalibr(measure(capture), capture.meta))
    assert content["update_rate"] == 100
    assert content["accelerometer_noise_density"] == pytest.approx(4e-4 * 9.80665, rel=0.08)
    assert "accelerometer_random_walk" not in content  # no rest of a minute


@pytest.mark.parametrize("alone, other", [("gyro", "accel"), ("accel", "gyro")])
def test_one_sensor_alone_is_written(capture, tmp_path, alone, other):
    meta = dict(capture.meta, **{alone + "_values": "float"})
    counts = {"accel": None, "gyro": None, alone: getattr(capture, alone)}
    for key in [key for key in meta if key.startswith(other + "_")]:
        del meta[key]
    path, yml, sdf = (str(tmp_path / name) for name in ("one.csv", "one.yaml", "one.sdf"))
    capture_file.write(path, Capture(meta, capture.t_us, counts["accel"], gyro=counts["gyro"],
                                     pose=None if alone == "gyro" else capture.pose))
    other_simulators.capture_kalibr(path, yml)
    other_simulators.capture_sdf(path, sdf)
    with open(yml) as text:
        content = yaml.safe_load(text)
    density = {"gyro": ("gyroscope_noise_density", np.radians(0.06) / 10),
               "accel": ("accelerometer_noise_density", 4e-4 * 9.80665)}
    assert content[density[alone][0]] == pytest.approx(density[alone][1], rel=0.08)
    assert density[other][0] not in content
    noise = list(ElementTree.parse(sdf).iter("noise"))
    assert len(noise) == 3  # an import's own counts are no step of the sensor
    assert {one.get("type") for one in noise} == {"gaussian"}
    assert all(one.find("precision") is None for one in noise)


def test_random_walk_from_a_long_rest():
    effects = [{"effect": "drift", "slope": 0.5, "seed": 4, "x": 0.03, "y": 0.03, "z": 0.03}]
    plan = scenario.from_dict({"world": dict(WORLD, dwell_s=4.0, first_rest_s=600.0), "seed": 3,
                               "effects": effects})
    found = measure(simulated_session.session(plan, 0))["accel"]
    # adev of a random walk K is K sqrt(tau / 3): 0.03 mg at 1 s is K = 0.03 sqrt(3) mg
    assert np.median(found.walk) == pytest.approx(3e-5 * 9.80665 * np.sqrt(3), rel=0.5)
    content = yaml.safe_load(other_simulators.kalibr({"accel": found}, {"sensor": "mpu6050",
                                                                        "rate_hz": 100}))
    assert content["accelerometer_random_walk"] == pytest.approx(found.walk.max(), rel=1e-4)


def test_table_has_units_formulas_and_effects(capture, tmp_path):
    meta = dict(capture.meta, effects=[{"effect": "thermal_bias", "z": -1.76}])
    capture_file.write(str(tmp_path / "c.csv"), capture)
    other_simulators.capture_table(str(tmp_path / "c.csv"), str(tmp_path / "t.txt"))
    assert "accel bias\t" in (tmp_path / "t.txt").read_text(encoding="utf-8")
    text = other_simulators.plain_table(measure(capture), meta, meta["effects"])
    rows = [row.split("\t") for row in text.splitlines()[1:]]
    assert all(len(row) == 6 and row[4] and row[5] for row in rows)
    assert ["accel thermal_bias", "z=-1.76", "", "", "mg/degC"] == rows[-1][:5]


def test_rests_in_several_attitudes_that_do_not_calibrate_are_one_line(capture):
    pose = capture.pose.copy()
    pose[capture.placements()[7].first:] = 0  # some faces, not six
    some = Capture(dict(capture.meta), capture.t_us, capture.accel, capture.gyro, capture.temp,
                   None, pose)
    with pytest.raises(CheckFailed) as caught:
        measure(some)
    assert "\n" not in str(caught.value)
