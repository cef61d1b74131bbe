"""The score of a set of hypotheses on the units of one sensor: evidence.py with the columns of all
members, those of each unit's own chosen one by one, and what was computed once kept.
"""
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import evidence, forms_at_once
from .evidence import NONE

KEPT = 8  # eliminations of each unit that are kept
NEAR = 14  # forms that are looked at with all levels of noise


@dataclass(frozen=True)
class Scored:
    """A tuple of Forms with its score (nats), Fit of each unit, private Columns of each unit;
    chances: what choosing those cost, nats (in the score already)."""

    forms: tuple
    score: float
    fits: tuple
    private: tuple
    chances: float

    @property
    def shared(self):
        return _distinct(self.forms)

    @property
    def names(self):
        return frozenset(f.effect for f in self.forms)


class Model:
    """Units of one sensor with the statistics of one data set; scores sets of Forms."""

    def __init__(self, units, statistics, levels):
        self.units, self.statistics, self.levels = units, statistics, levels
        self._known, self._priors = {}, {}
        self._eliminations = {}

    def scored(self, forms):
        """Scored of a tuple of Forms."""
        found = self._empty
        for form in forms:
            found = self.extended(found, form)
        return found

    def extended(self, base, form, points=evidence.EVERY):
        """Scored of a Scored set with one more Form; what is private in it stays as it is.
        points: evidence.EVERY or COARSE, how finely the levels of noise are looked through."""
        key = (frozenset((*base.forms, form)), points)
        if key not in self._known:
            self._known[key] = self._extended(base, form, points)
        return self._known[key]

    def best(self, base, forms):
        """[(Form, Scored of a base with it)] of the Forms that come near to the best one, which
        is first. Found with few levels of noise, then looked at with all of them."""
        rough = sorted(((score, place) for place, score in enumerate(self._roughly(base, forms))),
                       reverse=True)
        near = [forms[place] for _, place in rough[:NEAR]]
        return sorted(((form, self.extended(base, form)) for form in near),
                      key=lambda pair: -pair[1].score)

    @cached_property
    def _empty(self):
        return self._extended(None, None, evidence.EVERY)

    def _roughly(self, base, forms):
        """[score (nats)] of a base with each of the forms, with few levels of noise; those that
        only add shared columns are taken together."""
        found = [None if one.choices or one.free else 0.0 for one in forms]
        plain = [place for place, score in enumerate(found) if score is not None]
        free = frozenset().union(*(f.free for f in base.forms))
        shared = [_distinct((*base.forms, forms[place])) for place in plain]
        for places in forms_at_once.by_size(shared).values():
            index, prior = (np.stack([getattr(shared[k], name) for k in places])
                            for name in ("index", "prior"))
            fits = [forms_at_once.fit(
                unit, statistics, index, prior, self._prior(number, free), unit.coarse,
                self._elimination(number, base.private[number]))
                for number, (unit, statistics) in enumerate(zip(self.units, self.statistics))]
            scores = evidence.score(fits, evidence.Columns(index, prior), self.units[0].apart)
            for k, score in zip(places, scores):
                found[plain[k]] = float(score) - base.chances
        return [self.extended(base, form, evidence.COARSE).score if score is None else score
                for form, score in zip(forms, found)]

    def _extended(self, base, form, points):
        forms = () if base is None else (*base.forms, form)
        shared = _distinct(forms)
        free = frozenset().union(*(f.free for f in forms)) if forms else frozenset()
        fits, privates = [], []
        chances = 0.0 if base is None else base.chances
        for place, (unit, statistics) in enumerate(zip(self.units, self.statistics)):
            level = self._prior(place, free)
            private = NONE if base is None else base.private[place]
            if form is not None and form.choices and not unit.between:
                private, nats = self._chosen(place, shared, private, form, level)
                chances += float(np.log(len(form.choices))) - nats
            made = self._elimination(place, private)
            fit = evidence.fit(unit, statistics, shared, private, level, evidence.COARSE, made)
            if points == evidence.EVERY:
                near = unit.around(int(fit.index[0]))
                fit = evidence.fit(unit, statistics, shared, private, level, near, made)
            fits.append(fit)
            privates.append(private)
        score = float(evidence.score(fits, shared, self.units[0].apart)[0])
        return Scored(forms, score - chances, tuple(fits), tuple(privates), chances)

    def _prior(self, place, free):
        """(G,) log prior of one unit's grid, made once for what is free."""
        if (place, free) not in self._priors:
            self._priors[place, free] = self.levels.prior(self.units[place], free)
        return self._priors[place, free]

    def _elimination(self, place, private):
        """evidence.Elimination of private columns from one unit, made once."""
        if not len(private):
            return None
        key = (place, private.index.tobytes(), private.prior.tobytes())
        if key not in self._eliminations:
            while len(self._eliminations) >= KEPT * len(self.units):
                del self._eliminations[next(iter(self._eliminations))]
            self._eliminations[key] = evidence.Elimination(
                self.units[place], self.statistics[place], private)
        return self._eliminations[key]

    def _chosen(self, place, shared, private, form, level):
        """(private Columns with the likeliest choice of a form, nats that what the rests show
        within themselves says for it)."""
        unit, found = self.units[place], []
        elimination = self._elimination(place, private)
        # Integrated out by its prior a column is the same, shared or private.
        together = [shared + one for one in form.choices]
        for numbers in forms_at_once.by_size(together).values():
            likelihoods = forms_at_once.fit(
                unit, self.statistics[place], np.stack([together[n].index for n in numbers]),
                np.stack([together[n].prior for n in numbers]), level, unit.coarse,
                elimination).evidence
            for number, likelihood in zip(numbers, likelihoods.tolist()):
                within = unit.within.get((form.effect, number), 0.0)
                found.append((likelihood + within, number, within))
        _, number, within = max(found)
        return private + form.choices[number], within


def _distinct(forms):
    """Shared Columns of all forms, each column once."""
    shared = NONE
    for form in forms:
        new = ~np.isin(form.shared.index, shared.index)
        shared = shared + evidence.Columns(form.shared.index[new], form.shared.prior[new])
    return shared
