"""The half seconds at rest by which a sensor's noise is told.

What nobody labelled ends as a rest where either sensor is louder, so that noise in bursts, or
noise that grows for a while, is cut out of the rests that would show it. A hand, a knock or a
motor shakes both sensors; where one alone is louder the other one is as quiet as in the rests
before and after and reads the same, the louder one is white noise about what it reads there, and
nothing moves.
"""
import numpy as np

from ...capture.registers import SENSORS
from ...capture.rests import LOUDER_ONLY, ROUNDING, WHITE, joined
from .ringing import LIFTS_S, SETTLES_S

WINDOW_S = 0.5  # a touch or a step on the floor rings for less
# Of the rests before and after, by which what is read at rest is known: eight times the half
# second that is held against it, so that its own error counts little.
NEAR_S = 4.0


def window(session):
    """Samples of half a second."""
    return max(8, int(WINDOW_S * session.rate))


def windows(session, sensor):
    """((w, 3) counts², (w,) number of the rest, (w,) first sample) of a session's half seconds at
    rest, once the box has settled and before a hand takes it up: the mean square of the
    differences from one sample to the next. Where nobody labelled the poses of a box that was
    turned over, those are at rest as well in which it is only louder; a vehicle may move without
    a turn. Where one sensor alone is louder, nothing moves."""
    counts = getattr(session.capture, sensor)
    m = window(session)
    settles, lifts = (int(seconds * session.rate) for seconds in (SETTLES_S, LIFTS_S))
    power, place, begins = [np.zeros((0, 3))], [np.zeros(0, int)], [np.zeros(0, int)]
    runs = session.runs
    if not session.labelled and session.turned_over:
        runs = joined(session.capture, runs)
    for number, (_, first, end) in enumerate(runs):
        settled = first + settles
        x = np.diff(counts[settled:max(settled, end - lifts)].astype(float), axis=0)
        k = len(x) // m
        power.append((x[:k * m].reshape(k, m, 3) ** 2).mean(axis=1))
        place.append(np.full(k, number))
        begins.append(settled + m * np.arange(k))
    alone = _louder_alone(session, runs, sensor, m + 1)
    x = np.diff(counts[alone[:, :1] + np.arange(m + 1)].astype(float), axis=1)
    return (np.concatenate([*power, (x ** 2).mean(axis=1)]),
            np.concatenate([*place, alone[:, 1]]), np.concatenate([*begins, alone[:, 0]]))


def _louder_alone(session, runs, sensor, length):
    """(w, 2) first sample, and number of the rest before, of stretches of `length` samples between
    two of these Runs that nobody labelled, in which one sensor alone is louder."""
    found = [np.zeros((0, 2), int)]
    other = next(name for name in SENSORS if name != sensor)
    if session.labelled or getattr(session.capture, other) is None:
        return found[0]
    own, other = (getattr(session.capture, name).astype(float) for name in (sensor, other))
    near = int(NEAR_S * session.rate)
    for number, (before, after) in enumerate(zip(runs, runs[1:])):
        number_of = (after.first - before.end) // length
        if not number_of:
            continue
        parts = slice(before.end, before.end + number_of * length)
        at_rest = np.r_[max(before.first, before.end - near):before.end,
                        after.first:min(after.end, after.first + near)]
        quiet = (_same(other[parts], other[at_rest], length, other[at_rest].var(axis=0))
                 & _same(own[parts], own[at_rest], length, None))
        first = before.end + length * np.flatnonzero(quiet)
        found.append(np.stack([first, np.full(len(first), number)], 1))
    return np.concatenate(found)


def _same(counts, at_rest, length, noise):
    """(w,) whether stretches of `length` of counts (w length, 3) have the mean that they have at
    rest (n, 3), and noise of this variance (3,) at most; None: any white noise."""
    parts = counts.reshape(-1, length, 3)
    white = (np.diff(parts, axis=1) ** 2).mean(axis=1) / 2.0
    error = np.sqrt(white / length + at_rest.var(axis=0) / len(at_rest))
    moved = np.abs(parts.mean(axis=1) - at_rest.mean(axis=0)) > LOUDER_ONLY * error + ROUNDING
    louder = parts.var(axis=1) > WHITE * (white if noise is None else noise) + ROUNDING
    return ~(moved | louder).any(axis=1)
