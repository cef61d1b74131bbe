"""What the numbers that are told close of the gap of two logs of one motion, and no others: what a
user sets is what is said to differ, so the rest of the simulator stays as it is. Numbers of which
none differs by itself may do so together: a bias that a log of one attitude does not tell from a
scale, the scale of the one axis that a table turns about.
"""
from dataclasses import replace

import numpy as np

from .. import odds
from . import evidence_of_logs, hypotheses, own_effects, parameters, remaining_gap
from .alignment import errors, independent
from .parameters import MG
from .sensor_axes import DEG

SAME = 1e-5  # of a scale that does not differ: a tenth of a count at 1 g
NEAR = 1.1  # times the least left: what of several numbers leaves as little is told by evidence
MOSTLY = 0.5  # of an axis, that one is which is turned
SAME_BIAS = 1e-6  # m/s2 and rad/s, of a bias that does not: less than a count of any chip
# Standard deviations of what data sheets have, beyond which two parts do not differ: a fifth in
# scale between the axes of one, half of gravity in bias.
IMPOSSIBLE = 6.0
ALIKE = 9.21  # chi squared of two degrees of freedom, by chance more in one of a hundred


def told(sensor_fit, numbers, flicker):
    """The SensorFit in which only the numbers that differ are free, and what no two logs agree
    in: numbers within what each of them differs from itself by, and a course as wide as the
    flicker, mg or deg/s. numbers: list of Parameter of all sensors."""
    kind, h = sensor_fit.kind, sensor_fit.hypothesis
    unit = sensor_fit.fit.unit * (MG if kind == "accel" else DEG)
    columns, sizes = own_effects.of_time(kind, sensor_fit.pair.t, sensor_fit.pair.celsius)
    course = columns, np.minimum(sizes, flicker / unit / np.ptp(columns, axis=0))
    mine = [p for p in numbers if p.sensor == kind and p.name in ("bias", "scale", "misalignment")]
    # Where none of them was compared, as beside a wrong time step, nothing is known of what is
    # told; of turned axes each number is some of all.
    bias, shape = np.full(3, not mine or h.heading), np.full((3, 3), not mine or h.heading)
    for p in mine:
        free = p.differs or abs(p.difference) <= parameters.DIFFERS * p.least
        row = "xyz".index(p.axis[0])
        if p.name == "bias":
            bias[row] |= free
        else:
            shape[row, "xyz".index(p.axis[-1])] |= free
    axes = np.abs(sensor_fit.fit.axes)
    return replace(sensor_fit, own=course, hypothesis=replace(
        h, bias_sd=h.bias_sd if h.bias_sd is not None else np.where(
            axes @ bias > MOSTLY, hypotheses.BIAS[kind], SAME_BIAS),
        shape_sd=np.where(axes @ shape @ axes.T > MOSTLY,
                          hypotheses.SHAPE if h.shape_sd is None else h.shape_sd, SAME)))


def gap(numbers, fits, unmended, real, sim):
    """(The numbers, {sensor: told()}, {sensor: (before, after, noise alone)} of what they leave,
    frozenset of the sensors of which that goes on for seconds) of two Traces of one motion, and of
    the fits {sensor: SensorFit} with what the real one does not answer and unmended, without."""
    left = {kind: remaining_gap.not_foretold(sensor_fit) for kind, sensor_fit in fits.items()}
    attainable = remaining_gap.held_out(unmended, left, real, sim)
    numbers, of_told = together(numbers, fits, attainable, remaining_gap.wandering(fits, left),
                                real.flicker)
    left = {kind: remaining_gap.not_foretold(fit) for kind, fit in of_told.items()}
    return (numbers, of_told, remaining_gap.held_out(unmended, left, real, sim),
            remaining_gap.wandering(fits, left))


def of_gravity(numbers, g):
    """[sentence] where all three scales of the accelerometer differ by as much, within their
    intervals: of what moves little a scale is a gravity (m/s2) set otherwise as well."""
    scales = [p for p in numbers if (p.name, p.sensor) == ("scale", "accel") and p.differs]
    if len(scales) < 3:
        return []
    sizes = np.array([p.difference for p in scales])
    known = np.array([odds.Z_90 / (p.difference_interval[1] - p.difference) for p in scales]) ** 2
    mean = float(sizes @ known) / known.sum()
    if (sizes - mean) ** 2 @ known > ALIKE:
        return []
    return ["the scales of the accelerometer differ alike, by %.3g %%: a gravity of %.3f m/s² in "
            "the simulator, instead of %.3f, is as likely" % (mean, g / (1.0 + 0.01 * mean), g)]


def together(numbers, fits, gaps, wanders, flicker):
    """(The numbers, {sensor: told()} by them): where those told leave more of the gap of a sensor
    than all of them do, the fewest of the others that close it differ as well, the rest taken for
    equal. gaps {sensor: (before, after, noise alone)} with all numbers free; wanders: the sensors
    of which what is left then goes on for seconds, which no number is; flicker {sensor: mg or
    deg/s}."""
    of_told = {}
    for kind, sensor_fit in fits.items():
        of_told[kind] = told(sensor_fit, numbers, flicker[kind])
        before, after, noise = gaps[kind]
        enough = parameters.TOGETHER * noise
        if kind not in wanders:  # bumps shake each log: as far as all numbers close it
            enough = max(enough, before - odds.CLOSED * (before - after))
        left = remaining_gap.size(kind, remaining_gap.not_foretold(of_told[kind]))
        if sensor_fit.conventions or not after < enough < left:
            continue
        found = _closing(sensor_fit, numbers, enough, flicker[kind])
        if found:
            numbers = [parameters.alone(p, *found[p.name, p.axis]) if p.sensor == kind and (
                p.name, p.axis) in found else p for p in numbers]
            of_told[kind] = told(sensor_fit, numbers, flicker[kind])
    return numbers, of_told


def _closing(sensor_fit, numbers, enough, flicker):
    """{(name, axis) of a Parameter: (difference, standard error)} of the fewest that, beside those
    that differ, leave less of the gap than `enough`, mg or deg/s; none where more than FEW would
    have to."""
    kind, simulated = sensor_fit.kind, sensor_fit.pair.simulated(sensor_fit.kind)
    off = -told(sensor_fit, numbers, flicker).refitted(None).left
    scale, ones = (MG if kind == "accel" else DEG), np.ones(len(off))
    columns = {}
    for i, row in enumerate("xyz"):
        columns["bias", row] = i, ones, scale, hypotheses.BIAS[kind]
        for j, column in enumerate("xyz"):
            key = ("scale", row) if i == j else ("misalignment", row + column)
            columns[key] = i, simulated[:, j], 100.0 if i == j else DEG, hypotheses.SHAPE
    mine = {(p.name, p.axis): p for p in numbers if p.sensor == kind}
    given = [key for key in columns if key in mine and mine[key].differs]

    def likely(keys):
        """Log posterior with these free as well. (A fit's evidence leaves out what a scale below 1
        earns, which may be the real log's noise made less; which scale it is does not matter.)"""
        fit = told(sensor_fit, [replace(p, differs=key in given or key in keys)
                                for key, p in mine.items()], flicker).refitted(None)
        power = (fit.left[:, sensor_fit.live] ** 2).mean(axis=0)
        sizes = np.append(fit.shape / hypotheses.SHAPE, fit.bias / hypotheses.BIAS[kind])
        return -0.5 * (len(off) / sensor_fit.inflation * np.log(power).sum() + (sizes ** 2).sum())
    chosen, left, found = [], off, {}
    while scale * np.sqrt((left ** 2).mean()) > enough:
        tried = [[*chosen, key] for key in columns if key in mine and key not in (*given, *chosen)]
        if len(chosen) == parameters.FEW or not tried:
            return {}
        # Beside other numbers one may be what it is by chance alone.
        tried = [one for one in ((keys, *_regressed(off, columns, given, keys)) for keys in tried)
                 if all(abs(x) > odds.Z_90 * sigma for x, sigma in map(one[2].get, one[0]))]
        if not tried:
            return {}
        least = min(float((one[1] ** 2).sum()) for one in tried)
        near = [one for one in tried if (one[1] ** 2).sum() < NEAR * least]
        # What turns about one axis only may differ by the scale of that, or by many times as much
        # of what little another axis has of it.
        chosen, left, found = max(near, key=lambda one: likely(one[0])) if near[1:] else near[0]
    return {key: found[key] for key in chosen}


def _regressed(off, columns, given, keys):
    """((n, 3) what is left of off (n, 3) by these keys and those given, {key: (difference,
    standard error)}): each with its size in data sheets for a prior, as what next to nothing
    reads would be worth any number."""
    left, sizes = off.copy(), {}
    for i in range(3):
        mine = [key for key in (*given, *keys) if columns[key][0] == i]
        if mine:
            own = np.stack([columns[key][1] for key in mine], 1)
            known = np.array([columns[key][3] for key in mine]) ** -2.0
            noise = off[:, i] - own @ np.linalg.lstsq(own, off[:, i], rcond=None)[0]
            noise = max(noise.var() * independent(noise), 1e-30)
            size = np.linalg.solve(own.T @ own / noise + np.diag(known), own.T @ off[:, i] / noise)
            left[:, i] -= own @ size
            sigma = (np.maximum(errors(own, left[:, i]), 1e-15) ** -2.0 + known) ** -0.5
            for key, x, s in zip(mine, size, sigma):
                sizes[key] = columns[key][2] * x, columns[key][2] * s
    return left, sizes


def doubted(sensor_fit, noise2):
    """(probability, nats) that what a SensorFit says is something else, or None: it names a
    convention and does not close the gap, or needs numbers that no two parts differ by. A factor
    that all its axes have in common is a full scale, how they lie a mounting."""
    if sensor_fit.conventions and not remaining_gap.closes(sensor_fit, noise2):
        return sensor_fit.conventions[0].probability, sensor_fit.conventions[0].nats
    fit, live = sensor_fit.fit, sensor_fit.live
    usual = hypotheses.BIAS[sensor_fit.kind]
    if fit.hypothesis.bias_sd is not None:
        usual = np.maximum(usual, fit.hypothesis.bias_sd)
    factors = np.log(np.maximum(1.0 + np.diag(fit.shape)[live], evidence_of_logs.LEAST_FACTOR))
    beyond = max(np.abs(factors - np.median(factors)).max() / hypotheses.SHAPE,
                 np.abs((fit.bias / fit.unit / usual)[live]).max())
    nats = 0.5 * float(beyond) ** 2
    return (odds.probability(nats), nats) if beyond > IMPOSSIBLE else None
