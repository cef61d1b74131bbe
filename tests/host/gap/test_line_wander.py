"""What shakes a box at one frequency in one rest and at another in the next is not steady."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import line_wander, spectral_lines
from sixflip_host.experiment import blocks

REST, RESTS, RATE = 600, 12, 100.0


def session(hz, axes="z", rests=RESTS):
    """Session of rests of 6 s, each shaken at a frequency of its own, hz (rests,)."""
    rng, t = np.random.default_rng(6), np.arange(REST) / RATE
    wave = np.concatenate([np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.28)) for f in hz])
    accel = rng.normal(0.0, 40.0, (rests * REST, 3)) + [0.0, 0.0, 16384.0]
    for axis in axes:
        accel[:, "xyz".index(axis)] += 60.0 * wave
    meta = {"sensor": "other", "rate_hz": RATE, "accel_lsb_per_g": 16384.0}
    pose = np.repeat(1 + np.arange(rests) % 12, REST)
    return blocks.session_of("s", Capture(
        meta, 10_000 * np.arange(len(accel)), np.rint(accel).astype(np.int16),
        pose=pose.astype(np.int16)))


def vibration(*args, **kinds):
    found, = spectral_lines.findings([session(*args, **kinds)])
    return found


def test_one_that_moves_from_rest_to_rest_is_not_steady():
    """It was steady to six digits, by the longest rest alone."""
    hz = 30.8 + 0.1 * np.random.default_rng(1).standard_normal(RESTS)
    found = vibration(hz)
    line, = found.lines
    assert not line.steady and found.hz == {}
    assert line.hz == pytest.approx(30.8, abs=0.1)
    assert line.spread_hz == pytest.approx(hz.std(), rel=0.3)
    assert line.low < hz.min() + 0.1 and line.high > hz.max() - 0.1
    assert "at about 30.82 Hz, which moves by 0.06 Hz from rest to rest" in found.words


def test_one_that_stays_is_steady_and_known_by_all_rests():
    found = vibration([30.8123] * RESTS)
    line, = found.lines
    assert line.steady and line.low < 30.8123 < line.high and line.high - line.low < 0.01
    assert found.words.startswith("a line at 30.81")
    hz = found.words.split()[3]
    assert len(hz.split(".")[1]) == 3 and abs(float(hz) - 30.8123) < 0.006


def test_rests_that_hardly_have_it_say_nothing_of_its_frequency():
    """The longest rest, in which a line was weak, told the frequency of its noise."""
    one = session([30.8] * RESTS)
    one.capture.accel[:REST, 2] = 16384 + np.random.default_rng(2).normal(0.0, 40.0, REST)
    found, = spectral_lines.findings([one])
    assert found.hz["z"] == pytest.approx(30.8, abs=0.005)


def test_axes_that_are_shaken_by_the_same_thing_move_together():
    hz = 30.8 + 0.1 * np.random.default_rng(1).standard_normal(RESTS)
    lines = vibration(hz, axes="xz").lines
    assert [line.letter for line in lines] == ["x", "z"]
    assert not any(line.steady for line in lines)
    alone = [line_wander.replace(lines[0], steady=True, spread_hz=0.0), lines[1]]
    assert not line_wander.together(alone)[0].steady
    other = line_wander.replace(alone[0], hz=36.0, low=35.9, high=36.1)
    assert line_wander.together([other, lines[1]])[0].steady


@pytest.mark.parametrize("hz, half, words", [
    (30.299967, 0.04, "30.30"), (30.75, 0.3, "30.8"), (0.123456, 0.002, "0.123"),
    (120.0, 6.0, "120"), (12.3456, 0.0, "12.3456"), (12.3456789, 1e-7, "12.3457")])
def test_a_frequency_has_the_digits_that_its_interval_supports(hz, half, words):
    assert line_wander.digits(hz, hz - half, hz + half) == words
