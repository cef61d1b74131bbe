"""What is put back adds what the library's effects add, and says what it stands for."""
import numpy as np
import pytest

from sixflip_host.export import put_back, put_back_numpy
from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.moment import Moment

G, DEG = 9.80665, np.pi / 180.0
SHAPES = {"thermal_bias": {"reference_c": 21.0}, "thermal_scale": {"reference_c": 21.0},
          "warm_up": {"tau_s": 90.0}}
LINE_HZ = {"vibration": 31.7}
STEP_S = 0.1
EVERY = [(kind, name) for kind, names in put_back.BY_KIND.items() for name in names]


def answer(causes, effects=()):
    return {"simulator": {"parameters": {}, "conventions": [], "reference_c": 21.0,
                          "effects": list(effects)}, "causes": causes}


def cause(name, kind, value, **more):
    return {"effect": name, "class": [name], "sensor": kind, "value": value, "plausible": True,
            "shape": SHAPES.get(name, {}), **more}


def made(said):
    space = {}
    exec(put_back_numpy.text(put_back.from_diagnosis(said)), space)
    return space["ImuModel"]()


@pytest.mark.parametrize("kind,name", EVERY)
def test_a_step_adds_what_the_library_adds(kind, name):
    """Warming for long enough at a steady rate, then at one moment."""
    rng = np.random.default_rng(EVERY.index((kind, name)))
    shape = SHAPES.get(name, {})
    value = {key: float(rng.uniform(0.2, 1.0)) for key in EFFECTS[name].keys if key[1:] not in (
        "2", "3")}
    line = {"hz": dict.fromkeys("xyz", LINE_HZ[name])} if name in LINE_HZ else {}
    model = made(answer([cause(name, kind, value, **line)]))
    plain = made(answer([]))
    force, rate = rng.normal(0.0, 6.0, 3), rng.normal(0.0, 2.0, 3)
    for t in STEP_S * np.arange(1200):
        warm = 24.0 + 0.02 * t
        got, none = (one.step(force, rate, warm, STEP_S) for one in (model, plain))
    added = (got[kind == "gyro"] - none[kind == "gyro"]) / (DEG if kind == "gyro" else G / 1000.0)
    m = Moment()
    m.t, m.temperature, m.temperature_rate = t, warm, 0.02
    m.f, m.w = tuple(force / G), tuple(rate / DEG)
    wanted = [0.0, 0.0, 0.0]
    steady = {"frequency_hz": LINE_HZ[name]} if line else {}
    EFFECTS[name](kind, value, {**shape, **steady}).add(m, wanted)
    assert np.abs(wanted).max() > 1e-3
    assert added == pytest.approx(wanted, rel=1e-3)


def test_of_a_class_the_name_with_a_size_goes_in_and_the_others_are_said():
    said = answer([cause(None, "accel", {"x": 3.0}, **{
        "class": ["quadratic", "asymmetry"], "value_of": "quadratic"})])
    found = put_back.from_diagnosis(said)
    assert found.accel.effects["quadratic"].values["x"] == pytest.approx(3.0 * G / 1000.0)
    assert found.instead == ("quadratic of the accelerometer may as well be asymmetry: these logs "
                             "do not tell them apart",)
    assert found.instead[0] in put_back_numpy.text(found) and not found.left


def test_two_logs_of_one_motion_know_the_size_better():
    names = ["quadratic", "asymmetry"]
    said = answer([cause(None, "accel", {"x": 3.0}, **{"class": names, "value_of": "quadratic"})],
                  [{"effect": "asymmetry", "sensor": "accel", "class": names,
                    "value": {"x": 5.0}, "shape": {}}])
    found = put_back.from_diagnosis(said)
    assert list(found.accel.effects) == ["asymmetry"]
    assert found.accel.effects["asymmetry"].values["x"] == pytest.approx(5.0 * G / 1000.0)


@pytest.mark.parametrize("one", [
    cause("creep", "accel", {"x": 3.0}), cause("vibration", "accel", {"x": 3.0}),
    cause("warm_up", "accel", {"x": 3.0}, shape={}),
    cause("quadratic", "accel", {"x": 3.0}, plausible=False),
    cause(None, "accel", {"Z+x": 3.0}, **{"class": ["box_tilt", "quadratic"],
                                          "value_of": "box_tilt"})])
def test_what_a_step_cannot_know_is_left_and_said(one):
    found = put_back.from_diagnosis(answer([one]))
    assert not found.accel.effects and len(found.left) == 1
    assert "found, and not in here: " + found.left[0] in put_back_numpy.text(found)


def test_a_slope_is_about_the_temperature_that_it_was_taken_about():
    """The log's mean was taken: a bias beside 2 mg a degree was wrong by 2 mg for each between."""
    said = answer([cause("thermal_bias", "accel", {"x": 2.0})])
    said["simulator"]["reference_c"] = 30.0
    model = made(said)
    assert model.step(np.zeros(3), np.zeros(3), 21.0)[0] == pytest.approx(np.zeros(3))


def of_time(smooth_ms2, form="first order", delay_ms=None):
    """The answer where a gyro differs by a low-pass, and the sensors by a delay beside it."""
    gyro = {"smoothness": {"all": {"difference": smooth_ms2, "differs": True, "form": form}}}
    if delay_ms is not None:
        gyro["delay"] = {"all": {"difference": delay_ms, "differs": True}}
    said = answer([])
    said["simulator"]["parameters"] = {"gyro": gyro}
    return put_back.from_diagnosis(said)


def test_a_pole_goes_in_with_its_own_delay_and_what_is_late_beside_it():
    """8 ms: 32 ms2 are half of its square."""
    one = of_time(32.0)
    assert one.gyro.lag_s == pytest.approx(0.008)
    assert one.gyro.delay_s == 0.0 and one.accel.delay_s == 0.0 and one.left == ()
    assert of_time(32.0, delay_ms=5.0).gyro.delay_s == pytest.approx(0.005)
    assert of_time(32.0, delay_ms=-5.0).accel.delay_s == pytest.approx(0.005)


@pytest.mark.parametrize("smooth_ms2, form, late_s", [
    (32.0, "second order (Butterworth)", 0.008 * np.sqrt(2.0)), (6.0, "mean", 0.006),
    (-32.0, "first order", -0.008)])
def test_of_a_low_pass_that_does_not_go_in_the_delay_does(smooth_ms2, form, late_s):
    """A mean of 12 ms is late by half of it, and bends as much as a 24th of its square."""
    one = of_time(smooth_ms2, form)
    assert one.gyro.lag_s == 0.0
    assert one.gyro.delay_s - one.accel.delay_s == pytest.approx(late_s)
    said, = one.left
    assert said.endswith("(gyro)") and ("mean" in said or form in said)
