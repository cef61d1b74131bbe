"""A simulated sensor fitted to a recording at rest, and what it counts in the same time."""
import numpy as np

from sixflip import RAIL, STANDARD_G
from sixflip_sim.effects import make
from sixflip_sim.sensor_model import SensorModel, Triad

from ..experiment import signal_measures
from . import simulator

UNIT = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
_RADIAN = np.pi / 180.0


class HeldScene:
    """Still in one direction of gravity after another: forces (p, 3) in m/s2, seconds each;
    temperatures: degC in each, or one for all."""

    warm_c, warm_tau_s, lever_arm, g = 0.0, 300.0, None, STANDARD_G

    def __init__(self, forces, seconds, temperature_c=25.0):
        self.forces = np.atleast_2d(forces)
        self.seconds, self.temperature_c = seconds, temperature_c

    def fill(self, motion, t_us):
        pose = np.minimum((t_us * 1e-6 / self.seconds).astype(int), len(self.forces) - 1)
        motion.f[:] = self.forces[pose].T
        motion.before[:] = self.forces[np.maximum(pose - 1, 0)].T
        motion.attitude[6:9] = motion.f / np.linalg.norm(motion.f, axis=0)
        motion.resting[:] = True
        motion.since[:] = t_us * 1e-6 - pose * self.seconds


class Noise:
    """White noise, flicker floor and step of one triad, fitted to counts (n, 3) at rest."""

    def __init__(self, counts, lsb, rate_hz):
        self.step = signal_measures.step(counts).tolist()
        shortest = signal_measures.allan(counts, 1)
        # a step adds its own variance of step^2 / 12 to what is white
        self.white = np.sqrt(np.maximum(shortest ** 2 - np.square(self.step) / 12.0, 0.0)) / lsb
        m = max(1, len(counts) // 12)
        long = signal_measures.allan(counts, m) / lsb
        # only what exceeds white noise by twice the scatter of an Allan variance of 12 averages
        excess = long ** 2 - self.white ** 2 / m
        scatter = self.white ** 2 / m * np.sqrt(2.0 / (len(counts) / m - 1.0))
        self.flicker = np.sqrt(np.where(excess > 2.0 * scatter, excess, 0.0))
        self.seconds = m / rate_hz

    def effects(self, sensor, seed):
        """Specs of the effects that carry what is not white."""
        sizes = dict(zip("xyz", (float(v) for v in self.flicker)))
        specs = [dict(sizes, effect="drift", sensor=sensor, seed=seed)]
        if max(self.step) > 1:
            specs.append(dict(zip("xyz", (int(s) for s in self.step)), effect="quantisation",
                              sensor=sensor))
        return specs


def accel_model(scene, matrix, bias, noise_mg, effects, seed):
    """SensorModel with an accelerometer alone (the gyro stays at 0)."""
    accel = Triad(matrix, list(bias), [s * 1e-3 * STANDARD_G for s in noise_mg], 1, seed, 0)
    return SensorModel(scene, accel, Triad(UNIT, [0.0] * 3, 0.0, 1, seed, 3), seed=seed,
                       effects=make(effects, seed))


def gyro_model(scene, bias_dps, noise_dps, effects, seed):
    """SensorModel with a gyro alone; the accelerometer is ideal."""
    gyro = Triad(UNIT, [b * _RADIAN for b in bias_dps], [s * _RADIAN for s in noise_dps], 1,
                 seed, 3)
    return SensorModel(scene, Triad(UNIT, [0.0] * 3, 0.0, 1, seed, 0), gyro, seed=seed,
                       effects=make(effects, seed))


def counted(model, kind, lsb, rate_hz, n):
    """n samples (n, 3) of a model at a rate."""
    simulator.vectorise(model)
    output = simulator.Output(kind, int(round(1e9 / rate_hz)), lsb, RAIL)
    return simulator.counts(model, output, np.arange(n)).T


def accel_at_rest(counts, lsb_per_g, rate_hz, n, seed=1, more=()):
    """Fit the first rest in counts (m, 3), simulate n samples; more: further effects."""
    noise = Noise(counts, lsb_per_g / 1000.0, rate_hz)
    force = counts.mean(axis=0) / lsb_per_g * STANDARD_G
    model = accel_model(HeldScene(force, 1e9), UNIT, [0.0] * 3, noise.white,
                        list(more) + noise.effects("accel", seed), seed)
    return counted(model, "accel", lsb_per_g, rate_hz, n)


def gyro_at_rest(counts, lsb_per_dps, rate_hz, n, seed=1):
    """Likewise for a gyro."""
    noise = Noise(counts, lsb_per_dps, rate_hz)
    model = gyro_model(HeldScene([0.0, 0.0, STANDARD_G], 1e9), counts.mean(axis=0) / lsb_per_dps,
                       noise.white, noise.effects("gyro", seed), seed)
    return counted(model, "gyro", lsb_per_dps, rate_hz, n)
