"""The class of a cause: likelier the larger it is, the same for other forms than the library's,
and found beside a second cause, one in the registers too."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from sixflip_host.diagnosis import answer, diagnosis, discrepancy, scored_sets
from sixflip_host.experiment import blocks, linear_model
from sixflip_host.simulation import scenario, simulated_session

LSB_G = 16384.0


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 33,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0}})
    found = [simulated_session.session(plan, k) for k in range(2)]
    for capture in found:  # the accelerometer alone: half the work
        capture.gyro = None
    return found


def causes(captures, change):
    """[cause] of the answer on captures with change(t, warm, g) mg added, (n, 3): t s, warm degC
    above the first session's start, g (n, 3) what is read."""
    kept = [c.accel for c in captures]
    start = captures[0].temp[0] / captures[0].meta["temp_lsb_per_c"]
    try:
        for capture in captures:
            t = (capture.t_us - capture.t_us[0]) * 1e-6
            warm = capture.temp / capture.meta["temp_lsb_per_c"] - start
            mg = change(t, warm, capture.accel / LSB_G)
            capture.accel = np.rint(capture.accel + mg * LSB_G / 1000.0).astype(np.int16)
        sessions = [blocks.session_of(str(k), c) for k, c in enumerate(captures)]
        found = diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1))
        return answer.as_dict(found)["causes"]
    finally:
        for capture, accel in zip(captures, kept):
            capture.accel = accel


def on_z(values):
    return values[:, None] * np.array([0.0, 0.0, 1.0])


@pytest.mark.long
def test_the_right_class_gains_with_the_size(captures):
    scores = []
    for times in (0.3, 1.0, 3.0):
        cause, = causes(captures, lambda t, warm, g, k=times: on_z(0.9 * k * warm))
        assert "thermal_bias" in cause["class"] and cause["axes"] == ["z"]
        assert cause["probability"] > 0.8
        assert set(cause["class_probabilities"]) == set(cause["class"])
        scores.append(cause["score_nats"])
    assert scores == sorted(scores) and scores[2] > 3.0 * scores[0]


@pytest.mark.long
@pytest.mark.parametrize("change", [
    lambda t, warm, g: on_z(9.0 * np.tanh(0.15 * warm)),
    lambda t, warm, g: on_z(8.0 * g[:, 2] ** 2 + 4.0 * (t > 300.0))],
    ids=["slope", "bend and step"])
def test_levels_of_noise_that_are_far_behind_change_no_answer(captures, change, monkeypatch):
    """A large cause passes for noise until it is found: the levels that it leads to are tried."""
    short = causes(captures, change)
    assert short
    monkeypatch.setattr(linear_model, "HOPELESS", np.inf)
    assert causes(captures, change) == short


def late(t, warm):
    """A temperature behind a package of two masses, of 8 and 15 s."""
    for lag_s in (8.0, 15.0):
        share = np.median(np.diff(t)) / lag_s
        warm = signal.lfilter([share], [1.0, share - 1.0], warm - warm[0]) + warm[0]
    return warm


# Beside it in the class: what has the same variable, and the box that spans all even functions.
BESIDE = {"thermal_bias": (), "thermal_rate": (), "thermal_scale": (), "cubic": (),
          "quadratic": ("asymmetry", "cross_quadratic", "cubic", "box_tilt")}
FORMS = {"levels off": ("thermal_bias", lambda t, warm, g: on_z(8.0 * np.tanh(0.15 * warm))),
         "rate levels off": ("thermal_rate", lambda t, warm, g: on_z(
             6.0 * np.tanh(200.0 * np.gradient(late(t, warm), t)))),
         "levels off late": ("thermal_bias", lambda t, warm, g: on_z(
             12.0 * np.tanh(0.3 * (late(t, warm) - 4.0)))),
         "scale bends late": ("thermal_scale", lambda t, warm, g: on_z(
             g[:, 2] * (1.0 * late(t, warm) + 0.05 * late(t, warm) ** 2))),
         "seventh power": ("cubic", lambda t, warm, g: on_z(20.0 * g[:, 2] ** 7)),
         "square": ("quadratic", lambda t, warm, g: on_z(10.0 * g[:, 2] ** 2)),
         "fourth power": ("quadratic", lambda t, warm, g: on_z(10.0 * g[:, 2] ** 4)),
         "eighth power": ("quadratic", lambda t, warm, g: on_z(10.0 * g[:, 2] ** 8)),
         "square and size": ("quadratic", lambda t, warm, g: on_z(
             6.0 * g[:, 2] ** 2 + 6.0 * np.abs(g[:, 2])))}


@pytest.mark.long
@pytest.mark.parametrize("form", FORMS)
def test_a_cause_of_another_form_than_the_library_s_ends_in_its_class(captures, form):
    """With discrepancy.with_discrepancy returning None the bias that levels off with temperature
    and the seventh power are not found at all. Without the bends among the discrepancies the
    seventh power is three causes, the fourth a product of two axes. Poses turned by what the
    nominal sensor took of it make the square one of Y; with the share of one member of its class
    alone the eighth power has none. Without a form of it that levels off what goes with the
    temperature's rate has a drift beside it."""
    effect, change = FORMS[form]
    cause, = causes(captures, change)
    assert effect in cause["class"] and cause["axes"] == ["z"]
    assert set(cause["class"]) <= {effect, *BESIDE[effect]}
    # Of a rate that levels off the forms of its effect leave an eighth.
    assert cause["share"] > (0.85 if form == "rate levels off" else 0.95)


def test_a_stranger_is_held_against_every_name_of_its_variable():
    """A bias that levels off behind a slow package was a stranger of temperature: without its
    discrepancy no bias in proportion came near, and so none was tried with it."""
    def form(effect, axis, generic=False, shared=(0,)):
        return SimpleNamespace(effect=effect, axis=axis, generic=generic, shared=shared)
    forms = [form("thermal_bias", 1), form("thermal_bias", 1), form("thermal_bias", 2),
             form("thermal_rate", 1), form("cubic", 1), form("drift", 1, shared=()),
             form("temperature", 1, generic=True)]
    stranger = forms[-1]
    assert discrepancy.names_of(forms, stranger) == [forms[0], forms[3]]
    assert discrepancy.names_of(forms, form("orientation", 1, generic=True)) == [forms[4]]
    assert discrepancy.names_of(forms, forms[0]) == []


def test_a_pair_of_which_one_is_in_the_registers(captures):
    coarse = 16

    def both(t, warm, g):
        mg = on_z(1.8 * warm)
        counts = coarse * np.rint((g * LSB_G + mg * LSB_G / 1000.0) / coarse)
        return (counts - g * LSB_G) * 1000.0 / LSB_G
    found = causes(captures, both)
    assert {c["effect"] for c in found if c["effect"]} >= {"quantisation"}
    assert any("thermal_bias" in c["class"] for c in found) and len(found) == 2
    assert all(0.9 < c["share"] <= 1.0 for c in found)


@pytest.mark.long
def test_what_a_part_remembers_from_before_its_first_pose_may_be_anything(captures):
    """Nobody saw the box come to its first pose: a reading that remembered nothing there was a
    step in time and something of history."""
    each = iter(captures)

    def remembered(t, warm, g):
        session = blocks.session_of("s", next(each))
        before, added = np.zeros(3), np.zeros((len(t), 3))
        ends = [run.first for run in session.runs[1:]] + [len(t)]
        for run, end in zip(session.runs, ends):
            added[run.first:end] = [10.0, -14.0, 18.0] * np.tanh(1.6 * before)
            before = g[run.first:run.end].mean(axis=0)
        return added
    cause, = causes(captures, remembered)
    assert "hysteresis" in cause["class"] and set(cause["class"]) <= {"hysteresis", "creep"}
    assert cause["axes"] == ["x", "y", "z"] and cause["share"] > 0.98
    assert cause["value"]["y"] == pytest.approx(-14.0 * np.tanh(1.6), rel=0.15)


@pytest.mark.long
def test_a_session_that_started_warmer_warms_up_by_less(captures):
    """Of two time constants, and by another amount in each session, it was a course in time."""
    times = iter((1.0, 0.7))

    def warms(t, warm, g):
        return on_z(40.0 * next(times) * (0.65 * np.exp(-t / 55.0) + 0.35 * np.exp(-t / 190.0)))
    cause, = causes(captures, warms)
    assert cause["class"] == ["warm_up"] and cause["axes"] == ["z"] and cause["share"] > 0.97
    assert cause["value"]["z"] == pytest.approx(34.0, rel=0.25)


@pytest.mark.long
def test_a_matrix_that_levels_off_is_still_g_sensitivity():
    """Of another generator's board a stranger of orientation stood beside it, and four other names
    were in its class: products of two axes, which few poses show, were expected to be ten times as
    large as the squares."""
    matrix = 0.01 * np.array([[27.0, -9.0, 4.0], [9.0, 18.0, -31.0], [-18.0, 41.0, 13.0]])
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 34})
    sessions = []
    for k in range(2):
        capture = simulated_session.session(plan, k)
        dps = np.tanh(1.1 * capture.accel / LSB_G) @ matrix.T
        capture.gyro = np.rint(capture.gyro + dps * capture.meta["gyro_lsb_per_dps"]).astype(
            np.int16)
        sessions.append(blocks.session_of(str(k), capture))
    found = diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1))
    assert found.gaps["gyro"].strangers == []
    cause, = (cause for cause in answer.as_dict(found)["causes"] if cause["sensor"] == "gyro")
    assert cause["class"] == ["g_sensitivity"] and cause["share"] > 0.99
    gap = found.gaps["gyro"]
    model = scored_sets.Model(gap.units, gap.data.statistics, gap.noise)
    plain = next(f for f in gap.forms if f.effect == "g_sensitivity" and f.axis is None)
    wider = discrepancy.with_discrepancy(model, gap.forms, model.scored((plain,)), plain)
    beside = np.array(wider.powers) == discrepancy.BESIDE
    for axis in range(3):
        sizes = wider.prior[beside & (np.array(wider.axes) == axis)]
        assert len(sizes) > 10 and sizes.max() < 1.5 * sizes.min()


def test_a_scale_that_bends_with_temperature_has_no_hysteresis_beside_it():
    """Of three axes, with a square half as large as the slope; its discrepancy had no square."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "thermal", "seed": 4,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0}})
    found = [simulated_session.session(plan, k) for k in range(len(plan.worlds))]
    for capture in found:
        capture.gyro = None

    def bends(t, warm, g):
        warm = late(t, warm)[:, None]
        return g * [0.6, 0.8, -0.5] * (warm + 0.06 * warm ** 2)
    cause, = causes(found, bends)
    assert cause["class"] == ["thermal_scale"] and cause["axes"] == ["x", "y", "z"]
