"""A front end that saturates before the converter does: the real log levels off within its noise,
or softly, where the simulator's goes on."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis.simulator import comparison, single_log, stopping
from tests.worlds.tumbled import read, tumbled


def cut(rate):
    return np.clip(rate, -80.0, 80.0)


def soft(rate):
    return rate / (1.0 + np.abs(rate / 80.0) ** 8) ** 0.125


def compared(change, seed=1):
    t, force, rate = tumbled(seed)
    return comparison.compare([("real", read(t, force, change(rate), seed))], "sim",
                              read(t, force, rate, 100 + seed))


@pytest.mark.long
@pytest.mark.parametrize("change", [cut, soft])
def test_where_it_stops_is_a_range_and_no_scale(change, monkeypatch):
    """It was a scale that is some percent less, and most of the gap was left."""
    found = compared(change)
    ranges = {p.axis: p.real for p in found.differs if p.name == "range"}
    assert ranges and all(level == pytest.approx(80.0, rel=0.04) for level in ranges.values())
    assert "delay" not in {p.name for p in found.differs}
    monkeypatch.setattr(stopping, "found", lambda fits: ())
    without = compared(change)
    assert scale(found) < 0.6 < 1.5 < scale(without)
    assert found.gap["gyro"][1] < 0.2 * without.gap["gyro"][1]


@pytest.mark.long
@pytest.mark.parametrize("change", [cut, soft])
def test_a_simulator_that_stops_short_has_another_range(change):
    """It was a scale of 2 % and a shaking of the real one's."""
    t, force, rate = tumbled(1)
    found = comparison.compare([("real", read(t, force, rate, 1))], "sim",
                               read(t, force, change(rate), 101))
    ranges = [p for p in found.differs if p.name == "range"]
    assert ranges and {p.sensor for p in ranges} == {"gyro"}
    for parameter in ranges:
        assert parameter.simulated == pytest.approx(80.0, rel=0.04)
        assert parameter.difference > 5.0 and parameter.set_to is None
        assert parameter.how.startswith("let it go on: the real one reads up to")
    assert scale(found) < 0.6


def scale(found):
    """Percent by which the scale of a gyro's axis differs at most."""
    return max(abs(p.difference) for p in found.parameters
               if (p.name, p.sensor) == ("scale", "gyro"))


def smoothed(rate):
    """Behind a pole of 1.2 Hz, which takes the most of the fastest of its turns."""
    course, share = np.zeros_like(rate), 1.0 - np.exp(-2.0 * np.pi * 1.2 / 100.0)
    for k in range(1, len(rate)):
        course[k] = course[k - 1] + share * (rate[k] - course[k - 1])
    return course


def weaker(rate):
    return 0.94 * rate


def shaken(rate):
    return rate + 15.0 * np.random.default_rng(5).standard_normal(rate.shape)


def curved(rate):
    return rate - 1e-6 * rate ** 3


@pytest.mark.long
@pytest.mark.parametrize("change", [np.copy, smoothed, weaker, shaken, curved])
def test_what_only_makes_less_of_its_peaks_has_no_other_range(change):
    assert not [p for p in compared(change).parameters if p.name == "range"]


def test_few_readings_beyond_say_nothing():
    real, simulated = np.sin(np.linspace(0.0, 60.0, 3000)), np.sin(np.linspace(0.0, 60.0, 3000))
    simulated[70:80] = 1.5
    assert stopping.level_of(real, simulated) is None


def test_a_motor_that_does_not_go_beyond_its_rate_is_no_stop():
    """A simulator's controller that does, for a moment, made a range of the steady rate."""
    t = np.arange(0.0, 60.0, 0.02)
    rate = np.clip(4.0 * np.sin(0.6 * t), -1.0, 1.0)
    started = np.convolve(np.abs(np.diff(rate, prepend=0.0)) > 0.0, np.ones(16), "full")[:len(t)]
    beyond = rate * (1.0 + 0.15 * (started > 0.0) * (np.abs(rate) >= 1.0))
    assert stopping.level_of(rate, beyond) is None
    assert stopping.level_of(rate, 4.0 * np.sin(0.6 * t)) == pytest.approx(1.0)


def test_a_register_that_is_full_is_a_range_and_nothing_shakes():
    """-32768 was not held for as far as 32767: half of the readings at the end were no end, and
    what their edges have of fast power was shaking that the simulator lacked."""
    t, force, rate = tumbled(1, 100.0)
    real = read(t, force, 3.7 * rate, 1)
    sim = read(t, force, 1.85 * rate, 2)
    sim.meta = {**sim.meta, "gyro_lsb_per_dps": 32.75, "gyro_range_dps": 1000}
    found = comparison.compare([("real", real)], "sim", sim)
    assert {p.name for p in found.differs} - {"noise_density"} == {"range"}
    assert all(p.real == pytest.approx(32767.5 / 65.5, rel=2e-5)  # of either side
               for p in found.differs if p.name == "range")
    assert found.gap["gyro"][1] < 2.0 * found.gap["gyro"][2]


def test_a_register_that_is_full_half_of_the_time_is_a_range_and_nothing_else():
    """Clocks were matched by what was cut off, and nothing of that was left out: a time step, or
    scales, beside the range."""
    t, force, rate = tumbled(1, 60.0)
    simulated = read(t, force, rate, 101)
    simulated.gyro = np.clip(simulated.gyro, -3930, 3930).astype(np.int16)  # 60 deg/s
    found = comparison.compare([("real", read(t, force, rate, 1))], "sim", simulated)
    assert not found.conventions and {p.name for p in found.differs} == {"range"}
    assert found.gap["gyro"][1] < 0.05  # deg/s


def test_a_steady_rate_of_another_size_is_no_range():
    """What little an axis reads of a table's rates rose with nothing but its noise: 1.4 deg/s."""
    rng, t = np.random.default_rng(1), np.arange(0.0, 60.0, 0.02)
    rate = np.clip(0.08 * np.sin(0.6 * t), -0.025, 0.025)
    real, simulated = (scale * rate + 1e-4 * rng.standard_normal(len(t)) for scale in (1.0, 1.15))
    assert stopping.level_of(real, simulated) is None


@pytest.mark.parametrize("after, left", [(3.8, ["gyro"]), (0.02, [])])
def test_a_range_accounts_for_no_more_than_it_cuts_off(after, left):
    """Hundreds of times the noise were explained by a range that cut off a third of a deg/s."""
    cut = SimpleNamespace(name="range", sensor="gyro", difference=-0.3)
    pair = SimpleNamespace(differs=[cut], parameters=[SimpleNamespace(**vars(cut), differs=True)],
                           gap={"gyro": (3.9, after, 0.011)}, wanders=frozenset({"gyro"}))
    assert comparison.Comparison.left.fget(pair) == left


def test_a_stop_beside_a_rate_that_is_held_is_one():
    """Rates that are held just below a stop were as many as a third of those at it: no stop."""
    rng, t = np.random.default_rng(3), np.arange(0.0, 140.0, 0.01)
    spin = (199.0 + 2.0 * np.sin(0.5 * t) + 0.05 * rng.standard_normal(len(t))) * (t % 70.0 < 40.0)
    assert single_log.limit(np.round(100.0 * np.clip(spin, -200.0, 200.0))) == 20000.0
    assert single_log.limit(np.round(100.0 * spin)) is None
