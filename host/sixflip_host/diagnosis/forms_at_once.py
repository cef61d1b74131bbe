"""Fits of many forms at once, each with as many columns, where the one data set of a search is
looked at with few levels of noise: a call of a function takes more time than a form does.

The same numbers as evidence.fit for each of them; a Fit here has the forms where that has data
sets.
"""
import numpy as np

from . import evidence
from .evidence import Fit


def fit(unit, statistics, index, prior, level, points, elimination=None):
    """Fit of F forms in one unit: index, prior (F, k) of their columns; level (G,) log prior of
    its grid; points of the grid (P,); elimination: the Elimination of columns that are private,
    for all forms the same."""
    forms, k = index.shape
    number = len(points) * forms
    quadratic, inner, logdet = (one[points] for one in (
        (statistics[0], statistics[1], unit.logdet) if elimination is None
        else elimination.at(points)))
    own, place = np.unique(index, axis=0, return_inverse=True)  # forms may differ by prior only
    gram = unit.gram.each(points, own)
    if elimination is not None:
        gram = gram - elimination.taken(points, own)
    gram = gram[:, place.ravel()]
    inner = inner[:, index, 0]
    left, half = evidence.known(
        (gram + evidence.diagonal(prior ** -2.0)).reshape(number, k, k),
        inner.reshape(number, k, 1),
        np.repeat(quadratic, forms, axis=0))
    likelihood = (-0.5 * left[:, 0] - half).reshape(-1, forms) \
        - np.log(prior).sum(axis=1) - (logdet - level[points])[:, None]
    best, every = likelihood.argmax(axis=0), np.arange(forms)
    return Fit(points[best], quadratic[best, 0], inner[best, every], gram[best, every],
               logdet[best], level[points][best], likelihood[best, every])


def one(fit, number):
    """Fit of one of the forms."""
    own = slice(number, number + 1)
    return Fit(fit.index[own], fit.quadratic[own], fit.inner[own], fit.gram[own],
               fit.logdet[own], fit.level[own], fit.evidence[own])


def by_size(columns):
    """{k: places of the Columns (a list) that are k}"""
    found = {}
    for place, one in enumerate(columns):
        found.setdefault(len(one), []).append(place)
    return found
