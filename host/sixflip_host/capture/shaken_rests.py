"""Rests that a machine nearby, or noise, cuts into pieces: nothing turned and nothing went on
between two of them, and it was louder, or read something else all the while.

What moves turns, or comes up to its speed and loses it again. Second by second its mean rate or
its mean force then changes by more than noise as loud as it is there lets them. Where both are
alike from the first whole second to the last, the thing stood still, and what shook it is to be
judged as in every other rest. So it is where the force is alike but another one than at rest, for
long: a lift that starts has such a force for some seconds, but what it gains in speed it loses
again. What nothing makes up for is no speed.

Where the accelerometer sees a ripple all the time, no two windows of it read alike, and only the
gyro is as still as ever.
"""
import math
from dataclasses import replace

import numpy as np

from . import rests, still_windows
from .rests import Run

SECOND_S = 1.0  # whose means are held together: a vehicle comes up to its speed in one or more
FEWEST = 4  # whole seconds: the first and the last hold the begin and the end of what shakes it
# Whole seconds of another force: at 1 m/s2, where lifts, trams and trains end, they make 36 km/h.
LONG = 10
MADE_UP = 0.5  # share of all speed gained that is not lost again, below which it was a motion
# Standard errors of a mean of white noise with the same steps from sample to sample: of some
# thousand seconds with six axes each none is further off by chance (normal).
ALIKE = 5.0
ROUNDING = 0.5  # counts, of a mean
# By how much a mean changes besides: an accelerometer's by less, mg, than what comes up to 2.5
# cm/s within a second; a gyro's, deg/s, as where it warms by a third of a degree (typical.SIZES).
WANDERS = {"accel": 2.5, "gyro": 0.1}
# m/s from the slowest to the fastest, of what the accelerometer reads on a floor, on a table that
# somebody leans on, or of a supply, at most; s within which what drives has more.
SPEED, WITHIN_S = 0.07, 10.0
PIECES = 0.5  # of the time at rest, at most, that pieces make up
SCALES = {"accel": ("accel_lsb_per_g", 1000.0), "gyro": ("gyro_lsb_per_dps", 1.0)}


def joined(capture, runs):
    """list of Run: those that nobody labelled, made one where the thing stood still between two of
    them; the first and the last as far as it stood still before and after."""
    runs = list(runs)
    if capture.accel is None or capture.gyro is None or not runs:
        return runs
    start, end = Run(runs[0].code, 0, 0), Run(runs[-1].code, *[len(capture)] * 2)
    edges = [start, *runs, end]
    gained = [_gained(capture, *pair) for pair in zip(edges, edges[1:])]
    known = [speed for speed in gained if speed is not None]
    speeds = float(sum(np.linalg.norm(speed) for speed in known))
    moves = known and np.linalg.norm(sum(known)) < MADE_UP * speeds
    stood = [speed is not None and not (moves and speed.any()) for speed in gained]
    whole = [edges[0]]
    for run, still in zip(edges[1:], stood):
        whole[-1:] = [Run(run.code or whole[-1].code, whole[-1].first, run.end)] if still else [
            whole[-1], run]
    return [run for run in whole if run.end > run.first]


def _gained(capture, before, after):
    """(3,) mg s that a thing gained in speed between two Runs if what it reads there is its force:
    0 where the force is that at rest, None where it turned, or the force was another one from
    second to second. An empty Run is an end of the log."""
    second = max(1, int(SECOND_S * capture.meta["rate_hz"]))
    number = (after.first - before.end) // second
    if number < FEWEST or before.code != after.code:
        return None
    spare = (after.first - before.end - number * second) // 2
    between = slice(before.end + spare, before.end + spare + number * second)
    gained = np.zeros(3)
    for sensor, (scale, unit) in SCALES.items():
        counts = getattr(capture, sensor).astype(float)
        parts = counts[between].reshape(number, second, 3)
        means = parts[1:-1].mean(axis=1)
        # What comes up to a speed at once, and goes on at it, has its force at the edges only.
        edges = np.array([counts[k:k + second].mean(axis=0)
                          for k in (before.end, after.first - second)])
        # Of neighbours, also where a second has one row: then it is as uncertain as that.
        error = np.sqrt((np.diff(counts[between], axis=0) ** 2).mean(axis=0) / 2.0 / second)
        limit = ALIKE * error + WANDERS[sensor] * capture.meta[scale] / unit + ROUNDING
        ends = [counts[run.first:run.end].mean(axis=0) for run in (before, after)
                if run.end > run.first]
        at_rest, there = np.mean(ends, axis=0), np.median(means, axis=0)
        off = [means - there, ends - at_rest, edges - np.clip(
            edges, np.minimum(at_rest, there), np.maximum(at_rest, there))]
        if (np.abs(np.vstack(off)) > limit).any():
            return None
        if (np.abs(there - at_rest) > limit).any():
            if sensor == "gyro" or number < LONG:
                return None
            gained = (there - at_rest) * unit / capture.meta[scale] * number * SECOND_S
    return gained


def or_rippled(capture, found):
    """The rests.Found of a capture, or with the rests that the gyro alone tells where those found
    are so much less: they are the pieces that a ripple left of them."""
    if capture.gyro is None or found.noise is None:
        return found
    windows, sd = still_windows.cut_into_windows(capture), np.array(found.noise.sd)
    # Of the accelerometer's windows the last word is that of the speed.
    alike = [np.hstack([np.full((len(windows), 3), value), each[:, 3:]]) for value, each in (
        (0.0, windows.mean), (sd[:3] ** 2, windows.variance))]
    still, _ = still_windows.still(
        replace(windows, mean=alike[0], variance=alike[1]), found.noise)
    whole = [rests.rest(capture, first * windows.length, end * windows.length)
             for first, end in rests.stretches(still)
             if (end - first) * windows.length >= FEWEST * SECOND_S * capture.meta["rate_hz"]
             and _stands(windows.mean[first:end, :3] / capture.meta["accel_lsb_per_g"],
                         windows.length / capture.meta["rate_hz"], capture.g)]
    seconds = [sum(rest.end - rest.first for rest in each if not rest.by_hand)
               for each in (found.rests, whole)]
    if seconds[0] >= PIECES * seconds[1]:
        return found
    return replace(found, rests=tuple(rests.at_one_rate(capture, whole)))


def _stands(force, each_s, g):
    """Whether what reads force (n, 3) g, means over each_s s, comes up to no speed, and leans no
    more from one part to the next than it does where it wanders."""
    parts = np.array_split(force, math.ceil(len(force) * each_s / WITHIN_S))
    speed = max(float(np.ptp(np.cumsum(part - part.mean(axis=0), axis=0), axis=0).max())
                for part in parts)
    apart = np.abs(np.diff([part.mean(axis=0) for part in parts], axis=0))
    return speed * each_s * g < SPEED and not (apart > 2e-3 * WANDERS["accel"]).any()
