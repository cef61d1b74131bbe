"""What shakes the real sensor at rest, and the simulator's as much: no gap, whatever the rate of
either and whatever each log by itself makes of it."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis import localisation
from sixflip_host.diagnosis.detect import line_frequency, shake_detector, spectral_lines
from sixflip_host.diagnosis.simulator import against_simulator, shaken_alike
from sixflip_host.experiment import blocks
from tests.worlds.tumbled import META

SECONDS, FINE_HZ = 120.0, 400.0


def trembling(seed, size, hz=9.5, wide=2.5):
    """(n, 3) rates, deg/s, at 400 Hz, of noise behind a resonance: root mean square size (3,)."""
    rng = np.random.default_rng(seed)
    pole = np.exp(-np.pi * wide / FINE_HZ)
    course = lfilter([1.0], [1.0, -2.0 * pole * np.cos(2.0 * np.pi * hz / FINE_HZ), pole ** 2],
                     rng.standard_normal((int(SECONDS * FINE_HZ), 3)), axis=0)
    return course / course.std(axis=0) * size


def session(shaking, rate_hz, seed, noise=0.05):
    """Session of a box that lies on a table all the time but for a turn each ten seconds."""
    rng = np.random.default_rng(seed)
    rate = shaking[::int(FINE_HZ / rate_hz)].copy()
    t = np.arange(len(rate)) / rate_hz
    rate += 60.0 * ((t % 10.0) > 8.5)[:, None] * np.sin(2.0 * np.pi * (t % 10.0 - 8.5) / 1.5)[
        :, None]
    rate += noise * np.sqrt(rate_hz / 100.0) * rng.standard_normal(rate.shape)
    force = np.array([0.0, 0.0, 8192.0]) + 30.0 * rng.standard_normal(rate.shape)
    capture = Capture(dict(META, rate_hz=rate_hz), np.rint(1e6 * t).astype(np.int64),
                      np.rint(force).astype(np.int16), np.rint(65.5 * rate).astype(np.int16))
    return [blocks.session_of("one", capture)]


@pytest.mark.parametrize("rates", [(50.0, 100.0), (100.0, 50.0), (100.0, 200.0)])
@pytest.mark.parametrize("shaken", [{"x": None}, {"y": 9.7, "z": 10.6}, {"x": 9.0, "z": None}])
def test_a_hand_that_trembles_in_both_is_no_gap(rates, shaken):
    """At 50 rows a second it had half the size that it had at 100, and was on two axes."""
    real = session(trembling(1, (1.0, 0.9, 1.1)), rates[0], 1)
    simulated = session(trembling(2, (1.0, 0.9, 1.1)), rates[1], 2, noise=0.15)
    assert shaken_alike.alike(real, simulated, "gyro", shaken)


@pytest.mark.parametrize("size, hz", [((0.0, 0.0, 0.0), 9.5), ((1.0, 0.0, 0.0), 9.5), (
    (0.4, 0.4, 0.4), 9.5), ((2.5, 2.5, 2.5), 9.5), ((1.0, 1.0, 1.0), 17.0)])
def test_what_the_simulator_lacks_or_has_otherwise_is_one(size, hz):
    real = session(trembling(1, 1.0), 50.0, 1)
    simulated = session(trembling(2, size, hz) if any(size) else np.zeros(
        (int(SECONDS * FINE_HZ), 3)), 100.0, 2)
    assert not shaken_alike.alike(real, simulated, "gyro", {"x": 9.5, "y": 9.5})


def test_a_power_is_the_same_by_any_rate():
    course = trembling(1, (1.0, 0.5, 2.0))
    for rate_hz in (50.0, 100.0, 200.0):
        own = shaken_alike.spectra(session(course, rate_hz, 1), "gyro")
        for axis, size in enumerate((1.0, 0.5, 2.0)):
            power, sigma, _ = own.within(axis, 3.0, 17.0)
            assert np.sqrt(power) == pytest.approx(size, rel=0.1) and sigma < 0.2 * power


def test_without_a_rest_in_one_of_them_nothing_is_alike():
    real = session(trembling(1, 1.0), 50.0, 1)
    moving = [replace(session(trembling(1, 1.0), 50.0, 1)[0], runs=[])]
    assert not shaken_alike.alike(real, moving, "gyro", {"x": None})
    assert not shaken_alike.alike(real, real, "gyro", {})


def test_neither_a_vibration_nor_a_tone_without_a_name_is_new_that_both_logs_have():
    """The y and z axes had one, the x axis a tone that wanders, and so had the simulator's."""
    real = session(trembling(1, 1.0), 50.0, 1)
    lines = [SimpleNamespace(letter=axis, hz=9.5) for axis in "yz"]
    finding = SimpleNamespace(effect="vibration", sensor="gyro", value={"y": 0.43, "z": 0.53},
                              interval={"y": (0.37, 0.49), "z": (0.4, 0.66)}, lines=lines)
    own = SimpleNamespace(effect="vibration", sensor="gyro", lines=(), interval=None,
                          value=dict.fromkeys("xyz", 1.0))
    tone = localisation.Place("gyro", "x", "frequency", 1.0, 1e-9)
    for size, both in ((1.0, True), (0.3, False)):
        simulated = session(trembling(2, size), 100.0, 2)
        simulator = against_simulator.Simulator(
            SimpleNamespace(findings=[own], sessions=simulated), {}, ())
        assert simulator.new(finding, real) is not both
        assert simulator.has_tone(real, tone) is both
        assert not simulator.has_tone(real, replace(tone, domain="noise"))


def vibration(**sizes):
    """Finding of a gyro that is shaken at 9.5 Hz, but along x at 17 Hz."""
    lines = [line_frequency.Line("xyz".index(axis), 17.0 if axis == "x" else 9.5, 0.25, 40.0, size,
                                 0.05) for axis, size in sizes.items()]
    return spectral_lines.told(lines, "gyro", 100.0)


def test_of_two_lines_the_one_that_both_logs_have_is_no_gap():
    """A motor of the real one alone was told, and the sway of the ground on which both lay."""
    real = session(trembling(1, (0.0, 1.0, 0.0)) + trembling(3, (1.0, 0.0, 0.0), 17.0), 100.0, 1)
    simulator = against_simulator.Simulator(SimpleNamespace(
        findings=[vibration(y=1.0)], sessions=session(trembling(2, (0.0, 1.0, 0.0)), 100.0, 2)),
        {}, ())
    found = vibration(x=1.4, y=1.4)
    assert simulator.new(found, real)
    assert simulator.lacks(found, real).axes == ["x"]
    assert simulator.lacks(vibration(x=1.4), real).axes == ["x"]


@pytest.mark.parametrize("size, alone", [(1.0, False), (0.2, True)])
def test_what_the_real_one_is_shaken_by_as_much_is_not_the_simulator_s_alone(size, alone):
    """"The simulator has vibration, the real sensor does not": 2.02 mg, and 2.05."""
    own = vibration(y=1.0)
    simulator = against_simulator.Simulator(SimpleNamespace(
        findings=[own], sessions=session(trembling(2, (0.0, 1.0, 0.0)), 100.0, 2)), {}, ())
    real = session(trembling(1, (0.0, size, 0.0)), 100.0, 1)
    assert simulator.only_simulated([], real) == [own] * alone


@pytest.mark.parametrize("size, both", [(1.0, True), (0.15, False), (0.0, False)])
def test_what_comes_and_goes_in_two_rests_is_in_both_logs(size, both):
    """Its power differs from stretch to stretch by as much as its mean: of six of them it was not
    told from none, though it was thirty times the noise."""
    told = []
    for seed in range(8):
        real, simulated = (session(trembling(seed, own, wide=0.2)[int(20 * FINE_HZ):int(
            34 * FINE_HZ)], 100.0, k) for k, own in enumerate((1.0, max(size, 1e-9))))
        told.append(shaken_alike.alike(real, simulated, "gyro", {"y": 9.5}))
    assert np.mean(told) >= 0.75 if both else not any(told)


def ridden(rate_hz, mg, noise_mg, seed, band_hz=(15.0, 24.0)):
    """Session of what moves all the time, shaken along y and z by mg (root mean square) but for
    three seconds in twenty."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, 40.0, 1.0 / rate_hz)
    rolls = (t % 20.0 < 17.0)[:, None] * (0.6 + 0.4 * np.sin(0.7 * t))[:, None]
    shaking = lfilter(*butter(2, band_hz, "band", fs=rate_hz),
                      rng.standard_normal((len(t), 3)), axis=0)
    force = np.array([0.0, 0.0, 1000.0]) + 200.0 * np.sin(2.0 * t)[:, None] + rolls * shaking * (
        mg / shaking.std(axis=0)) * [0.0, 1.0, 1.0] + noise_mg * rng.standard_normal((len(t), 3))
    gyro = 20.0 * np.sin(2.0 * t)[:, None] + 0.05 * rng.standard_normal((len(t), 3))
    capture = Capture(dict(META, rate_hz=rate_hz), np.rint(1e6 * t).astype(np.int64), np.rint(
        8.192 * force).astype(np.int16), np.rint(65.5 * gyro).astype(np.int16))
    return [replace(blocks.session_of("one", capture), runs=[])]


@pytest.mark.parametrize("rate_hz", [54.0, 54.5, 100.0])
@pytest.mark.parametrize("mg, noise_mg, both", [
    (30.0, 9.0, True), (30.0, 3.0, True), (0.0, 3.0, False), (0.0, 30.0, False),
    (8.0, 3.0, False)])
def test_what_shakes_both_on_the_way_is_no_gap_under_any_noise(rate_hz, mg, noise_mg, both):
    """A simulator that was the real log and white noise has no quiet second to be shaken beside,
    and "lacked" a vibration of 31 mg that it had."""
    real, simulated = ridden(54.0, 30.0, 1.0, 1), ridden(rate_hz, mg, noise_mg, 2)
    finding, = shake_detector.shaken(real)
    assert finding.axes == ["y", "z"]
    simulator = against_simulator.Simulator(SimpleNamespace(
        findings=shake_detector.shaken(simulated), sessions=simulated), {}, ())
    assert simulator.new(finding, real) is not both
    simulator = against_simulator.Simulator(SimpleNamespace(
        findings=[finding], sessions=real), {}, ())
    assert bool(simulator.only_simulated([], simulated)) is not both


@pytest.mark.parametrize("highest_hz, both", [(55.0, True), (24.0, False)])
def test_what_shakes_the_real_one_an_octave_higher_as_well_is_a_gap(highest_hz, both):
    """A simulator that stops at 25 Hz has three quarters of the power of a real one that does not,
    which is no more than it scatters by."""
    real = ridden(200.0, 30.0, 1.0, 1, (15.0, 55.0))
    simulated = ridden(200.0, 27.0, 1.0, 2, (15.0, highest_hz))
    assert shaken_alike.on_the_way(real, simulated, "yz") is both
