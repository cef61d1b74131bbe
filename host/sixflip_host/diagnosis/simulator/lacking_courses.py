"""What goes with time or temperature in the difference of two logs of one motion: a long rest of
the real sensor's own, whatever moves it, since the simulator's log takes off what it went through.

The best convention and the numbers are fitted without any course; the means of what they leave
over a second or more are judged as those of a rest are (rest_gap), with the flicker of two logs.
"""
from dataclasses import replace

import numpy as np

from ...experiment import block_measures, long_rest
from .. import adequacy, rest_gap
from .pairing import GRID_HZ
from .parameters import MG
from .sensor_axes import DEG

# Effects that a course can be: a walk of two logs is what each wanders by, and has no name here.
NAMES = frozenset(["thermal_bias", "thermal_rate", "thermal_scale", "warm_up"])
# Times what both logs wander by, root mean square, that a course has at least: what a rough floor
# or a mount leaves of a fit is as large, and has no time constant.
LEAST = 2.0
TWO_LOGS = np.sqrt(2.0)


def added(diagnosis):
    """The Diagnosis with a RestGap of each sensor that logs of one motion show to have a course,
    where its own rests show none."""
    rest = dict(diagnosis.rest)
    for kind in ("accel", "gyro"):
        if any(kind == sensor and NAMES & set(c.names) for sensor, c in diagnosis.causes):
            continue
        by_real = {c.against: c for c in sorted(
            diagnosis.comparisons, key=lambda c: c.alignment.correlation)
            if kind in c.fits and c.fits[kind].hypothesis.name}
        sessions = [s for s in diagnosis.sessions if s.name in by_real]
        if not sessions:
            continue
        chip = sessions[0].capture.meta["sensor"]
        course = of_logs(kind, sessions, [by_real[s.name] for s in sessions])
        if course is None or wandered(course, kind) < LEAST * TWO_LOGS * adequacy.usual(
                chip, kind):
            continue
        gap = rest_gap.of_one_sensor(course, kind, chip, diagnosis.settings, flickers=TWO_LOGS)
        causes = tuple(c for c in gap.causes if NAMES & set(c.names))
        if causes:
            letters = {letter for c in causes for letter in c.letters}
            rest[kind] = replace(gap, causes=causes, nameless=(), places=tuple(
                p for p in gap.places if p.axis in letters))
    return replace(diagnosis, rest=rest) if rest != diagnosis.rest else diagnosis


def of_logs(kind, sessions, comparisons):
    """long_rest.LongRest of the difference of each Session's log and the simulator's, or None
    where there is too little of it; mg or deg/s."""
    scale, parts = MG if kind == "accel" else DEG, []
    seconds = sum(float(len(c.fits[kind].pair.t)) for c in comparisons) / GRID_HZ
    length = max(1, int(GRID_HZ * max(seconds / long_rest.MEANS, long_rest.SHORTEST_S)))
    half = max(1, int(GRID_HZ * block_measures.SUBMEAN_S))
    for number, comparison in enumerate(comparisons):
        sensor_fit = comparison.fits[kind]
        fit, pair = replace(sensor_fit, own=None).refitted(None), sensor_fit.pair
        # In the real sensor's axes, and what it has more than the simulator.
        left = -scale * fit.left @ fit.axes / fit.unit
        number_of = np.arange(len(left)) // length
        for k in range(number_of[-1] + 1):
            x = left[number_of == k]
            if len(x) < max(2 * half, length // 2):
                continue
            short = x[:len(x) // half * half].reshape(-1, half, 3).mean(axis=1)
            t = float(comparison.alignment.of_simulator(pair.t[number_of == k].mean()))
            parts.append((t, len(x) / GRID_HZ, number, x.mean(axis=0),
                          short.std(axis=0, ddof=1) / np.sqrt(len(short))))
    if len(parts) < rest_gap.MEANS:
        return None
    t, lasted, number, means, noise = (np.array(x) for x in zip(*parts))
    thermometers = tuple(s.thermometer for s in sessions)
    temperature = None if None in thermometers else np.array(
        [float(thermometers[k].at(np.array([at]))[0]) for k, at in zip(number, t)])
    up = sum(c.fits[kind].pair.motion.up.mean(axis=0) for c in comparisons)
    typical = np.sqrt((noise ** 2).mean(axis=0))
    return long_rest.LongRest(t, lasted, number, number, temperature, {kind: means},
                              {kind: np.maximum(noise, typical)},
                              up / max(np.linalg.norm(up), 1e-9), thermometers)


def wandered(course, kind):
    """Of a LongRest, root mean square of its means about each log's, beyond their noise, of the
    axis that wanders most."""
    off = course.values[kind].copy()
    for k in np.unique(course.session):
        off[course.session == k] -= off[course.session == k].mean(axis=0)
    return float(np.sqrt(np.maximum((off ** 2 - course.noise[kind] ** 2).mean(axis=0), 0.0).max()))
