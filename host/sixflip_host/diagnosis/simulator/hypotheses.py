"""What a simulator may output instead of what a sensor reads, as signals made of the real log.

A hypothesis says: simulator = (1 + E) S signal + S columns · c + bias, where the signal is made of
what the real sensor went through. S is a signed permutation times a unit, or a turn about the
vertical; E, the bias and c have priors of their physical size. The nameless one is the sensor's
own reading with every signal beside it, each with free coefficients.
"""
from dataclasses import dataclass, replace

import numpy as np

from . import alignment
from .own_effects import pairs
from .pairing import GRID_HZ
from .sensor_axes import SHAPE
from .traces import spinning

# Prior standard deviations beside SHAPE. Zero level: 80 mg and 20 deg/s (MPU-6050 PS rev 3.4,
# tables 6.1 and 6.2).
BIAS = {"accel": 0.8, "gyro": 0.35}
FREE = 0.3  # of the nameless one's coefficients: a third of a signal where it should not be
SLOPES = 0.035  # of gravity along a floor: two degrees, as roads and yards have
LEVER_M = 0.1  # m: a sensor sits somewhere in a robot of some tens of centimetres
DELAY_S = 0.05  # s: GAP has 1 to 19 ms of chips; logs made elsewhere had 40 to 80 ms
SMOOTH_S2 = 2e-4  # half the square of a pole of 8 Hz
# Steps of physics in one of the sensor, or the reverse, and how far a factor may be off.
TIMES = (0.05, 0.1, 0.2, 0.25, 0.33, 0.5, 2.0, 3.0, 4.0, 5.0, 10.0, 20.0)
TIMES_SPREAD = 0.1  # relative standard deviation of each
# Slower than the first a gyro's tilt between two rests is its own: a cross axis of 1 % of a robot
# that turns to one side, or a tenth of a deg/s of bias, make a degree in ten seconds. What turns
# to and fro makes it faster, up to where springs tilt a robot, at 1 to 2 Hz: octave by octave.
WANDERS_HZ = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)
UPRIGHT = 0.05  # cosine of the pitch from which on roll and yaw are one: 87 degrees
# What shows where the thing turns only: along one line of forces a wrong time step is a scale and
# a bias, and the world's axes are the body's.
LEAST_LINE = 1e-5  # of an axis across it: none, but for a prior that has a width
UPPER = [0, 1, 2, 4, 5, 8]  # of a symmetric (3, 3), row by row
IN_TURNS = ("time_step", "no_centripetal_term", "lever_arm_missing", "world_frame_forces")


@dataclass(frozen=True)
class Hypothesis:
    """name ("": the nameless one); signal (n, 3); columns (n, 3, k) with prior sizes mean (k,)
    and sd (k,); heading: S is a turn about the vertical; free (n, f): further columns of each
    channel with prior FREE; bias_sd: one, or (3,), None for BIAS; constant: how long the bias is,
    which is gravity then, or 0; copies: the first so many triples of free, and the first scaled
    of columns, carry the signal's noise; shape_sd (3, 3): of E, None for SHAPE; smooth_sd: s2, of
    how much smoother it is, see Fit; full_scale: how many times the signal the real one reads by
    a full scale that is not stated; slopes: the columns are the world's two level axes, times g;
    shared: the simulator reads by the real one's full scale, whatever it is; behind: the LowPass
    that the readings are behind."""

    name: str
    signal: np.ndarray
    columns: np.ndarray
    mean: np.ndarray
    sd: np.ndarray
    heading: bool = False
    free: np.ndarray = None
    bias_sd: np.ndarray = None
    constant: float = 0.0
    copies: int = 0
    scaled: int = 0
    shape_sd: np.ndarray = None
    smooth_sd: float = SMOOTH_S2
    full_scale: float = 1.0
    slopes: bool = False
    shared: bool = False
    behind: object = None


def none(n):
    """No columns (n, 3, 0) beside the signal, with no priors."""
    return np.zeros((n, 3, 0)), np.zeros(0), np.zeros(0)


def accelerometer(force, motion, g):
    """Hypotheses of the accelerometer; force (n, 3) and the fields of Motion on one grid."""
    n = len(force)
    up, moved = g * motion.up, motion.moved
    spin, lever = spun(motion), lever_columns(motion)
    arm = np.zeros(3), np.full(3, LEVER_M)
    transport = -np.cross(motion.rate, motion.speed)[:, :, None]
    world = np.einsum("nij,nj->ni", motion.turn, force)
    # What a gyro says of the tilt wanders between rests; of a thing that stays level its fast part
    # and the mean say more.
    level = up.mean(axis=0)
    slower = [alignment.smooth(up, GRID_HZ, hz) for hz in WANDERS_HZ]
    tilt = np.stack([b - a for a, b in zip(slower, [*slower[1:], up])], 2)
    half = np.full(tilt.shape[2], 0.5)
    tried = [
        Hypothesis("healthy", force, *none(n)),
        # What moves it in another proportion to gravity than a scale has, as of two logs one of
        # which is smoother: no wrong time step, and no reason to tell a scale.
        Hypothesis("healthy", force, moved[:, :, None] * np.eye(3), np.zeros(3),
                   np.full(3, SHAPE), scaled=3),
        # A floor that slopes and a simulator's that does not: each heading has another share.
        Hypothesis("healthy", force, g * motion.turn[:, :2].transpose(0, 2, 1), np.zeros(2),
                   np.full(2, SLOPES), slopes=True),
        Hypothesis("no_gravity", moved, *none(n)),
        Hypothesis("no_gravity", force - level, -tilt, half, half),
        Hypothesis("gravity_sign", moved - up, *none(n)),
        Hypothesis("gravity_sign", force - 2.0 * level, -2.0 * tilt, half, half),
        Hypothesis("gravity_after_rotation", moved, *none(n), bias_sd=g, constant=g),
        Hypothesis("world_frame_forces", world, *none(n), heading=True),
        Hypothesis("no_centripetal_term", force, transport, np.ones(1), np.full(1, 0.1)),
        Hypothesis("no_centripetal_term", force, -spin, *arm),
        Hypothesis("lever_arm_missing", force, np.concatenate([-lever, crooked_arm(motion)], 2),
                   *(np.concatenate([x, np.zeros(27) + sd]) for x, sd in zip(
                       arm, (0.0, LEVER_M * SHAPE)))),
    ]
    tried += [Hypothesis("time_step", force, moved[:, :, None], np.array([k - 1.0]),
                         np.array([TIMES_SPREAD * k]), scaled=1) for k in TIMES]
    everything = np.concatenate([moved, world, up, transport[:, :, 0], motion.rate,
                                 motion.rate_dot, pairs(motion.rate)], axis=1)
    return tried + [nameless(force, everything, 2)]


def along_one_line(force, motion, g):
    """Hypotheses of the accelerometer of what does not turn: its forces change along one line.
    What it reads across that does not tell its scale there, nor its misalignment."""
    off = force - force.mean(axis=0)
    line = np.abs(np.linalg.eigh(off.T @ off)[1][:, -1])
    return [replace(h, shape_sd=SHAPE * np.tile(np.maximum(line, LEAST_LINE), (3, 1)))
            for h in accelerometer(force, motion, g)
            if h.name not in IN_TURNS and not h.scaled]  # what moves it is all that shows


def gyro(rate, motion, g):
    """Hypotheses of the gyro."""
    n, at_rest = len(rate), rate.mean(axis=0) - motion.rate.mean(axis=0)
    world = np.einsum("nij,nj->ni", motion.turn, rate)
    tried = [Hypothesis("healthy", rate, *none(n)),
             Hypothesis("world_frame_rates", world, *none(n), heading=True),
             Hypothesis("euler_angle_rates", angle_rates(rate - at_rest, motion.up), *none(n))]
    tried += [Hypothesis("time_step", rate, rate[:, :, None], np.array([k - 1.0]),
                         np.array([TIMES_SPREAD * k]), scaled=1) for k in TIMES]
    everything = np.concatenate([world, motion.rate_dot * 0.1, pairs(rate), motion.up,
                                 motion.moved / g], axis=1)
    return tried + [nameless(rate, everything, 1)]


def angle_rates(rate, up):
    """(n, 3): the derivatives of roll, pitch and yaw, in this order, of what turns by rate (n, 3)
    in the body, up (n, 3) [Diebel, Representing attitude (2006), equations 75 and 76: turned about
    z, then y, then x]. Angles to a vertical that points down are the same."""
    x, y, z = (up if up[:, 2].mean() > 0.0 else -up).T
    cosine = np.maximum(np.hypot(y, z), UPRIGHT)
    about_z = (rate[:, 1] * y + rate[:, 2] * z) / cosine  # without the pitch
    return np.stack([rate[:, 0] - x / cosine * about_z, (rate[:, 1] * z - rate[:, 2] * y) / cosine,
                     about_z / cosine], 1)


def nameless(signal, everything, copies):
    """The Hypothesis without a name: the reading with everything (n, f) beside it."""
    return Hypothesis("", signal, *none(len(signal)), free=everything, copies=copies)


def spun(motion):
    """(n, 3, 3): what multiplies r in w x (w x r) of a Motion."""
    return spinning(motion.rate) if motion.spin is None else motion.spin


def lever_columns(motion):
    """(n, 3, 3): what multiplies r in dw/dt x r + w x (w x r)."""
    columns = spun(motion).copy()
    x, y, z = motion.rate_dot.T
    for (i, j), value in {(0, 1): -z, (0, 2): y, (1, 0): z, (1, 2): -x, (2, 0): -y,
                          (2, 1): x}.items():
        columns[:, i, j] += value
    return columns


def crooked_arm(motion):
    """(n, 3, 27): what an arm makes of dw/dt and of the products of w where the gyro's scales and
    axes are off by some percent, as no rest shows them: any of them in any axis."""
    spin = spun(motion)  # w w' - |w|2
    square = -0.5 * np.trace(spin, axis1=1, axis2=2)
    products = (spin + square[:, None, None] * np.eye(3)).reshape(-1, 9)[:, UPPER]
    parts = np.concatenate([motion.rate_dot, products], 1)
    return (np.eye(3)[:, :, None] * parts[:, None, None, :]).reshape(len(parts), 3, -1)


def made(kind, turning):
    """The function that makes the Hypotheses of a sensor of what turns, or only moves."""
    return gyro if kind == "gyro" else accelerometer if turning else along_one_line
