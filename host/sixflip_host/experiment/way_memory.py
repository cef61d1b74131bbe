"""What remembers the way that a box was taken: what rubs, and what forgets a turn in its time.

What rubs lags behind the specific force of its axis, in ways that friction has: a play
operator [Krejci, Hysteresis, Convexity and Dissipation in Hyperbolic Equations (1996), chapter
II], and what slips the longer the way is [Dahl, Aerospace Corp. TOR-0158(3107-18)-1 (1968)]. Each
value depends on the one before, for as many as a session has tenths of a second: plain numbers are
faster here than arrays.
"""
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..capture.capture_file import Capture

PLAY_G = (0.1, 0.2, 0.4)  # widths of a play operator: octaves below half of what a pose changes by
SLIP_G = (0.5, 1.0)  # lengths of way over which what sticks begins to slip: half a move and one
UNMOVED_G = 0.02  # that is no way yet: several times the noise of STEP_S of a chip at rest
# g, of what levels off: at 1 g, the most that a box at rest feels, it has nearly done so.
LEVELLING, LEVELS_G = "levelling off", 0.5
FRICTION = (*("play %g g" % width for width in PLAY_G),
            *("slip %g g" % length for length in SLIP_G))
TURNED_S = (5.0, 20.0, 80.0)  # time constants in which a turn is forgotten
# s, step at which a memory follows the way: a hand takes a second and more from pose to pose, so
# the reading changes by about the narrowest width within it, at most.
STEP_S = 0.1


@dataclass(frozen=True, eq=False)
class Way:
    """The way of a capture in steps; t_s (N,) s of every sample. What remembers it is worked out
    once, when it is first asked for, for every Session of the same samples: their halves, and
    those that are judged with others."""

    capture: Capture
    rate: float
    t_s: np.ndarray

    @property
    def step(self):
        """Samples in a step."""
        return max(1, int(STEP_S * self.rate))

    @cached_property
    def friction(self):
        """(steps, len(FRICTION), 3): friction() behind the specific force of each axis."""
        return friction(self._means(self.capture.accel) / self.capture.meta["accel_lsb_per_g"])

    @cached_property
    def turned(self):
        """(steps, len(TURNED_S), 3): turned() about each axis, as the gyro tells it."""
        rate = self._means(self.capture.gyro) / self.capture.meta["gyro_lsb_per_dps"]
        if len(rate):
            rate -= np.median(rate, axis=0)  # the box rests most of the time
        ends = self.t_s[self.step - 1::self.step][:len(rate)]
        return turned(rate * self.step / self.rate, np.diff(ends, prepend=ends[:1]))

    def _means(self, values):
        """(steps, 3) means of values (N, 3) over each step."""
        steps = len(values) // self.step
        return values[:steps * self.step].reshape(steps, self.step, 3).mean(axis=1)


def levelling(f, friction):
    """{variant: (n, 3)} what follows a play and levels off, -1 to 1: a play operator under an
    envelope of its own [Al Janaideh, Rakheja & Su, Smart Mater. Struct. 18 (2009) 045001]. f
    (n, 3) g; friction (n, len(FRICTION), 3): the lags there."""
    return {"play %g g, %s" % (width, LEVELLING): np.tanh((f + width * friction[:, k]) / LEVELS_G)
            for k, width in enumerate(PLAY_G)}


def friction(f):
    """(n, len(FRICTION), 3) lags behind f (n, 3) g, -1 to 1."""
    return np.array([[*(_play(axis, width) for width in PLAY_G),
                      *(_slip(axis, length) for length in SLIP_G)]
                     for axis in f.T.tolist()]).transpose(2, 1, 0)


def turned(turn, seconds):
    """(n, len(TURNED_S), 3) quarter turns about each axis that are not forgotten: turn (n, 3)
    degrees in each step; seconds (n,) since the end of the step before it."""
    return np.array([[_kept((axis / 90.0).tolist(), np.exp(-seconds / tau).tolist())
                      for tau in TURNED_S] for axis in turn.T]).transpose(2, 1, 0)


def _kept(added, fades):
    """[what is left of all that was added, numbers, of which a share stays from each to the
    next]."""
    now, kept = 0.0, []
    for more, fade in zip(added, fades):
        now = now * fade + more
        kept.append(now)
    return kept


def _play(f, width):
    """[lag of the play operator of a width], f a list of numbers."""
    state, lags = f[0] if f else 0.0, []
    for now in f:
        # Not by min() and max(): to call them takes most of the time.
        if state < now - width:
            state = now - width
        elif state > now + width:
            state = now + width
        lags.append((state - now) / width)
    return lags


def _slip(f, length):
    """[lag of what slips after a length of way], f a list of numbers."""
    held, slack, lags = f[0] if f else 0.0, 0.0, []
    for now in f:
        way = now - held
        if abs(way) > UNMOVED_G:
            held, full = now, -math.copysign(length, way)  # full: where it has slipped for long
            slack = full + (slack - full) * math.exp(-abs(way) / length)
        lags.append(slack / length)
    return lags
