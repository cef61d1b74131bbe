"""The motion of a log that never rests, by gravity's mean over many seconds: what goes to and fro
is not sped up for ever. Carried along by the gyro, that mean is the vertical in a frame that turns
with the gyro's bias alone, of which it shows all but what is about the vertical itself [Laidig &
Seel, VQF, Information Fusion 91 (2023), 187, sections 3.2 and 3.3]. And its noise, of the quick
end of its spectrum.
"""
import numpy as np

from ...capture.attitude import carried, rotations
from .alignment import smooth

# Hz: slower than waves and than a car brakes, and what a tenth of a deg/s of a gyro's bias turns
# by in the meantime is two degrees.
VERTICAL_HZ = 0.05
PERIODS = 2.0  # of it, that a log must last
SUSPENDED = 0.5  # of gravity, that the mean of a force must have to be one
ROUNDS = 3  # of a bias, each of which leaves a tenth
# Of the average axis, how well an axis is seen that is half believed: what stays level shows a
# bias about the vertical by its tilt of a few degrees, and a car that brakes in bends otherwise.
SEEN = 0.1
UP = np.array([0.0, 0.0, 1.0])  # of the world
# Order of the differences that noise is taken from: of a wave of a tenth of the rate they leave
# (2 sin 18 deg)^8, 2 %, while white noise is as strong in them as anywhere.
ORDER, ORDER_POWER = 4, 70.0  # (its power in them is the binomial of 8 over 4)
BLOCK = 32  # differences whose mean square has errors that are nearly normal
# Squares that count as one, by the correlation of such differences, the sum of its squares; of a
# median's standard error over that of a mean; and the median of a block's mean square, of chi
# squared with BLOCK / ALIKE degrees of freedom, over its mean [Wilson & Hilferty, PNAS 17 (1931)].
ALIKE, MEDIAN_LOSES, MEDIAN_OF_BLOCK = 2.6, 1.25, 0.947
# By how much a white noise may differ from one octave to the next: standard errors, and a share
# besides that lines and rounding make, which is then not told of it either. Means over two to
# sixteen samples, and poles up to 0.4 of the rate, leave pairs a third stronger and more.
FLAT_SIGMAS, UNTOLD = 4.0, 0.1


def levelled(t, force, rate, rate_hz, g):
    """(turn (n, 3, 3) body to world, bias (3,) rad/s that is known but about the vertical, speed
    (n, 3) m/s in the body), or None where nothing shows the vertical; force, rate (n, 3)."""
    if len(t) < 2 or (t[-1] - t[0]) * VERTICAL_HZ < PERIODS:
        return None
    bias, dt = rate.mean(axis=0), np.diff(t)[:, None]
    edge = slice(*(int(share * len(t)) for share in (0.05, 0.95)))  # one side only of the means
    for left in range(ROUNDS, -1, -1):
        own = rate - bias
        turn = carried(rotations(0.5 * (own[1:] + own[:-1]) * dt))
        carried_force = np.einsum("nij,nj->ni", turn, force) / g
        vertical = smooth(carried_force, rate_hz, VERTICAL_HZ)
        if not left:
            break
        # Of a rate that is too large by e a frame turns by it: dv/dt = (R e) x v.
        columns = np.stack([smooth(np.cross(turn[:, :, k], carried_force), rate_hz, VERTICAL_HZ)
                            for k in range(3)], 2)
        slope = np.gradient(vertical, axis=0) / np.maximum(np.gradient(t), 1e-9)[:, None]
        design, wanted = columns[edge].reshape(-1, 3), slope[edge].reshape(-1)
        gram = design.T @ design
        gram += SEEN * np.trace(gram) / 3.0 * np.eye(3)
        bias = bias + np.linalg.solve(gram, design.T @ wanted)
    size = np.linalg.norm(vertical, axis=1)
    if size.min() < SUSPENDED:
        return None
    axis = np.cross(vertical / size[:, None], UP)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, vertical[:, 2] / size)
    turn = rotations(axis / np.maximum(sine, 1e-12)[:, None] * angle[:, None]) @ turn
    world = np.einsum("nij,nj->ni", turn, force) - g * UP
    way = np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * (world[1:] + world[:-1]) * dt, 0)])
    way -= smooth(way, rate_hz, VERTICAL_HZ)
    return turn, bias, np.einsum("nji,nj->ni", turn, way)


def white(values):
    """((3,) standard deviation of a sample's white noise, its relative standard error) of values
    (n, 3) that move all the time, or None where pairs of them are not as strong as they are: then
    either is motion, or the noise has a colour, and what it is lower down is not known."""
    if len(values) < 16 * BLOCK:
        return None
    levels, errors = [], []
    for wide in (1, 2):
        means = values[:len(values) // wide * wide].reshape(-1, wide, 3).mean(axis=1)
        squares = wide * np.diff(means, ORDER, axis=0) ** 2 / ORDER_POWER
        number = len(squares) // BLOCK
        # By the median of blocks: what is jolted now and then is not the noise.
        levels.append(np.median(squares[:number * BLOCK].reshape(number, BLOCK, 3).mean(axis=1),
                                axis=0) / MEDIAN_OF_BLOCK)
        errors.append(MEDIAN_LOSES * np.sqrt(2.0 * ALIKE / len(squares)))
    ratio = np.maximum(levels[0], 1e-30) / np.maximum(levels[1], 1e-30)
    if (np.abs(np.log(ratio)) > 2.0 * UNTOLD + FLAT_SIGMAS * np.hypot(*errors)).any():
        return None
    return np.sqrt(levels[0]), float(np.hypot(0.5 * errors[0], UNTOLD))
