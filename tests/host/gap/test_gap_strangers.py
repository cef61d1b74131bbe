"""Nameless functions are those of the sensor: the same in every session."""
from types import SimpleNamespace

import numpy as np

from sixflip_host.diagnosis import hypotheses, session_strangers, strangers
from sixflip_host.experiment import blocks, way_memory
from sixflip_host.simulation import scenario, simulated_session


def session(temperature):
    """Twelve rests of a sensor in one attitude at these temperatures (12,)."""
    n = len(temperature)
    still = [np.zeros(n), np.zeros(n), np.ones(n)]
    return SimpleNamespace(
        n=n, t=np.arange(n) * 10.0, since=np.ones(n), temperature=temperature, thermal=True,
        shaken_mg=0.0, thermometer=SimpleNamespace(lagged=lambda t, lag: temperature),
        face=np.zeros(n, int), code=np.ones(n, int),
        moment=lambda up: SimpleNamespace(f=still, before=still))


def test_what_is_smooth_in_temperature_is_one_function_of_it_in_every_session():
    """A bias that levels off with temperature was none of them as soon as one session was warmer
    on average than the other: each had powers about its own mean."""
    sessions = [session(np.linspace(25.0, 33.0, 12)), session(np.linspace(40.0, 30.0, 12))]
    felt = np.concatenate([one.temperature for one in sessions])
    columns = np.vstack([next(d for d in strangers.shared(one, None, "accel", felt.mean()) if (
        d.effect, d.variant) == ("temperature", "")).columns[2::3] for one in sessions])
    constant = np.ones((len(felt), 1))
    bias = 8.0 * np.tanh((felt - 25.0) / 8.0)
    design = np.hstack([constant, columns])
    left = bias - design @ np.linalg.lstsq(design, bias, rcond=1e-9)[0]
    assert np.abs(left).max() < 0.25
    alone = np.vander(felt - felt.mean(), 4)
    assert np.allclose(design @ np.linalg.lstsq(design, alone, rcond=1e-9)[0], alone)


def test_a_turn_is_forgotten_in_its_time():
    """A quarter turn about y within a second, then rest; looked at when 20 s have passed."""
    turn = np.zeros((210, 3))
    turn[:10, 1] = 9.0
    kept = way_memory.turned(turn, np.full(210, 0.1))
    assert kept.shape == (210, len(way_memory.TURNED_S), 3) and not kept[:, :, [0, 2]].any()
    paused = way_memory.turned(turn[:12], np.array([0.1] * 10 + [19.9, 0.1]))
    assert np.allclose(paused[11], kept[209])
    assert way_memory.turned(turn[:0], np.zeros(0)).shape == (0, len(way_memory.TURNED_S), 3)
    assert way_memory.friction(turn[:0]).shape == (0, len(way_memory.FRICTION), 3)
    for tau, course in zip(way_memory.TURNED_S, kept[:, :, 1].T):
        mean = tau * (1.0 - np.exp(-1.0 / tau))  # of a turn that is forgotten on the way
        assert np.isclose(course[9], mean, rtol=0.02)
        assert np.isclose(course[209], course[9] * np.exp(-20.0 / tau), rtol=1e-9)


def test_a_session_may_have_nothing_of_what_is_its_own():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 5})
    one = blocks.session_of("", simulated_session.session(plan, 0))
    up = np.zeros((len(one.runs), 3))
    designs = session_strangers.private(one, up, "accel", np.zeros((one.n, 3)))
    silent = np.zeros(sum(len(design.keys) for design in designs), bool)
    forms = hypotheses.forms_of([SimpleNamespace(designs=designs, silent=silent, apart=False)])
    private = [form for form in forms if form.choices]
    assert {"jump", "periodic", "own_time", "drift"} <= {form.effect for form in private}
    for form in private:
        chance = np.exp(form.chances)
        assert np.array_equal(hypotheses.on_axes(form, {0}).chances, form.chances)
        nothing = np.array([not len(choice) for choice in form.choices])
        assert np.isclose(chance.sum(), 1.0)
        assert np.isclose(chance[nothing].sum(),
                          0.0 if form.effect == "drift" else hypotheses.ABSENT)
