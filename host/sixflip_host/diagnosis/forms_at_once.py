"""Fits of many forms at once, each with as many columns: a call of a function takes more time than
a form does. The one data set of a search is looked at with few levels of noise, and beside what a
set has already; the many that are simulated have their forms alone, or beside one stranger.

The same numbers as evidence.fit for each of them; a Fit here has the forms where that has data
sets, and of several data sets those of the first form, then those of the next.
"""
import numpy as np

from .. import progress
from . import evidence
from .elimination import Columns
from .evidence import Fit

MOST_TAKEN = 1.0 - 1e-9  # of a column by those before it: of the rest seven digits are right
HELD = 2 ** 22  # numbers in an array of what is fitted together: 32 MB


def fit(unit, statistics, index, prior, level, points, elimination=None):
    """Fit of F forms in one unit, in each of R data sets, of F * R: index, prior (F, k) of their
    columns; level (G,) log prior of its grid; points of the grid (P,); elimination: the
    Elimination of columns that are private, for all forms the same.

    Columns that all of them begin with, those of the set that the forms are tried beside, are
    factored once, and each form's own across them (a Schur complement: Bjorck, Numerical Methods
    for Least Squares Problems (1996), section 2.2.3).
    """
    number = _common(index, prior)
    if number:
        try:
            return _fit(unit, statistics, index, prior, level, points, elimination, number)
        except np.linalg.LinAlgError:
            pass  # nothing is left of a column but rounding
    return _fit(unit, statistics, index, prior, level, points, elimination, 0)


def _fit(unit, statistics, index, prior, level, points, elimination, number):
    """fit() with so many columns that all forms begin with."""
    quadratic, inner, logdet = (*statistics, unit.logdet) if elimination is None \
        else elimination.at(points)
    quadratic, logdet = quadratic[points], logdet[points]
    own, sets, forms = index[:, number:], quadratic.shape[1], len(index)
    gram = _products(unit, points, own, elimination)
    left, half = quadratic, np.zeros(len(points))
    explained = inner[points[:, None, None], own]
    schur = gram + evidence.diagonal(prior[:, number:] ** -2.0)
    if number:
        rows = index[0, :number]
        columns, place = np.unique(own, return_inverse=True)
        place = place.reshape(own.shape)
        base, beside = (_blocks(unit, points, rows, those, elimination)
                        for those in (rows, columns))
        factor = np.linalg.cholesky(base + np.diag(prior[0, :number] ** -2.0))
        white = np.linalg.solve(factor, np.concatenate(
            [inner[points[:, None], rows], beside], axis=2))
        left = quadratic - (white[:, :, :sets] ** 2).sum(axis=1)
        half = np.log(np.diagonal(factor, axis1=1, axis2=2)).sum(axis=1)
        across = white.transpose(0, 2, 1)[:, sets + place]
        taken = across @ across.transpose(0, 1, 3, 2)
        if (_diagonal(taken) > MOST_TAKEN * _diagonal(schur)).any():
            raise np.linalg.LinAlgError("a column that is one of those before")
        schur = schur - taken
        explained = explained - across @ white[:, None, :, :sets]
    grams, size = len(points) * forms, own.shape[1]
    left, own_half = evidence.known(
        schur.reshape(grams, size, size), explained.reshape(grams, size, sets),
        np.repeat(left, forms, axis=0))
    likelihood = -0.5 * left.reshape(-1, forms, sets) - (
        own_half.reshape(-1, forms) + half[:, None] + np.log(prior).sum(axis=1)
        + (logdet - level[points])[:, None])[..., None]
    best = likelihood.argmax(axis=0)
    every, data = (each.ravel() for each in np.indices(best.shape))
    best = best.ravel()
    whole = np.empty((len(best), index.shape[1], index.shape[1]))
    whole[:, number:, number:] = gram[best, every]
    if number:
        whole[:, :number, :number] = base[best]
        whole[:, number:, :number] = beside.transpose(0, 2, 1)[best[:, None], place[every]]
        whole[:, :number, number:] = whole[:, number:, :number].transpose(0, 2, 1)
    return Fit(points[best], quadratic[best, data],
               inner[points[best][:, None], index[every], data[:, None]], whole,
               logdet[best], level[points][best], likelihood[best, every, data])


def scores(units, statistics, columns, levels, points, what="", apart=False, bounded=None):
    """(F, R) evidence.score of each of these Columns (a list) in R data sets; levels: of each unit
    the log prior of its grid; points: of each unit those that are looked at; what: words for the
    progress; apart, bounded: as of evidence.score."""
    scored = np.empty((len(columns), len(statistics[0][0][0])))
    for places, index, prior in _parts(columns, scored.shape[1] * max(map(len, points)), what):
        fits = [fit(unit, sums, index, prior, level, own)
                for unit, sums, level, own in zip(units, statistics, levels, points)]
        of_each = Columns(*(np.repeat(own, scored.shape[1], axis=0) for own in (index, prior)))
        scored[places] = evidence.score(fits, of_each, apart, bounded).reshape(len(places), -1)
    return scored


def evidences(unit, statistics, columns, level, points):
    """(F, R) evidence of one unit with each of these Columns (a list), integrated out."""
    found = np.empty((len(columns), statistics[0].shape[1]))
    for places, index, prior in _parts(columns, found.shape[1] * len(points)):
        evidence_of_each = fit(unit, statistics, index, prior, level, points).evidence
        found[places] = evidence_of_each.reshape(len(places), -1)
    return found


def _parts(columns, each, what=""):
    """(places of some of these Columns (a list) that are as many, index (F, k), prior (F, k)), no
    more at a time than fit in HELD; each: numbers that a column takes."""
    parts = []
    for size, places in by_size(columns).items():
        most = max(1, HELD // (each * max(size, 1)))
        parts += [places[k:k + most] for k in range(0, len(places), most)]
    for places in progress.steps(parts, what) if what else parts:
        index, prior = (np.stack([getattr(columns[place], name) for place in places])
                        for name in ("index", "prior"))
        yield places, index, prior


def _common(index, prior):
    """How many columns all forms begin with, and have more than."""
    same = (index == index[0]).all(axis=0) & (prior == prior[0]).all(axis=0)
    return int(np.logical_and.accumulate(same).sum()) if not same.all() else 0


def _diagonal(matrices):
    return np.diagonal(matrices, axis1=-2, axis2=-1)


def _products(unit, points, index, elimination):
    """(P, F, k, k) of columns index (F, k), less what private columns take off."""
    places = {}  # forms may differ by prior only
    place = [places.setdefault(row.tobytes(), len(places)) for row in index]
    own = index[np.unique(place, return_index=True)[1]]
    gram = unit.gram.each(points, own)
    if elimination is not None:
        gram = gram - elimination.taken(points, own)
    return gram if len(own) == len(index) else gram[:, place]


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
