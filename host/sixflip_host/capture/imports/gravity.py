"""Gravity in an accelerometer's values: how long it is, which unit that makes of them, and whether
it turns as a gyro says."""

import math
from typing import NamedTuple

import numpy as np

from ..attitude import cross_matrix
from ..capture_header import STANDARD_G

# Counts per g of the chips in use: ±2, 4, 8, 16 g of 16 bits (MPU-6000 register map 4.17), 1024
# of 12 bits, 256 of an ADXL345.
USUAL_LSB = (16384, 8192, 4096, 2048, 1024, 256)
USUAL = (1.0, STANDARD_G, 1000.0, 1e3 * STANDARD_G, *USUAL_LSB)   # what 1 g is in a unit
ZERO_G = 0.2            # offset and scale of a part at rest: MPU-6000 has ±80 mg and 3 %
WINDOW = 20             # rows that are averaged to see gravity
MOST_WINDOWS = 2000     # that gravity is looked for in, evenly over the file
QUIET = 0.05            # of |a|: scatter within a window that rests
RESTS = 0.02            # of the windows, that rest where anything does
# Of what a hand, a leg or a vehicle moves to and fro several mean forces are near nothing in
# STAYS_S, in which only what tumbles turns over; and the size of what has no constant part varies
# by at least that of three like axes, Maxwell's sqrt(3 pi / 8 - 1). In the logs of three phones
# without gravity 0.06 to 0.19 of the force stays and its size varies by 1.4 or more; in those of
# some twenty sensors with it, in which nothing rests, 0.36 or more stays, in most 0.8, and the
# size varies by 0.25, of a rocket in flight by 0.5. Fewer spans than FEWEST_STAYS have no median
# that one move would not shift.
STAYS_S, STAYS, MAXWELL, FEWEST_STAYS = 4.0, 0.3, math.sqrt(3.0 * math.pi / 8.0 - 1.0), 3
MOST_TURNS = 20_000     # twentieths of a second in which gravity is seen to turn: the first ones
LAG = 4                 # of those, over which it is
DISAGREES = 2.0         # factor from 1 g beyond which what was said of the unit is wrong
TELLS = math.log(20.0)  # nats of a hypothesis that is named alone
# Of a scale of the gyro, where what moves the sensor is told along with it: degrees for radians
# are 57; a fifth apart, then a fiftieth; twentieths of a second that are looked at; of |a|, what
# knocks have more of.
FACTORS, FINER, MOST_MOVED, KNOCKS = np.geomspace(1 / 64, 64, 47), 11, 5000, 0.3
# m/s that what never rests may gain while |a| is not 1 g, a rocket on its way up for instance:
# sound's. In ten seconds that is 3.5 g, in a minute 0.6 g.
FASTEST_MS = 340.0


class Gravity(NamedTuple):
    """size: |a| in the unit of the values; rests: whether it was seen at rest."""

    size: float
    rests: bool


class Offset(NamedTuple):
    """about (3,): what an accelerometer reads where nothing acts, in the unit of its values;
    size: of gravity about that; nats: how much likelier than no offset at another scale."""

    about: np.ndarray
    size: float
    nats: float


class Turn(NamedTuple):
    """factor: how much farther gravity turns in the accelerometer than by the gyro's rates; alike:
    their correlation; number: of places in which it turns, of which LAG overlap."""

    factor: float
    alike: float
    number: int


def may_be_thrust(size, seconds):
    """Whether |a| of so many g for so many seconds may be what drives a thing that never rests."""
    return abs(size - 1.0) * STANDARD_G * seconds < FASTEST_MS


def seen(values, usual=USUAL):
    """Gravity in accelerometer values (n, 3), or None in fewer than two windows of rows; usual:
    what 1 g may be in their unit.

    Where nothing rests it is the median of the means of windows, in which vibration is gone. What
    flies freely is stiller than what stands on a launch pad, but nothing does so for most of a
    recording, and while it does it reads less: where the median is 1 g and what rests reads less
    than half of it, gravity is what rests as the median has it, or else the median.
    """
    if len(values) < 2 * WINDOW:
        return None
    mean, scatter = _windows(values)
    size = np.linalg.norm(mean, axis=1)
    usually = float(np.median(size))
    quiet = scatter < QUIET * size
    if quiet.mean() >= RESTS and DISAGREES * _stillest(size, scatter, quiet) < usually and any(
            abs(usually / g - 1.0) < ZERO_G for g in usual):
        quiet &= np.abs(size / usually - 1.0) < ZERO_G
    if quiet.mean() >= RESTS:
        return Gravity(_stillest(size, scatter, quiet), True)
    return Gravity(usually, False)


def _windows(values):
    """((n, 3) means, (n,) scatter) of windows of values, evenly over the file."""
    number = len(values) // WINDOW
    step = -(-number // MOST_WINDOWS)
    windows = values[:number * WINDOW].reshape(number, WINDOW, 3)[::step].astype(float)
    return windows.mean(axis=1), np.sqrt(windows.var(axis=1).sum(axis=1))


def offset(values):
    """The Offset of accelerometer values (n, 3) at rest, in their unit, held against none: by the
    rests, each of which is one value, of a sphere about it or about 0 [BIC: Schwarz, Annals of
    Statistics 6 (1978) 461]."""
    mean, scatter = _windows(values)
    size = np.linalg.norm(mean, axis=1)
    quiet = scatter < QUIET * size
    goes = np.linalg.norm(np.diff(mean, axis=0), axis=1) > QUIET * size[1:]
    runs = np.split(np.arange(len(mean)), np.flatnonzero(goes | (quiet[1:] != quiet[:-1])) + 1)
    rests = np.array([mean[run].mean(axis=0) for run in runs if quiet[run[0]]]).reshape(-1, 3)
    square = (rests ** 2).sum(axis=1)
    if not len(rests):
        return Offset(np.zeros(3), 0.0, 0.0)
    *twice, _ = np.linalg.lstsq(np.c_[rests, np.ones(len(rests))], square, rcond=1e-3)[0]
    about = 0.5 * np.array(twice)
    sizes = [np.linalg.norm(rests - centre, axis=1) for centre in (np.zeros(3), about)]
    noise = np.median(scatter[quiet]) / math.sqrt(WINDOW)
    plain, beside = (len(rests) * (size.var() + noise ** 2) for size in sizes)
    nats = 0.5 * len(rests) * math.log(plain / beside) - 1.5 * math.log(len(rests))
    return Offset(about, float(sizes[1].mean()), nats)


def stays(values, rate_hz, one_g=math.inf):
    """False where accelerometer values (n, 3) have no vector that stays as gravity does, which a
    body feels for seconds unless it tumbles, and at every moment unless it falls; True where there
    is one, and where the log is too short to tell. one_g: what 1 g is where the unit is known:
    however hard a body is shaken, what stays is that long."""
    rows = max(1, int(STAYS_S * rate_hz))
    number = len(values) // rows
    if number < FEWEST_STAYS:
        return True
    spans = values[:number * rows].reshape(number, rows, 3)
    size = np.linalg.norm(values, axis=1)
    slow = np.linalg.norm(spans.mean(axis=1, dtype=float), axis=1)
    whole = np.sqrt(np.square(spans, dtype=float).sum(axis=2).mean(axis=1))
    there = whole > 0.0
    return not (there.any() and np.median(slow[there] / whole[there]) < STAYS
                and np.median(slow) < one_g / DISAGREES
                and size.std() > MAXWELL * size.mean())


def _stillest(size, scatter, some):
    """The median |a| of the stiller half of some windows."""
    half = some & (scatter <= np.quantile(scatter[some], 0.5))
    return float(np.median(size[half]))


def unit(size, whole):
    """(unit, counts per g or None) that make |a| gravity, or None; whole: the values are whole
    numbers."""
    if abs(size - 1) < ZERO_G and not whole:
        return "g", None
    if abs(size / STANDARD_G - 1) < ZERO_G and not whole:
        return "m/s2", None
    if abs(size / STANDARD_G / 1000 - 1) < ZERO_G and not whole:
        return "mm/s2", None
    if abs(size / 1000 - 1) < ZERO_G and (not whole or abs(size / 1000 - 1)
                                          < abs(size / 1024 - 1)):
        return "mg", None
    if whole:
        for lsb in USUAL_LSB:
            if abs(size / lsb - 1) < ZERO_G:
                return "counts", lsb
    return None


def turn_about_a_point(accel, gyro, dps, rate_hz):
    """The Turn of gravity as turn_factor has it, in a body whose forces come along with its
    turning: a pendulum's points along its string, in which gravity does not show. All that a point
    of a body which turns about a fixed one feels is gravity and w x (w x r) + dw/dt x r; r is told
    for each scale that the gyro may have, and the scale by what is left."""
    m = max(1, int(rate_hz / 20))
    k = min(len(accel) // m, MOST_MOVED)
    if k < 20:
        return None
    a = accel[:k * m].reshape(k, m, 3).mean(axis=1, dtype=float)
    w = np.radians(gyro[:k * m].reshape(k, m, 3).mean(axis=1, dtype=float) * dps)
    size = np.linalg.norm(a, axis=1)
    usual = float(np.median(size))
    good = np.abs(size[LAG:] / max(usual, 1e-9) - 1) < KNOCKS
    good &= np.abs(size[:k - LAG] / max(usual, 1e-9) - 1) < KNOCKS
    if good.sum() < 10:
        return None

    # All is a polynomial in the factor, and so are the sums of squares of what is left.
    middle, lag_s = slice(LAG // 2, LAG // 2 + k - LAG), LAG * m / rate_hz
    rate = np.stack([w[j:j + k - LAG] for j in range(1, LAG + 1)]).mean(axis=0)[good]
    around, spin = cross_matrix(rate), cross_matrix(w) @ cross_matrix(w)
    twist = cross_matrix(np.gradient(w, m / rate_hz, axis=0))
    spun, twisted = ((x[LAG:] - x[:-LAG])[good] for x in (spin, twist))
    by_arm = [twisted, spun + lag_s * around @ twist[middle][good],
              lag_s * around @ spin[middle][good]]
    change = [(a[LAG:] - a[:-LAG])[good, :, None], lag_s * around @ a[middle][good, :, None]]
    every = np.concatenate(by_arm + change, axis=2).reshape(-1, 11)
    products = every.T @ every

    def left(factor):
        """(what is left of the changes of the force, the arm)."""
        powers = np.zeros((11, 4))
        powers[:9, :3] = np.concatenate([factor ** n * np.eye(3) for n in (1, 2, 3)])
        powers[9:, 3] = 1.0, factor
        gram = powers.T @ products @ powers
        arm = np.linalg.lstsq(gram[:3, :3], gram[:3, 3], rcond=None)[0]
        off = np.append(-arm, 1.0)
        return float(off @ gram @ off), arm

    best = min(FACTORS, key=lambda factor: left(factor)[0])
    near = best * np.geomspace(FACTORS[0] / FACTORS[1], FACTORS[1] / FACTORS[0], FINER)
    best = min(near, key=lambda factor: left(factor)[0])
    by_the_arm = (best ** 2 * spin + best * twist) @ left(best)[1]
    turn = turn_factor(a - by_the_arm, w, math.degrees(best), rate_hz / m)
    return turn and Turn(best * turn.factor, turn.alike, turn.number)


def turn_factor(accel, gyro, dps, rate_hz):
    """The Turn of gravity; None where nothing turns. dps: deg/s that one of the gyro's unit is.

    A direction that stands still in the world obeys du/dt = -w x u in a body that turns at w;
    least squares of one on the other over a fifth of a second.
    """
    m = max(1, int(rate_hz / 20))
    k = len(accel) // m
    if k < 20:
        return None
    k = min(k, MOST_TURNS)
    a = accel[:k * m].reshape(k, m, 3).mean(axis=1, dtype=float)
    w = np.radians(gyro[:k * m].reshape(k, m, 3).mean(axis=1, dtype=float) * dps)
    size = np.linalg.norm(a, axis=1)
    usual = float(np.median(size))
    if usual <= 0:
        return None
    u = a / np.maximum(size, 1e-9)[:, None]
    lag, number = LAG, k - LAG
    rate = np.stack([w[j:j + number] for j in range(1, lag + 1)]).mean(axis=0)
    middle = u[lag // 2:lag // 2 + number]
    by_gyro = -np.cross(rate, middle) * (lag * m / rate_hz)
    turned = u[lag:] - u[:number]
    good = (np.abs(size[lag:] / usual - 1) < 0.1) & (np.abs(size[:number] / usual - 1) < 0.1)
    good &= np.linalg.norm(turned, axis=1) > np.radians(2.0)    # what noise does not turn
    if good.sum() < 10:
        return None
    x, y = by_gyro[good].ravel(), turned[good].ravel()
    both = math.sqrt(float(x @ x) * float(y @ y))
    if both <= 0:
        return None
    return Turn(float(x @ y) / float(x @ x), float(x @ y) / both, int(good.sum()))
