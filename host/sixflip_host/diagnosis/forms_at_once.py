"""Fits of many forms at once, each with as many columns, where the one data set of a search is
looked at with few levels of noise: a call of a function takes more time than a form does.

The same numbers as evidence.fit for each of them; a Fit here has the forms where that has data
sets.
"""
import numpy as np

from . import evidence
from .evidence import Fit


def fit(unit, statistics, index, prior, level, points, elimination=None, common=None):
    """Fit of F forms in one unit: index, prior (F, k) of their columns; level (G,) log prior of
    its grid; points of the grid (P,); elimination: the Elimination of columns that are private,
    for all forms the same.

    Columns that all of them begin with, those of the set that the forms are tried beside, are
    factored once, and each form's own across them (a Schur complement: Bjorck, Numerical Methods
    for Least Squares Problems (1996), section 2.2.3). common: how many those are, if known.
    """
    forms, number = index.shape[0], _common(index, prior) if common is None else common
    quadratic, inner, logdet = (values[points] for values in (
        (statistics[0], statistics[1], unit.logdet) if elimination is None
        else elimination.at(points)))
    own = index[:, number:]
    gram = _products(unit, points, own, elimination)
    left, explained, half = quadratic, inner[:, own, 0], np.zeros(len(points))
    schur = gram + evidence.diagonal(prior[:, number:] ** -2.0)
    if number:
        rows = index[0, :number]
        columns, place = np.unique(own, return_inverse=True)
        place = place.reshape(own.shape)
        base, beside = (_blocks(unit, points, rows, those, elimination)
                        for those in (rows, columns))
        try:
            factor = np.linalg.cholesky(base + np.diag(prior[0, :number] ** -2.0))
        except np.linalg.LinAlgError:  # by rounding, where priors are wide
            return fit(unit, statistics, index, prior, level, points, elimination, 0)
        white = np.linalg.solve(factor, np.concatenate([inner[:, rows], beside], axis=2))
        left = quadratic - (white[:, :, :1] ** 2).sum(axis=1)
        half = np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)
        across = white.transpose(0, 2, 1)[:, 1 + place]
        schur = schur - across @ across.transpose(0, 1, 3, 2)
        explained = explained - (across @ white[:, None, :, :1])[..., 0]
    grams, size = len(points) * forms, own.shape[1]
    left, own_half = evidence.known(
        schur.reshape(grams, size, size), explained.reshape(grams, size, 1),
        np.repeat(left, forms, axis=0))
    likelihood = (-0.5 * left[:, 0] - own_half).reshape(-1, forms) - half[:, None] \
        - np.log(prior).sum(axis=1) - (logdet - level[points])[:, None]
    best, every = likelihood.argmax(axis=0), np.arange(forms)
    whole = np.empty((forms, index.shape[1], index.shape[1]))
    whole[:, number:, number:] = gram[best, every]
    if number:
        whole[:, :number, :number] = base[best]
        whole[:, number:, :number] = beside.transpose(0, 2, 1)[best[:, None], place]
        whole[:, :number, number:] = whole[:, number:, :number].transpose(0, 2, 1)
    return Fit(points[best], quadratic[best, 0], inner[best[:, None], index, 0], whole,
               logdet[best], level[points][best], likelihood[best, every])


def _common(index, prior):
    """How many columns all forms begin with, and have more than."""
    same = (index == index[0]).all(axis=0) & (prior == prior[0]).all(axis=0)
    return int(np.logical_and.accumulate(same).sum()) if not same.all() else 0


def _products(unit, points, index, elimination):
    """(P, F, k, k) of columns index (F, k), less what private columns take off."""
    own, place = np.unique(index, axis=0, return_inverse=True)  # forms may differ by prior only
    gram = unit.gram.each(points, own)
    if elimination is not None:
        gram = gram - elimination.taken(points, own)
    return gram[:, place.ravel()]


def _blocks(unit, points, rows, columns, elimination):
    """(P, r, c) of columns rows (r,) with columns (c,), less what private columns take off."""
    gram = unit.gram.blocks(points, rows, columns)
    return gram if elimination is None else gram - elimination.block(points, rows, columns)


def fit_of_form(fit, number):
    """Fit of one of the forms."""
    own = slice(number, number + 1)
    return Fit(fit.index[own], fit.quadratic[own], fit.inner[own], fit.gram[own],
               fit.logdet[own], fit.level[own], fit.evidence[own])


def by_size(columns):
    """{k: places of the Columns (a list) that are k}"""
    places = {}
    for place, each in enumerate(columns):
        places.setdefault(len(each), []).append(place)
    return places
