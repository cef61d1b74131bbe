"""Codes at rest that are read far more or less often than those around them, and what is not."""
import numpy as np
import pytest

from sixflip_host.capture import registers
from sixflip_host.diagnosis import samples_judged
from sixflip_host.diagnosis.detect import codes
from sixflip_host.diagnosis.detect.detection import present
from tests.worlds.still_session import at_rest, flicker


def noisy(number, generator, sd=60.0):
    return np.rint(generator.normal(900.0, sd, number)).astype(np.int64)


def test_codes_that_are_left_out_are_told_by_those_around():
    x = noisy(40000, np.random.default_rng(6))
    assert codes.uneven_nats([x]) == 0.0
    within = x % 32
    left_out = np.where((within >= 9) & (within <= 15), x - within + 16, x)
    assert codes.uneven_nats([left_out]) > 1000.0
    changes = np.concatenate([x[:16000], 24 * np.rint(x[16000:] / 24.0).astype(np.int64)])
    assert codes.uneven_nats([changes]) > 1000.0


def test_steps_as_wide_as_the_noise_that_differ_are_told():
    """They are multiples of five counts, some of them beside 0: no step of five, no dead band."""
    generator = np.random.default_rng(8)
    edges = np.cumsum(generator.choice([10, 25, 35, 60, 110], 4000))
    edges -= edges[2000]
    rests = [edges[np.searchsorted(edges, np.rint(generator.normal(level, 65.0, 600)))]
             for level in generator.uniform(-300.0, 300.0, 20)]
    assert codes.uneven_nats([rest // 5 for rest in rests]) > 1000.0
    still = at_rest(flicker(5, 12000))
    still.capture.accel[:, 0] = np.concatenate(rests)
    judged = samples_judged.judge([still])
    assert judged.findings == ()
    assert ("accel", "x", "amplitude") in [(p.sensor, p.axis, p.domain) for p in judged.nameless]


def test_low_bits_that_are_left_out_are_told_where_each_code_is_read_a_few_times_only():
    """Twelve rests of five seconds, in noise of 46 counts: 16 readings of a code, none where the
    low four bits are 7 to 10."""
    generator = np.random.default_rng(12)
    rests = [np.rint(generator.normal(level, 46.0, 500)).astype(np.int64)
             for level in (-16400.0, 16380.0, *generator.uniform(-300.0, 300.0, 10))]
    assert codes.uneven_nats(rests) == 0.0
    low = [rest % 16 for rest in rests]
    left_out = [rest - bits + np.where((bits == 7) | (bits == 8), 6, np.where(
        (bits == 9) | (bits == 10), 11, bits)) for rest, bits in zip(rests, low)]
    assert codes.uneven_nats(left_out) > 500.0


@pytest.mark.parametrize("period, left", [(16, (15, 0)), (64, range(20, 28))])
def test_runs_of_codes_that_are_left_out_in_narrow_noise_are_told(period, left):
    """An eighth of all, in rests whose noise, of 10 counts, does not fill their period."""
    generator = np.random.default_rng(13)
    rests = [np.rint(generator.normal(level, 10.0, 1000)).astype(np.int64)
             for level in (-16400.0, 16380.0, *generator.uniform(-300.0, 300.0, 22))]
    assert codes.uneven_nats(rests) == 0.0
    read = np.array([code for code in range(-17000, 17000) if code % period not in left])
    left_out = [read[np.searchsorted(read, rest)] for rest in rests]
    assert codes.uneven_nats(left_out) > 500.0
    single = np.array([code for code in range(-17000, 17000) if code % period != 5])
    assert codes.uneven_nats([single[np.searchsorted(single, rest)] for rest in rests]) == 0.0


@pytest.mark.parametrize("step", [2.3, 4.0, 5.333, 7.6, 10.0, 13.1, 14.0, 15.9, 20.0, 22.0, 28.0])
@pytest.mark.parametrize("rows", [500, 6000])
@pytest.mark.parametrize("levels", [50.0, 300.0])
def test_other_steps_than_the_chips_are_no_matter_of_low_bits(step, rows, levels):
    for seed in range(5):
        generator = np.random.default_rng(seed)
        rests = [np.rint(np.rint(generator.normal(level, 46.0, rows) / step) * step).astype(int)
                 for level in generator.uniform(-levels, levels, 12)]
        assert codes.uneven_nats(rests) == 0.0


@pytest.mark.parametrize("step", [1.3, 2.3, 7.6])
def test_a_file_in_other_steps_than_the_chips_leaves_codes_out_evenly(step):
    generator = np.random.default_rng(9)
    rests = [np.rint(np.rint(generator.normal(level, 30.0, 6000)) * step).astype(int)
             for level in (-40.0, 0.0, 55.0)]
    assert codes.uneven_nats(rests) == 0.0


@pytest.mark.parametrize("noise", [0.55, 0.8, 1.6, 3.0, 9.0, 20.0])
def test_between_two_rests_codes_are_read_less_often_without_being_left_out(noise):
    generator = np.random.default_rng(10)
    for apart in (2.0, 3.0, 3.8, 4.5, 6.0, 8.0):
        rests = [np.rint(generator.normal(level, noise, 30000)).astype(int)
                 for level in (0.0, noise * apart)]
        assert codes.uneven_nats(rests) == 0.0


def test_steps_as_wide_as_the_noise_keep_their_name():
    generator = np.random.default_rng(11)
    still = at_rest(flicker(5, 12000))
    still.capture.accel[:, 0] = 8 * np.rint(np.concatenate([
        generator.normal(level, 4.8, 4000) for level in (40.0, 72.0, 104.0)]) / 8.0)
    judged = samples_judged.judge([still])
    assert [(f.effect, f.axes, f.value) for f in judged.findings] == [
        ("quantisation", ["x"], {"x": 8})]
    assert "amplitude" not in [place.domain for place in judged.nameless]


def test_single_codes_that_are_left_out_are_no_gap():
    """A recording of a sensor sold calibrated has them: a tenth of its samples are elsewhere."""
    x = noisy(40000, np.random.default_rng(7))
    assert codes.uneven_nats([np.where(x % 16 == 3, x + 1, x)]) == 0.0


@pytest.mark.parametrize("codes_of, step", [
    (lambda noise, command: 10 * np.rint(noise), 10), (lambda noise, command: np.rint(noise), 1),
    (lambda noise, command: 500 * command, 1)])
def test_wide_steps_of_which_a_quiet_axis_shows_few_are_steps(codes_of, step):
    """Noise of one of them is all that it reads; what is told to go at one of five rates, without
    noise, reads as few values."""
    rng = np.random.default_rng(13)
    x = codes_of(rng.normal(0.3, 1.1, 600), np.repeat(rng.integers(-2, 3, 24), 25)).astype(int)
    assert len(np.unique(x)) < 10
    counts = (x + 8200)[:, None]
    assert registers.steps(counts).tolist() == [step]
    assert present(codes.step_nats(counts, [step])[0]) == (step > 1)


@pytest.mark.parametrize("bits, missing, reads, noise", [
    (4, (3,), 2, 1.5), (8, (7,), 6, 3.0), (16, (14, 15), 13, 46.0), (8, (3,), 4, 2.0)])
def test_codes_that_a_wide_step_of_a_converter_holds_are_told_in_narrow_noise_too(
        bits, missing, reads, noise):
    """Of 18,176 rows none had 3 in the two low bits, and 2 was read twice as often: no gap."""
    generator = np.random.default_rng(21)
    rests = [np.rint(generator.normal(level, noise, 1500)).astype(np.int64)
             for level in generator.uniform(-200.0, 200.0, 24)]
    assert codes.uneven_nats(rests) == 0.0
    held = [np.where(np.isin(rest % bits, missing), rest - rest % bits + reads, rest)
            for rest in rests]
    assert codes.uneven_nats(held) > 100.0


@pytest.mark.parametrize("gain", [4.0 / 3.0, 8.0 / 7.0, 16.0 / 15.0, 1.05, 2.0])
@pytest.mark.parametrize("noise", [1.0, 2.0, 3.0])
def test_codes_that_a_gain_leaves_out_evenly_are_no_converters(gain, noise):
    generator = np.random.default_rng(22)
    rests = [np.floor(gain * np.rint(generator.normal(level, noise, 1500))).astype(np.int64)
             for level in generator.uniform(-200.0, 200.0, 24)]
    assert codes.uneven_nats(rests) == 0.0
