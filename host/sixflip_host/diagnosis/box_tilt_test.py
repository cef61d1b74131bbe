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
    units = _certified(gap, few=True)
    data, scored = _scored(gap, units)
    if scored is None:
        return [], data
    without, best, cost = scored
    gain = best.score - without.score
    if gain <= cost:
        return [], data
    # Only now are the other names asked for, which may not be told from it.
    units = _certified(gap, few=False)
    data, (without, best, _) = _scored(gap, units, cost)
    gains = dict.fromkeys((f.effect for f in best.forms), gain)
    places = {f.effect: odds.shares({"": cost, f.effect: gain}) for f in best.forms}
    said = Posterior(best, without, gap.cost, places, gains)
    forms = hypotheses.of(units, gap.settings.without)
    return [c for c in aliases.causes(said, units, forms) if c.effect == "box_tilt"], data


def _certified(gap, few):
    """The units of a SensorGap with a box that is no nuisance; few: with the columns of the causes
    found and of the box alone, else with those of every name, in the same places."""
    looked_at = {form.effect for form in gap.found.best.forms}
    designs = gap.units[0].designs
    kept = [k for k, one in enumerate(designs) if one.effect in looked_at or (
        one.effect == "box_tilt" if few else not (one.generic or one.choices or one.beside))]
    first = np.cumsum([0] + [len(one.keys) for one in designs])
    wanted = None if few else np.concatenate([np.arange(first[k], first[k + 1]) for k in kept])
    return [linear_model.unit(
        replace(one.rows, nuisance=nominal_rows.accel_nuisance(session, model, True)),
        [one.designs[k] for k in kept] if few else one.designs, wanted,
        signature=one.signature, within=one.within)
        for one, (session, model) in zip(gap.units, gap.parts)]


def _scored(gap, units, cost=None):
    """(Data, (Scored without a crooked box, the best with one, its cost)); None instead of the
    three where no box can be told from the rest."""
    data = coefficient_fits.Data(units)
    forms = hypotheses.of(units, gap.settings.without)
    mine = [f for f in forms if f.effect == "box_tilt"]
    if not mine:
        return data, None
    model = scored_sets.Model(units, data.statistics, gap.noise)
    same = tuple(f for f in forms if any(
        (f.effect, f.variant, f.axis, f.record) == (c.effect, c.variant, None, c.record)
        for c in gap.found.best.forms))
    without = model.scored(same)
    best = max((model.scored((*same, f)) for f in mine), key=lambda s: s.score)
    if cost is None:
        # What gains less than any cost is spared the simulation of its own.
        cost = cutoffs.LEAST_NATS if best.score - without.score <= cutoffs.LEAST_NATS \
            else cutoffs.of(units, mine, gap.noise).member
    return data, (without, best, cost)
