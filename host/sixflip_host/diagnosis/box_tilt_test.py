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
    looked_at = {form.effect for form in gap.found.best.forms}
    designs = gap.units[0].designs
    first = np.cumsum([0] + [len(one.keys) for one in designs])
    wanted = np.concatenate([np.arange(start, start + len(one.keys))
                             for start, one in zip(first, designs)
                             if not (one.generic or one.choices) or one.effect in looked_at])
    units = [linear_model.unit(
        replace(one.rows, nuisance=nominal_rows.accel_nuisance(session, model, True)),
        one.designs, wanted, signature=one.signature, within=one.within)
        for one, (session, model) in zip(gap.units, gap.parts)]
    data = coefficient_fits.Data(units)
    forms = hypotheses.of(units, gap.settings.without)
    mine = [f for f in forms if f.effect == "box_tilt"]
    if not mine:
        return [], data
    model = scored_sets.Model(units, data.statistics, gap.noise)
    same = tuple(f for f in forms if any(
        (f.effect, f.variant, f.axis, f.record) == (c.effect, c.variant, None, c.record)
        for c in gap.found.best.forms))
    without = model.scored(same)
    best = max((model.scored((*same, f)) for f in mine), key=lambda s: s.score)
    gain = best.score - without.score
    # What gains less than any cost is spared the simulation of its own.
    cost = cutoffs.LEAST_NATS if gain <= cutoffs.LEAST_NATS else cutoffs.of(
        units, mine, gap.noise).member
    if gain <= cost:
        return [], data
    gains = dict.fromkeys((f.effect for f in best.forms), gain)
    places = {f.effect: odds.shares({"": cost, f.effect: gain}) for f in best.forms}
    said = Posterior(best, without, gap.cost, places, gains)
    return [c for c in aliases.causes(said, units, forms) if c.effect == "box_tilt"], data
