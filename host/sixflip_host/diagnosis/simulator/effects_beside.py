"""Layers two and three of one motion together: what an effect adds to the readings is neither a
bias nor a scale. Both logs are fitted once more with the effects found as columns, so that the
simulator's parameters are those it has beside them; of names that the rests do not tell apart,
the one is put in whose form both logs bear out best.
"""
from dataclasses import dataclass, replace
from itertools import islice, product

import numpy as np

from sixflip import STANDARD_G
from sixflip.poses import faces
from sixflip_sim.effects.library import EFFECTS

from ...experiment import noise_arrays, terms
from .. import closed_loop, odds
from ..hypotheses import Form, columns_of
from . import conventions, hypotheses, pairing, parameters

# Standard errors within which the share of an effect in the difference is none, so that both logs
# have it, if it is also as far from all of it: either is wrong in one of 370 (normal).
BOTH = 3.0
FLAT, RESTS_DPS = 0.966, 2.0  # cosine of 15 deg, as the simulator has a face; slower is a rest
SAME = 1e-5  # of a scale that does not differ: a tenth of a count at 1 g
MOST_SETS = 16  # of names that classes may stand for, tried: each takes a fit of the whole log
WARMING_S = 10.0  # over which the temperature's rate is taken: a thermometer has steps


@dataclass(frozen=True)
class Beside:
    """An effect of a sensor as the difference of two logs of one motion shows it: value and
    interval {key: ...} in unit, real less simulated; shape: the library's other parameters;
    stands_for: all names of its class."""

    effect: str
    sensor: str
    value: dict
    interval: dict
    unit: str
    shape: dict
    stands_for: tuple


def beyond(diagnosis):
    """The Diagnosis with the effects of its Comparisons."""
    return replace(diagnosis, comparisons=tuple(
        _compared(comparison, diagnosis) for comparison in diagnosis.comparisons))


def _compared(comparison, diagnosis):
    """The Comparison with its effects, and bias, scale and misalignment beside them."""
    for kind, sensor_fit in comparison.fits.items():
        mine = [c for sensor, c in diagnosis.causes if sensor == kind and c.plausible]
        names = _likeliest(kind, sensor_fit, mine, diagnosis)
        if names:
            comparison = _beside(comparison, kind, names, diagnosis)
    return comparison


def _beside(comparison, kind, names, diagnosis):
    """The Comparison with the effects names ([(name, Cause)]) of one sensor, and its bias, scale
    and misalignment beside them. What does not differ is the same in both when the sizes are
    taken: a cubic is much like a scale."""
    sensor_fit = comparison.fits[kind]
    fit, _ = _fitted(kind, sensor_fit, names, diagnosis)
    numbers = parameters.shapes(comparison.real, comparison.simulated,
                                {kind: replace(sensor_fit, fit=fit)}, {kind: True})
    known = {(p.name, p.axis): p for p in numbers if p.sensor == kind}
    differs = np.array([[any(p.differs for p in numbers if p.sensor == kind and p.axis in (
        a + b, a * (a == b)) and p.name in ("scale", "misalignment")) for b in "xyz"]
        for a in "xyz"])
    same = replace(sensor_fit, hypothesis=replace(
        sensor_fit.hypothesis, shape_sd=np.where(differs, hypotheses.SHAPE, SAME)))
    return replace(
        comparison, effects=comparison.effects + _sizes(
            kind, *_fitted(kind, same, names, diagnosis), names, diagnosis),
        parameters=tuple(known.get((p.name, p.axis), p) if p.sensor == kind else p
                         for p in comparison.parameters))


def in_both(diagnosis):
    """{sensor: [(effect, variant, key, coefficient)]} of the causes of a Diagnosis that two logs
    of one motion show to be in the simulator as well: of what such a cause adds to the real
    readings, nothing is in their difference. Each log by itself may take one effect for several,
    and not alike, which is no gap between them."""
    shared = {}
    for comparison in diagnosis.comparisons:
        for kind, fit in comparison.fits.items():
            gap = diagnosis.gaps.get(kind)
            for cause in gap.causes if gap else ():
                if _is_in_both(kind, fit, cause, diagnosis):
                    shared.setdefault(kind, []).extend(_coefficients(gap, cause))
    return shared


def _coefficients(gap, cause):
    """[(effect, variant, key, coefficient)] of a cause of a SensorGap."""
    every = [(d.effect, d.variant, key) for d in gap.units[0].designs for key in d.keys]
    columns = columns_of(cause.chosen).index
    return [(*every[column], float(size)) for column, size in zip(columns, cause.theta)]


def _is_in_both(kind, sensor_fit, cause, diagnosis):
    names = (*terms.of_the_moment(kind), "box_tilt")
    if sensor_fit.hypothesis.name == "" or cause.effect not in names or not cause.value:
        return False
    design = _design(kind, cause.effect, cause, sensor_fit.pair, diagnosis)
    added = design.columns @ [cause.value.get(key, 0.0) for key in design.keys]
    fit = _fit(kind, sensor_fit, [replace(
        design, keys=["share"], columns=added[:, None], prior=np.ones(1))])
    share, sigma = fit.extra[-1], fit.extra_sigma[-1]
    return bool(abs(share) < BOTH * sigma < abs(1.0 - share))


def _likeliest(kind, sensor_fit, causes, diagnosis):
    """[(name, Cause)]: of each cause the name in whose form both logs bear it out best."""
    causes = [c for c in causes if any(name in terms.of_the_moment(kind) for name in c.names)]
    if sensor_fit.hypothesis.name == "" or not causes:
        return []
    sets = [list(zip(names, causes)) for names in islice(product(
        *([n for n in c.names if n in terms.of_the_moment(kind)] for c in causes)), MOST_SETS)
        if len(set(names)) == len(names)]
    if len(sets) < 2:
        return sets[0] if sets else []
    return max(sets, key=lambda names: _fit(kind, sensor_fit, [
        _design(kind, *named, sensor_fit.pair, diagnosis) for named in names]).log)


def _fitted(kind, sensor_fit, names, diagnosis):
    """(Fit, designs) of effects beside the parameters. An effect is a function of what acts,
    which the real readings are once it is taken off."""
    pair = sensor_fit.pair
    for _ in range(2):
        designs = [_design(kind, *named, pair, diagnosis) for named in names]
        fit = _fit(kind, sensor_fit, designs)
        pair = _less(kind, sensor_fit.pair, designs, fit)
    return fit, designs


def _less(kind, pair, designs, fit):
    """The Pair whose real log has not what a Fit says of the designs."""
    columns = _columns(kind, pair, designs)
    added = columns @ fit.extra[len(fit.extra) - columns.shape[2]:]
    if kind == "accel":
        return replace(pair, force=pair.force - added)
    return replace(pair, rate=pair.rate - added)


def _columns(kind, pair, designs):
    """(n, 3, k): what the designs add, m/s2 or rad/s for a unit of each size."""
    size = STANDARD_G / 1000.0 if kind == "accel" else np.pi / 180.0
    return size * np.concatenate([d.columns.reshape(len(pair.t), 3, -1) for d in designs], axis=2)


def _shape(name, cause, diagnosis):
    """{parameter: value}; another name of a class has no variant of its own."""
    form = cause if name == cause.effect else Form(name)
    shape = closed_loop.shape(form, diagnosis.conditions.reference_c)
    if name == "warm_up":
        shape.setdefault("tau_s", EFFECTS["warm_up"].shapes["tau_s"][0])
    return shape


def _design(kind, name, cause, pair, diagnosis):
    """terms.Design of an effect on a Pair's samples."""
    chip = diagnosis.sessions[0].capture.meta["sensor"]
    return terms.of_terms(name, kind, moment(pair), len(pair.t), chip=chip,
                          shape=_shape(name, cause, diagnosis))


def moment(pair):
    """Moment of arrays: what the real log of a Pair says."""
    m = noise_arrays.moment()
    m.t = pair.t
    m.f = tuple(pair.force.T / STANDARD_G)
    m.up = tuple(pair.motion.up.T)
    resting = np.linalg.norm(pair.rate, axis=1) < np.radians(RESTS_DPS)
    m.face = -1 + sum((face + 1) * (resting & (sign * m.up[axis] > FLAT))
                      for face, (axis, sign) in enumerate(zip(faces.AXIS, faces.SIGN)))
    m.w = tuple(np.degrees(pair.rate).T)
    if pair.celsius is None:
        m.temperature, m.temperature_rate = np.full(len(pair.t), 25.0), np.zeros(len(pair.t))
    else:
        m.temperature = pair.celsius
        rows = max(1, int(WARMING_S * pairing.GRID_HZ))
        smooth = np.convolve(np.pad(pair.celsius, rows, "edge"), np.hanning(2 * rows + 1) / rows,
                             "valid")
        m.temperature_rate = np.gradient(smooth, pair.t)
    return m


def _fit(kind, sensor_fit, designs):
    """Fit of the sensor's own hypothesis with the designs' columns beside it; what the real
    sensor may do besides is left out, since it would take their place."""
    h = sensor_fit.hypothesis
    wide = replace(h, columns=np.concatenate(
                       [h.columns, -_columns(kind, sensor_fit.pair, designs)], axis=2),
                   mean=np.concatenate([h.mean, *(np.zeros(len(d.keys)) for d in designs)]),
                   sd=np.concatenate([h.sd, *(d.prior for d in designs)]))
    rows = conventions.local_noise(sensor_fit.fit.left[:, sensor_fit.live])
    return replace(sensor_fit, hypothesis=wide, own=None).refitted(rows)


def _sizes(kind, fit, designs, names, diagnosis):
    """Effects of a Fit."""
    effects, start = [], len(fit.extra) - sum(len(d.keys) for d in designs)
    for design, (name, cause) in zip(designs, names):
        part = slice(start, start + len(design.keys))
        start = part.stop
        value = dict(zip(design.keys, fit.extra[part].tolist()))
        half = dict(zip(design.keys, (odds.Z_90 * fit.extra_sigma[part]).tolist()))
        effects.append(Beside(
            name, kind, value, {k: (v - half[k], v + half[k]) for k, v in value.items()},
            EFFECTS[name].units[kind], _shape(name, cause, diagnosis),
            tuple(cause.probabilities)))
    return tuple(effects)
