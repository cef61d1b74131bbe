"""Layer three of one motion: what the real sensor does of itself as it moves, and the simulator
lacks. The best convention is fitted once more with the columns of each effect beside it; names
compete with each other, with nothing, and with what has no name: products, signs and forces in
every channel, and any bent line of each axis of the sensor's own. What has none is told as well.

What goes with time alone (warming up, a thermometer's, what fades) is beside all of them: two logs
tell it from a bias that wanders no better than one does (rest_gap).
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip import STANDARD_G
from sixflip_sim.effects.library import EFFECTS

from ...experiment import terms
from .. import adequacy, localisation, odds
from ..detect.detection import Finding
from ..effect_estimates import believable
from ..hypotheses import Form
from . import alignment as align_by
from . import conventions, effects_beside, own_effects, pairing, remaining_gap
from .parameters import DIFFERS, MG
from .sensor_axes import DEG

# Effects that are functions of what acts while a thing moves.
OF_MOTION = ("quadratic", "cubic", "cross_quadratic", "asymmetry", "g_sensitivity",
             "thermal_scale")
# Of these the form may be another one that is as large to both sides, by a little: |f|^1.5 lies
# between the two. What is odd may be a dead band or a soft end, and has no such room.
EVEN = ("quadratic", "asymmetry")
# Of the prior's width, ten times the typical size: what the logs make likeliest of them is taken,
# as of what has no name (conventions.sized).
WIDTHS = (1.0, 0.1, 0.01)
MOST = 2  # names of one sensor that are looked for: GAP.md's pairs
# That a log is cut into, half of them to be foretold from the others: each is as long as a rest
# with its move or longer, in which a box that lies otherwise than planned lies so all the time.
BLOCKS = 16
# Share of what is beyond the noise that a name has to account for: what leaves most of the gap is
# like the cause, and not it.
MOST_OF_IT = 0.5


@dataclass(frozen=True)
class Rival:
    """What may be there: names, () for nothing, "" among them for what has none; designs
    (terms.Design, ...) of those that have one; nuisance: (columns (n, q), sizes (q,)) of each
    channel; fit (evidence_of_logs.Fit) to one log."""

    names: tuple
    designs: tuple
    nuisance: tuple
    fit: object


def log_posterior(rivals):
    """Of one hypothesis by its Rivals of all logs, but for what all hypotheses have in common."""
    names = rivals[0].names
    prior = np.prod([conventions.prior(name or "unknown") for name in names]) if names else \
        conventions.PRIOR_HEALTHY
    return sum(r.fit.log for r in rivals) + np.log(prior)


def added(diagnosis):
    """The Diagnosis with a Finding of each effect that logs of one motion show and its rests have
    no name for, and a Place where what has no name either is in their difference."""
    findings, nameless = [], []
    for kind in ("accel", "gyro"):
        # Of several logs against one real one, whose noise and misfits they share, the nearest.
        by_real = {c.against: (c.fits[kind], c.gap[kind][2]) for c in sorted(
            diagnosis.comparisons, key=lambda c: c.alignment.correlation)
            if kind in c.fits and c.fits[kind].hypothesis.name}
        logs = list(by_real.values())
        named = _explained(kind, diagnosis)
        if not named and any(open_without(*log) for log in logs):
            found_here = found(kind, logs, diagnosis)
            findings, named = findings + found_here, bool(found_here)
        if logs and not named:
            nameless += without_name(kind, logs, diagnosis)
    return replace(diagnosis, findings=(*diagnosis.findings, *findings), nameless=(
        *diagnosis.nameless, *nameless)) if findings or nameless else diagnosis


def _explained(kind, diagnosis):
    return any(sensor == kind and cause.plausible and set(cause.names) & set(OF_MOTION)
               for sensor, cause in diagnosis.causes)


def found(kind, logs, diagnosis):
    """[Finding] of a sensor; logs: [(SensorFit, noise of both logs in the band, mg or deg/s, 0
    where that is unknown)]."""
    names = [name for name in OF_MOTION if name in terms.of_the_moment(kind)
             and name not in diagnosis.settings.without
             and (name != "thermal_scale" or all(f.pair.celsius is not None for f, _ in logs))]
    findings, held, pairs = [], (), [sensor_fit.pair for sensor_fit, _ in logs]
    while len(held) < MOST:
        weighed = [judged(kind, sensor_fit, held, names, diagnosis) for sensor_fit, _ in logs]
        hypotheses_of_all = list(zip(*(rivals for rivals, _, _ in weighed)))
        scores = np.array([log_posterior(rivals) for rivals in hypotheses_of_all])
        weights = np.exp(scores - scores.max()) / np.exp(scores - scores.max()).sum()
        told = sorted(((float(w), rivals) for w, rivals in zip(weights, hypotheses_of_all)
                       if len(rivals[0].names) > len(held) and "" not in rivals[0].names),
                      key=lambda x: -x[0])
        if sum(w for w, _ in told) < odds.HOLDS:
            break
        best, nothing = told[0][1], hypotheses_of_all[0]
        share, blocks = remaining_gap.earned(
            [blocks_of(fit, rows, a, b) for (_, fit, rows), a, b in zip(weighed, nothing, best)],
            [noise for _, noise in logs])
        if share < MOST_OF_IT:
            break
        held = best[0].names
        finding = _finding(kind, best, nothing, {r[0].names[-1]: w for w, r in told}, share,
                           blocks, logs, diagnosis)
        if not finding.axes:
            break
        findings.append(finding)
        # An effect is a function of what acts, which is what is read without the effect.
        logs = [(replace(sensor_fit, pair=effects_beside.less(kind, whole, r.designs, r.fit)), n)
                for r, (sensor_fit, n), whole in zip(best, logs, pairs)]
    return findings


def without_name(kind, logs, diagnosis):
    """[Place] of a sensor, logs as in found(): where what has no name, be it less than the noise,
    foretells a tenth of the power of what is left of blocks that its fit has not seen."""
    weighed = [judged(kind, sensor_fit, (), (), diagnosis) for sensor_fit, _ in logs]
    nothing, *others = zip(*(rivals for rivals, _, _ in weighed))
    best = max(others, key=log_posterior)
    nats = log_posterior(best) - log_posterior(nothing)
    if nats < odds.COST:
        return []
    blocks = [blocks_of(fit, rows, a, b) for (_, fit, rows), a, b in zip(weighed, nothing, best)]
    share, _ = remaining_gap.earned(blocks, [noise for _, noise in logs])
    before, after = (np.concatenate([x[k] for x in blocks]).sum() for k in (0, 1))
    return [localisation.Place(kind, None, "motion", share, odds.chance(nats))] \
        if share and after < odds.CLOSED * before else []


def open_without(sensor_fit, noise):
    """Whether more than the noise (mg, deg/s), by a tenth of its power, is left of a SensorFit."""
    fit = replace(sensor_fit, own=None).refitted(None)
    left = remaining_gap.size(sensor_fit.kind, fit.left[:, sensor_fit.live] / fit.unit)
    return left ** 2 * odds.CLOSED > noise ** 2


def judged(kind, sensor_fit, held, names, diagnosis):
    """([Rival] beside the effects held, the SensorFit that they were judged by, rows (n,)): by
    the noise of each sample, and how many are one, that the likeliest leaves."""
    weighed = replace(sensor_fit, inflation=1.0)
    best = max(_rivals(kind, weighed, held, names, diagnosis, None), key=lambda r: r.fit.log)
    left = _fitted(weighed, best.designs, best.nuisance, None).left[:, weighed.live]
    rows = pairing.local_noise(left)
    weighed = replace(weighed, inflation=align_by.independent(left / rows[:, None]))
    return _rivals(kind, weighed, held, names, diagnosis, rows), weighed, rows


def _rivals(kind, sensor_fit, held, names, diagnosis, rows):
    pair = sensor_fit.pair
    beside = tuple(_design(kind, name, pair, diagnosis) for name in held)

    def likeliest(names, designs, nuisances):
        """Rival with the width, and the nuisance, that make the logs likeliest."""
        return max((Rival(names, made, nuisance, _fitted(sensor_fit, made, nuisance, rows, False))
                    for width in (WIDTHS if designs else WIDTHS[:1])
                    for made in [(*beside, *(replace(d, prior=d.prior * width) for d in designs))]
                    for nuisance in nuisances), key=lambda r: r.fit.log)

    def widened(nuisance, more, widths):
        columns, sizes = more
        return [(np.concatenate([nuisance[0], columns], 1),
                 np.concatenate([nuisance[1], sizes * width])) for width in widths]

    def of_other_form(name, nuisance):
        return widened(nuisance, own_effects.bent(np.abs(readings)),
                       WIDTHS[1:]) if name in EVEN else []

    readings = pair.real(kind)
    none = np.zeros((len(pair.t), 0)), np.zeros(0)
    time = widened(none, own_effects.of_time(kind, pair.t, pair.celsius), WIDTHS)
    nothing = likeliest(held, (), time + [
        wide for name in held for each in time for wide in of_other_form(name, each)])
    common, rivals = nothing.nuisance, [nothing]
    for name in names:
        if name not in held:
            rivals.append(likeliest((*held, name), (_design(kind, name, pair, diagnosis),),
                                    [common, *of_other_form(name, common)]))
    for nameless in (own_effects.of_motion(kind, pair.force, pair.motion.rate, STANDARD_G),
                     own_effects.of_products(kind, pair.force, pair.motion.rate, STANDARD_G),
                     own_effects.bent(readings)):
        rivals.append(likeliest((*held, ""), (), widened(common, nameless, WIDTHS)))
    return rivals


def _design(kind, name, pair, diagnosis):
    return effects_beside.design(kind, name, Form(name), pair, diagnosis)


def _fitted(sensor_fit, designs, nuisance, rows, left=True):
    """Fit of the SensorFit's convention with effects and nuisance beside it."""
    return replace(effects_beside.wide(sensor_fit, designs), own=nuisance).refitted(rows, left)


def blocks_of(sensor_fit, rows, nothing, best):
    """(before, after) (b,): mean squares, (mg)2 or (deg/s)2, of what nothing and the best Rival
    leave of each block, by a fit that has not seen it; and how many samples it has."""
    pair, scale = sensor_fit.pair, MG if sensor_fit.kind == "accel" else DEG
    seconds = max(remaining_gap.FOLD_S, 1.001 * np.ptp(pair.t) / BLOCKS)
    block = ((pair.t - pair.t[0]) / seconds).astype(int)
    power = []
    for rival in (nothing, best):
        left = np.empty((len(pair.t), 3))
        for fold in (0, 1):
            hidden = np.where(block % 2 == fold, remaining_gap.UNSEEN, rows)
            fit = _fitted(sensor_fit, rival.designs, rival.nuisance, hidden)
            left[block % 2 == fold] = scale * fit.left[block % 2 == fold] / fit.unit
        power.append(np.bincount(block, (left[:, sensor_fit.live] ** 2).mean(axis=1)))
    size = np.bincount(block)
    return power[0][size > 0], power[1][size > 0], size[size > 0]


def _finding(kind, best, nothing, chances, share, blocks, logs, diagnosis):
    """Finding of the last name of a hypothesis by its Rivals of all logs; chances {name:
    probability} of those in its place."""
    name, keys = best[0].names[-1], best[0].designs[-1].keys
    chip = diagnosis.sessions[0].capture.meta["sensor"]
    level = np.sqrt(2.0) * adequacy.usual(chip, kind)  # by which both logs wander
    sizes, sigmas = np.swapaxes([effects_beside.of_fit(
        r.fit, r.designs, -1, level, sensor_fit.pair.t)
        for r, (sensor_fit, _) in zip(best, logs)], 0, 1)
    weights = sigmas ** -2.0
    mean = (weights * sizes).sum(axis=0) / weights.sum(axis=0)
    # An axis that has none of it is off by more than a 90 % interval once in ten.
    of_keys = zip(keys, mean.tolist(), (weights.sum(axis=0) ** -0.5).tolist())
    shown = [(k, v, s) for k, v, s in of_keys if abs(v) > DIFFERS * s]
    value, sigma = {k: v for k, v, _ in shown}, {k: s for k, _, s in shown}
    interval = {k: (v - odds.Z_90 * s, v + odds.Z_90 * s) for k, v, s in shown}
    axes = sorted({k[0] for k in value})
    kept, total = {}, 0.0
    for other, chance in chances.items():
        if total < odds.HOLDS:
            kept[other], total = chance, total + chance
    return Finding(
        name, kind, axes, value, EFFECTS[name].units[kind],
        sum(a.fit.log - b.fit.log for a, b in zip(best, nothing)), terms.DOMAIN[name],
        "differs from the simulator in the same motion by %s" % name.replace("_", " "),
        interval=interval, rivals={other: "" for other in kept if other != name},
        plausible=believable(name, chip, kind, value, sigma), share=share, number=blocks,
        place={**kept, "": max(0.0, 1.0 - total)})
