"""How wide a gyro's dead band beside a simulator is at least, and how far off its scale beside it
is at most."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import dead_zone, pairing, traces
from tests.worlds.tumbled import read, tumbled

BAND_HZ = 4.0


def soft(rate, band):
    return rate - np.clip(rate, -band, band)


def bands_of(change, seconds=30.0):
    """The dead_zone.Bands of the y axis of a gyro that makes this of the rates, beside a simulator
    of the same motion on the same clock."""
    t, force, rate = tumbled(1, seconds)
    real, sim = (traces.trace_from_capture("one", read(t, force, read_as(rate), seed))
                 for read_as, seed in ((change, 1), (np.copy, 101)))
    grid = np.arange(pairing.EDGE_S, sim.seconds - pairing.EDGE_S, 1.0 / pairing.GRID_HZ)
    rates = (pairing.at_times(log, log.rate, grid, BAND_HZ) for log in (real, sim))
    fit = SimpleNamespace(unit=1.0, axes=np.eye(3), bias=np.zeros(3), delay_s=0.0)
    pair = SimpleNamespace(t=grid, rate=next(rates), sim_rate=next(rates), celsius=None,
                           band_hz=BAND_HZ)
    return dead_zone.found({"gyro": SimpleNamespace(
        fit=fit, pair=pair, hypothesis=SimpleNamespace(name="one"),
        live=np.array([False, True, False]))}, real, sim)


@pytest.mark.parametrize("band, there", [(0.03, 0), (0.04, 0), (0.08, 1), (0.12, 1)])
def test_it_is_wider_than_the_noise_of_both_at_rest(band, there):
    """deg/s, of two logs whose noise together is 0.009 in the frequencies compared: long enough
    ones would tell one of a third of that, too, which either's shaking at rest may be."""
    found = bands_of(lambda rate: soft(rate, band), 90.0)
    assert len(found) == there
    assert all(np.degrees(one.rate) == pytest.approx(band, rel=0.3) for one in found)


@pytest.mark.parametrize("scale, there", [(0.7, 0), (0.93, 1), (1.06, 1), (1.3, 0)])
def test_beside_it_the_scale_is_a_parts_own(scale, there):
    """What is less by a third at every rate is another scale, or unit, and no band says it."""
    assert len(bands_of(lambda rate: scale * soft(rate, 3.0))) == there
