"""The score of a set of hypotheses on the units of one sensor: evidence.py with the columns of all
members, those of each unit's own chosen one by one, and what was computed once kept.
"""
from dataclasses import dataclass, replace
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
        self._known, self._looked_at, self._priors = {}, {}, {}
        self._eliminations, self._tried = {}, {}
        self._positive = evidence.positive(units)

    def scored(self, forms):
        """Scored of a tuple of Forms."""
        found = self._empty
        for form in forms:
            found = self.extended(found, form)
        return found

    def extended(self, base, form):
        """Scored of a Scored set with one more Form; what is private in it stays as it is."""
        key = frozenset((*base.forms, form))
        if key not in self._known:
            self._known[key] = self._closer(self._looked_at.get(key) or self._rough(base, form))
        return self._known[key]

    def best(self, base, forms):
        """[(Form, Scored of a base with it)] of the Forms that come near to the best one, which
        is first. Found with few levels of noise, then looked at with all of them."""
        rough = sorted(enumerate(self._roughly(base, forms)),
                       key=lambda pair: (pair[1].score, pair[0]), reverse=True)
        self._looked_at.update((frozenset(one.forms), one) for _, one in rough)
        return sorted(((forms[place], self.extended(base, forms[place]))
                       for place, _ in rough[:NEAR]), key=lambda pair: -pair[1].score)

    @cached_property
    def _empty(self):
        return self._closer(self._rough(None, None))

    def _roughly(self, base, forms):
        """[_rough(base, form)] of many forms; those that only add shared columns are taken
        together."""
        found = [self._rough(base, one) if one.choices or one.free else None for one in forms]
        plain = [place for place, one in enumerate(found) if one is None]
        free = _free(base.forms)
        shared = [_distinct((*base.forms, forms[place])) for place in plain]
        for places in forms_at_once.by_size(shared).values():
            index, prior = (np.stack([getattr(shared[k], name) for k in places])
                            for name in ("index", "prior"))
            fits = [forms_at_once.fit(
                unit, statistics, index, prior, self._prior(number, free),
                self._levels_tried(number, free),
                self._elimination(number, base.private[number]))
                for number, (unit, statistics) in enumerate(zip(self.units, self.statistics))]
            scores = self._score(fits, evidence.Columns(index, prior))
            for number, k in enumerate(places):
                found[plain[k]] = Scored(
                    (*base.forms, forms[plain[k]]), float(scores[number]) - base.chances,
                    tuple(forms_at_once.one(fit, number) for fit in fits), base.private,
                    base.chances)
        return found

    def _rough(self, base, form):
        """Scored of a base with one more Form (both None: of no form), looked at with few levels
        of noise."""
        forms = () if base is None else (*base.forms, form)
        shared, free = _distinct(forms), _free(forms)
        fits, privates = [], []
        chances = 0.0 if base is None else base.chances
        for place, (unit, statistics) in enumerate(zip(self.units, self.statistics)):
            private = NONE if base is None else base.private[place]
            if form is not None and form.choices and not unit.between:
                private, nats = self._chosen(place, shared, private, form, free)
                chances += float(np.log(len(form.choices))) - nats
            fits.append(evidence.fit(
                unit, statistics, shared, private, self._prior(place, free),
                self._levels_tried(place, free), self._elimination(place, private)))
            privates.append(private)
        score = float(self._score(fits, shared)[0])
        return Scored(forms, score - chances, tuple(fits), tuple(privates), chances)

    def _closer(self, rough):
        """The Scored set looked at with all levels of noise around its likeliest."""
        free, fits = _free(rough.forms), []
        for place, (unit, fit) in enumerate(zip(self.units, rough.fits)):
            private = rough.private[place]
            fits.append(evidence.fit(
                unit, self.statistics[place], rough.shared, private, self._prior(place, free),
                unit.around(int(fit.index[0])), self._elimination(place, private)))
        score = float(self._score(fits, rough.shared)[0])
        return replace(rough, score=score - rough.chances, fits=tuple(fits))

    def _score(self, fits, shared):
        return evidence.score(fits, shared, self.units[0].apart, self._positive)

    def _prior(self, place, free):
        """(G,) log prior of one unit's grid, made once for what is free."""
        if (place, free) not in self._priors:
            self._priors[place, free] = self.levels.prior(self.units[place], free)
        return self._priors[place, free]

    def _levels_tried(self, place, free):
        """Points of one unit's grid that a set is first looked at with."""
        if (place, free) not in self._tried:
            unit, (quadratic, _) = self.units[place], self.statistics[place]
            self._tried[place, free] = unit.tried(
                -0.5 * quadratic[:, 0] - unit.logdet + self._prior(place, free))
        return self._tried[place, free]

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

    def _chosen(self, place, shared, private, form, free):
        """(private Columns with the likeliest choice of a form, nats that what the rests show
        within themselves says for it)."""
        unit, found = self.units[place], []
        elimination = self._elimination(place, private)
        # Integrated out by its prior a column is the same, shared or private.
        together = [shared + one for one in form.choices]
        for numbers in forms_at_once.by_size(together).values():
            likelihoods = forms_at_once.fit(
                unit, self.statistics[place], np.stack([together[n].index for n in numbers]),
                np.stack([together[n].prior for n in numbers]), self._prior(place, free),
                self._levels_tried(place, free), elimination).evidence
            for number, likelihood in zip(numbers, likelihoods.tolist()):
                within = unit.within.get((form.effect, number), 0.0)
                found.append((likelihood + within, number, within))
        _, number, within = max(found)
        return private + form.choices[number], within


def _free(forms):
    """Names of the levels that may be anything."""
    return frozenset().union(*(form.free for form in forms))


def _distinct(forms):
    """Shared Columns of all forms, each column once."""
    shared = NONE
    for form in forms:
        new = ~np.isin(form.shared.index, shared.index)
        shared = shared + evidence.Columns(form.shared.index[new], form.shared.prior[new])
    return shared
