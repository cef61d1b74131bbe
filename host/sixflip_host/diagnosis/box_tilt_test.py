"""Crooked faces as a cause: tested beside the causes found, the box no longer a nuisance.

Twelve free angles take up much that is none: they are looked for last, where all else is
explained, nothing in the registers moves readings near zero, and no nonlinearity was found: what
its true form differs from the library's by would be called a crooked box (GAP 1).
"""
from dataclasses import replace

import numpy as np

from ..experiment import linear_model, nominal_rows
from . import aliases, coefficient_fits, cutoffs, hypotheses, odds, scored_sets
from .posterior import Posterior

LEAST_DEG = 0.1  # below that a placement by hand is as crooked
BENT = ("orientation", "amplitude")  # domains of what bends the reading itself


def possible(gap):
    """Whether a crooked box would be told from all else that a SensorGap shows."""
    if gap.unexplained or gap.drift or gap.model.conditions.coarse:
        return False
    if bent(gap.causes):
        return False
    return max(s.rounding_accel.max() for s in gap.sessions) <= nominal_rows.COARSE_MG


def bent(causes):
    """Whether one of the causes bends the reading itself."""
    return any(hypotheses.domain(c.effect) in BENT for c in causes)


def found(gap):
    """(list of Cause, Data they were found in) of a SensorGap of the accelerometer."""
    data, scored = _scored(gap, _certified(gap, few=True))
    # What gains less than any cost is spared the rest of the search, and a cost of its own.
    if scored is None or scored[1].score - scored[0].score <= cutoffs.LEAST_NATS:
        return [], data
    units = _certified(gap, few=False)
    data, (without, best) = _scored(gap, units)
    forms = hypotheses.of(units, gap.settings.without)
    cost = cutoffs.of(units, [f for f in forms if f.effect == "box_tilt"], gap.noise).member
    gain = best.score - without.score
    if gain <= cost:
        return [], data
    gains = dict.fromkeys((f.effect for f in best.forms), gain)
    places = {f.effect: odds.shares({"": cost, f.effect: gain}) for f in best.forms}
    said = Posterior(best, without, gap.cost, places, gains)
    return [c for c in aliases.causes(said, units, forms) if c.effect == "box_tilt"], data


def _certified(gap, few):
    """The units of a SensorGap with a box that is no nuisance; few: with the columns of the causes
    found and of the box alone, at levels of noise next to those found, else with those of every
    name, which may not be told from it, in the same places, at all levels."""
    looked_at = {form.effect for form in gap.found.best.forms}
    designs = gap.units[0].designs
    kept = [k for k, one in enumerate(designs) if one.effect in looked_at or (
        one.effect == "box_tilt" if few else not (one.generic or one.choices or one.beside))]
    first = np.cumsum([0] + [len(one.keys) for one in designs])
    wanted = None if few else np.concatenate([np.arange(first[k], first[k + 1]) for k in kept])
    units = []
    for one, point, (session, model) in zip(gap.units, gap.adequacy.index, gap.parts):
        near = [one.grid[k] for k in one.around(point)]
        levels = tuple(tuple(sorted(set(values))) for values in zip(*near))
        rows = replace(one.rows, nuisance=nominal_rows.accel_nuisance(session, model, True),
                       levels=levels if few else one.rows.levels)
        units.append(linear_model.unit(
            rows, [one.designs[k] for k in kept] if few else one.designs, wanted,
            signature=one.signature, within=one.within))
    return units


def _scored(gap, units):
    """(Data, (Scored without a crooked box, the best with one)); None instead of the two where no
    box can be told from the rest."""
    data = coefficient_fits.Data(units)
    forms = hypotheses.of(units, gap.settings.without)
    mine = [f for f in forms if f.effect == "box_tilt"]
    if not mine:
        return data, None
    model = scored_sets.Model(units, data.statistics, gap.noise)
    same = tuple(f for f in forms if any(
        (f.effect, f.variant, f.axis, f.record) == (c.effect, c.variant, None, c.record)
        for c in gap.found.best.forms))
    return data, (model.scored(same), max((model.scored((*same, f)) for f in mine),
                                          key=lambda s: s.score))
