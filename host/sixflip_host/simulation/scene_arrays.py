"""A Scene at many times at once: the Moment of sensor_model.py with arrays for fields.

The formulas are sixflip_sim.scene's and rotation's, in the same order of operations, and sine
and cosine are the C library's, one by one, as on the board's interpreter: the same bits.
"""
import math

import numpy as np

from sixflip_sim.scene import REST, TREMOR_HZ, TURN, bump_profile, turn_profile
from sixflip_sim.sensor_model import Moment


class Motion:
    """Arrays (n,) for the times t_us: attitude (9, n), f, w, alpha, before (3, n), since (n,)
    in s, resting bool (n,)."""

    def __init__(self, n):
        self.attitude = np.zeros((9, n))
        self.f, self.w, self.alpha, self.before = (np.zeros((3, n)) for _ in range(4))
        self.since = np.zeros(n)
        self.resting = np.zeros(n, dtype=bool)


def motion(scene, t_us):
    """Motion of a sixflip_sim.scene.Scene at t_us (n,), not decreasing, in us."""
    t_us = np.asarray(t_us, dtype=float)
    moved = Motion(len(t_us))
    if hasattr(scene, "fill"):  # a scene of arrays by itself, see motion_scenes.py
        scene.fill(moved, t_us)
        return moved
    segments = scene.segments
    ends = np.array([s.t1 for s in segments[:-1]], dtype=float)
    held = np.searchsorted(ends, t_us, side="right")
    edges = np.searchsorted(held, np.arange(len(segments) + 1))
    for i, segment in enumerate(segments):
        part = slice(edges[i], edges[i + 1])
        if part.start == part.stop:
            continue
        moved.before[:, part] = np.array(scene.previous_force(i))[:, None]
        if segment.kind == REST:
            moved.attitude[:, part] = np.array(segment.start)[:, None]
            moved.f[:, part] = np.array(scene.rest_force(i))[:, None]
            moved.resting[part] = True
            moved.since[part] = (t_us[part] - segment.t0) * 1e-6
        else:
            _turn(moved, part, segment, t_us[part], scene)
    return moved


def _turn(moved, part, segment, t_us, scene):
    """scene.Scene.motion within one moving segment."""
    seconds = (segment.t1 - segment.t0) * 1e-6
    tau = (t_us - segment.t0) * 1e-6 / seconds
    s, ds, dds = (turn_profile if segment.kind == TURN else bump_profile)(tau)
    axis = segment.axis
    r = _product(segment.start, _about(axis, segment.angle * s))
    speed = segment.angle * ds / seconds
    gain = segment.angle * dds / (seconds * seconds)
    up = scene.g
    if segment.lift:
        up = up + segment.lift * bump_profile(tau)[2] / (seconds * seconds)
        if scene.tremor:
            phase = 2.0 * math.pi * TREMOR_HZ * tau * seconds
            up = up + scene.tremor * np.array([math.sin(x) for x in phase.tolist()])
    moved.attitude[:, part] = r
    f = (r[6] * up, r[7] * up, r[8] * up)
    w = tuple(a * speed for a in axis)
    alpha = tuple(a * gain for a in axis)
    if scene.lever_arm is not None:
        from sixflip_sim import rotation
        a = rotation.cross(alpha, scene.lever_arm)
        b = rotation.cross(w, rotation.cross(w, scene.lever_arm))
        f = tuple(f[i] + a[i] + b[i] for i in range(3))
    moved.f[:, part], moved.w[:, part], moved.alpha[:, part] = f, w, alpha


def _about(axis, angle):
    """rotation.about for an array of angles."""
    x, y, z = axis
    angles = angle.tolist()
    c = np.array([math.cos(a) for a in angles])
    s = np.array([math.sin(a) for a in angles])
    d = 1.0 - c
    return (c + x * x * d, x * y * d - z * s, x * z * d + y * s,
            y * x * d + z * s, c + y * y * d, y * z * d - x * s,
            z * x * d - y * s, z * y * d + x * s, c + z * z * d)


def _product(a, b):
    """rotation.times, its order of operations."""
    return tuple(a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]
                 for i in range(3) for j in range(3))


def moment(scene, k, t, look_us):
    """sensor_model.Moment with arrays: samples k, device time t (s), looked at look_us."""
    moved = motion(scene, look_us)
    m = Moment()
    m.k, m.t = k, t
    m.attitude = tuple(moved.attitude)
    m.f, m.w, m.alpha = list(moved.f), list(moved.w), tuple(moved.alpha)
    m.previous_f, m.since_move, m.resting = tuple(moved.before), moved.since, moved.resting
    warm = scene.warm_c
    if warm:
        fading = np.exp(-np.asarray(look_us) * 1e-6 / scene.warm_tau_s)
        m.temp = scene.temperature_c - warm * fading
        m.temp_rate = warm / scene.warm_tau_s * fading
    else:
        m.temp = np.full(len(k), scene.temperature_c)
        m.temp_rate = np.zeros(len(k))
    return m
