"""What lies between sessions: biases against each other, as one more unit of contrasts."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import answer, detectability, diagnosis, localisation, members
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def sessions(effects=(), change=((0, 0, 0), (0, 0, 0)), seed=61):
    """Sessions of a recommended scene; change: counts added to each session's accelerometer."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": seed,
                               "world": {"placement_scatter_deg": 0.05},
                               "effects": list(effects)})
    captures = [simulated_session.session(plan, k) for k in range(2)]
    for capture, counts in zip(captures, change):
        capture.accel = (capture.accel + np.array(counts)).astype(np.int16)
        capture.gyro = None     # the accelerometer alone: half the work
    return [blocks.session_of(str(k), c) for k, c in enumerate(captures)]


def test_a_bias_that_differs_from_session_to_session_is_found_there():
    found = diagnosis.diagnose_sessions(sessions(change=((0, 0, 0), (0, 1000, 0))),
                                               diagnosis.Settings())
    between = found.gaps["accel"].units[-1]
    assert between.between
    # 1000 counts are 61 mg; the contrast is the difference over the root of two
    changed = between.z
    np.testing.assert_allclose(np.abs(changed), [0, 61.0 / np.sqrt(2), 0], atol=1.5)
    assert found.verdict == "unexplained"
    assert not found.causes
    places = localisation.places(found.gaps["accel"])
    assert (places[0].domain, places[0].axis) == ("session", "y")


@pytest.mark.parametrize("strain_mg", [0.0, 2.0])
def test_what_the_two_poses_of_a_face_read_differently_is_no_misalignment(strain_mg, monkeypatch):
    """On a table that leans by 0.7 degrees a misalignment of 9 degrees would do the same: a strain
    of its own in each of twelve poses, 2 mg, was "no gap"."""
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "paper", "seed": 14,
        "world": {"placement_scatter_deg": 0.05, "tilt_deg": 0.7}})
    capture = simulated_session.session(plan, 0)
    strain = strain_mg / 1000.0 * 16384 * np.random.default_rng(15).standard_normal((13, 3))
    strain[0] = 0.0
    capture.accel = np.rint(capture.accel + strain[capture.pose]).astype(np.int16)
    capture.gyro = None
    found = diagnosis.diagnose_sessions([blocks.session_of("s", capture)], diagnosis.Settings())
    assert not found.causes
    if not strain_mg:
        seen = detectability.visible_share(found)
        assert found.verdict == ("no gap" if seen > 0.5 else "cannot tell")
        monkeypatch.setattr(detectability, "visible_share", lambda found: 0.5)
        assert not found.sees()  # half of the effects are not most of them
        return
    assert found.verdict == "unexplained"
    assert "flip" in {place.domain for place in localisation.places(found.gaps["accel"])[:3]}


def test_an_ordinary_change_is_no_gap():
    found = diagnosis.diagnose_sessions(sessions(change=((0, 0, 0), (20, -20, 20))),
                                               diagnosis.Settings())
    assert found.verdict == "no gap"
    assert not answer.as_dict(found)["where"]


def test_products_of_the_other_axes_leave_the_axis_open():
    """Where only the length of gravity is known x: f_y f_z and y: f_x f_z add the same."""
    found = diagnosis.diagnose_sessions(
        sessions([{"effect": "cross_quadratic", "sensor": "accel", "xyz": 4.0}]),
        diagnosis.Settings())
    said = answer.as_dict(found)
    cause, = said["causes"]
    assert "cross_quadratic" in cause["class"]
    assert cause["axes"] == []
    low, high = cause["interval_90"][max(cause["value"], key=lambda k: abs(cause["value"][k]))]
    assert low < 1e-9 and high > -1e-9  # to rounding
    assert ("on which axes the accelerometer has %s these captures do not tell" % " or ".join(
        cause["class"])) in said["remarks"]


def test_an_axis_that_another_name_of_the_class_denies_is_not_told(monkeypatch):
    """Along gravity, x: f_x f_x is a scale of x less y: f_x f_y and z: f_x f_z. A name that tells
    no axis denies none."""
    needed = {"cross_quadratic": {1, 2}, "quadratic": {0}, "asymmetry": {1}, "creep": set()}
    monkeypatch.setattr(members, "_without", lambda *found: None)
    monkeypatch.setattr(members, "_needed_axes", lambda model, forms, found, others, alike:
                        needed[alike[0].effect])
    forms = [SimpleNamespace(effect=name, axes=(0, 1, 2), choices=()) for name in needed]

    def told(*others):
        cause = SimpleNamespace(chosen=forms[:1], members=others)
        return members._told_axes(None, forms, None, cause)
    assert told() == told("creep") == {1, 2}
    assert told("asymmetry") == {1}
    assert told("quadratic") == set()


def test_a_square_along_x_is_on_no_other_axis():
    found = diagnosis.diagnose_sessions(
        sessions([{"effect": "quadratic", "sensor": "accel", "x": 4.0}]), diagnosis.Settings())
    cause, = answer.as_dict(found)["causes"]
    assert {"quadratic", "cross_quadratic"} <= set(cause["class"])
    assert cause["axes"] in ([], ["x"])
