"""What two logs of one motion leave unexplained decides the verdict: products of readings that are
less than the noise, effects of one axis, and what a log says by itself that both refute."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, log_noise, remaining_gap
from sixflip_host.present import simulator_words
from tests.worlds.tumbled import RATE_HZ, read, tumbled


def answered(t, sim, real, seed=1):
    """The answer to a real log and the simulator's, (force g, rate deg/s) each."""
    return answer.as_dict(diagnose([("real", read(t, *real, seed))],
                                   [("sim", read(t, *sim, 100 + seed))], jobs=1))


def on_a_table(seconds=80.0, size=120.0):
    """(t, specific force g, rate deg/s) of a table that turns about x, which lies level."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    way = np.clip(np.minimum(t % 20.0 - 3.0, 19.5 - t % 20.0) / 1.5, 0.0, 1.0)
    spin = size * np.sin(0.7 * t) * way
    turned = np.radians(np.cumsum(spin) / RATE_HZ)
    force = np.stack([0.0 * t, np.sin(turned), np.cos(turned)], 1)
    return t, force, np.stack([spin, 0.01 * spin, -0.005 * spin], 1)


@pytest.mark.long
def test_an_asymmetry_of_the_axis_that_is_turned_has_its_name_beside_a_bias():
    """The bend was looked for where the reading is zero, and not the rate: no name at all."""
    t, force, rate = on_a_table()
    found = answered(t, (force, rate + [8.0, 0.0, 0.0]), (
        force, rate + [8.0, 0.0, 0.0] + np.abs(rate) * [0.03, 0.0, 0.0]))
    cause, = found["causes"]
    assert (cause["effect"], cause["sensor"]) == ("asymmetry", "gyro")
    assert cause["value"]["x"] == pytest.approx(3.0, rel=0.05)
    assert found["verdict"] == "explained"


def test_axes_that_have_none_of_an_effect_are_not_named_by_chance():
    """Beside 2.04 deg/s of y the other axes had 0.001 and 0.004, by two of their errors."""
    cause = {"axes": ["y"], "class": ["quadratic"], "value": {}, "interval_90": {}}
    effect = SimpleNamespace(
        effect="quadratic", unit="deg/s", shape={}, value={"x": 0.0012, "y": 2.044, "z": 0.0036},
        interval={"x": (0.0001, 0.0023), "y": (2.038, 2.05), "z": (0.0008, 0.0064)})
    said = answer._by_both_logs(cause, effect)
    assert said["axes"] == ["y"] and said["value"] == {"y": 2.044}
    faint = SimpleNamespace(**{**vars(effect), "interval": {
        key: (low, 40.0) for key, (low, _) in effect.interval.items()}})
    assert answer._by_both_logs(cause, faint)["axes"] == ["x", "y", "z"]


def squared(rate):
    """Rates with 2 deg/s more at 100 deg/s of each axis, whichever way it turns."""
    return rate + 2e-4 * rate ** 2


def test_a_square_of_the_rate_is_no_unknown_convention():
    """What a sensor does of itself was given the size that suits what has no name best: none."""
    t, force, rate = tumbled(1, 80.0)
    found = comparison.compare([("real", read(t, force, squared(rate), 1))], "sim",
                               read(t, force, rate, 101))
    assert not found.conventions


@pytest.mark.long
def test_a_square_of_the_rate_is_one_effect():
    """The square of what was read with it in had a cube in it: of what acts it has none."""
    t, force, rate = tumbled(1)
    found = answered(t, (force, rate), (force, squared(rate)))
    cause, = found["causes"]
    assert (cause["effect"], cause["sensor"]) == ("quadratic", "gyro")
    assert list(cause["value"].values()) == pytest.approx([2.0, 2.0, 2.0], rel=0.05)


@pytest.mark.long
@pytest.mark.parametrize("size_mg, verdict", [(0.0, "no gap"), (6.0, "unexplained")])
def test_a_product_of_readings_that_is_less_than_the_noise_is_no_lack_of_a_gap(size_mg, verdict):
    """Two logs left it in their difference, and it was no gap, or a bias explained it."""
    t, force, rate = tumbled(1)
    product = 1e-3 * size_mg * force[:, :1] * rate[:, 2:] / 50.0 * [0.0, 1.0, 0.0]
    found = answered(t, (force, rate), (force + product, rate))
    assert found["verdict"] == verdict
    assert [(p["sensor"], p["domain"]) for p in found["where"]] == (
        [("accel", "motion")] if size_mg else [])


def test_what_a_log_says_of_itself_is_not_printed_where_both_refute_it():
    """1.78 less -0.86 % were said to be -0.089: an asymmetry that passes for a scale in one."""
    scale = {"unit": "%", "real": 1.78, "real_interval_90": [0.91, 2.65], "simulator": -0.86,
             "simulator_interval_90": [-1.47, -0.26], "difference": -0.089,
             "difference_interval_90": [-0.111, -0.067], "differs": True, "set": -0.089, "how": ""}
    row, = simulator_words.parameter_rows({"parameters": {"gyro": {"scale": {"x": scale}}}})
    assert row[1:3] == ("-", "-")
    alike = {**scale, "real": -0.9, "real_interval_90": [-1.6, -0.2]}
    row, = simulator_words.parameter_rows({"parameters": {"gyro": {"scale": {"x": alike}}}})
    assert "-" not in row[1:3]


def behind_a_pole(values, hz, rate_hz=100.0):
    share = 1.0 - np.exp(-2.0 * np.pi * hz / rate_hz)
    return lfilter([share], [1.0, share - 1.0], values)


def test_what_follows_from_both_logs_is_left_of_a_gap():
    """3 % of y behind a pole of 0.3 Hz: "explained" by a crooked axis, 2.4 mg left of 0.84."""
    t, force, rate = tumbled(1, 60.0)
    crooked = force + np.outer(0.03 * behind_a_pole(force[:, 1], 0.3), [1.0, 0.0, 0.0])
    found = comparison.compare([("real", read(t, crooked, rate, 1))], "sim",
                               read(t, force, rate, 101))
    assert found.left == ["accel"]


@pytest.mark.parametrize("own, late, least, most", [
    (0.3, 0.0, -1.0, 0.0), (0.03, 0.03, 0.1, 0.3), (0.0, 0.03, 0.9, 1.0)])
def test_what_shakes_each_log_in_its_own_way_follows_from_one_alone(own, late, least, most):
    rng, t = np.random.default_rng(8), np.arange(0.0, 120.0, 0.02)
    moved = lfilter([0.25], [1.0, -0.94], rng.standard_normal((len(t), 3)), axis=0)
    moved /= moved.std()
    logs = [moved + own * rng.standard_normal(moved.shape) for _ in range(2)]
    left = logs[1] - logs[0] + late * behind_a_pole(moved.T, 0.3, 50.0).T
    pair = SimpleNamespace(t=t, real=lambda kind: logs[0], simulated=lambda kind: logs[1])
    fit = SimpleNamespace(kind="accel", pair=pair, live=np.ones(3, bool))
    assert least < remaining_gap.follows(fit, left) < most


@pytest.mark.parametrize("hz", [0.0, 1.03, 5.5])
def test_what_swings_steadily_at_rest_is_no_noise(hz):
    """8 mg at 1 Hz were 13 times the noise of the simulator, and the gap less than that noise."""
    rng, t = np.random.default_rng(4), np.arange(0.0, 40.0, 0.01)
    values = 0.02 * rng.standard_normal((len(t), 3))
    values[:, 2] += 0.08 * np.sin(2.0 * np.pi * hz * t)
    log = SimpleNamespace(rests=[(k, k + 950) for k in range(0, 4000, 1000)], rate_hz=100.0)
    assert log_noise.noise(log, values).density == pytest.approx([0.002] * 3, rel=0.2)
