"""The parts of rests: the half seconds by which a sensor's noise is told, and the first and the
last seconds, which say what rings out after each move.

What nobody labelled ends as a rest where either sensor is louder, so that noise in bursts, or
noise that grows for a while, is cut out of the rests that would show it. A hand, a knock or a
motor shakes both sensors; where one alone is louder the other one is as quiet as in the rests
before and after and reads the same, the louder one is white noise about what it reads there, and
nothing moves.

A box that was just put down shakes for a moment, so the first second of a rest says nothing. What
goes on beyond it and fades, rest for rest, is no vibration, which runs on: it is said by the
domain time_since_move, with the frequency where it has one.
"""
import numpy as np
from scipy import special

from sixflip.poses.still_window import window_length

from ...capture import still_windows
from ...capture.registers import SENSORS
from ...capture.rests import Run
from .. import odds
from .detection import present

WINDOW_S = 0.5  # a touch or a step on the floor rings for less
# Of the rests before and after, by which what is read at rest is known: eight times the half
# second that is held against it, so that its own error counts little.
NEAR_S = 4.0
# Standard errors of a window's mean, in which nothing moved; its variance by that of white noise
# with the same steps from sample to sample, of which a tremor of 12 Hz has four times as much at
# 100 Hz; counts of a mean, and of a variance, that rounding makes.
LOUDER_ONLY, WHITE, ROUNDING = 5.0, 2.0, 0.5
SETTLES_S = 1.0  # of a box that was put down, twice as long as a touch rings
LIFTS_S = 0.5  # of a box that is taken up: a hand is on it before it moves
PART_S = 1.5  # of a rest, early and late
FEWEST = 12  # rests: the scatter of what they say is known to a fifth
GOES_ON = 0.5  # of a line's early power that is there late in a rest where something runs on
LEAST_SHARE = 0.25  # of the noise's standard deviation, as of a line: smaller is no matter


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


def joined(capture, runs):
    """The Runs that nobody labelled, made one where nothing moved between two of them: all that is
    read there is white noise about the mean of what is read at its two ends. So it is only louder
    than a rest is taken to be. Without a gyro a turn about the vertical would look like that."""
    whole, last = [], None
    for run in runs:
        if whole and _louder_only(capture, last, run):
            last, run = run, Run(run.code, whole.pop().first, run.end)
        else:
            last = run
        whole.append(run)
    return whole


def _louder_only(capture, before, after):
    """Whether nothing moves between two Runs, by every window as long as the board's."""
    length = window_length(capture.meta["rate_hz"], still_windows.POSE_SAMPLES)
    if capture.accel is None or capture.gyro is None or after.first - before.end < length:
        return False
    first, end = max(before.first, before.end - length), min(after.end, after.first + length)
    counts = np.hstack([s[first:end].astype(float) for s in (capture.accel, capture.gyro)])
    before, after = before.end - first, after.first - first
    near = np.vstack([counts[:before], counts[after:]])
    for start in [*range(before, after - length + 1, length), after - length]:
        window = counts[start:start + length]
        white, quiet = ((np.diff(x, axis=0) ** 2).mean(axis=0) / 2.0 for x in (window, near))
        error = np.sqrt(white / length + quiet / len(near))
        moved = np.abs(window.mean(axis=0) - near.mean(axis=0)) > LOUDER_ONLY * error + ROUNDING
        if (moved | (window.var(axis=0) > WHITE * white + ROUNDING)).any():
            return False
    return True


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


def fading(sessions, sensor, axis):
    """(nats, amplitude over the noise's standard deviation) of the first seconds of all rests
    being louder than their last ones. The logarithm of the ratio of both powers has a mean of 0
    over the rests where nothing fades [Student's t]."""
    ratios = []
    for session in sessions:
        settles, part = (int(seconds * session.rate) for seconds in (SETTLES_S, PART_S))
        counts = getattr(session.capture, sensor)[:, axis]
        ratios += [np.log(_power(counts[a + settles:a + settles + part])
                          / _power(counts[b - part:b]))
                   for _, a, b in session.runs if b - a >= settles + 2 * part]
    if len(ratios) < FEWEST:
        return 0.0, 0.0
    mean, error = np.mean(ratios), np.std(ratios, ddof=1) / np.sqrt(len(ratios))
    p = float(special.stdtr(len(ratios) - 1, -mean / max(error, 1e-9)))
    return -np.log(max(3.0 * p, odds.SMALLEST)), np.sqrt(2.0 * max(np.exp(mean) - 1.0, 0.0))


def ringing_axes(sessions):
    """[(sensor, axis letter, sentence, nats)] of what rings out after the moves."""
    rings = []
    for sensor, words in SENSORS.items():
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        for axis in range(3):
            nats, size = fading(sessions, sensor, axis)
            if present(nats) and size > LEAST_SHARE:
                rings.append((sensor, "xyz"[axis], "the %s axis of the %s rings for seconds after "
                              "the moves" % ("xyz"[axis], words), nats))
    return rings


def _power(x):
    """Mean square of counts (n,) about their straight line, rounding at the least."""
    course = np.linspace(-1.0, 1.0, len(x))
    x = x - x.mean()
    x = x - course * (x @ course) / (course @ course)
    return max(float((x ** 2).mean()), 1.0 / 12.0)


def fades(sessions, sensor, axis, hertz):
    """Whether a line of an axis has less than GOES_ON of its early power in the last seconds of
    the rests: it rings out, and does not run."""
    early, late = [], []
    for session in sessions:
        settles, part = (int(seconds * session.rate) for seconds in (SETTLES_S, PART_S))
        counts = getattr(session.capture, sensor)[:, axis].astype(float)
        wave = np.hanning(part) * np.exp(-2j * np.pi * hertz / session.rate * np.arange(part))
        for _, a, b in session.runs:
            if b - a >= settles + 2 * part:
                for powers, first in ((early, a + settles), (late, b - part)):
                    x = counts[first:first + part]
                    powers.append(abs((x - x.mean()) @ wave) ** 2)
    return bool(early) and np.mean(late) < GOES_ON * np.mean(early)


def fades_within(stretches, axis, cycles):
    """Whether a line of so many cycles a sample fades within the stretches, as what was just put
    down does."""
    x = np.array([s[:, axis] - s[:, axis].mean() for s in stretches])
    half = x.shape[1] // 2
    wave = np.hanning(half) * np.exp(-2j * np.pi * cycles * np.arange(half))
    early, late = (float((np.abs(part @ wave) ** 2).mean()) for part in (
        x[:, :half], x[:, -half:]))
    return late < GOES_ON * early
