"""Scenes that go on moving: a turntable and a drive. Arrays only, and closed formulas.

Each has the fields of sixflip_sim.scene.Scene that scene_arrays needs, and fill(found, t_us).
"""
import numpy as np

from sixflip import STANDARD_G


class MovingScene:
    """Upright on something that turns about the vertical; subclasses say how."""

    warm_c, warm_tau_s, temperature_c = 0.0, 300.0, 25.0

    def __init__(self, g=STANDARD_G, lever_arm=None):
        self.g, self.lever_arm = g, lever_arm

    def fill(self, motion, t_us):
        """Fill a scene_arrays.Motion."""
        t = t_us * 1e-6
        attitude, rate, acceleration, linear = self.at(t)
        motion.attitude[:] = np.stack([attitude[i, j] for i in range(3) for j in range(3)])
        # f = R^T (a + g up), w and its derivative in the body
        world = linear + np.array([[0.0], [0.0], [self.g]])
        motion.f[:] = np.einsum("ijn,in->jn", attitude, world)
        motion.w[:] = np.einsum("ijn,in->jn", attitude, rate)
        motion.alpha[:] = np.einsum("ijn,in->jn", attitude, acceleration)
        if self.lever_arm is not None:
            r = np.array(self.lever_arm)[:, None]
            motion.f += np.cross(motion.alpha, r, axis=0)
            motion.f += np.cross(motion.w, np.cross(motion.w, r, axis=0), axis=0)
        motion.before[:] = motion.f[:, :1]
        motion.resting[:] = np.abs(motion.w).max(axis=0) < 1e-9


class Turntable(MovingScene):
    """Steps of constant rate about the vertical, dwell_s each with a second of smooth change
    between: 0, then each of rates_dps and its opposite; then again with the box on the next of
    its axes (Z, X, Y up)."""

    MOUNTS = np.array([[[1.0, 0, 0], [0, 1, 0], [0, 0, 1]], [[0.0, 1, 0], [0, 0, 1], [1, 0, 0]],
                       [[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]])
    CHANGE_S = 1.0

    def __init__(self, rates_dps=(30.0, 90.0, 180.0), dwell_s=10.0, **place):
        MovingScene.__init__(self, **place)
        rates = [0.0] + [s * r for r in rates_dps for s in (1.0, -1.0)] + [0.0]
        self.rates = np.deg2rad(rates)
        self.step_s = dwell_s + self.CHANGE_S
        self.turn_s = self.step_s * len(rates)
        self.end_s = 3 * self.turn_s

    def at(self, t):
        mount = np.minimum((t / self.turn_s).astype(int), 2)
        local = np.minimum(t - mount * self.turn_s, self.turn_s - 1e-9)
        step = np.minimum((local / self.step_s).astype(int), len(self.rates) - 1)
        tau = np.clip((local - step * self.step_s) / self.CHANGE_S, 0.0, 1.0)
        before = self.rates[np.maximum(step - 1, 0)] * (step > 0)
        jump = self.rates[step] - before
        rate = before + jump * tau * tau * (3.0 - 2.0 * tau)
        change = jump * 6.0 * tau * (1.0 - tau) / self.CHANGE_S
        # turned so far: whole steps, the change, and what is left at the new rate
        whole = np.concatenate([[0.0], np.cumsum(
            np.concatenate([[0.0], self.rates[:-1]]) * self.CHANGE_S * 0.5
            + self.rates * (self.CHANGE_S * 0.5 + self.step_s - self.CHANGE_S))])
        into = local - step * self.step_s
        angle = whole[step] + before * np.minimum(into, self.CHANGE_S) \
            + jump * self.CHANGE_S * (tau ** 3 - 0.5 * tau ** 4) \
            + self.rates[step] * np.maximum(into - self.CHANGE_S, 0.0)
        attitude = np.einsum("ikn,nkj->ijn", yawed(angle), self.MOUNTS[mount])
        zero = np.zeros_like(t)
        return attitude, np.stack([zero, zero, rate]), np.stack([zero, zero, change]), \
            np.zeros((3, len(t)))


class Drive(MovingScene):
    """A vehicle on level ground: rest_s still, then curves and speed as sums of slow sines
    that start from rest, with a shake of the road; end_s in all."""

    TURNS = ((0.35, 23.0, 0.0), (0.22, 11.0, 1.1), (0.10, 5.3, 2.3))  # rad/s, s, rad
    SPEEDS = ((2.0, 31.0, 0.4), (0.8, 13.0, 2.0))  # m/s, s, rad
    ROAD = ((0.15, 0.19, 0.3), (0.10, 0.083, 1.7))  # m/s2, s, rad

    def __init__(self, end_s=300.0, rest_s=10.0, **place):
        MovingScene.__init__(self, **place)
        self.end_s, self.rest_s = end_s, rest_s

    def at(self, t):
        moving = np.maximum(t - self.rest_s, 0.0)
        fade, slope = start(moving)
        rate, change, angle = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        for size, period, phase in self.TURNS:
            w = 2.0 * np.pi / period
            rate += size * np.sin(w * moving + phase)
            change += size * w * np.cos(w * moving + phase)
            angle += size / w * (np.cos(phase) - np.cos(w * moving + phase))
        # The angle is faded, and rate and change are its exact derivatives.
        second = change * fade + 2.0 * rate * slope[0] + angle * slope[1]
        rate, angle = rate * fade + angle * slope[0], angle * fade
        speed, gain = np.zeros_like(t), np.zeros_like(t)
        for size, period, phase in self.SPEEDS:
            w = 2.0 * np.pi / period
            speed += size * (1.0 + np.sin(w * moving + phase))
            gain += size * w * np.cos(w * moving + phase)
        gain = gain * fade + speed * slope[0]
        speed = speed * fade
        shake = sum(size * np.sin(2.0 * np.pi / period * moving + phase)
                    for size, period, phase in self.ROAD) * fade
        c, s = np.cos(angle), np.sin(angle)
        linear = np.stack([gain * c - speed * rate * s, gain * s + speed * rate * c, shake])
        zero = np.zeros_like(t)
        return yawed(angle), np.stack([zero, zero, rate]), np.stack([zero, zero, second]), linear


def start(t, seconds=5.0):
    """A smooth start from 0 to 1 (minimum jerk), and its two derivatives."""
    u = np.clip(t / seconds, 0.0, 1.0)
    return (u ** 3 * (10.0 - 15.0 * u + 6.0 * u * u),
            (30.0 * u * u * (1.0 - u) ** 2 / seconds,
             60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / seconds ** 2))


def yawed(angle):
    """(3, 3, n): body to world, turned about the vertical."""
    c, s = np.cos(angle), np.sin(angle)
    zero, ones = np.zeros_like(angle), np.ones_like(angle)
    return np.array([[c, -s, zero], [s, c, zero], [zero, zero, ones]])
