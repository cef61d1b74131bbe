"""`sixflip diagnose --sim`, two logs of one hand: what an arm makes of its tremor, and how late a
gyro is in a log with holes."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.simulator import (
    alignment,
    comparison,
    hypotheses,
    pairing,
    traces,
)

RATE, G, SECONDS = 100.0, 9.80665, 60.0


class Hand:
    """Turns about all axes, with a tremor, at rest at both ends, as sums of sines: every slope of
    it is known."""

    def __init__(self, seed, tremor):
        rng = np.random.default_rng(seed)
        self.hz = np.concatenate([rng.uniform(0.2, 1.5, 8), rng.uniform(6.5, 9.0, 4)])
        self.size = rng.normal(0.0, 1.0, (12, 3)) * np.repeat([0.5, tremor], [8, 4])[:, None]
        self.phase = rng.uniform(0.0, 6.3, (12, 3))

    def rate(self, t, slope=0):
        u = np.pi * np.clip(np.minimum(t - 5.0, SECONDS - 5.0 - t), 0.0, 1.0)[:, None]
        held = 0.5 - 0.5 * np.cos(u)
        if not slope:
            return held * self.waves(t, 0)
        taken = 0.5 * np.pi * np.sin(u) * np.sign(0.5 * SECONDS - t)[:, None]
        return held * self.waves(t, 1) + taken * self.waves(t, 0)

    def waves(self, t, slope):
        w = 2.0 * np.pi * self.hz[:, None]
        return sum(s * f ** slope * np.sin(f * t[:, None] + p + 0.5 * np.pi * slope)
                   for s, f, p in zip(self.size, w, self.phase))

    def gravity(self, t):
        up, out, fine = np.array([0.0, 0.0, 1.0]), np.empty((len(t), 3)), 4
        step = (t[1] - t[0]) / fine
        for k, now in enumerate(t):
            out[k] = G * up
            for w in self.rate(now + step * (np.arange(fine) + 0.5)):
                up = up - np.cross(w, up) * step
            up /= np.linalg.norm(up)
        return out


def log(t, force, rate, seed):
    rng = np.random.default_rng(seed)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 65.5}
    accel = np.rint((force + rng.normal(0.0, 0.02, force.shape)) * 8192.0 / G)
    gyro = np.rint(65.5 * (np.degrees(rate) + rng.normal(0.0, 0.05, rate.shape)))
    return Capture(meta, np.rint(1e6 * t).astype(np.int64), accel.astype(np.int16),
                   gyro.astype(np.int16))


@pytest.mark.long
def test_an_arm_that_a_simulator_lacks_is_told_by_a_hand_that_trembles():
    """What the slope from row to row took off of it, and what scales of both gyros made of it,
    was "something that no convention here explains"."""
    hand, t, arm = Hand(1, 0.3), np.arange(0.0, SECONDS, 1.0 / RATE), np.array([0.05, 0.03, -0.04])
    turns, gravity = hand.rate(t), hand.gravity(t)
    carried = gravity + np.cross(hand.rate(t, 1), arm) + np.cross(turns, np.cross(turns, arm))
    read = turns @ (np.eye(3) + [[0.03, 0.01, 0.0], [0.0, 0.025, -0.01], [0.01, 0.0, 0.02]])
    found = comparison.compare([("real", log(t, carried, read, 1))], "sim", log(
        t, gravity, read, 2))
    lever, = found.conventions
    assert lever.name == "lever_arm_missing"
    assert list(lever.value.values()) == pytest.approx(list(100.0 * arm), abs=0.35)
    assert not [p for p in found.differs if p.sensor == "accel"]
    before, after, noise = found.gap["accel"]
    assert before > 20.0 * noise and after < 1.2 * noise


def test_what_an_arm_multiplies_has_all_of_a_tremor():
    """From row to row the slope of 5 Hz was 1.6 % too small, and of what is faster than the band
    nothing was left in the square of the rate."""
    t = np.arange(0.0, 20.0, 1.0 / RATE)
    slow, fast = (np.outer(np.sin(2.0 * np.pi * hz * t), [0.0, 0.0, 1.0]) for hz in (5.0, 15.0))
    still = np.zeros((len(t), 3)) + [0.0, 0.0, G]
    pairs = []
    for rate in (slow, fast):
        one = traces.trace_from_capture("one", log(t, still, rate, 1))
        motion = traces.Motion(np.tile(np.eye(3), (len(t), 1, 1)), still / G, rate, np.gradient(
            rate, axis=0) * RATE, 0.0 * still, 0.0 * still)
        pairs.append(pairing.paired(one, one, alignment.Alignment(
            True, 1.0, 0.0, 0.001, 0.0, 1e-6, 20.0), motion))
    turned = pairs[0].motion
    assert turned.rate_dot[:, 2].std() / turned.rate[:, 2].std() == pytest.approx(
        2.0 * np.pi * 5.0, rel=0.002)
    assert hypotheses.lever_columns(pairs[1].motion)[:, 0, 0].mean() == pytest.approx(
        -0.5, rel=0.02)


@pytest.mark.long
def test_a_delay_is_told_in_a_log_with_holes():
    """A row in a hundred was not read: the gyro's delay of 12.5 ms was 5.3 ms, and a gap of eight
    times the noise was left."""
    hand, t = Hand(2, 0.05), np.arange(0.0, SECONDS, 1.0 / RATE)
    gravity, rng = hand.gravity(t), np.random.default_rng(3)
    real = log(t, gravity, hand.rate(t - 0.0125), 1)
    keep = np.sort(np.append(rng.permutation(np.arange(1, len(t) - 1))[60:], [0, len(t) - 1]))
    held = Capture(real.meta, real.t_us[keep], real.accel[keep], real.gyro[keep])
    found = comparison.compare([("real", held)], "sim", log(t, gravity, hand.rate(t), 2))
    delay, = (p for p in found.differs if p.name == "delay")
    assert abs(delay.difference) == pytest.approx(12.5, abs=1.0)
    assert found.gap["accel"][1] < 1.5 * found.gap["accel"][2] and not found.conventions
