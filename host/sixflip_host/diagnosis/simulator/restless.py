"""What a log that never rests says its sensor went through, and its noise.

The gyro carries the attitude, and the vertical is where the specific force lies over some twenty
seconds, in the frame that it carries: what moves a thing averages out, since it does not go ever
faster [Mahony et al., IEEE Trans. Autom. Control 53 (2008), 1203, whose filter this is without its
delay: past and future alike]. The noise is that of the quick end of the spectrum.
"""
import numpy as np

from ...capture.attitude import carried, rotations
from .alignment import smooth

UP = np.array([0.0, 0.0, 1.0])  # of the world
# Hz below which the force is the vertical's; the first ones are for a bias of a gyro that turns
# the frame by more than a radian in the period of the last (20 deg/s, ITG-3205 PS).
BANDS, BIAS = (0.4, 0.1, 0.05), np.radians(20.0)
# Of gravity, by which what moves a thing is still there in such a mean: 2 m/s of change in 20 s
# are a hundredth, a drone that leans into a curve has some hundredths.
STRAYS = 0.03
SUSPENDED = 0.5  # of gravity, that the mean of a force must have to be one
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
    if len(t) < 2 or (t[-1] - t[0]) * BANDS[-1] < 1.0:
        return None
    bias = np.zeros(3)
    for band in BANDS:
        course = _carried(t, rate - bias)
        bias = bias + _bias(t, course, _vertical(force, course, rate_hz, band)[0], band)
    course = _carried(t, rate - bias)
    vertical, size = _vertical(force, course, rate_hz, BANDS[-1])
    if size.min() < SUSPENDED * g:
        return None
    turn = _smallest(vertical) @ course
    return turn, bias, _speed(t, turn, force - g * turn[:, 2, :], rate_hz)


def _carried(t, rate):
    """(n, 3, 3): attitudes in the frame of the first row, as a gyro carries them."""
    return carried(rotations(0.5 * (rate[1:] + rate[:-1]) * np.diff(t)[:, None]))


def _vertical(force, course, rate_hz, band):
    """((n, 3) unit vectors against gravity in that frame, which a wrong bias lets wander; (n,)
    m/s2 how large the mean force is)."""
    slow = _slow(np.einsum("nij,nj->ni", course, force), rate_hz, band)
    size = np.linalg.norm(slow, axis=1)
    return slow / np.maximum(size, 1e-12)[:, None], size


def _bias(t, course, vertical, band):
    """(3,) rad/s of the gyro that makes the vertical wander as it does; what stays along it all
    the time does not show, and keeps its prior's nothing."""
    x, y, z = vertical.T
    zero = np.zeros(len(x))
    across = np.stack([np.stack([zero, z, -y], 1), np.stack([-z, zero, x], 1),
                       np.stack([y, -x, zero], 1)], 1)
    pull = across @ course
    steps = 0.5 * (pull[1:] + pull[:-1]) * np.diff(t)[:, None, None]
    wandered = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(steps, axis=0)])
    columns = _slow(wandered.reshape(-1, 9), (len(t) - 1) / (t[-1] - t[0]), band).reshape(-1, 3, 3)
    columns = (columns - columns.mean(axis=0)).reshape(-1, 3)
    off = (vertical - vertical.mean(axis=0)).ravel()
    found, number = np.zeros(3), min(1.0, 2.0 * band * (t[-1] - t[0]) / len(vertical))
    for _ in range(3):
        # Two values a period of the band are independent, and err by what is left of them.
        weight = number / max(STRAYS ** 2, 3.0 * np.mean((off - columns @ found) ** 2))
        found = np.linalg.solve(weight * columns.T @ columns + np.eye(3) / BIAS ** 2,
                                weight * columns.T @ off)
    return found


def _smallest(vertical):
    """(n, 3, 3): the smallest rotations that take unit vectors (n, 3) to the world's vertical."""
    axis = np.cross(vertical, UP)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, vertical[:, 2])
    return rotations(axis / np.maximum(sine, 1e-12)[:, None] * angle[:, None])


def _speed(t, turn, moved, rate_hz):
    """(n, 3) m/s in the body: the integral of what moves it, less what is as slow as that."""
    world = np.einsum("nij,nj->ni", turn, moved)
    steps = 0.5 * (world[1:] + world[:-1]) * np.diff(t)[:, None]
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return np.einsum("nji,nj->ni", turn, total - _slow(total, rate_hz, BANDS[-1]))


def _slow(values, rate_hz, slow_hz):
    """(n, k): what is slower than that of values (n, k), whose ends are mirrored: by themselves
    the first and the last reading would say what is there on average."""
    wide = min(len(values) - 1, int(rate_hz / slow_hz))
    longer = np.pad(values, ((wide, wide), (0, 0)), "reflect")
    return smooth(longer, rate_hz, slow_hz)[wide:len(longer) - wide]


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
