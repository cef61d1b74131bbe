"""A numpy simulator that follows the docstrings gets the simulated chip's counts, all of them."""

import numpy as np
import pytest

from sixflip import RAIL, STANDARD_G
from sixflip.chips import adxl345, itg3205
from sixflip_sim import noise, worlds
from sixflip_sim.scene import REST, TURN

DEGREE = np.pi / 180


def gauss(stream, k):
    x = noise.bits(stream, k)
    body = np.array(list(noise.BODY) + [0], dtype=np.int64)
    tail = np.array(noise.TAIL, dtype=np.int64)
    cell = (x >> 24) & 0x7F
    i = np.minimum(cell, 126)
    value = body[i] + (((body[i + 1] - body[i]) * (x & 0xFFFFFF)) >> 24)
    j = (x >> 18) & 0x3F
    far = tail[j] + (((tail[j + 1] - tail[j]) * (x & 0x3FFFF)) >> 18)
    value = np.where(cell == 127, far, value)
    return np.where(x >> 31, -value, value) * noise.UNIT


def motion(scene, t_us):
    """(force (n, 3), rate (n, 3)): scene.py's formulas, all times at once."""
    force, rate = np.zeros((len(t_us), 3)), np.zeros((len(t_us), 3))
    for number, segment in enumerate(scene.segments):
        last = number == len(scene.segments) - 1
        here = (t_us >= segment.t0) & ((t_us < segment.t1) | last)
        r = np.array(segment.start).reshape(3, 3)
        if segment.kind == REST:
            force[here] = r[2] * scene.g
            continue
        seconds = (segment.t1 - segment.t0) * 1e-6
        tau = (t_us[here] - segment.t0) * 1e-6 / seconds
        assert segment.kind == TURN
        s = tau**3 * (10 - 15 * tau + 6 * tau**2)
        ds = 30 * tau**2 * (1 - tau)**2
        p = tau * (1 - tau)
        up = scene.g + segment.lift * 384 * p * (1 - 5 * p) / seconds**2
        x = np.array(segment.axis)
        v = np.broadcast_to(r[2], (len(tau), 3))
        c, sn = np.cos(segment.angle * s)[:, None], np.sin(segment.angle * s)[:, None]
        # the world's z in the body: R^T z, a turn by -angle of what it was (Rodrigues)
        z = v * c + np.cross(v, x) * sn + np.outer(v @ x, x) * (1 - c)
        force[here] = z * up[:, None]
        rate[here] = np.outer(segment.angle * ds / seconds, x)
    return force, rate


def counts(triad, true, k, per_unit, rail):
    matrix, bias = np.array(triad.matrix), np.array(triad.bias)
    measured = true @ matrix.T + bias
    rows = []
    for i in range(3):
        x = measured[:, i] + triad.sigma[i] * gauss(triad.keys[i], k)
        rows.append(np.clip(np.floor(x * (per_unit / triad.step) + 0.5) * triad.step,
                            -rail - 1, rail))
    return np.array(rows).T.astype(int)


@pytest.mark.parametrize("spec", [
    {"sensor": "mpu6050", "tilt_deg": 3, "seed": 11, "accel_step": 4},
    {"sensor": "gy85", "tilt_deg": 1, "seed": 12, "order": "random"},
])
def test_counts_of_a_session(spec):
    world = worlds.make(spec)
    k = np.arange(0, world.end_us // 5000, 13, dtype=np.int64)      # 200 Hz
    force, rate = motion(world.scene, k * 5000)
    if spec["sensor"] == "mpu6050":
        scale = (16384, RAIL, 65.5, RAIL)
    else:
        scale = (adxl345.LSB_PER_G, 4095, itg3205.LSB_PER_DPS, RAIL)
    accel = counts(world.model.accel, force, k, scale[0] / STANDARD_G, scale[1])
    gyro = counts(world.model.gyro, rate, k, scale[2] / DEGREE, scale[3])
    out = [0] * 7
    found = []
    for i in k:
        world.model.accel_counts(int(i), int(i) * 5000, scale[0], scale[1], 1.0, out)
        world.model.gyro_counts(int(i), int(i) * 5000, scale[2], scale[3], 1.0, out)
        found.append(out[:6])
    found = np.array(found)
    assert np.array_equal(found[:, :3], accel)
    assert np.array_equal(found[:, 3:], gyro)
    assert len(np.unique(found[:, 3])) > 50
    assert np.all(accel % spec.get("accel_step", 1) == 0)
