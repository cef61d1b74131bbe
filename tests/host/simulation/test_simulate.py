"""sixflip simulate, and that numpy counts what the simulated chips count."""
import json
from array import array

import numpy as np
import pytest

from sixflip.chips import probe
from sixflip.poses import faces
from sixflip_host.capture import capture_file
from sixflip_host.cli import Parser
from sixflip_host.errors import BadFile, UsageError
from sixflip_host.experiment import signal_measures
from sixflip_host.simulation import motion_scenes, scenario, simulator
from sixflip_host.verbs import simulate
from sixflip_sim import worlds
from sixflip_sim.chips.adxl345 import SimulatedADXL345
from sixflip_sim.effects import datasheets, typical

EVERYTHING = [
    {"effect": "thermal_bias", "x": 5.0, "z2": 0.1}, {"effect": "thermal_scale", "y": 0.02},
    {"effect": "warm_up", "sensor": "gyro", "x": 0.5}, {"effect": "thermal_rate", "z": 2.0},
    {"effect": "quadratic", "x": 5.0}, {"effect": "cross_quadratic", "xyz": 4.0},
    {"effect": "cubic", "y": 5.0}, {"effect": "asymmetry", "sensor": "gyro", "z": 5.9},
    {"effect": "g_sensitivity", "xy": 0.1}, {"effect": "drift", "x": 2.0, "z": 0.4},
    {"effect": "quantisation", "sensor": "gyro", "x": 4}, {"effect": "dead_band", "y": 8},
    {"effect": "saturation", "z": 1.0, "level": 0.99},
    {"effect": "vibration", "x": 20.0, "frequency_hz": 45.0},
    {"effect": "vibration_rectification", "z": 5.0, "vibration_mg": 100.0},
    {"effect": "sample_rate", "rate": 0.5, "stamped": 0},
    {"effect": "filter_lag", "sensor": "device", "tau": 4.9},
    {"effect": "hysteresis", "y": 1.0}, {"effect": "creep", "z": 5.0},
    {"effect": "lever_arm", "x": 3.0}, {"effect": "box_tilt", "Z+x": 0.3},
    {"effect": "table_tilt", "table_x": 0.5}, {"effect": "local_gravity", "g": 1.0},
    {"effect": "torn_reads", "chance": 5.0}, {"effect": "supply", "x": 5.0, "volts": 3.2},
    {"effect": "axis_swap", "x": 2, "y": -1}, {"effect": "earth_rate", "up": 0.003}]


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85", "adxl345", "lsm6ds3trc"])
@pytest.mark.parametrize("effects", [[], EVERYTHING], ids=["nominal", "every effect"])
def test_numpy_counts_what_the_chips_count_through_driver_and_bus(sensor, effects):
    """The paper's session polled through the real driver; every count must be the same."""
    world = worlds.make({"sensor": sensor, "tilt_deg": 2.0, "seed": 3, "dwell_s": 1.0,
                         "warm_c": 8.0, "placement_scatter_deg": 0.05, "effects": effects,
                         "tremor_mg": 15.0,
                         "mishaps": [{"kind": "touched", "pose": "X+a", "at_s": 0.4}]})
    imu, _ = probe.find(world.i2c)
    imu.configure(100)
    chips = [chip for chip in world.chips if hasattr(chip, "model")]
    outputs = simulator.outputs_of(chips)
    sample, rows, seen = array("h", 7 * [0]), [], []
    while world.clock.now_us() < world.end_us:
        imu.read_into(sample)
        rows.append(list(sample))
        seen.append([chip._k for chip in chips])
        world.clock.sleep_us(9000)
    rows, seen = np.array(rows), np.array(seen)
    assert len(rows) > 3000 and len(outputs) == (1 if sensor == "adxl345" else 3)
    simulator.vectorise(world.model)
    gyro_chip = len(chips) - 1
    for output in outputs:
        k = seen[:, 0 if output.kind == "accel" else gyro_chip]
        columns = {"accel": rows[:, 0:3], "gyro": rows[:, 3:6], "temp": rows[:, 6:7]}
        counted = simulator.counts(world.model, output, k)
        assert (counted.T == columns[output.kind]).all(), output.kind


def written(tmp_path, text):
    path = tmp_path / "scenario.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def simulated(tmp_path, text, *names):
    parser = Parser()
    simulate.add_arguments(parser)
    files = [str(tmp_path / name) for name in names]
    assert simulate.run(parser.parse_args([written(tmp_path, text), "-o", *files])) == 0
    return [capture_file.read(name) for name in files]


def test_the_paper_session_is_seeded_and_repeatable(tmp_path):
    text = 'seed = 5\n[[effects]]\neffect = "drift"\nx = 0.4\n'
    first, = simulated(tmp_path, text, "a.csv")
    simulated(tmp_path, text, "b.csv.gz")
    assert (tmp_path / "a.csv").read_bytes() == capture_file.text(
        capture_file.read(str(tmp_path / "b.csv.gz")))
    other, = simulated(tmp_path, text.replace("5", "6", 1), "c.csv")
    assert (other.accel != first.accel).any()
    assert [faces.pose_name(p.pose) for p in first.placements()] == [
        face + letter for face in faces.FACES for letter in "ab"]
    assert np.unique(np.diff(first.t_us)).tolist() == [10000]


def test_the_recommended_session_two_thermal_states_leaning_and_backward(tmp_path):
    warm, cool = simulated(tmp_path, 'scene = "recommended"\nseed = 2', "a.csv", "b.csv")
    for capture in (warm, cool):
        codes = [p.pose for p in capture.placements()]
        assert len(codes) == 39 and codes[:12] == codes[:26:-1]
        assert sorted(codes[:12]) == list(range(1, 13)) and codes[:12] != list(range(1, 13))
        assert codes[12:27] == [faces.LEANING + k for k in range(1, 16)]
    assert warm.temp[-100:].mean() > warm.temp[:100].mean() + 1000
    assert cool.temp[-100:].mean() < cool.temp[:100].mean() - 1000
    means = [[p.sums[2] / p.n for p in c.placements() if p.pose == 1] for c in (warm, cool)]
    assert abs(np.mean(means[0]) - np.mean(means[1])) < 100  # one and the same part


def test_scatter_of_placements_is_what_was_asked_for(tmp_path):
    text = 'scene = "backward"\nflicker = false\nseed = %d\n[world]\n' \
           'placement_scatter_deg = %g\nflip_error_deg = 0.0\naccel_noise_mg = 0.1\n'
    spread = {0.0: [], 0.5: []}
    for seed, size in ((1, 0.0), (1, 0.5), (2, 0.5), (3, 0.5), (4, 0.5)):
        capture, = simulated(tmp_path, text % (seed, size), "s.csv")
        found = {}
        for p in capture.placements():
            found.setdefault(p.pose, []).append(np.array(p.sums[:3]) / p.n)
        spread[size] += [np.linalg.norm(np.subtract(*pair)) for pair in found.values()
                         if len(pair) == 2]
    assert max(spread[0.0]) < 5  # counts
    # two placements, two directions each: sigma times the root of two times Rayleigh's mean
    assert np.mean(spread[0.5]) == pytest.approx(16384 * np.deg2rad(0.5) * 1.77, rel=0.25)


def test_touching_the_table_shows_and_is_not_labelled(tmp_path):
    capture, = simulated(tmp_path, 'touch_every = 3', "t.csv")
    quiet, = simulated(tmp_path, '', "q.csv")
    assert len(capture.placements()) > len(quiet.placements())
    spread = [capture.accel[capture.pose == code].std(axis=0).max() for code in range(1, 13)]
    assert max(spread) < 80


@pytest.mark.parametrize("sensor, kind", [
    ("mpu6050", "accel"), ("mpu6050", "gyro"), ("gy85", "accel"), ("gy85", "gyro")])
def test_allan_deviation_of_a_soak_matches_the_datasheet(tmp_path, sensor, kind):
    text = 'sensor = "%s"\nscene = "soak"\n[world]\nideal = true\nwarm_c = 0.0\n' % sensor
    capture, = simulated(tmp_path, text, "soak.csv")
    lsb = capture.meta["accel_lsb_per_g"] / 1000 if kind == "accel" \
        else capture.meta["gyro_lsb_per_dps"]
    data = getattr(capture, kind) / lsb
    chip = typical.chip_of(sensor, kind)
    density = np.mean(datasheets.figures(sensor, kind, "density"))
    # 0.1 s: white; 100 s: the floor, with what the white noise still gives
    found = signal_measures.allan(data, 10).mean()
    assert 0.3 < found * np.sqrt(0.1) / density < 1.5
    expected = np.hypot(typical.FLOOR[chip], density * 0.1)
    found = np.sqrt(np.mean(signal_measures.allan(data, 10000) ** 2))
    assert 0.5 < found / expected < 1.6


def test_flicker_can_be_switched_off(tmp_path):
    quiet, = simulated(tmp_path, "flicker = false", "q.csv")
    slow, = simulated(tmp_path, "flicker = true", "s.csv")
    assert (quiet.accel != slow.accel).any()
    assert np.abs(quiet.accel.astype(int) - slow.accel)[quiet.pose > 0].max() < 40


def test_rate_error_and_lost_samples(tmp_path):
    text = '[[effects]]\neffect = "sample_rate"\nrate = -0.7\n[[effects]]\n' \
           'effect = "dropped_samples"\nchance = 2\n'
    capture, = simulated(tmp_path, text, "r.csv")
    gaps = np.diff(capture.t_us)
    assert np.median(gaps) == pytest.approx(10070, abs=1)
    assert (gaps > 15000).mean() == pytest.approx(0.02, abs=0.006)


@pytest.mark.parametrize("scene", [motion_scenes.Turntable(), motion_scenes.Drive(100.0)],
                         ids=["turntable", "drive"])
def test_moving_scenes_are_consistent(scene):
    """The rate is the derivative of the attitude, the acceleration that of the rate."""
    t = np.arange(0.0, min(scene.end_s, 70.0), 1e-3)
    attitude, w, alpha, _ = scene.at(t)
    turn = np.einsum("ijn,kjn->ikn", np.gradient(attitude, t, axis=2), attitude)
    assert turn[1, 0] == pytest.approx(w[2], abs=2e-4)
    assert np.gradient(w[2], t) == pytest.approx(alpha[2], abs=0.02)
    assert np.einsum("ijn,kjn->ikn", attitude, attitude)[..., -1] == pytest.approx(np.eye(3))


@pytest.mark.parametrize("scene, top", [("turntable", 180.0), ("drive", 20.0)])
def test_moving_captures(tmp_path, scene, top):
    capture, = simulated(tmp_path, 'scene = "%s"\n[world]\nideal = true\n' % scene, "m.csv")
    assert not capture.pose.any()
    rate = np.abs(capture.gyro).max() / capture.meta["gyro_lsb_per_dps"]
    assert top * 0.9 < rate < 185.0
    norm = np.linalg.norm(capture.accel[:500], axis=1).mean() / 16384
    assert norm == pytest.approx(1.0, abs=0.001)


def test_a_plan_file_is_a_scene(tmp_path):
    plan = tmp_path / "plan.json"
    plan.write_text('["Z+a", {"pose": "Z+b", "dwell_s": 9}, "L1"]', encoding="utf-8")
    capture, = simulated(tmp_path, "plan = '%s'" % plan, "p.csv")
    placements = capture.placements()
    assert [faces.pose_name(p.pose) for p in placements] == ["Z+a", "Z+b", "L1"]
    assert placements[1].n == pytest.approx(900, abs=2)


def test_worlds_of_a_scenario_are_what_the_virtual_board_runs(tmp_path):
    text = 'scene = "paper"\n[world]\ntilt_deg = 1.0\n[[effects]]\neffect = "creep"\nz = 5.0\n'
    plan = scenario.read(written(tmp_path, text))
    world = worlds.make(json.loads(json.dumps(plan.worlds[0])))
    assert world.truth.tilt_deg == 1.0 and [p[0] for p in world.operator.log][:2] == ["Z+a",
                                                                                     "Z+b"]
    assert world.model.effects[0].effects[0].name == "creep"


@pytest.mark.parametrize("text, expected", [
    ("scene = ", "not TOML"), ('scene = "papr"', "scene is 'papr', did you mean paper?"),
    ('sensor = "bmi270"', "expected one of mpu6050 lsm6dsox"), ("sed = 1", "unknown key 'sed'"),
    ("rate_hz = 0", "rate_hz is 0"), ("seed = 1.5", "seed is 1.5, expected a whole number"),
    ("flicker = 3", "flicker is 3, expected true or false"),
    ('[[effects]]\neffect = "gremlins"', "unknown effect 'gremlins'"),
    ('[[effects]]\neffect = "thermal_bais"', "did you mean thermal_bias? expected one of"),
    ('[[effects]]\neffect = "creep"\nz = 1e6', "expected a number from -200 to 200 mg/g"),
    ("effects = 3", "expected [[effects]] tables"),
    ("[world]\ntilt = 1", "[world] has an unknown key 'tilt'"),
    ("[world]\ntilt_deg = 90", "[world] tilt_deg is 90"),
    ("[world]\naccel_bias_mg = [1, 2]", "expected three numbers"),
    ("[world]\naccel_matrix = [[1, 2, 3]]", "expected three rows"),
    ("plan = 3", "expected the name of a plan file"), ("scene = [1]", "scene is [1]"),
    ('plan = "nowhere.json"', "nowhere.json: No such file")])
def test_bad_scenarios_are_one_line(tmp_path, text, expected):
    with pytest.raises(BadFile) as caught:
        scenario.read(written(tmp_path, text))
    assert expected in str(caught.value) and "\n" not in str(caught.value)


def test_zero_poses_and_saturation_and_the_number_of_files(tmp_path):
    (tmp_path / "empty.json").write_text("[]", encoding="utf-8")
    with pytest.raises(BadFile, match="no poses"):
        simulated(tmp_path, "plan = '%s'" % (tmp_path / "empty.json"), "a.csv")
    with pytest.raises(BadFile, match="accel saturates throughout"):
        simulated(tmp_path, "[world]\naccel_bias_mg = [5000, 5000, 5000]", "a.csv")
    assert not (tmp_path / "a.csv").exists()
    with pytest.raises(UsageError, match="has 2 sessions, expected as many files"):
        simulated(tmp_path, 'scene = "thermal"', "a.csv")


def test_a_chip_tells_its_period_and_ranges():
    world = worlds.make({"sensor": "adxl345"})
    imu, _ = probe.find(world.i2c)
    imu.configure(100)
    output, = simulator.outputs_of(world.chips)
    assert isinstance(world.chips[0], SimulatedADXL345)
    assert (output.kind, output.per_unit, output.period_ns) == ("accel", 256, 5_000_000)
