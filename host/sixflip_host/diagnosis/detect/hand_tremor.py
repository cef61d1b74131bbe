"""A hand that holds the box in some of its rests, and trembles: a motion of the box, and no effect
of its sensors.

A hand trembles at 4 to 12 Hz at no steady frequency [Elble & Koller, Tremor (1990)], turns the box
by hundredths of a degree and hardly pushes it. That competes with something that shakes the gyro
whoever holds it: of that the rests have more or less, by chance as noise through a resonance has
(its power is exponential), and next to nothing in none of them. What pushes, too, is no hand.
"""
import math

import numpy as np

from .detection import present

TREMBLES_HZ = (4.0, 12.0)
HALF_HZ = 2.0  # around its middle, where a tremor is
# Of the mean power of all placements, below which one is not shaken: of noise through a resonance
# three in a hundred are by chance.
STILL = 0.03
SHORTEST_S = 1.0  # of a rest whose power there is looked at: eight periods


def without(findings, sessions):
    """(Findings without what a hand does, [sentence])."""
    lines = [f for f in findings if f.effect == "vibration"]
    if [f.sensor for f in lines] != ["gyro"] or not present(_nats(lines[0], sessions)):
        return findings, []
    hz = max(lines[0].lines, key=lambda line: line.nats).hz
    return [f for f in findings if f is not lines[0]], [
        "the gyro: in some of the rests the box trembles at about %.2g Hz, as in a hand" % hz]


def _nats(finding, sessions):
    """Nats of some placements being held by a hand and the others not over all being shaken by
    one thing, by their power; none where the frequency is no hand's, or steady."""
    if any(line.steady or not TREMBLES_HZ[0] <= line.hz <= TREMBLES_HZ[1]
           for line in finding.lines):
        return 0.0
    middle = float(np.median([line.hz for line in finding.lines]))
    axes = [line.axis for line in finding.lines]
    power = np.array([_power(session, run, axes, middle) for session in sessions
                      for run in session.runs if run.end - run.first >= SHORTEST_S * session.rate])
    if not len(power) or not power.any():
        return 0.0
    still, number = int((power < STILL * power.mean()).sum()), len(power)
    by_chance = -math.expm1(-STILL)
    if not by_chance * number < still < number:
        return 0.0
    return (still * math.log(still / number / by_chance)
            + (number - still) * math.log((number - still) / number / (1.0 - by_chance))
            - 0.5 * math.log(number))


def _power(session, run, axes, hz):
    """Counts² of a rest around a frequency, of all axes together."""
    x = session.capture.gyro[run.first:run.end, axes].astype(float)
    spectrum = np.abs(np.fft.rfft((x - x.mean(axis=0)) * np.hanning(len(x))[:, None], axis=0)) ** 2
    at = np.fft.rfftfreq(len(x), 1.0 / session.rate)
    return float(spectrum[np.abs(at - hz) <= HALF_HZ].sum()) / len(x) ** 2
