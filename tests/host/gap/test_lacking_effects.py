"""What a real sensor does of itself as a thing moves, beside a simulator of the same motion that
lacks it: a name where the form is one of the library's or near it, and none for what has none."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import (
    against_simulator,
    hypotheses,
    lacking_effects,
    remaining_gap,
    sensor_axes,
)
from tests.worlds.tumbled import RATE_HZ, read, tumbled


def answered(added, seeds=(1,)):
    """The answer to captures of which the real ones have what `added` makes of (force, rate)."""
    real, simulated = [], []
    for seed in seeds:
        t, force, rate = tumbled(seed)
        real.append(("real %d" % seed, read(t, *added(force, rate), seed)))
        simulated.append(("sim %d" % seed, read(t, force, rate, 100 + seed)))
    return answer.as_dict(diagnose(real, simulated, jobs=1))


def on(axis, change):
    """change (n,) on one of three axes."""
    return np.stack([change if axis == a else np.zeros(len(change)) for a in "xyz"], 1)


def softened(force, rate):
    """3 % more to one side than to the other, in full from 15 deg/s on."""
    return force, rate + on("z", 0.03 * rate[:, 2] * np.tanh(rate[:, 2] / 15.0))


def pulled(force, rate):
    return force, rate + force @ np.array([[0.1, 0.0, -0.05], [0.0, 0.08, 0.0], [0.06, 0.0, 0.1]])


def bowed(force, rate):
    return force + on("x", 0.005 * np.abs(force[:, 0]) ** 1.5), rate


@pytest.mark.long
@pytest.mark.parametrize("added, effect, sensor, key, size", [
    (softened, "asymmetry", "gyro", "z", 3.0), (pulled, "g_sensitivity", "gyro", "zz", 0.1),
    (bowed, "quadratic", "accel", "x", 5.0)], ids=["asymmetry", "g_sensitivity", "quadratic"])
def test_what_the_motion_shows_has_a_name_and_its_size(added, effect, sensor, key, size):
    """Beside a robot's simulator these were room for error: no cause at all."""
    found = answered(added)
    cause, = found["causes"]
    assert (cause["effect"], cause["sensor"]) == (effect, sensor)
    assert cause["value"][key] == pytest.approx(size, rel=0.1)
    assert cause["share"] > 0.9
    assert found["verdict"] == "explained"
    gap = found["simulator"]["gap"][sensor]
    assert gap["after"] < 0.1 * gap["before"] or gap["after"] < 1.1 * gap["floor"]


@pytest.mark.long
def test_logs_of_several_sessions_tell_an_effect_together_and_once():
    found = answered(bowed, seeds=(1, 2))
    cause, = found["causes"]
    assert (cause["effect"], cause["value"]["x"]) == ("quadratic", pytest.approx(5.0, rel=0.1))
    # A square shifts the bias, and that is no sign that the simulator has turned.
    assert not found["simulator"]["conventions"]


def bent_at_the_end(force, rate):
    return force, 90.0 * np.tanh((np.abs(rate) / 90.0) ** 4) ** 0.25 * np.sign(rate)


def dead(force, rate):
    return force, rate - 2.0 * np.tanh(rate / 2.0)


def swinging(force, rate):
    return force, rate * (1.0 + 0.02 * np.sin(0.36 * np.arange(len(rate)) / RATE_HZ)[:, None])


def kinked(force, rate):
    """5 % more from 45 deg/s on: a cube closes much of it, a bent line more."""
    return force, rate + 0.05 * np.sign(rate) * np.maximum(np.abs(rate) - 45.0, 0.0)


def healthy(force, rate):
    return force, rate


@pytest.mark.long
@pytest.mark.parametrize("added", [healthy, bent_at_the_end, dead, swinging, kinked])
def test_what_has_no_name_gets_none(added):
    """A front end that levels off, a dead band and a scale that swings are like a cube, a square
    or a warm scale, and none of these."""
    causes = answered(added)["causes"]
    assert not [c for c in causes if set(c["class"]) & set(lacking_effects.OF_MOTION)]


@pytest.mark.long
def test_what_leaves_most_of_the_gap_is_not_its_name():
    """An accelerometer that is cut off at 0.9 g is a little like a cube, which closed a fifth."""
    t, force, rate = tumbled(1, 60.0)
    found = answer.as_dict(diagnose([("real", read(t, np.clip(force, -0.9, 0.9), rate, 1))],
                                    [("sim", read(t, force, rate, 101))], jobs=1))
    assert not [c for c in found["causes"] if set(c["class"]) & set(lacking_effects.OF_MOTION)]


def test_a_real_log_counts_once_whatever_is_held_against_it(monkeypatch):
    """Its noise is the same in each comparison; the simulator's log that is nearest is taken."""
    def comparison(log, against, correlation):
        fit = SimpleNamespace(log=log, hypothesis=SimpleNamespace(name="healthy"))
        return SimpleNamespace(fits={"accel": fit}, gap={"accel": (3.0, 2.0, 1.0)},
                               against=against,
                               alignment=SimpleNamespace(correlation=correlation))
    asked = []
    monkeypatch.setattr(lacking_effects, "open_without", lambda fit, noise: True)
    monkeypatch.setattr(lacking_effects, "found", lambda kind, logs, diagnosis: asked.extend(
        fit.log for fit, _ in logs) or [])
    monkeypatch.setattr(lacking_effects, "without_name", lambda *args: [])
    lacking_effects.added(SimpleNamespace(causes=(), findings=(), comparisons=(
        comparison("a", "real 1", 0.98), comparison("b", "real 1", 0.99),
        comparison("c", "real 1", 0.97), comparison("d", "real 2", 0.9))))
    assert sorted(asked) == ["b", "d"]


@pytest.mark.long
def test_an_effect_that_is_left_out_is_not_looked_for():
    t, force, rate = tumbled(1)
    found = diagnose([("real", read(t, *softened(force, rate), 1))],
                     [("sim", read(t, force, rate, 101))], without=("asymmetry",), jobs=1)
    assert "asymmetry" not in {f.effect for f in found.findings}


def test_a_share_is_that_of_what_is_beyond_the_noise():
    before, after, size = np.full(20, 5.0), np.full(20, 1.1), np.full(20, 1.0)
    share, blocks = remaining_gap.earned([(before * size, after * size, size)], [1.0])
    assert (share, blocks) == (pytest.approx(3.9 / 4.0), 20)


def test_what_one_block_alone_bears_out_earns_nothing():
    before, after = np.ones(20), np.ones(20)
    before[3] = 1000.0
    assert remaining_gap.earned([(before, after, np.ones(20))], [0.0]) == (0.0, 0)


def made(effect, is_in, monkeypatch):
    """A Diagnosis of one cause and three logs, of which is_in (bool, ...) have it as well."""
    cause = SimpleNamespace(effect=effect, theta=[2.0], chosen=None)
    design = SimpleNamespace(effect=effect, variant="", keys=("x",))
    gap = SimpleNamespace(causes=[cause], units=[SimpleNamespace(designs=[design])])
    monkeypatch.setattr(against_simulator, "columns_of", lambda form: SimpleNamespace(index=[0]))
    monkeypatch.setattr(against_simulator, "_is_in_both", lambda kind, fit, cause, diagnosis: fit)
    return SimpleNamespace(gaps={"accel": gap}, comparisons=[
        SimpleNamespace(fits={"accel": one}) for one in is_in])


def test_what_three_logs_show_in_both_is_taken_off_once(monkeypatch):
    """It was taken off once a log, so that twice as much was left with the other sign."""
    shared = against_simulator.in_both(made("box_tilt", (True, True, True), monkeypatch))
    assert shared == {"accel": [("box_tilt", "", "x", 2.0)]}


def test_what_one_of_three_logs_lacks_is_a_gap(monkeypatch):
    assert against_simulator.in_both(made("box_tilt", (True, False, True), monkeypatch)) == {}


def test_of_one_motion_the_logs_say_what_is_in_both_and_not_the_simulators_rests():
    known = {"accel": [("box_tilt", "", "Z+x", 0.2), ("hysteresis", "", "x", 3.0)],
             "gyro": [("g_sensitivity", "", "xx", 0.1)]}
    fit = SimpleNamespace(hypothesis=SimpleNamespace(name="healthy"))
    compared = [SimpleNamespace(fits={"accel": fit})]
    assert against_simulator.not_compared(known, compared) == {
        "accel": [("hysteresis", "", "x", 3.0)], "gyro": [("g_sensitivity", "", "xx", 0.1)]}
    assert against_simulator.not_compared(known, [SimpleNamespace(fits={})]) == known


def test_a_channel_that_hears_no_more_than_the_others_and_noise_is_not_constant():
    """Of a robot on wheels z is what x and y make of it by how crooked the sensor stands."""
    rng, t = np.random.default_rng(3), np.arange(4000) / 50.0
    moved = np.stack([2.0 * np.sin(0.7 * t), 3.0 * np.sin(1.6 * t), 0.0 * t], 1)
    moved[:, 2] = 0.01 * moved[:, 0] - 0.02 * moved[:, 1]
    signal, measured = (moved + 0.006 * rng.standard_normal(moved.shape) for _ in range(2))
    h = hypotheses.Hypothesis("healthy", signal, *hypotheses.none(len(t)))

    def dead(measured):
        return [not axes[2].any() for axes, _ in sensor_axes.candidates(
            h, measured, "accel", np.ones(3, bool))]
    assert not any(dead(measured))
    signal[:, 2] += 0.1 * np.sin(0.9 * t)
    assert not any(dead(measured))  # it may shake there by itself
    measured[:, 2] = 0.006 * rng.standard_normal(len(t))
    assert any(dead(measured))


def test_a_channel_of_nothing_but_noise_says_nothing_of_another_ones_gain():
    """A thing that swings about one axis: y had a gain of five in x, and was constant by it."""
    rng, t = np.random.default_rng(4), np.arange(4000) / 50.0
    noise = 0.004 * rng.standard_normal(len(t))
    signal = np.stack([np.sin(0.7 * t), noise, np.cos(0.7 * t) ** 2], 1)
    measured = signal + 0.004 * rng.standard_normal(signal.shape)
    measured[:, 1] = 0.004 * rng.standard_normal(len(t))
    measured[:, 0] += 5.0 * noise
    measured[:, 2] += 5.0 * noise
    h = hypotheses.Hypothesis("healthy", signal, *hypotheses.none(len(t)))
    assert all(axes[1].any() for axes, _ in sensor_axes.candidates(
        h, measured, "accel", np.ones(3, bool)))
