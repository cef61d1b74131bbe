"""`sixflip diagnose --sim`: whether two logs are of one motion where the size of what a gyro reads
does not tell, and what may be said where they are not."""
import numpy as np
import pytest
from scipy import signal

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, motion_match, own_consistency, traces

RATE, G = 100.0, 9.80665


def handled(seed, seconds=40.0, rest_s=4.0):
    """(rate rad/s, force m/s2) of what a hand turns about all axes, at rest at both ends."""
    rng, t = np.random.default_rng(seed), np.arange(0.0, seconds, 1.0 / RATE)
    rate = sum(rng.normal(0.0, 0.5, 3) * np.sin(2.0 * np.pi * f * t[:, None] + rng.uniform(
        0.0, 6.3, 3)) for f in rng.uniform(0.2, 2.0, 12))
    moves = np.clip(np.minimum(t - rest_s, seconds - rest_s - t), 0.0, 1.0)
    rate = rate * moves[:, None]
    up, force = np.array([0.0, 0.0, 1.0]), np.empty_like(rate)
    for k, w in enumerate(rate):
        up = up - np.cross(w, up) / RATE
        up /= np.linalg.norm(up)
        force[k] = G * up
    push = sum(rng.normal(0.0, 0.4, 3) * np.sin(2.0 * np.pi * f * t[:, None] + rng.uniform(
        0.0, 6.3, 3)) for f in rng.uniform(0.5, 4.0, 8))
    return rate, force + push * moves[:, None]


def log(rate, force, seed, gyro=True):
    """Capture of both with the noise of a chip."""
    rng = np.random.default_rng(seed)
    accel = np.rint((force + rng.normal(0.0, 0.02, force.shape)) * 8192.0 / G)
    turns = np.rint(np.degrees(rate + rng.normal(0.0, 0.001, rate.shape)) * 65.5)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    return Capture(meta, np.rint(np.arange(len(accel)) * 1e6 / RATE).astype(np.int64),
                   np.clip(accel, -32768, 32767).astype(np.int16),
                   np.clip(turns, -32768, 32767).astype(np.int16) if gyro else None)


def aligned(real, sim):
    return motion_match.aligned(*(traces.trace_from_capture(name, one) for name, one in (
        ("real", real), ("sim", sim))))


def later(values, rows):
    """values (n, 3) so many rows later."""
    return np.concatenate([np.repeat(values[:1], rows, axis=0), values[:-rows]])


@pytest.mark.long
def test_a_gyro_with_an_axis_that_strays_at_times_is_of_the_motion_it_is_of():
    """What a camera makes of a heading jumps now and then: the size of the turn was then another
    one, "different motions", and the mirrored axes of the accelerometer were never looked for."""
    rate, force = handled(1)
    rng, strays = np.random.default_rng(9), rate.copy()
    for at in rng.integers(400, len(rate) - 420, 12):
        strays[at:at + 15, 2] += rng.choice([-8.0, 8.0])
    found = comparison.compare([("real", log(later(rate, 50), later(force, 50), 1))], "sim", log(
        strays, force * [-1.0, -1.0, 1.0], 2))
    assert found.alignment.same and found.alignment.offset_s == pytest.approx(0.5, abs=0.02)
    assert [(c.name, c.value) for c in found.conventions if c.sensor == "accel"] == [
        ("accel_axes", {"x": "-x", "y": "-y", "z": "z"})]


def test_a_gyro_without_some_of_what_turns_it_is_no_other_motion_and_no_time_step():
    """A notch took the turns of a hand out of it: the forces were alike by 1.00, and the logs of
    different motions; of conventions none of which fits a wrong time step was the likeliest."""
    rate, force = handled(2)
    cut = signal.filtfilt(*signal.butter(2, [0.25, 1.2], "bandstop", fs=RATE), rate, axis=0)
    found = comparison.compare([("real", log(cut, force, 1))], "sim", log(rate, force, 2))
    assert found.alignment.same and "accel" in found.fits
    assert not [c for c in found.conventions if c.name != "unknown" or c.one_of]
    assert found.shaken == ["gyro"] or found.unexplained


def test_logs_of_two_hands_are_of_two_motions():
    found = aligned(log(*handled(3), 1), log(*handled(4), 2))
    assert not found.same and found.nats < motion_match.ONE


@pytest.mark.parametrize("seed", range(4))
def test_two_runs_of_one_schedule_about_other_axes_are_two_motions(seed):
    """They turn as fast at the same times, which are not those of a clock."""
    rng = np.random.default_rng(seed)
    t, starts = np.arange(0.0, 60.0, 1.0 / RATE), np.cumsum(rng.uniform(2.5, 5.0, 14))
    logs = []
    for run in (1, 2):
        rate = np.zeros((len(t), 3))
        for at in starts[starts < 56.0]:
            u = np.clip((t - at) / 2.0, 0.0, 1.0)
            axis = rng.normal(size=3)
            rate += np.outer(np.sin(np.pi * u) ** 2, axis / np.linalg.norm(axis))
        up, force = np.array([0.0, 0.0, 1.0]), np.empty_like(rate)
        for k, w in enumerate(rate):
            up = up - np.cross(w, up) / RATE
            force[k] = G * up / np.linalg.norm(up)
        logs.append(log(rate, force, run))
    found = motion_match.by_directions(*(traces.trace_from_capture("one", one) for one in logs))
    assert found[1] < motion_match.ONE


def test_accelerometers_of_one_body_that_lie_otherwise_are_not_said_to_have_no_gap():
    """Without a gyro nothing was compared, of one motion or not, and "no gap" was said."""
    rate, force = handled(5)
    said = diagnose([("real", log(rate, force, 1, gyro=False))],
                    [("sim", log(rate, force[:, [0, 2, 1]] * [1.0, 1.0, -1.0], 2, gyro=False))])
    assert said.comparisons[0].alignment.offset_s == pytest.approx(0.0, abs=0.05)
    assert said.verdict == "cannot tell"


@pytest.mark.long
def test_a_thing_that_is_laid_down_again_as_it_lay_has_no_gravity_along_one_axis():
    """One long move, of which rows are lost: that it lay flat before and after was gravity added
    after the rotation, or a wrong time step, with 0.99 by a constant."""
    (rate, force), (turned, pulled) = handled(6, 60.0), handled(7, 60.0)
    force[-450:] = pulled[-450:] = [0.0, 0.0, G]
    turned = np.concatenate([turned[:1500], turned[1530:3000], turned[3060:], np.zeros((90, 3))])
    logs = (traces.trace_from_capture(name, one) for name, one in (
        ("real", log(rate, force, 1)), ("sim", log(turned, pulled, 2))))
    assert own_consistency.conventions_of(*logs)[0] == []


@pytest.mark.parametrize("scatter_us, alike", [(900.0, True), (90.0, True), (0.0, False)])
def test_stamps_that_scatter_alike_in_both_logs_are_of_one_clock(scatter_us, alike):
    """Two sensors that one program read in turn were set 0.77 s apart by the course of gravity."""
    rate, force = handled(8, 20.0)
    logs = [log(rate, pulled, seed) for seed, pulled in ((1, force), (2, force[::-1]))]
    for one in logs:
        one.t_us = one.t_us + np.rint(np.random.default_rng(3).uniform(
            0.0, scatter_us, len(one.t_us))).astype(np.int64)
    assert motion_match.of_one_clock(*(
        traces.trace_from_capture("one", one) for one in logs)) == alike


def short(seed, number, times=1.0, seconds=5.0):
    """Capture of some seconds of what a hand turns, without a rest; its gyro reads so many times
    the rate."""
    rate, force = (x[300:300 + int(seconds * RATE)] for x in handled(seed, 14.0, 0.0))
    return log(times * rate, force, number)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_two_logs_of_five_seconds_of_one_motion_are_compared(seed):
    """Below eight seconds none was looked for, "of different motions (correlation of the turn
    rates 0.00)", and a gyro's scale of 1.1 was no gap."""
    compared = comparison.compare([("real", short(seed, 1))], "sim", short(seed, 2, 1.1))
    assert compared.alignment.same and abs(compared.alignment.offset_s) < 0.01
    found = {(p.sensor, p.name, p.axis): p.difference for p in compared.differs}
    assert set(found) == {("gyro", "scale", axis) for axis in "xyz"}
    assert list(found.values()) == pytest.approx([-9.09] * 3, abs=0.5)
    alike = comparison.compare([("real", short(seed, 1))], "sim", short(seed, 2))
    assert alike.alignment.same and not alike.differs and not alike.conventions


@pytest.mark.parametrize("seconds", [3.0, 5.0, 7.0])
def test_short_logs_of_other_motions_are_of_none(seconds):
    """What is slow has few independent values, which match at one of many lags by chance."""
    for seed in range(20):
        assert not aligned(short(seed, 1, seconds=seconds), short(
            seed + 50, 2, seconds=seconds)).same


def test_what_is_too_short_to_tell_is_said_to_be():
    compared = comparison.compare([("real", short(1, 1, seconds=1.5))], "sim", short(
        1, 2, seconds=1.5))
    assert not compared.alignment.same
    assert any("too short to show whether they are of one motion" in x for x in compared.remarks)
    assert not any("different motions" in x for x in compared.remarks)
