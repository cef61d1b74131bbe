"""One cause in another form than the library's is that cause, and nothing else."""
import itertools

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import diagnosis, discrepancy, rest_model, scored_sets
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session

EVERY = 10  # samples from which what plays is followed: it is slower than a hand


def played(readings, play=0.2):
    """(n, 3) where gears with that play to both sides are, driven by the readings (n, 3)."""
    at, found, n = np.zeros(3), [], len(readings)
    for now in readings[::EVERY]:
        at = np.minimum(np.maximum(at, now - play), now + play)
        found.append(at)
    return np.stack([np.interp(np.arange(n), np.arange(0, n, EVERY), column)
                     for column in np.transpose(found)], 1)


def recommended(world):
    """A healthy sensor's plan of sessions, for simulated_session."""
    return scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 77,
                               "world": dict(world or {}), "effects": []})


def accelerometer(added, sessions=2, world=None):
    """SensorGap of the accelerometer of so many sessions of a recommended capture, to whose
    readings added(t (n,) s, g (n, 3), generator) gives (n, 3) g."""
    plan, found = recommended(world), []
    for number in range(sessions):
        capture = simulated_session.session(plan, number)
        more = added(capture.t_us * 1e-6, capture.accel / 16384.0, np.random.default_rng(number))
        capture.accel = np.rint(capture.accel + 16384.0 * more).astype(np.int16)
        found.append(blocks.session_of(str(number), capture))
    return rest_model.RestModel("accel", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        found, [attitude_fit.fit(session) for session in found])


@pytest.mark.long
def test_a_play_along_the_whole_way_is_hysteresis_whatever_its_form():
    """A play of 0.2 g, as a gear has it, through a tanh: no form that the simulator has."""
    def added(t, g, generator):
        return 0.02 * np.tanh((played(g) - g) / 0.1)
    gap = accelerometer(added, world={"placement_scatter_deg": 0.05})
    assert gap.causes
    assert {name for cause in gap.causes for name in cause.names} <= {"hysteresis", "creep"}
    one = accelerometer(added, world={"placement_scatter_deg": 0.05}, sessions=1)
    assert one.unexplained or one.causes
    assert len(one.causes) <= 2


def relaxed(t, g, tau):
    """What follows g (n, 3) with a time constant, s."""
    found, now = np.empty_like(g), g[0]
    for k, step in enumerate(np.diff(t, prepend=t[0])):
        now = now + (g[k] - now) * (1.0 - np.exp(-step / tau))
        found[k] = now
    return found


def test_a_mount_that_creeps_with_two_time_constants_creeps():
    """The one creep of the library left a drift over."""
    def added(t, g, generator):
        left = 0.7 * (relaxed(t, g, 20.0) - g) + 0.3 * (relaxed(t, g, 90.0) - g)
        return 0.012 * left * [1.0, 1.0, 0.0]
    gap = accelerometer(added)
    assert [cause.names for cause in gap.causes] == [["creep"]] and gap.drift is None
    assert gap.causes[0].share > 0.9


@pytest.mark.long
def test_what_sticks_and_slips_in_many_places_is_hysteresis():
    """Plays of many widths, as friction has them [Prandtl-Ishlinskii], were two causes."""
    def added(t, g, generator):
        widths = (0.05, 0.15, 0.3, 0.6)
        return 0.01 * sum((played(g, width) - g) / width for width in widths) / len(widths)
    gap = accelerometer(added)
    assert [cause.names for cause in gap.causes] == [["hysteresis"]]


def test_a_form_of_its_own_has_no_more_of_what_the_poses_hardly_show():
    """On flat poses products of two axes show nothing: each had as much of the gyro's sensitivity
    to gravity as its squares had, and a stranger without them was likelier than the name."""
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "paper", "seed": 5, "world": {"tilt_deg": 0.5},
        "effects": [{"effect": "g_sensitivity", "sensor": "gyro", "xx": 0.1, "yy": 0.1,
                     "zz": 0.1}]})
    session = blocks.session_of("flat", simulated_session.session(plan, 0))
    gap = rest_model.RestModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        [session], [attitude_fit.fit(session)])
    model = scored_sets.Model(gap.units, gap.data.statistics, gap.noise)
    form, = (f for f in gap.forms if f.effect == "g_sensitivity" and f.axis is None)
    wider = discrepancy.with_discrepancy(model, gap.forms, model.scored((form,)), form)
    beside = wider.shared.prior[len(form.keys):]
    assert len(beside) == 45 and beside.max() < 30.0 * beside.min()


def slipped(readings, length):
    """(n, 3) what sticks and slips the more the longer the way is, -1 to 1 [Dahl]; what the noise
    of a rest adds up to is no way."""
    spring, at, found, n = np.zeros(3), readings[EVERY], [], len(readings)
    for k in range(0, n, EVERY):
        step = readings[max(k - EVERY, 0):k + EVERY].mean(axis=0) - at
        step[np.abs(step) < 0.03] = 0.0
        at, spring = at + step, spring + step - np.abs(step) * spring / length
        found.append(spring / length)
    return np.stack([np.interp(np.arange(n), np.arange(0, n, EVERY), column)
                     for column in np.transpose(found)], 1)


@pytest.mark.parametrize("length, sessions", [(1.0, 2), (2.0, 1)])
def test_what_slips_more_the_longer_the_way_is_is_hysteresis(length, sessions):
    """It was hysteresis with a creep beside it, and a creep of some minutes alone."""
    def added(t, g, generator):
        return 0.005 * slipped(g, length) * [1.0, 0.0, 0.0]
    gap = accelerometer(added, sessions, world={"placement_scatter_deg": 0.1})
    cause, = gap.causes
    assert "hysteresis" in cause.names and cause.letters == ["x"]
    assert cause.probabilities["hysteresis"] > 0.4
    assert not gap.unexplained


def test_a_memory_of_the_sign_alone_is_hysteresis():
    """Of leaning poses it was hysteresis, and something nameless of each rest's own beside it."""
    number = itertools.count()

    def added(t, g, generator):
        session = blocks.session_of("", simulated_session.session(plan, next(number)))
        more, before = np.zeros(len(g)), None
        for run in session.runs:
            now = g[run.first:run.end, 2].mean()
            if before is not None:
                more[run.first:run.end] = np.sign(before - now) * (abs(before - now) > 0.03)
            before = now
        return 0.01 * more[:, None] * [0.0, 0.0, 1.0]
    world = {"placement_scatter_deg": 0.05}
    plan = recommended(world)
    gap = accelerometer(added, world=world)
    assert [(cause.names, cause.letters) for cause in gap.causes] == [(["hysteresis"], ["z"])]
    assert not gap.unexplained and gap.causes[0].share > 0.9


def test_a_memory_that_is_partly_forgotten_in_each_rest_is_hysteresis():
    """Where a stranger may follow how the box lies now as well, it took up what is forgotten."""
    number = itertools.count()

    def added(t, g, generator):
        session = blocks.session_of("", simulated_session.session(plan, next(number)))
        more, before = np.zeros(len(g)), 0.0
        for run in session.runs:
            stretch = slice(run.first, run.end)
            since = t[stretch] - t[run.first]
            more[stretch] = np.tanh(1.3 * before) * (0.7 + 0.3 * np.exp(-since / 8.0))
            before = g[stretch, 0].mean()
        return 0.012 * more[:, None] * [1.0, 0.0, 0.0]
    world = {"placement_scatter_deg": 0.05}
    plan = recommended(world)
    gap = accelerometer(added, world=world)
    assert [cause.letters for cause in gap.causes] == [["x"]]
    assert set(gap.causes[0].names) <= {"hysteresis", "creep"} and gap.causes[0].share > 0.9


def test_friction_keeps_within_its_bounds_however_fast_the_box_is_turned():
    """Poses that follow each other from one sample to the next, as where the moves were left
    out."""
    up = np.repeat(np.vstack([np.eye(3), -np.eye(3)] * 2), 200, axis=0)
    session = blocks.session_of("cut", Capture(
        {"sensor": "mpu6050", "rate_hz": 10.0, "accel_lsb_per_g": 16384.0},
        100_000 * np.arange(2400), np.rint(16384.0 * up).astype(np.int16),
        pose=np.repeat(np.arange(1, 13), 200)))
    assert np.abs(session.friction).max() <= 1.0
    assert np.abs(session.friction).max(axis=(0, 2)).min() > 0.8


def shaken(rectified):
    """Readings beside a motor that is on now and then, its strength swelling by a third, and that
    shift by rectified(strength (n,)) mg on x and z."""
    def added(t, g, generator):
        on = np.searchsorted(np.cumsum(generator.uniform(20.0, 70.0, 80)), t) % 2
        strength = on * (1.0 + 0.33 * np.sin(2.0 * np.pi * t / 23.0))
        tone = 0.04 * strength * np.sin(2.0 * np.pi * 26.4 * t)
        shift = 1e-3 * rectified(strength)
        return tone[:, None] * [1.0, 1.0, 0.3] + shift[:, None] * [1.0, 0.0, -1.0]
    return added


@pytest.mark.parametrize("rectified", [
    lambda strength: 5.0 * strength ** 2, lambda strength: 6.0 * (strength > 0.0)],
    ids=["as its power", "as soon as it is on"])
def test_what_shifts_while_a_motor_is_on_is_rectified(rectified):
    """Only the vibration was named, and what it shifts had no name or that of a slow wave: a
    coefficient had to be that of the bend of a chip which feels all of the vibration."""
    gap = accelerometer(shaken(rectified))
    assert [cause.names for cause in gap.causes] == [["vibration_rectification"]]
    assert gap.causes[0].axes == (0, 2) or set(gap.causes[0].letters) == set("xz")
    assert gap.causes[0].share > 0.8


@pytest.mark.long
def test_a_motor_that_is_on_in_one_session_rectifies_there():
    """But for two poses all of that session was as loud as its own quietest rests, so that nothing
    shook."""
    sessions = iter((0.0, 1.0))

    def added(t, g, generator):
        on = next(sessions) * (t > 60.0)[:, None]
        return on * (0.03 * generator.standard_normal(g.shape) + [0.03, 0.0, -0.02])
    gap = accelerometer(added)
    assert [cause.names for cause in gap.causes] == [["vibration_rectification"]]
    assert list(gap.causes[0].letters) == ["x", "z"] and gap.causes[0].plausible


def test_a_motor_that_shifts_nothing_is_no_rectification():
    gap = accelerometer(shaken(lambda strength: 0.0 * strength))
    assert not gap.causes
