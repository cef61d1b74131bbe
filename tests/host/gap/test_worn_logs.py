"""What is worn on a head: quick turns between short rests that never lean far, 18 cm from where
the neck turns. Its rests leave the accelerometer's scale and bias half known, and its turns pull
by 1 g. None of that is an effect without a name."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.signal import butter, lfilter
from scipy.spatial.transform import Rotation

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.detect import noise_bursts
from sixflip_host.diagnosis.diagnose import diagnose

INSIDE_HZ, RATE_HZ, G = 1000, 100, 9.80665
ARM_M = (0.12, 0.0, 0.14)


def worn(seed, seconds=300.0):
    """(specific force m/s2, rate rad/s) of a head, at INSIDE_HZ: it looks about for 25 to 50 s and
    is still for ten."""
    rng = np.random.default_rng(seed)
    n = int(seconds * INSIDE_HZ)
    aims, awake = np.zeros((n, 3)), np.zeros(n)
    at = 0
    while at < n:
        until = at + int((rng.exponential(1.2) + 0.3) * INSIDE_HZ)
        aims[at:until], at = rng.normal(0.0, 1.0, 3) * (0.8, 0.4, 0.2), until
    at = 9 * INSIDE_HZ
    while at < n:
        until = at + int(rng.uniform(25.0, 50.0) * INSIDE_HZ)
        awake[at:until], at = 1.0, until + int(rng.uniform(9.0, 14.0) * INSIDE_HZ)
    awake = gaussian_filter1d(awake, 0.3 * INSIDE_HZ)[:, None]
    turn = Rotation.from_euler("ZYX", gaussian_filter1d(aims, 0.09 * INSIDE_HZ, axis=0) * awake)
    sway = gaussian_filter1d(rng.standard_normal((n, 3)), 0.8 * INSIDE_HZ, axis=0)
    way = turn.apply(ARM_M) + 0.02 * awake * sway / sway.std()
    rate = np.zeros((n, 3))
    rate[:-1] = (turn[:-1].inv() * turn[1:]).as_rotvec() * INSIDE_HZ
    force = np.gradient(np.gradient(way, axis=0), axis=0) * INSIDE_HZ ** 2
    return turn.inv().apply(force + [0.0, 0.0, G]), rate


def read(force, rate, seed):
    """The Capture of an MPU-6050 behind a low-pass of 49 Hz that nobody has calibrated."""
    rng = np.random.default_rng(1000 + seed)
    low = butter(1, 49.0, fs=INSIDE_HZ)
    counts = []
    for values, bias, density, lsb in (
            (force / G, 0.03, 0.4e-3, 4096.0), (np.degrees(rate), 1.0, 0.006, 32.8)):
        off = np.eye(3) + rng.normal(0.0, 0.01, (3, 3))
        values = values @ off.T + rng.normal(0.0, bias, 3)
        noisy = values + density * np.sqrt(INSIDE_HZ / 2.0) * rng.standard_normal(values.shape)
        counts.append(lfilter(*low, noisy - values[0], axis=0)[::INSIDE_HZ // RATE_HZ] * lsb
                      + values[0] * lsb)
    t_us = np.arange(len(counts[0])) * (1000000 // RATE_HZ)
    meta = {"sensor": "mpu6050", "rate_hz": RATE_HZ, "accel_lsb_per_g": 4096, "accel_range_g": 8,
            "gyro_lsb_per_dps": 32.8, "gyro_range_dps": 1000}
    return Capture(meta, t_us, *(np.rint(x).astype(np.int16) for x in counts))


@pytest.mark.long
@pytest.mark.parametrize("seed, seconds", [(1, 400.0), (6, 300.0)])
def test_a_healthy_sensor_on_a_head_has_no_effect_without_a_name(seed, seconds):
    """Turns ended elsewhere than gravity was read, by half a degree that an accelerometer was off
    by, and 6 mg of 120 that the arm pulls by were of another form."""
    found = answer.as_dict(diagnose([("head", read(*worn(seed, seconds), seed))]))
    assert found["verdict"] in ("no gap", "cannot tell")
    assert not any("no effect of the library" in said for said in found["remarks"])


@pytest.mark.parametrize("labelled, told", [(True, "z"), (False, "time")])
def test_noise_follows_a_pose_that_somebody_put_it_down_in(labelled, told):
    """What is worn is still in one pose, and sways in all others."""
    rng = np.random.default_rng(5)
    up = np.linspace(0.3, 1.0, 30)[rng.permutation(30)]
    accel = np.concatenate([rng.normal([0.0, 0.0, 4096.0 * z], 40.0 - 35.0 * z, (200, 3))
                            for z in up])
    capture = SimpleNamespace(accel=np.rint(accel).astype(np.int16),
                              meta={"accel_lsb_per_g": 4096.0})
    session = SimpleNamespace(capture=capture, labelled=labelled, t_s=0.01 * np.arange(len(accel)),
                              runs=[(0, 200 * k, 200 * k + 200) for k in range(30)])
    assert noise_bursts.following(session, "accel").variable == told
