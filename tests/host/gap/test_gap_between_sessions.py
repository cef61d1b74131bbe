"""What lies between sessions: biases against each other, as one more unit of contrasts."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import (
    adequacy,
    answer,
    between_sessions,
    diagnosis,
    hypotheses,
    localisation,
    members,
    rest_model,
    turn_model,
)
from sixflip_host.experiment import attitude_fit, blocks, covariance, session_terms, terms
from sixflip_host.planning import detectable
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
    (between,) = [u for u in found.gaps["accel"].units if u.between == "bias"]
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
        seen = detectable.visible_share(found)
        assert found.verdict == ("no gap" if seen > 0.5 else "cannot tell")
        monkeypatch.setattr(detectable, "visible_share", lambda found: 0.5)
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


def stood_at(temperatures, sensor, slope, axis):
    """Sessions of one part, each at a temperature (degC) of its own; slope: %/degC of an axis of
    the sensor's scale."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 5,
                               "world": {"placement_scatter_deg": 0.05}})
    part = plan.worlds[0]
    plan.worlds[:] = [dict(part, seed=part["seed"] + 1000 * k) for k in range(len(temperatures))]
    made = []
    for k, celsius in enumerate(temperatures):
        capture = simulated_session.session(plan, k)
        raw = (celsius - capture.meta["temp_offset_c"]) * capture.meta["temp_lsb_per_c"]
        capture.temp = np.full(len(capture), round(raw), dtype=np.int16)
        counts = getattr(capture, sensor).astype(float)
        counts[:, axis] *= 1.0 + slope / 100.0 * (celsius - 25.0)
        setattr(capture, sensor, np.rint(counts).astype(np.int16))
        if sensor == "accel":
            capture.gyro = None
        made.append(blocks.session_of(str(k), capture))
    return made


@pytest.mark.long
@pytest.mark.parametrize("sensor", ["accel", "gyro"])
def test_a_scale_that_goes_with_temperature_shows_between_sessions_of_one_each(sensor):
    """Within each of these sessions the temperature stands still: the scale of each was a
    nuisance, and the answer "no gap"."""
    found = diagnosis.diagnose_sessions(stood_at((20.0, 35.0, 28.0), sensor, 0.02, 1),
                                        diagnosis.Settings())
    gap = found.gaps["accel"] if sensor == "accel" else found.turns
    assert [cause.names for _, cause in found.causes] == [["thermal_scale"]]
    cause = gap.causes[0]
    assert list(cause.value) == ["y"] and cause.value["y"] == pytest.approx(0.02, abs=0.002)
    # Each session is foretold by the two others.
    assert found.verdict == "explained" and gap.shrinkage.share > 0.9
    between = [unit for unit in gap.units if unit.between == "scale"][0]
    # 15 degC are 3 thousandths; the contrast is the difference over the root of two
    np.testing.assert_allclose(np.abs(between.z[:3]), [0.0, 3.0 / np.sqrt(2), 0.0], atol=0.6)


def test_scales_that_differ_without_a_temperature_have_no_name():
    """0.6 % of one axis from one session to the next, at one temperature."""
    made = stood_at((25.0, 25.0), "accel", 0.0, 2)
    made[1].capture.accel[:, 2] = np.rint(made[1].capture.accel[:, 2] * 1.006)
    found = diagnosis.diagnose_sessions(
        [blocks.session_of(s.name, s.capture) for s in made], diagnosis.Settings())
    assert found.verdict == "unexplained" and not found.causes
    places = localisation.places(found.gaps["accel"])
    assert (places[0].domain, places[0].axis) == ("session", "z")


def test_what_scales_change_by_in_an_ordinary_session_is_known_to_its_error():
    """Of twelve simulated pairs of sessions the contrasts are normal with the errors stated."""
    standard = []
    for seed in range(12):
        made = sessions(seed=200 + seed)
        model = rest_model.RestModel("accel", "mpu6050", diagnosis.Settings())
        nominal = [attitude_fit.fit(session) for session in made]
        units = [model.unit(*part, False) for part in zip(session_terms.agreed(made), nominal)]
        (scale,) = [u for u in model.between(units, list(zip(made, nominal)))
                    if u.between == "scale"]
        errors = covariance.dense(scale.groups, 0.0, 0.0)
        standard.append(np.linalg.solve(np.linalg.cholesky(errors), scale.z))
    # 36 standard normals: their mean square is 1 within 0.24 (one standard deviation)
    assert 0.5 < np.mean(np.square(standard)) < 1.6


def test_a_session_held_out_and_the_others_are_all_that_lies_between_them():
    generator = np.random.default_rng(3)
    constants = [between_sessions.Constants(
        generator.normal(size=3), np.diag(generator.uniform(0.1, 0.2, 3)),
        generator.normal(size=(3, 2)), True) for _ in range(4)]
    designs = [terms.Design("quadratic", "", ["x", "y"], [0, 1], np.zeros((0, 2)), np.ones(2))]
    (unit,) = between_sessions.unit("bias", "accel", constants, designs)
    own, others = between_sessions.held_out(unit, 2)
    values = np.array([c.value for c in constants])
    difference = values[2] - np.delete(values, 2, 0).mean(axis=0)
    np.testing.assert_allclose(np.abs(own.z), np.abs(difference) * np.sqrt(3.0 / 4.0))
    columns = np.array([c.columns for c in constants])
    difference = columns[2] - np.delete(columns, 2, 0).mean(axis=0)
    np.testing.assert_allclose(np.abs(own.raw(slice(None))), np.abs(difference) * np.sqrt(0.75))
    variance = np.array([np.diag(c.covariance) for c in constants])
    np.testing.assert_allclose(
        np.diag(covariance.dense(own.groups, 0.0, 0.0)),
        0.75 * variance[2] + 0.75 * np.delete(variance, 2, 0).mean(axis=0) / 3.0)
    # The others know nothing of the one held out.
    changed = [replace(c, value=c.value + 5.0) if k == 2 else c for k, c in enumerate(constants)]
    (moved,) = between_sessions.unit("bias", "accel", changed, designs)
    np.testing.assert_allclose(between_sessions.held_out(moved, 2)[1].z, others.z, atol=1e-12)
    assert np.abs(between_sessions.held_out(moved, 2)[0].z - own.z).min() > 1.0
    assert (unit.z ** 2).sum() == pytest.approx((own.z ** 2).sum() + (others.z ** 2).sum())


def test_a_change_at_switching_on_is_a_hypothesis_of_what_lies_between():
    """What it frees are the levels of this very unit."""
    constants = [between_sessions.Constants(
        np.full(3, 30.0 * k), np.eye(3), np.zeros((3, 0)), True) for k in range(2)]
    for quantity in ("bias", "scale"):
        (unit,) = between_sessions.unit(quantity, "accel", constants, [])
        levels = adequacy.levels("mpu6050", "accel")
        assert levels.prior(unit, ()).min() < -20.0
        assert not levels.prior(unit, hypotheses.FREE["session"][0]).any()


def test_scales_of_sessions_without_a_thermometer_say_nothing():
    """0.1 % apart is what ten degrees of another temperature do."""
    made = stood_at((20.0, 25.0), "accel", 0.02, 1)
    for session in made:
        session.capture.temp = None
    found = diagnosis.diagnose_sessions(
        [blocks.session_of(s.name, s.capture) for s in made], diagnosis.Settings())
    assert not found.causes and found.verdict in ("no gap", "cannot tell")
    assert not [u for u in found.gaps["accel"].units if u.between == "scale"]


def test_scales_are_known_as_well_as_said_where_half_turns_are_degrees_off():
    """About turns in which half turns of eight degrees off count as much as gravity does, what is
    linear was wrong by twice the error stated."""
    model, off = turn_model.TurnModel("gyro", "mpu6050", diagnosis.Settings()), []
    for seed in range(1, 6):
        plan = scenario.from_dict({
            "sensor": "mpu6050", "scene": "paper", "seed": seed,
            "world": {"flip_error_deg": 8.0, "placement_scatter_deg": 1.0}})
        session = blocks.session_of("s", simulated_session.session(plan, 0))
        found = turn_model.scales(model.fit([session], [attitude_fit.fit(session)]).units[0],
                                  model.usual())
        true = 1000.0 * np.linalg.norm(plan.worlds[0]["gyro_matrix"], axis=1)
        off.append((found.value - true) / np.sqrt(np.diag(found.covariance)))
    assert 0.4 < np.sqrt(np.mean(np.square(off))) < 1.2
