"""Drift: a random walk of every axis, or of one. What sways, jumps or moves them together, or
moves with the poses only, is none."""
import copy
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from sixflip_host.diagnosis import (
    answer,
    diagnosis,
    hypotheses,
    leaps,
    localisation,
    rest_model,
    session_strangers,
    wandering,
)
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session
from sixflip_sim.effects import typical

SIZE_DPS = 0.15


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 21})
    return [simulated_session.session(plan, k) for k in range(len(plan.worlds))]


def walk(generator, t, axes):
    """(n, axes) random walks with a standard deviation of SIZE_DPS over the session."""
    steps = generator.standard_normal((len(t), axes)).cumsum(axis=0)
    return SIZE_DPS * steps / np.sqrt(len(t))


def walks(generator, t):
    return walk(generator, t, 3)


def together(generator, t):
    return walk(generator, t, 1) @ np.array([[1.0, -0.8, 1.2]])


def one_axis(generator, t):
    return walk(generator, t, 1) @ np.array([[0.0, 1.0, 0.0]])


def sways(generator, t):
    phase = generator.uniform(0.0, 6.28, 3)
    return SIZE_DPS * np.sin(2.0 * np.pi * t[:, None] / 75.0 + phase)


def jumps(generator, t):
    return SIZE_DPS * (t > 0.4 * t[-1])[:, None] * np.array([[1.0, -0.7, 0.9]])


def moved(captures, course):
    """Sessions of the captures with course(generator, t) deg/s added to their gyros."""
    generator, sessions = np.random.default_rng(4), []
    for number, capture in enumerate(captures):
        one = copy.copy(capture)
        t = (capture.t_us - capture.t_us[0]) * 1e-6
        added = course(generator, t) * capture.meta["gyro_lsb_per_dps"]
        one.gyro = np.round(capture.gyro + added).astype(capture.gyro.dtype)
        sessions.append(blocks.session_of(str(number), one))
    return sessions


def diagnosed(captures, course):
    return diagnosis.diagnose_sessions(moved(captures, course), diagnosis.Settings(jobs=1))


@pytest.mark.long
def test_a_random_walk_of_each_axis_drifts(captures):
    found = diagnosed(captures, walks)
    assert found.gaps["gyro"].drift and found.verdict == "explained"
    assert not found.gaps["accel"].drift
    assert not found.causes  # nothing slow that a walk follows by chance for a while


@pytest.mark.parametrize("seed", range(3))
def test_the_walk_that_any_such_gyro_has_is_no_drift(captures, seed):
    """3e-4 deg/s per root of a second, of each axis: 0.008 deg/s in this session. It was a drift,
    or a function of time or temperature without a name."""
    own = np.random.default_rng(seed)

    def usual(_, t):
        per_sample = typical.WALK["mpu6050-gyro"] * np.sqrt(np.diff(t, prepend=t[0]))
        return (own.standard_normal((len(t), 3)) * per_sample[:, None]).cumsum(axis=0)

    gap = gyro_at_rest(moved(captures, usual))
    assert not gap.drift and not gap.posterior.best.names and gap.adequacy.ok


@pytest.mark.long
def test_a_walk_as_wide_as_no_other_effect_drifts(captures):
    """0.6 deg/s were "unexplained": what moves in steps was wider than the widest walk."""
    found = diagnosed(captures, lambda generator, t: 4.0 * walk(generator, t, 3))
    assert found.gaps["gyro"].drift and found.verdict == "explained"


@pytest.mark.long
def test_a_slope_beside_a_walk_keeps_its_name(captures):
    warmest = max(c.temp.max() for c in captures)

    remaining = list(captures)

    def slope_too(generator, t):
        capture = remaining.pop(0)
        degrees = (capture.temp - warmest) / capture.meta["temp_lsb_per_c"]
        return 0.3 * walks(generator, t) + 0.4 * degrees[:, None] * np.array([[0.0, 1.0, 0.0]])

    found = diagnosed(captures, slope_too)
    (sensor, cause), = found.causes
    assert (sensor, cause.effect) == ("gyro", "thermal_bias") and "y" in cause.letters
    low, high = cause.interval["y"]
    assert low < 0.4 < high


def test_what_something_else_explains_says_nothing_of_a_walk(captures):
    """A sine moves while the box lies still as well, and an axis that has one does not walk."""
    def course(generator, t):
        sine = np.sin(2.0 * np.pi * t[:, None] / 40.0) * np.array([[1.0, 0.0, 0.0]])
        return 3.0 * one_axis(generator, t) + 0.1 * sine

    sessions = moved(captures, course)
    gap = gyro_at_rest(sessions)
    assert gap.posterior.best.names == {"periodic", "drift"}
    for place, session in enumerate(gap.sessions):
        beside = wandering.beside_others(gap.units[place], gap.data.statistics[place],
                                         gap.posterior.best, place)
        sine = 0.1 * np.sin(2.0 * np.pi * session.t / 40.0)
        sizes = np.polyfit(sine, beside, 1)[0]
        assert sizes == pytest.approx([1.0, 0.0, 0.0], abs=0.1)
        within = [max(gap.units[place].within["drift", hypotheses.ONE_AXIS, k]
                      for k in range(axis * len(hypotheses.WALKS),
                                     (axis + 1) * len(hypotheses.WALKS))) for axis in range(3)]
        alone = wandering.within_rests(session, "gyro", 0.0, 0.05, 0.003)
        assert within[0] < 1.0 < within[1] and alone[0] > wandering.MOVES


def gyro_at_rest(sessions):
    """SensorGap of the gyro at rest alone: a third of the work."""
    return rest_model.RestModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        sessions, [attitude_fit.fit(session) for session in sessions])


def test_a_walk_of_one_axis_is_a_drift_of_that_axis(captures):
    gap = gyro_at_rest(moved(captures, one_axis))
    assert gap.drift.axes == ("y",) and not gap.unexplained
    assert gap.drift.share > 0.9


@pytest.mark.parametrize("seed", [2, 3])
def test_a_drift_of_one_axis_has_the_size_that_it_has_on_all(seed):
    """The two quiet axes halved it, and their quiet beside the loud one passed for tails."""
    found = {}
    for axes in ("y", "xyz"):
        plan = scenario.from_dict({
            "sensor": "mpu6050", "scene": "recommended", "seed": 100 + seed, "effects": [
                dict(dict.fromkeys(axes, 0.06), effect="drift", sensor="gyro", seed=seed)]})
        found[axes] = gyro_at_rest([blocks.session_of(str(k), simulated_session.session(plan, k))
                                    for k in range(2)]).drift
    assert (found["y"].axes, found["xyz"].axes) == (("y",), ())
    assert found["y"].low < found["xyz"].level < found["y"].high
    assert found["y"].high / found["y"].low > found["xyz"].high / found["xyz"].low


def test_what_moves_with_the_poses_only_is_not_called_drift(captures):
    """Up or down by a notch with every move, and still while the box lies still: what a random
    walk is from rest to rest."""
    generator, sessions = np.random.default_rng(5), []
    for number, capture in enumerate(captures):
        session = blocks.session_of(str(number), capture)
        course = np.zeros(len(capture))
        for run in session.runs[1:]:
            course[run.first:] += generator.choice([-1.0, 1.0]) * 0.05
        changed = copy.copy(capture)
        changed.gyro = np.rint(capture.gyro + course[:, None] * np.array([[0.0, 1.0, 0.0]])
                               * capture.meta["gyro_lsb_per_dps"]).astype(np.int16)
        sessions.append(blocks.session_of(str(number), changed))
    gap = gyro_at_rest(sessions)
    assert not gap.drift and gap.unexplained
    assert gap.strangers and all(form.generic for form in gap.strangers)


@pytest.mark.parametrize("course", [together, sways, jumps])
def test_what_is_no_random_walk_is_not_called_drift(course, captures):
    gap = gyro_at_rest(moved(captures, course))
    assert not gap.drift
    assert gap.unexplained
    assert any(place.domain in ("time", "frequency") for place in localisation.places(gap))


def test_what_was_looked_for_costs_what_was_looked_through(captures):
    """The numbers of the choices that cost are those of the strongest periods and steps."""
    gap = gyro_at_rest(moved(captures[:1], walks))
    designs = {d.effect: d for d in gap.units[0].designs if d.choices and d.generic}
    start = np.cumsum([0] + [len(d.keys) for d in gap.units[0].designs])
    first = {d.effect: begin for begin, d in zip(start, gap.units[0].designs)}
    # of a choice on all axes, on one, and of none
    lengths = {"periodic": {6, 2, 0}, "jump": {3, 1, 0}}
    forms = [form for form in gap.options if form.effect in lengths]
    assert {form.effect for form in forms} == set(lengths)
    for form in forms:
        fixed = len(designs[form.effect].choices) - session_strangers.STRONGEST
        last = first[form.effect] + designs[form.effect].choices[fixed][0]
        cost = [gap.units[0].within.get((form.effect, "", k), 0.0)
                for k in range(len(form.choices))]
        assert [c < 0.0 for c in cost] == [
            len(choice) > 0 and choice.index[0] >= last for choice in form.choices]
        assert {len(choice) for choice in form.choices} == lengths[form.effect]


@pytest.mark.parametrize("n", [1, 2, 3, 40])
def test_the_largest_step_is_found_on_the_axis_that_has_it(n):
    """One axis is a hundred times as noisy as the one that jumps."""
    left = np.random.default_rng(2).normal(0.0, 1.0, (n, 3)) * np.array([100.0, 0.1, 0.1])
    left[n // 2:, 2] += 5.0
    first, *others = session_strangers.highest(np.arange(n), left)
    assert first.shape == (n,) and len(others) == session_strangers.STRONGEST - 1
    if n > 2:
        assert np.flatnonzero(np.diff(first)).tolist() == [n // 2 - 1]


@pytest.mark.parametrize("part", [0.3, 0.5])
def test_a_jump_of_one_axis_is_not_called_drift(part):
    """2.5 mg along z, once in one session of two: between two rests, and in the middle of one.
    All axes had to jump together, and between rests only: a walk was the likelier."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 4})
    sessions = []
    for number in range(2):
        capture = simulated_session.session(plan, number)
        capture.gyro = None
        if number:
            after = capture.t_us - capture.t_us[0] > part * (capture.t_us[-1] - capture.t_us[0])
            capture.accel[after, 2] += round(2.5e-3 * capture.meta["accel_lsb_per_g"])
        sessions.append(blocks.session_of(str(number), capture))
    gap = rest_model.RestModel("accel", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        sessions, [attitude_fit.fit(session) for session in sessions])
    assert not gap.drift and [form.effect for form in gap.strangers] == ["jump"]
    assert [axis for axis, _ in gap.strange_axes["jump"]] == [2]


def test_a_drift_between_the_levels_tried_is_explained_and_has_its_size():
    """The levels of noise lie a factor of two apart there: what was left beside the nearest one
    was half as much again as noise, and the interval did not hold the size."""
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "recommended", "seed": 1,
        "world": {"placement_scatter_deg": 0.05}, "effects": [
            {"effect": "drift", "sensor": "accel", "x": 0.6, "y": 0.6, "z": 0.6, "seed": 1}]})
    sessions = []
    for number in range(2):
        capture = simulated_session.session(plan, number)
        capture.gyro = None
        sessions.append(blocks.session_of(str(number), capture))
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1)))
    cause, = found["causes"]
    assert found["verdict"] == "explained" and cause["effect"] == "drift"
    for low, high in cause["interval_90"].values():
        assert low < 0.6 < high


@pytest.mark.long
def test_what_leans_under_the_box_is_no_drift_of_its_accelerometer(captures):
    """A table of foam that gives way by a degree in each rest was "partly explained: drift"."""
    generator, leaning, wanders = np.random.default_rng(7), [], []
    for number, capture in enumerate(captures):
        session = blocks.session_of(str(number), capture)
        nominal, t = attitude_fit.fit(session), session.t_s
        felt, walked = np.zeros((len(t), 3)), 4.0 * generator.standard_normal((len(t), 3)).cumsum(
            axis=0) / np.sqrt(len(t))
        for run, up in zip(session.runs, nominal.up):
            axis = np.cross(up, generator.standard_normal(3))
            way = 1.0 - np.exp(-(t[run.first:run.end] - t[run.first]) / 5.0)
            felt[run.first:run.end] = 12.0 * way[:, None] * axis / np.linalg.norm(axis)
        for added, parts in ((felt, leaning), (10.0 * walked, wanders)):
            one = copy.copy(capture)
            one.accel = np.rint(capture.accel + added * 16.384).astype(np.int16)
            parts.append((blocks.session_of(str(number), one), nominal))
    assert leaps.across_gravity("accel", leaning) < 1e-9
    assert leaps.across_gravity("accel", wanders) == 1.0
    assert leaps.across_gravity("gyro", leaning) == 1.0
    # Of axes that are unlike one is upright more often than the others.
    unlike = []
    for session, nominal in wanders:
        upright = [k for k, up in enumerate(nominal.up) if abs(up[2]) > 0.9 or k % 3 == 0]
        one = copy.copy(session.capture)
        one.accel = np.rint(one.accel * [4.0, 4.0, 1.0]).astype(np.int16)
        unlike.append((session.reading(one).part(upright), nominal))
    assert leaps.across_gravity("accel", unlike) > 0.01
    found = diagnosis.diagnose_sessions([s for s, _ in leaning], diagnosis.Settings(jobs=1))
    assert found.verdict == "unexplained" and found.gaps["accel"].drift is None


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_leaps_between_the_rests_is_still_within_them(seed):
    """20 rests of 2 to 10 s, of which the telegraph leaps in two or three: too few for tails."""
    generator = np.random.default_rng(seed)
    length = generator.uniform(2.0, 10.0, 20)
    begin = np.cumsum(length + 12.0) - length
    t = np.arange(int(100 * (begin[-1] + 10.0))) / 100.0
    session = SimpleNamespace(rate=100.0, t=begin + 0.5 * length, seconds=length)
    courses = {
        "leaps": 0.6 * (np.searchsorted(np.cumsum(generator.exponential(25.0, 99)), t) % 2),
        "walk": 0.3 * generator.standard_normal(len(t)).cumsum() / np.sqrt(len(t)),
        "slow": signal.lfilter(*signal.butter(1, 0.002, fs=100.0),
                               generator.standard_normal(len(t))) * 120.0}
    noise = 0.05 * generator.standard_normal(len(t))
    p = {}
    for name, course in courses.items():
        rests = [(course + noise)[int(100 * s):int(100 * (s + long))]
                 for s, long in zip(begin, length)]
        spread = np.std([x.mean() for x in rests])
        p[name] = leaps._still(rests, session, 0.5 * spread)
    assert p["leaps"] < 1e-6 and min(p["walk"], p["slow"]) > 0.05
