"""Where one sensor alone is louder than at rest: the other says that nothing moves.

What nobody labelled ends as a rest where either sensor is louder, so that noise in bursts, or
noise that grows for a while, is cut out of the rests that would show it. A hand, a knock or a
motor shakes both sensors; here the other one is as quiet as in the rests before and after and
reads the same, and the louder one is white noise about what it reads there.
"""
import numpy as np

from ...capture.registers import SENSORS
from ...capture.rests import LOUDER_ONLY, ROUNDING, WHITE

# Of the rests before and after, by which what is read at rest is known: eight times the half
# second that is held against it, so that its own error counts little.
NEAR_S = 4.0


def windows(session, runs, sensor, length):
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
