"""What hands, vehicles and robots shake: captures that move on, how much faster than the hand or
the wheels the sensor is shaken, and what runs beside it at a steady frequency; and a hand that
holds the box in some of its rests, and trembles, which is no effect of its sensors.

A hand trembles at 4 to 12 Hz at no steady frequency [Elble & Koller, Tremor (1990)], turns the box
by hundredths of a degree and hardly pushes it. That competes with something that shakes the gyro
whoever holds it: of that the rests have more or less, by chance as noise through a resonance has
(its power is exponential), and next to nothing in none of them. What pushes, too, is no hand.
"""
import copy
import math
from dataclasses import dataclass

import numpy as np
from scipy import special

from . import line_frequency, line_wander, rest_spectra, saturation, spectral_lines
from .detection import Finding, present

# A filter that lets a thousandth of the power through of what hands, legs and wheels do
# (spectral_lines.MOTION_HZ), and half or more of what is a fifth faster. Where a log has too few
# rows to show that it lets the last quarter of what it shows through: vibration folds into it. Of
# an odd order it lets nothing of a constant through; of an even one gravity is as loud as 1 mg.
STOPPED_DB, ORDER, HIGHEST = 30.0, 7, 0.75
WINDOW_S = 1.0  # a shaken second stands beside quiet ones; at 100 Hz it knows its level to 7 %
QUIET = 0.02  # share of the windows that counts as quiet
# Times the quiet level, root mean square, in at least half of the windows; and as many times what
# chance makes of few values in a window: of two, noise alone is eight times the quiet level.
SHAKEN, ABOVE_CHANCE = 3.0, 2.0
# Of the power of all that is fast, below which that is not what shakes it: jerks are, or the end
# of a rest, and what lies between is next to none of it.
LEAST = 0.1
FEWEST_WINDOWS = 8  # of which half and one quiet one are compared
TREMBLES_HZ = (4.0, 12.0)
HALF_HZ = 2.0  # around its middle, where a tremor is
# Of the mean power of all placements, below which one is not shaken: of noise through a resonance
# three in a hundred are by chance.
STILL = 0.03
SHORTEST_S = 1.0  # of a rest whose power there is looked at: eight periods


@dataclass(frozen=True)
class Moving:
    """What a session is to those who look for lines, of its longest stretch without a rest."""

    name: str
    capture: object
    rate: float
    runs: tuple = ()


def findings(sessions):
    """list of Finding: vibration of captures without poses."""
    return shaken(sessions) or steady(sessions)


def steady(sessions):
    """list of Finding: a line of the accelerometer that is there where nothing rests, steady in
    its frequency, which no motion of a hand, a vehicle or a robot is, but that of legs."""
    moves = [move for move in map(_longest_move, sessions) if move]
    if not moves or any(s.capture.accel is None for s in sessions):
        return []
    lines = [line_frequency.refined(line, moves, "accel") for line in (
        spectral_lines.strongest(moves, "accel", axis) for axis in range(3)) if line]
    lines = line_wander.without_strides([line for line in lines if line.steady], moves)
    return [spectral_lines.told(lines, "accel", moves[0].rate)] if lines else []


def _longest_move(session):
    """Moving, or None where there is too little of it."""
    edges = [0, *(edge for run in session.runs for edge in (run.first, run.end)),
             len(session.capture)]
    first, end = max(zip(edges[::2], edges[1::2]), key=lambda part: part[1] - part[0])
    if end - first < rest_spectra.FEWEST * rest_spectra.MOVING_S * session.rate:
        return None
    cut = copy.copy(session.capture)
    cut.accel = cut.accel[first:end] if cut.accel is not None else None
    return Moving(session.name, cut, session.rate)


def shaken(sessions):
    """list of Finding: from what is faster than any motion of a hand, legs or a vehicle, where
    nothing is cut off: a rail is quiet by itself."""
    levels, fewest = [], np.inf
    if any(session.capture.accel is None for session in sessions):
        return []
    for session in sessions:
        m = max(8, int(WINDOW_S * session.rate))
        # Of a window's values so many are independent, as of all frequencies so many are faster.
        fewest = min(fewest, m * (1.0 - edge(session.rate) / (0.5 * session.rate)))
        x = session.capture.accel.astype(float) * (1000.0 / session.capture.meta[
            "accel_lsb_per_g"])
        k = len(x) // m
        if k < FEWEST_WINDOWS:
            return []
        fast = _fast(x, session.rate)
        whole = ~saturation.railed(session)[:k * m].reshape(k, m).any(axis=1)
        if whole.sum() < FEWEST_WINDOWS:
            return []
        levels.append(np.sqrt((fast[:k * m].reshape(k, m, 3)[whole] ** 2).mean(axis=1)))
    level = np.concatenate(levels)
    quiet = np.quantile(level, QUIET, axis=0)
    usual = np.median(level, axis=0)
    chance = float(np.sqrt(special.chdtri(fewest, 0.5) / special.chdtri(fewest, 1.0 - QUIET)))
    times = usual / np.maximum(quiet, 1e-9)
    if times.max() <= max(SHAKEN, ABOVE_CHANCE * chance):
        return []
    # One thing shakes them all, or it shakes some: an axis is as loud as the loudest or as chance
    # has it, whichever is nearer; and louder than that by itself in any case.
    axes = np.flatnonzero(times > min(max(SHAKEN, ABOVE_CHANCE * chance),
                                      np.sqrt(chance * times.max())))
    value, interval, score, power = {}, {}, 0.0, []
    for i in axes:
        ranked = np.sort(level[:, i])
        ends = ranked[list(ends_of_median(len(ranked)))]
        value["xyz"[i]] = float(_amplitude(usual[i], quiet[i]))
        interval["xyz"[i]] = tuple(float(_amplitude(end, quiet[i])) for end in ends)
        # Half of the windows above a level that QUIET of them are below, if they were alike.
        mean = float((level[:, i] ** 2).mean()) - quiet[i] ** 2
        power.append((min(usual[i] ** 2 - quiet[i] ** 2, mean), mean))
        score += 0.5 * len(ranked) * np.log(0.25 / (QUIET * (1.0 - QUIET)))
    steadily, all_of_it = np.sum(power, axis=0)
    if steadily < LEAST * all_of_it:
        return []
    return [Finding("vibration", "accel", sorted(value), value, "mg", score, "frequency",
                    "it is shaken most of the time", interval, share=float(steadily / all_of_it))]


def ends_of_median(number):
    """Ranks of the 90 % interval of a median of so many [Conover, Practical Nonparametric
    Statistics]."""
    off = 0.5 * 1.645 * np.sqrt(number)
    return int(max(0.5 * number - off, 0)), int(min(0.5 * number + off, number - 1))


def edge(rate):
    """Hz from which on what is faster than motion is looked at."""
    return min(spectral_lines.MOTION_HZ, HIGHEST * rate / 2.0)


def _fast(x, rate):
    """(n, 3) what of readings (n, 3) is faster than motion."""
    from scipy import signal  # it takes a second to import
    return signal.sosfiltfilt(signal.cheby2(
        ORDER, STOPPED_DB, edge(rate), "highpass", fs=rate, output="sos"), x, axis=0)


def _amplitude(level, quiet):
    """Amplitude of a sine that lifts the root mean square from quiet to level."""
    return np.sqrt(2.0 * max(level ** 2 - quiet ** 2, 0.0))


def without_tremor(findings, sessions):
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
