"""Crooked faces as a cause: tested beside the causes found, the box no longer a nuisance.

Twelve free angles take up much that is none: they are looked for last, where all else is
explained, nothing in the registers moves readings near zero, and no nonlinearity was found: what
its true form differs from the library's by would be called a crooked box (GAP 1).
"""
from . import classes, cutoffs, hypotheses, nominal_fit, posterior, which
from .posterior import Posterior

LEAST_DEG = 0.1  # below that a placement by hand is as crooked
BENT = ("orientation", "amplitude")  # domains of what bends the reading itself


def possible(gap):
    """Whether a crooked box would be told from all else that a SensorGap shows."""
    if gap.unexplained or gap.drift or gap.settings.coarse:
        return False
    if bent(gap.causes):
        return False
    return max(s.rounding_accel.max() for s in gap.sessions) <= nominal_fit.COARSE_MG


def bent(causes):
    """Whether one of the causes bends the reading itself."""
    return any(hypotheses.domain(c.effect) in BENT for c in causes)


def found(gap):
    """(list of Cause, Data they were found in) of a SensorGap of the accelerometer."""
    units = [gap.unit(part, model, True) for part, model in gap.parts]
    data = which.Data(units)
    forms = hypotheses.of(units, gap.settings.without)
    mine = [f for f in forms if f.effect == "box_tilt"]
    if not mine:
        return [], data
    model = posterior.Model(units, data.statistics, gap.noise)
    same = tuple(f for f in forms if any((f.effect, f.variant, f.axis) == (
        c.effect, c.variant.rstrip("~"), None) for c in gap.found.best.forms))
    without = model.scored(same)
    best = max((model.scored((*same, f)) for f in mine), key=lambda s: s.score)
    gain = best.score - without.score
    if gain <= cutoffs.of(units, mine, gap.noise):
        return [], data
    gains = dict.fromkeys((f.effect for f in best.forms), gain)
    places = {f.effect: {f.effect: 1.0} for f in best.forms}
    said = Posterior(best, without, gap.cost, places, gains)
    return [c for c in classes.causes(said, units, forms) if c.effect == "box_tilt"], data
