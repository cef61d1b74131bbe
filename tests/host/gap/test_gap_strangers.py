"""Nameless functions are those of the sensor: the same in every session."""
from types import SimpleNamespace

import numpy as np

from sixflip_host.diagnosis import strangers


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
