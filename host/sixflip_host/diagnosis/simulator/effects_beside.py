"""Layers two and three of one motion together: what an effect adds to the readings is neither a
bias nor a scale. Both logs are fitted once more with the effects found as columns, so that the
simulator's parameters are those it has beside them; of names that the rests do not tell apart,
and of the variants of one, that is put in whose form both logs bear out best.
"""
from dataclasses import dataclass, replace
from itertools import islice, product

import numpy as np

from sixflip_sim.effects.library import EFFECTS

from ...experiment import noise_arrays, session_terms, terms
from .. import closed_loop, effect_estimates, members
from ..detect.detection import Finding
from ..hypotheses import Form
from . import hypotheses, numbers_told, pairing, parameters, remaining_gap
from .parameters import MG
from .sensor_axes import DEG

MOST_SETS = 16  # of names that classes may stand for, tried: each takes a fit of the whole log
SCALE = {"accel": MG, "gyro": DEG}  # mg to a m/s2, deg/s to a rad/s
SELDOM = 0.01  # probability below which a form changes no interval


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
        mine += [f for f in diagnosis.findings if f.sensor == kind and f.plausible]
        names = _likeliest(kind, sensor_fit, mine, diagnosis)
        if names:
            names, others = _variants(kind, sensor_fit, names, comparison.real, diagnosis)
            comparison = _beside(comparison, kind, names, others, diagnosis)
    return comparison


def _beside(comparison, kind, names, others, diagnosis):
    """The Comparison with the effects names ([(name, Cause)]) of one sensor, others (_variants())
    of them that are as likely, and its bias, scale
    and misalignment, and what is left of the gap, beside them. A scale that does not differ is the
    same in both when the sizes are taken: a cubic is much like one."""
    sensor_fit = comparison.fits[kind]
    fit, _ = _fitted(kind, sensor_fit, names, comparison.real, diagnosis)
    numbers = parameters.shapes(comparison.real, comparison.simulated,
                                {kind: replace(sensor_fit, fit=fit)}, {kind: True},
                                beside=True)
    known = {(p.name, p.axis): p for p in numbers if p.sensor == kind}
    width = sensor_fit.hypothesis.shape_sd
    width = np.full((3, 3), hypotheses.SHAPE) if width is None else np.array(width)
    for i, axis in enumerate("xyz"):
        if not any(p.differs for p in numbers
                   if (p.sensor, p.name, p.axis) == (kind, "scale", axis)):
            width[i, i] = min(width[i, i], numbers_told.SAME)
    same = replace(sensor_fit, hypothesis=replace(sensor_fit.hypothesis, shape_sd=width))
    fit, designs = _fitted(kind, same, names, comparison.real, diagnosis)
    left = remaining_gap.not_foretold(numbers_told.told(
        wide(sensor_fit, designs), numbers, comparison.real.flicker[kind]))
    before, after, noise = comparison.gap[kind]
    wanders = remaining_gap.wandering({kind: sensor_fit}, {kind: left})
    turned = {c.sensor for c in parameters.bias_sign(numbers)}
    return replace(
        comparison, effects=comparison.effects + _sizes(
            kind, same, fit, designs, names, others, comparison.real, diagnosis),
        conventions=tuple(c for c in comparison.conventions
                          if (c.name, c.sensor) != ("bias_sign", kind) or kind in turned),
        gap={**comparison.gap, kind: (before, min(after, remaining_gap.size(kind, left)), noise)},
        wanders=comparison.wanders - {kind} | wanders,
        parameters=tuple(known.get((p.name, p.axis), p) if p.sensor == kind else p
                         for p in comparison.parameters))


def _likeliest(kind, sensor_fit, causes, diagnosis):
    """[(name, Cause)]: of each cause the name in whose form both logs bear it out best."""
    possible = terms.of_the_moment(kind)
    causes = [c for c in causes if any(name in possible for name in c.probabilities)]
    if sensor_fit.hypothesis.name == "" or not causes:
        return []
    sets = [list(zip(names, causes)) for names in islice(product(
        *([n for n in c.probabilities if n in possible] for c in causes)), MOST_SETS)
        if len(set(names)) == len(names)]
    if len(sets) < 2:
        return sets[0] if sets else []
    return max(sets, key=lambda names: fit_with(sensor_fit, [
        design(kind, *named, sensor_fit.pair, diagnosis) for named in names]).log)


def _variants(kind, sensor_fit, names, real, diagnosis):
    """(names ([(name, Cause)]), each Cause in the likeliest variant by the rests and both logs,
    [[(probability, Cause), ...]] of each in the others). Lag and size are one where a temperature
    fades as an exponential does: a lag, one of several, is as likely beforehand as none, which is
    said where it does as well."""
    names, others = list(names), [[] for _ in names]
    for place, (name, cause) in enumerate(names):
        variants = getattr(cause, "variants", ())
        if name != cause.effect or len(variants) < 2:
            continue
        forms = [replace(variant, variant=variant.chosen[0].variant, shape=variant.chosen[0].shape)
                 for _, variant in variants]
        logs = []
        for (p, _), form in zip(variants, forms):
            names[place] = name, form
            fit, _ = _fitted(kind, sensor_fit, names, real, diagnosis)
            lags = len(session_terms.LAGS_S) - 1 if form.variant.startswith("lag") else 1
            logs.append(np.log(p / lags) + noise_arrays.flicker_log_likelihood(
                sensor_fit.pair.t, SCALE[kind] * fit.left / fit.unit, real.flicker[kind]))
        best = int(np.argmax(np.array(logs) + [
            0.0 if form.variant else members.AS_WELL for form in forms]))
        weights = np.exp(np.array(logs) - max(logs))
        names[place] = name, forms[best]
        others[place] = [(float(w), form) for k, (w, form) in enumerate(zip(
            weights / weights.sum(), forms)) if k != best and w > SELDOM]
    return names, others


def _fitted(kind, sensor_fit, names, own, diagnosis):
    """(Fit, designs) of effects beside the parameters. An effect is a function of what acts,
    which the real readings are once it is taken off, and the forces once their OwnSensor's bias
    and scale are: the square of a reading with a bias is a scale besides."""
    pair = acting = replace(sensor_fit.pair,
                            force=(sensor_fit.pair.force - own.bias) @ own.accel.T)
    for _ in range(2):
        designs = [design(kind, *named, pair, diagnosis) for named in names]
        fit = fit_with(sensor_fit, designs)
        pair = less(kind, acting, designs, fit)
    return fit, designs


def less(kind, pair, designs, fit):
    """The Pair whose real log has not what a Fit says of the designs."""
    columns = _columns(kind, pair, designs)
    added = columns @ fit.extra[len(fit.extra) - columns.shape[2]:]
    if kind == "accel":
        return replace(pair, force=pair.force - added)
    return replace(pair, rate=pair.rate - added)


def _columns(kind, pair, designs):
    """(n, 3, k): what the designs add, m/s2 or rad/s for a unit of each size."""
    return np.concatenate([d.columns.reshape(len(pair.t), 3, -1) for d in designs],
                          axis=2) / SCALE[kind]


def _shape(name, cause, diagnosis):
    """{parameter: value}; another name of a class has no variant of its own, nor has what the
    motion shows (lacking_effects)."""
    form = Form(name) if name != cause.effect or isinstance(cause, Finding) else cause
    shape = closed_loop.shape(form, diagnosis.conditions.reference_c)
    if name == "warm_up":
        shape.setdefault("tau_s", EFFECTS["warm_up"].shapes["tau_s"][0])
    return shape


def design(kind, name, cause, pair, diagnosis):
    """terms.Design of an effect on a Pair's samples."""
    chip = diagnosis.sessions[0].capture.meta["sensor"]
    return terms.of_terms(name, kind, pairing.moment(pair), len(pair.t), chip=chip,
                          shape=_shape(name, cause, diagnosis))


def fit_with(sensor_fit, designs):
    """Fit of the sensor's own hypothesis with the designs' columns beside it; what the real
    sensor may do besides is left out, since it would take their place."""
    return replace(wide(sensor_fit, designs), own=None).refitted(
        pairing.local_noise(sensor_fit.fit.left[:, sensor_fit.live]))


def wide(sensor_fit, designs):
    """The SensorFit whose hypothesis has the designs' columns beside its own."""
    if not designs:
        return sensor_fit
    h = sensor_fit.hypothesis
    return replace(sensor_fit, hypothesis=replace(
        h, columns=np.concatenate(
            [h.columns, -_columns(sensor_fit.kind, sensor_fit.pair, designs)], axis=2),
        mean=np.concatenate([h.mean, *(np.zeros(len(d.keys)) for d in designs)]),
        sd=np.concatenate([h.sd, *(d.prior for d in designs)])))


def _sizes(kind, sensor_fit, fit, designs, names, others, own, diagnosis):
    """Effects of a Fit; of each an interval over its form and the others that stay as likely."""
    effects = []
    for place, (one, (name, cause)) in enumerate(zip(designs, names)):
        parts = [(1.0 - sum(p for p, _ in others[place]), fit, designs), *((p, *_fitted(
            kind, sensor_fit, [*names[:place], (name, form), *names[place + 1:]], own, diagnosis))
            for p, form in others[place])]
        sizes = np.array([of_fit(*part[1:], place, own.flicker[kind], sensor_fit.pair.t)
                          for part in parts])
        interval = {key: effect_estimates.ends(np.array([p for p, _, _ in parts]),
                                               *sizes[:, :, k].T)
                    for k, key in enumerate(one.keys)}
        value, keys = dict(zip(one.keys, sizes[0, 0].tolist())), parameters.told(interval)
        effects.append(Beside(
            name, kind, {key: value[key] for key in keys}, {key: interval[key] for key in keys},
            EFFECTS[name].units[kind], _shape(name, cause, diagnosis),
            tuple(cause.probabilities)))
    return tuple(effects)


def of_fit(fit, designs, place, level, t):
    """((k,) sizes, (k,) standard deviations with flicker, and with what an axis reads of the
    others' effects as far as its own readings go in proportion to theirs) of one of a Fit's
    designs."""
    after = sum(len(design.keys) for design in designs[place:])
    part = slice(len(fit.extra) - after, len(fit.extra) - after + len(designs[place].keys))
    columns, sizes = designs[place].columns.reshape(len(t), 3, -1), fit.extra[part]
    wander = level * noise_arrays.flicker_of_sizes(t, columns)
    own = columns - columns.mean(axis=0)
    added = own @ sizes
    across = np.einsum("nck,nd->kcd", own, added) * (1.0 - np.eye(3))
    crooked = np.sqrt((across ** 2).sum(axis=(1, 2))) / np.maximum(
        (own ** 2).sum(axis=(0, 1)), 1e-12)
    return sizes, np.sqrt(fit.extra_sigma[part] ** 2 + wander ** 2
                          + (hypotheses.SHAPE * crooked) ** 2)
