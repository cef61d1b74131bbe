"""What rings out after each move: power in the first seconds of the rests that the last ones lack.

A box that was just put down shakes for a moment, so the first second of a rest says nothing. What
goes on beyond it and fades, rest for rest, is no vibration, which runs on: it is said by the
domain time_since_move, with the frequency where it has one.
"""
import numpy as np
from scipy import special

from ...capture.registers import SENSORS
from .. import odds
from .detection import present

SETTLES_S = 1.0  # of a box that was put down, twice as long as a touch rings (noise_windows.py)
LIFTS_S = 0.5  # of a box that is taken up: a hand is on it before it moves
PART_S = 1.5  # of a rest, early and late
FEWEST = 12  # rests: the scatter of what they say is known to a fifth
GOES_ON = 0.5  # of a line's early power that is there late in a rest where something runs on
LEAST_SHARE = 0.25  # of the noise's standard deviation, as of a line: smaller is no matter


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
