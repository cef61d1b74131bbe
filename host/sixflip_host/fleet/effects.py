"""What a board's rests say of each effect's size, found or not: information instead of verdicts.

A population cannot be made of what was found in single boards: what is too small there is
missing, and what was found is too large. So every board gives, for the same columns, the precision
Λ = S' C^-1 S and the score Λ θ = S' C^-1 z of the diagnosis' own linear model, summed over its
sessions (experiment/linear_model.py), over the levels of placement and flicker that it may have.
"""
from dataclasses import dataclass

import numpy as np

from sixflip_sim.effects.library import EFFECTS

from ..diagnosis import adequacy, evidence, hypotheses
from ..experiment import linear_model, nominal_rows, session_terms, terms
from ..json_numbers import spelled

# One form of each effect that rests can show, the likeliest cause first: where a protocol cannot
# tell two, the population names the first and says which others it may be.
FORMS = {
    "accel": (("thermal_bias", ""), ("quadratic", ""), ("cubic", ""), ("thermal_scale", ""),
              ("creep", "tau 60 s"), ("hysteresis", ""), ("warm_up", "tau 120 s")),
    "gyro": (("thermal_bias", ""), ("g_sensitivity", ""), ("warm_up", "tau 120 s"),
             ("hysteresis", ""))}
NEGLIGIBLE = 7.0  # nats: of levels that are a thousand times less likely than the best
FLOOR = 1000.0  # times its prior: what a column that shows nothing is known to
MATRIX = tuple(a + b for a in "xyz" for b in "xyz")  # gyro axis, then accelerometer axis


def _keys(effect):
    return MATRIX if effect == "g_sensitivity" else tuple("xyz")


NAMES = {sensor: tuple("%s.%s.%s" % (sensor, effect, key) for effect, _ in forms
                       for key in _keys(effect)) for sensor, forms in FORMS.items()}


@dataclass(frozen=True, eq=False)
class Information:
    """precision (k, k) and score (k,) of the coefficients NAMES[sensor]; zero where a board's
    sessions say nothing."""

    precision: np.ndarray
    score: np.ndarray


def nothing(sensor):
    """Information of no session."""
    k = len(NAMES[sensor])
    return Information(np.zeros((k, k)), np.zeros(k))


def unit(name):
    """The library's unit of a coefficient, for people."""
    sensor, effect, _ = name.split(".")
    return spelled(EFFECTS[effect].units[sensor])


def information(rests, chip, gaps=None):
    """({sensor: Information}, remarks) of the UsableRests of one board. gaps: {sensor:
    SensorGap} of their diagnosis, whose units need not be made again."""
    told = {sensor: nothing(sensor) for sensor in FORMS}
    if not rests.nominal:
        return told, [*rests.remarks, "too few rests in known poses: no effects"]
    agreed = session_terms.agreed(rests.sessions)
    for sensor in FORMS:
        if any(getattr(one, sensor) is None for one in agreed):
            continue
        if gaps and sensor in gaps:
            units = [unit for unit in gaps[sensor].units if not unit.between]
        else:
            units = [_unit(sensor, *part, rests.reference_c, chip)
                     for part in zip(agreed, rests.nominal)]
        told[sensor] = _of_units(sensor, units, chip)
    return told, list(rests.remarks)


def _unit(sensor, session, nominal, reference_c, chip):
    designs = [d for d in session_terms.library(session, nominal.up, sensor, reference_c, chip)
               if (d.effect, d.variant) in FORMS[sensor] and not d.record]
    if sensor == "accel":
        designs = terms.corrected(designs, nominal.matrix)
    return linear_model.unit(nominal_rows.rows(sensor, session, nominal), designs)


def _of_units(sensor, units, chip):
    columns, names, prior, start = [], [], [], 0
    for design in units[0].designs:
        if (design.effect, design.variant) in FORMS[sensor] and not design.record:
            columns += range(start, start + len(design.keys))
            names += ["%s.%s.%s" % (sensor, design.effect, key) for key in design.keys]
            prior += list(hypotheses.TYPICAL * design.prior)
        start += len(design.keys)
    place = [NAMES[sensor].index(name) for name in names]
    told = nothing(sensor)
    for unit in units:
        precision, score = averaged(unit, np.array(columns, dtype=int), np.array(prior),
                                    adequacy.levels(chip, sensor).flicker)
        told.precision[np.ix_(place, place)] += precision
        told.score[place] += score
    return told


def averaged(unit, columns, prior, usual):
    """(precision (k, k), score (k,)) of columns of a linear_model.Unit, over the levels of
    placement and flicker that it may have: a session of ten minutes does not tell slow noise
    well, and the likeliest level alone would make its estimates too sure. usual: of flicker, for
    the chip; its logarithm's standard deviation is evidence.USUAL_FACTOR's.

    Estimates and covariances at the points of the coarse grid and around its best one are
    averaged by their restricted likelihood, what they differ by among themselves is added.
    """
    first = unit.tried(_alone(unit, usual))
    best = first[int(np.argmax(_likelihood(unit, first, columns, prior, usual)))]
    points = np.union1d(first, unit.around(best))
    likelihood = _likelihood(unit, points, columns, prior, usual)
    points = points[likelihood > likelihood.max() - NEGLIGIBLE]
    weight = np.exp(_likelihood(unit, points, columns, prior, usual) - likelihood.max())
    weight /= weight.sum()
    floor = np.diag((FLOOR * prior) ** -2.0)
    spread = np.linalg.inv(unit.gram.blocks(points, columns, columns) + floor)
    each = (spread @ unit.inner[points][:, columns, None])[:, :, 0]
    mean = weight @ each
    away = each - mean
    whole = np.einsum("g,gij->ij", weight, spread) + np.einsum("g,gi,gj->ij", weight, away, away)
    precision = np.linalg.inv(whole)
    return precision - floor, precision @ mean


def _likelihood(unit, points, columns, prior, usual):
    """Restricted log likelihood at points of the grid [Patterson & Thompson 1971], and the prior
    of the flicker."""
    full = unit.gram.blocks(points, columns, columns) + np.diag(prior ** -2.0)
    inner = unit.inner[points][:, columns]
    taken = (inner * np.linalg.solve(full, inner[:, :, None])[:, :, 0]).sum(axis=1)
    return _alone(unit, usual)[points] + 0.5 * taken - 0.5 * np.linalg.slogdet(full)[1]


def _alone(unit, usual):
    """(G,) the same at every point without any effect."""
    flicker = np.array([level for _, level in unit.grid])
    known = -0.5 * (np.log(flicker / usual) / np.log(evidence.USUAL_FACTOR["flicker"])) ** 2
    return known - 0.5 * unit.quadratic - unit.logdet
