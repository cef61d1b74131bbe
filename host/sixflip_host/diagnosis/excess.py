"""The excess: chi2 of what is read beyond its degrees of freedom, and which share of it goes with
a cause or with noise that wanders.
"""
import numpy as np

from . import evidence, hypotheses
from .elimination import NONE


def taken(unit, point, private):
    """Degrees of freedom that private columns take off."""
    if not len(private):
        return 0.0
    gram = unit.gram.at(point, private.index)
    return float(np.trace(np.linalg.solve(gram + np.diag(private.prior ** -2.0), gram)))


def at(units, statistics, chosen, index):
    """chi2 beyond the degrees of freedom with these Forms, at given points of the grids, each
    unit with sizes of its own."""
    shared, total = hypotheses.columns_of(chosen), 0.0
    for unit, (quadratic, projections), point in zip(units, statistics, index):
        total += quadratic[point, 0] - unit.freedom
        if len(shared):
            gram = unit.gram.at(point, shared.index) + np.diag(1.0 / shared.prior ** 2)
            inner = projections[point][shared.index, 0]
            total -= inner @ np.linalg.solve(gram, inner) - (~unit.silent[shared.index]).sum()
    return float(total)


def share(units, statistics, index, without, including):
    """Share (0 to 1) of the excess that is there with no cause at all, at the points `index` of
    the grids, that goes with one cause: it is there `without` it and not `including` it, both
    pairs of Forms and of points."""
    total, before, after = (at(units, statistics, forms, points)
                            for forms, points in (([], index), without, including))
    return float(np.clip((before - after) / max(total, before - after, 1e-9), 0.0, 1.0))


def share_of_drift(units, statistics, scored, chosen, index, levels):
    """share() of noise that wanders more than usual, beside the Forms chosen: of the excess over
    noise with no more flicker than evidence.Levels say, what goes with more of it and with the
    walk that a Scored set has."""
    quiet = usual_levels(units, index, levels.flicker)
    total = at(units, statistics, [], quiet)
    by_level = at(units, statistics, chosen, quiet) - at(units, statistics, chosen, index)
    walked = sum(_walked(*unit, choice.columns) for *unit, choices in zip(
        units, statistics, index, scored.chosen) for choice in choices
        if choice.form.effect == "drift")
    return float(np.clip((by_level + walked) / max(total, by_level + walked, 1e-9), 0.0, 1.0))


def _walked(unit, statistics, point, private):
    """chi2 that private columns take off beyond their degrees of freedom."""
    flat = np.zeros(len(unit.grid))
    before, after = (evidence.fit(unit, statistics, NONE, columns, flat,
                                  np.array([point]))
                     for columns in (NONE, private))
    return float(before.quadratic[0] - after.quadratic[0]) - taken(unit, point, private)


def usual_levels(units, index, flicker):
    """Indices of the grids' points with no more flicker than that (the least there is, if none),
    and the placement levels of the points `index`."""
    return [_usual(unit, point, flicker) for unit, point in zip(units, index)]


def _usual(unit, point, most):
    """Index of the point of a unit's grid that has no more flicker than that."""
    if unit.between:
        return point
    placement, flicker = unit.grid[point]
    low = [b for a, b in unit.grid if a == placement]
    low = [b for b in low if b <= most] or [min(low)]
    return unit.grid.index((placement, min(flicker, max(low))))
