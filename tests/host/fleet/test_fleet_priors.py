"""The population as what plan and diagnose expect of the next board, and as simulated parts."""
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host import cli
from sixflip_host.diagnosis import hypotheses
from sixflip_host.diagnosis.elimination import Columns
from sixflip_host.errors import BadFile
from sixflip_host.fleet import answer, fleet_prior, judgement, members, randomisation
from sixflip_host.planning import plan_answer, protocols

SPREAD = {"accel_scale": 0.01, "accel_misalignment": 0.5, "accel_bias": 20.0, "accel_noise": 0.01,
          "gyro_scale": 0.01, "gyro_misalignment": 0.5, "gyro_bias": 0.8, "gyro_noise": 0.0005}
MIDDLE = {"accel_scale": 1.0, "gyro_scale": 1.0, "accel_bias": 15.0, "accel_noise": 0.3,
          "gyro_noise": 0.005}


@pytest.fixture(scope="module")
def batch():
    """(Members, [Batch]) of 80 boards whose z slope is -1 ± 0.2 mg/degC."""
    rng, blocks, n = np.random.default_rng(5), [], 80

    def block(name, names, mean, spread, usual=None):
        k = len(names)
        y = mean + rng.normal(0.0, 1.0, (n, k)) * spread
        R = np.tile(np.diag(np.full(k, (0.05 * np.max(spread)) ** 2)), (n, 1, 1))
        blocks.append(members.Block(name, tuple(names), y, R, usual))
    for name, names in members.parameters.BLOCKS.items():
        block(name, names, MIDDLE.get(name, 0.0), SPREAD[name])
    for effect, mean, spread in (("accel.thermal_bias", (0.0, 0.0, -1.0), 0.2),
                                 ("gyro.thermal_bias", 0.0, 0.01)):
        block(effect, [effect + "." + a for a in "xyz"], mean, spread, np.ones(3))
    them = members.Members("mpu6050", 2.0, 500.0, tuple("b%02d" % k for k in range(n)),
                           ("",) * n, blocks, [], {}, ())
    return them, judgement.batches(them)


@pytest.fixture
def file(batch, tmp_path):
    path = tmp_path / "fleet.json"
    path.write_text(json.dumps(answer.population([(*batch, [])], [], [])))
    return str(path)


def test_the_next_board_is_expected_to_be_like_the_batch(file):
    prior = fleet_prior.read(file, "mpu6050")
    assert prior.boards == 80
    z = prior.deviation("accel", "thermal_bias", "z", 2.0)
    x = prior.deviation("accel", "thermal_bias", "x", 2.0)
    assert z == pytest.approx(np.sqrt((1.0 + 0.04) * 81 / 82 + 4.0 / 82), rel=0.1)
    assert 0.2 < x < 0.4        # a board that is not of the batch may still have it
    assert prior.deviation("accel", "cubic", "x", 2.0) is None
    assert prior.size("accel", "thermal_bias") == pytest.approx(1.0, rel=0.1)


def test_forms_take_the_deviations_of_the_fleet_and_bends_keep_theirs(file):
    prior = fleet_prior.read(file, "mpu6050")
    form = hypotheses.Form("thermal_bias", "", None, ("z", "z"), (2, 2),
                           Columns(np.array([0, 1]), np.array([2.0, 0.3])), powers=(1, 2))
    other = hypotheses.Form("cubic", "", None, ("z",), (2,), Columns(np.array([2]),
                                                                    np.array([5.0])), powers=(1,))
    told, kept = hypotheses.by_fleet([form, other], "accel", prior)
    assert told.of_fleet and told.prior[0] < 1.2 and told.prior[1] == 0.3
    assert kept is other and not kept.of_fleet
    assert hypotheses.by_fleet([form], "accel", None) == [form]


def test_a_plan_judges_by_the_fleet_s_sizes(file):
    found, _ = plan_answer.planned(protocols.named("paper"), prior=fleet_prior.read(
        file, "mpu6050"))
    slope, = (e for e in found["effects"] if (e["effect"], e["sensor"]) == (
        "thermal_bias", "accel"))
    assert slope["typical"] == pytest.approx(1.02, rel=0.1) and "80 boards" in slope["source"]


def test_what_is_no_fleet_is_one_sentence(file, tmp_path, capsys):
    with pytest.raises(BadFile, match="no boards with a gy85"):
        fleet_prior.read(file, "gy85")
    with open(file) as text:
        good = json.load(text)
    group = good["groups"][0]
    for bad in ("{", "[]", '{"format": 1}', json.dumps(dict(good, kind="else")),
                json.dumps(dict(good, groups=[dict(group, chip=3)])),
                json.dumps(good).replace('"mean": ', '"mean": "x", "m": ', 1),
                "[" * 100000,
                '{"format": 1, "kind": "sixflip fleet", "groups": [{"chip": 1e999}]}'):
        (tmp_path / "bad.json").write_text(bad)
        with pytest.raises(BadFile) as said:
            fleet_prior.read(str(tmp_path / "bad.json"), "mpu6050")
        assert "\n" not in str(said.value)
    assert cli.main(["plan", "--prior", str(tmp_path / "bad.json")]) == 4
    assert "bad.json" in capsys.readouterr().err


def run(text):
    found = {}
    exec(compile(text, "imu", "exec"), found)
    return found


def test_drawn_parts_are_those_of_the_batch(batch):
    files = randomisation.files(*batch)
    numpy_form = run(files["imu_numpy.py"])
    imu = numpy_form["Imu"](4000, 1)
    assert imu.parts["accel.thermal_bias.z"].mean() == pytest.approx(-1.0, abs=0.05)
    assert imu.parts["accel.thermal_bias.z"].std() == pytest.approx(0.2, rel=0.2)
    assert imu.parts["accel_bias_x_mg"].std() == pytest.approx(20.0, rel=0.25)
    still = np.zeros((4000, 3)), np.zeros((4000, 3))
    force, _ = imu.read(*still, 0.01)
    warm, _ = imu.read(*still, 0.01, temperature=35.0)
    mg = 1000.0 / 9.80665
    assert (warm - force)[:, 2].mean() * mg == pytest.approx(-10.0, abs=0.5)
    assert force[:, 0].mean() * mg == pytest.approx(
        imu.parts["accel_bias_x_mg"].mean(), abs=0.5)


def test_a_part_that_is_calibrated_by_its_own_numbers_reads_the_truth(batch):
    imu = run(randomisation.files(*batch)["imu_numpy.py"])["Imu"](3, 2)
    (_, bias, noise), (_, _, gyro_noise) = imu.accel, imu.gyro
    noise[:] = gyro_noise[:] = 0.0
    true = np.array([[0.3, -9.0, 2.0]] * 3)
    read, _ = imu.read(true, np.zeros((3, 3)), 0.01)
    for k in range(3):
        T = np.eye(3)
        for i, a in enumerate("xyz"):
            for j, b in enumerate("xyz"):
                if i != j:
                    T[i, j] = np.radians(imu.parts["accel_misalignment_%s%s_deg" % (a, b)][k])
        S = np.diag([imu.parts["accel_scale_" + a][k] for a in "xyz"])
        assert np.allclose(T @ S @ (read[k] - bias[k]), true[k])


def test_mujoco_reads_a_part_in_its_sensordata(batch):
    import mujoco
    model = mujoco.MjModel.from_xml_string("""<mujoco><worldbody><body><freejoint/>
      <geom size="0.1" mass="1"/><site name="imu"/></body></worldbody><sensor>
      <gyro name="imu_gyro" site="imu"/><accelerometer name="imu_accelerometer" site="imu"/>
      </sensor></mujoco>""")
    data = mujoco.MjData(model)
    form = run(randomisation.files(*batch)["imu_mujoco.py"])
    imu = form["Imu"](1, 3)
    mujoco.mj_step(model, data)
    assert np.allclose(data.sensordata, 0.0, atol=1e-9)     # it falls
    form["apply"](imu, model, data, model.opt.timestep)
    gyro, force = data.sensordata[:3], data.sensordata[3:]
    assert np.allclose(force, imu.accel[1][0], atol=6.0 * imu.accel[2].max() / 0.002 ** 0.5)
    assert np.allclose(gyro, imu.gyro[1][0], atol=6.0 * imu.gyro[2].max() / 0.002 ** 0.5)


def test_isaac_lab_s_form_redraws_the_environments_that_are_reset(batch, monkeypatch):
    import sys
    torch = SimpleNamespace(
        as_tensor=lambda value, device: np.asarray(value), einsum=np.einsum,
        randn_like=lambda value: np.zeros(value.shape))
    monkeypatch.setitem(sys.modules, "torch", torch)
    form = run(randomisation.files(*batch)["imu_isaaclab.py"])
    imu = form["RandomImu"](4, "cpu", 0.01)
    still = np.zeros((4, 3))
    before = imu.accel(still)
    assert np.allclose(before, imu.imu.accel[1], atol=1e-6)
    pull = imu.imu.pull.copy()
    imu.reset([1, 3])
    after = imu.accel(still)
    assert np.array_equal(pull[[0, 2]], imu.imu.pull[[0, 2]])
    assert np.array_equal(np.any(before != after, axis=1), [False, True, False, True])
    assert imu.gyro(still, still).shape == (4, 3)


def test_what_a_form_cannot_express_is_in_its_list(batch):
    _, batches = batch
    files = randomisation.files(*batch)
    missing = {name: run(text)["CANNOT_EXPRESS"] for name, text in files.items()}
    assert missing["imu_isaaclab.py"] == ["thermal_bias of the accel", "thermal_bias of the gyro"]
    assert missing["imu_numpy.py"] == missing["imu_mujoco.py"] == []
    assert "This form cannot express: thermal_bias of the accel, " in files["imu_isaaclab.py"]
    first, = batches
    creeping = replace(first, parameters=[
        *first.parameters, replace(first.parameters[-1], name="accel.creep.x", kind="batch")])
    assert randomisation.cannot_express([creeping])["imu_numpy.py"] == ["creep of the accel"]
