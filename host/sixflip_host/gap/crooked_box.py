"""Crooked faces as a cause: tested beside the causes found, the box no longer a nuisance.

Twelve free angles take up much that is none: they are looked for last, where all else is
explained, nothing in the registers moves readings near zero, and no nonlinearity was found: what
its true form differs from the library's by would be called a crooked box (GAP 1).
"""
from . import classes, nominal_fit, regressors, selection, thresholds, which

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
    return any(regressors.DOMAIN[c.effect] in BENT for c in causes)


def found(gap):
    """(list of Cause, Data they were found in) of a SensorGap of the accelerometer."""
    units = [gap.unit(part, model, True) for part, model in gap.parts]
    data = which.Data(units)
    options = [o for o in which.candidates(units) if not o.generic
               and o.effect not in gap.settings.without]
    mine = [o for o in options if o.effect == "box_tilt"]
    if not mine:
        return [], data
    limit = thresholds.of(units, mine, gap.levels(data)).named
    same = _everywhere(options, gap.chosen)
    best, gain = selection.best_of(which.gains(data, mine, same))
    if best is None or gain <= limit:
        return [], data
    causes = classes.causes(data, options, same + [best])
    return [c for c in causes if c.effect == "box_tilt"], data


def _everywhere(options, chosen):
    """All axes and terms of the causes: here they show across gravity, too."""
    names = {c.effect for c in chosen}
    variants = {(c.effect, c.variant.rstrip("+")) for c in chosen}
    whole = [o for o in options if o.axis is None and o.effect in names
             and not o.variant.endswith("+")]
    return [o for o in whole if (o.effect, o.variant) in variants] + [
        o for o in whole if not o.variant and (o.effect, "") not in variants]
