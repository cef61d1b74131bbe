"""A gyro that follows its temperature beside a simulator of the same motion: which lag it is, and
what flicker makes of the other axes."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import answer, diagnose, effect_estimates
from sixflip_host.diagnosis.aliases import Cause
from sixflip_host.diagnosis.hypotheses import Form
from sixflip_host.diagnosis.simulator import (
    against_simulator,
    comparison,
    effects_beside,
    parameters,
)
from sixflip_host.experiment import noise_arrays
from tests.worlds.tumbled import read, tumbled

TRUE = 0.06  # deg/s/degC
CLASS = {"thermal_bias": 0.97}
LAGGED = Form("thermal_bias", "lag -30 s", keys=tuple("xyz"))


def logs(seed=4, seconds=140.0, simulated=0.0, wanders=0.0):
    """(capture, simulated) of a thing that warms up by 10 degC within minutes; its z axis wanders
    by a few thousandths of a deg/s, and its y by so much; simulated: the simulator's slope."""
    t, force, rate = tumbled(seed, seconds)
    celsius = 35.0 - 10.0 * np.exp(-t / 100.0)
    generator = np.random.default_rng(seed)
    own = np.zeros((len(t), 3))
    own[:, 1] = TRUE * (celsius - celsius.mean())
    own[:, 2] = 0.003 * (1.0 - 2.0 * np.exp(-t / 60.0))
    both = simulated / TRUE * own * [0.0, 1.0, 0.0]
    own[:, 1] += wanders * (1.0 - 2.0 * np.exp(-t / 100.0))
    captures = []
    for number, added in enumerate((own, both)):
        capture = read(t, force, rate + added, seed + 50 * number)
        capture.meta.update(temp_lsb_per_c=340, temp_offset_c=36.53)
        capture.temp = np.rint((celsius - 36.53) * 340 + generator.normal(0.0, 8.0, len(t))
                               ).astype(np.int16)
        captures.append(capture)
    return captures


@pytest.fixture(scope="module")
def beside():
    """The effect that both logs show of a cause whose lag the rests do not tell from none."""
    real, simulated = logs()
    compared = comparison.compare([("real", real)], "sim", simulated)
    plain = Form("thermal_bias", "", keys=tuple("xyz"))
    causes = [Cause("thermal_bias", (form,), 200.0, CLASS) for form in (LAGGED, plain)]
    cause = SimpleNamespace(
        effect="thermal_bias", plausible=True, probabilities=CLASS, variant="lag -30 s", shape=(),
        variants=((0.6, causes[0]), (0.4, causes[1])))
    diagnosis = SimpleNamespace(
        causes=[("gyro", cause)], findings=(), comparisons=(compared,),
        conditions=SimpleNamespace(reference_c=30.0), sessions=[SimpleNamespace(capture=real)])
    effect, = effects_beside._compared(compared, diagnosis).effects
    return effect


def test_a_lag_that_nothing_needs_is_none(beside):
    """0.0692 (0.0688 ... 0.0695) deg/s/degC were 0.06: an exponential that is later is larger."""
    low, high = beside.interval["y"]
    assert "lag_s" not in beside.shape
    assert beside.value["y"] == pytest.approx(TRUE, abs=0.002) and low < TRUE < high


def test_what_flicker_makes_of_an_axis_is_no_effect_of_it(beside):
    """It was said with the others, by an interval around nothing, and set."""
    assert list(beside.value) == list(beside.interval) == ["y"]


@pytest.mark.parametrize("size, both", [(TRUE, True), (0.0, False)])
def test_what_two_logs_that_wander_have_in_both_is_no_gap(size, both):
    """Of 0.8 mg/degC in both one had 3 % less, by what it wandered: the whole was the gap."""
    real, simulated = logs(seconds=60.0, simulated=size, wanders=0.018)
    fits = comparison.compare([("real", real)], "sim", simulated).fits
    cause = SimpleNamespace(effect="thermal_bias", value={"y": TRUE}, variant="", shape=())
    diagnosis = SimpleNamespace(conditions=SimpleNamespace(reference_c=30.0),
                                sessions=[SimpleNamespace(capture=real)])
    assert against_simulator._is_in_both("gyro", fits["gyro"], cause, diagnosis) == both


def test_an_axis_that_goes_with_another_has_no_effect_by_what_it_reads_of_that():
    """On a table that turns about x, 1 % of x was an asymmetry of -0.985 % of y."""
    t = np.arange(0.0, 100.0, 0.05)
    turn = 100.0 * np.sin(0.7 * t)
    columns = np.zeros((len(t), 3, 3))
    for axis, share in enumerate((1.0, -0.005, 0.3 * np.sin(0.17 * t))):
        columns[:, axis, axis] = np.abs(share * turn)
    fit = SimpleNamespace(extra=np.array([1.0, -0.985, 0.9]), extra_sigma=np.full(3, 0.002))
    design = SimpleNamespace(keys="xyz", columns=columns.reshape(-1, 3))
    sizes, sigmas = effects_beside.of_fit(fit, [design], 0, 0.0, t)
    assert parameters.told({key: (size - 1.645 * sigma, size + 1.645 * sigma)
                            for key, size, sigma in zip("xyz", sizes, sigmas)}) == ["x", "z"]
    assert sigmas[0] < 0.03 and sigmas[1] > 1.0


def test_flicker_gives_sizes_the_spread_that_it_is_said_to_give():
    generator = np.random.default_rng(6)
    t = np.arange(0.0, 400.0, 0.5)
    column = np.exp(-t / 150.0) - np.exp(-t / 150.0).mean()
    columns = np.zeros((len(t), 3, 1))
    columns[:, 1, 0] = column
    kernel = sum(np.exp(-np.abs(t[:, None] - t) / tau) for tau in noise_arrays.ALL_TIMES_S)
    wandering = np.linalg.cholesky(kernel + 1e-6 * np.eye(len(t))) @ generator.normal(
        size=(len(t), 400))
    sizes = column @ (wandering - wandering.mean(axis=0)) / (column @ column)
    assert noise_arrays.flicker_of_sizes(t, columns)[0] == pytest.approx(sizes.std(), rel=0.15)


def test_the_size_that_is_told_lies_within_its_interval():
    """Of a form without a lag that does as well as one with, and has a twentieth of the weight."""
    low, high = effect_estimates.ends(
        np.array([0.05, 0.95]), np.array([0.060, 0.069]), np.array([0.0002, 0.0002]))
    assert low == 0.060 and 0.069 < high < 0.070


@pytest.mark.parametrize("counts, said", [(160.0, True), (-10.0, True), (-160.0, False)])
def test_a_dead_band_is_no_narrower_than_none(counts, said):
    """One of -164 counts explained a gyro whose scales up and down differ."""
    assert effect_estimates.believable("dead_band", "mpu6050", "gyro", {"x": counts},
                                       {"x": 10.0}) is said


@pytest.mark.long
@pytest.mark.parametrize("simulated, verdict", [(0.0, "explained"), (0.15, "no gap")])
def test_what_follows_the_temperature_all_the_way_has_its_name(simulated, verdict):
    """Four seconds of each rest showed nothing of it, and of the way nobody asked: a bias of one
    temperature was to be set, and ten times the noise were left."""
    t, force, rate = tumbled(5, 140.0)
    celsius, captures = 30.0 + 6.0 * np.sin(2.0 * np.pi * t / 110.0), []
    for number, slope in enumerate((0.15, simulated)):
        capture = read(t, force, rate + np.outer(slope * (celsius - 30.0), [0.0, 0.0, 1.0]),
                       60 + number)
        capture.meta.update(temp_lsb_per_c=340, temp_offset_c=36.53)
        capture.temp = np.rint((celsius - 36.53) * 340).astype(np.int16)
        captures.append(capture)
    found = answer.as_dict(diagnose.diagnose([("real", captures[0])], [("sim", captures[1])],
                                             jobs=1))
    assert found["verdict"] == verdict
    assert [c["class"][0] for c in found["causes"]] == ["thermal_bias"][:verdict == "explained"]
    for cause in found["causes"]:
        assert list(cause["value"]) == ["z"]
        assert cause["value"]["z"] == pytest.approx(0.15, rel=0.03)
        assert found["simulator"]["gap"]["gyro"]["after"] < 0.05 < 0.3 < found["simulator"][
            "gap"]["gyro"]["before"]
