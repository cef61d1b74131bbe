"""Hands that lift the box in the same way each time, and tremble: no simulator of ours makes them.

The motion is made here, by rotations from scipy: each move carries the box up and down again in
one and the same way while it is turned over, and the hand trembles at 5 to 9 Hz on the way.
"""
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip.poses import faces
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import diagnosis
from sixflip_host.experiment import blocks

RATE, LSB_G, LSB_DPS = 100.0, 16384, 65.5
REST_S = 5.0
FACES = {"Z+": (0.0, 0.0, 0.0), "Z-": (180.0, 0.0, 0.0), "X+": (0.0, -90.0, 0.0),
         "X-": (0.0, 90.0, 0.0), "Y+": (90.0, 0.0, 0.0), "Y-": (-90.0, 0.0, 0.0)}


def least_jerk(u):
    """Way of a hand [Flash & Hogan 1985], 0 to 1."""
    return u ** 3 * (10.0 - 15.0 * u + 6.0 * u ** 2)


def course(generator, waits=False):
    """(attitudes, heights m, poses) of a session: twelve poses in random order. waits: the hand
    holds the box still before and after it turns it, now longer, now shorter, and lifts it higher
    or less."""
    poses = [(face, half) for face in generator.permutation(list(FACES)) for half in "ab"]
    attitudes, heights, labels, last = [], [], [], None
    for face, half in poses:
        turned = Rotation.from_euler("z", 180.0 * (half == "b") + generator.normal(0.0, 1.0),
                                     degrees=True) * Rotation.from_euler(
            "xyz", FACES[face], degrees=True)
        lean = generator.normal(0.0, 0.05, 2)
        turned = Rotation.from_euler("xy", lean, degrees=True) * turned
        if last is not None:
            n = int(generator.uniform(2.5, 4.0) * RATE)
            u = (np.arange(n) + 0.5) / n
            between = (last.inv() * turned).as_rotvec()
            way = last * Rotation.from_rotvec(np.outer(least_jerk(u), between))
            bump = (4.0 * u * (1.0 - u)) ** 3
            hz = generator.uniform(5.0, 9.0, 3)
            tremble = 0.3 * bump[:, None] * np.sin(2.0 * np.pi * hz * np.arange(n)[:, None] / RATE)
            attitudes.append(way * Rotation.from_euler("xyz", tremble, degrees=True))
            height = (0.004 if half == "b" else 0.07) * (generator.uniform(0.5, 1.5) if waits
                                                         else 1.0)
            heights.append(height * bump)
            labels.append(np.zeros(n))
            if waits:
                before, after = (generator.uniform(0.3, 1.8, 2) * RATE).astype(int)
                attitudes[-1] = Rotation.concatenate([last] * before + [attitudes[-1]]
                                                     + [turned] * after)
                heights[-1] = np.pad(heights[-1], (before, after))
                labels[-1] = np.pad(labels[-1], (before, after))
        n = int(REST_S * RATE)
        attitudes.append(Rotation.concatenate([turned] * n))
        heights.append(np.zeros(n))
        labels.append(np.full(n, faces.pose_code(face + half)))
        last = turned
    return Rotation.concatenate(attitudes), np.concatenate(heights), np.concatenate(labels)


def session(seed, late_s=0.0, waits=False):
    """blocks.Session of one and the same MPU6050 whose gyro is late by so many seconds."""
    generator, part = np.random.default_rng(seed), np.random.default_rng(0)
    attitude, height, labels = course(generator, waits)
    n = len(labels)
    up = np.gradient(np.gradient(height)) * RATE ** 2 / 9.80665
    force = attitude.inv().apply(np.stack([np.zeros(n), np.zeros(n), 1.0 + up], 1))
    rate = np.degrees((attitude[:-2].inv() * attitude[2:]).as_rotvec()) * 0.5 * RATE
    rate = np.vstack([rate[:1], rate, rate[-1:]])
    t = np.arange(n) / RATE
    rate = np.stack([np.interp(t - late_s, t, axis) for axis in rate.T], 1)
    accel = force @ (np.eye(3) + part.normal(0.0, 0.01, (3, 3))) + part.normal(
        0.0, 0.02, 3) + 0.001 * generator.standard_normal((n, 3))
    gyro = rate + part.normal(0.0, 1.0, 3) + 0.05 * generator.standard_normal((n, 3))
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "g": 9.80665, "accel_lsb_per_g": LSB_G,
            "gyro_lsb_per_dps": LSB_DPS}
    return blocks.session_of(str(seed), Capture(
        meta, np.rint(t * 1e6).astype(np.int64), np.rint(accel * LSB_G).astype(np.int16),
        np.rint(gyro * LSB_DPS).astype(np.int16), None, None, labels.astype(np.int16)))


def motion(late_s=0.0, waits=False, number=2):
    found = diagnosis.diagnose_sessions(
        [session(1 + k, late_s, waits) for k in range(number)], diagnosis.Settings(jobs=1))
    return [f for f in found.findings if f.domain == "motion"], [
        p for p in found.nameless if p.domain == "motion"]


def test_a_hand_that_always_lifts_in_the_same_way_is_no_gap():
    """A guard: with the hands of another generator it was a reading that follows the size of the
    rate and gravity, by a chance of 1e-160."""
    assert motion() == ([], [])


@pytest.mark.long
def test_a_hand_that_waits_now_longer_now_shorter_has_the_same_habit():
    """In shares of the time from rest to rest, the waiting included, each lift had a course of its
    own, and what goes with the rate follows the lift better: a reading that follows the size of
    the rate and gravity, in six of twenty healthy sensors of another generator."""
    assert motion(waits=True, number=7) == ([], [])


def test_a_gyro_that_is_late_by_more_than_the_tremor_s_period_has_its_delay():
    """70 ms were 10: half a period of the tremor, of which no derivative tells."""
    (found,), strange = motion(0.07)
    assert (found.effect, found.sensor, strange) == ("filter_lag", "gyro", [])
    assert abs(found.value["tau"] - 70.0) < 5.0
