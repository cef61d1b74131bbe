"""The score of a set of hypotheses on the units of one sensor: evidence.py with the columns of all
members, those of each unit's own chosen one by one, and what was computed once kept.
"""
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from . import evidence, forms_at_once
from .elimination import NONE, Columns, Elimination
from .hypotheses import distinct_columns

KEPT = 8  # eliminations of each unit that are kept
NEAR = 14  # forms that are looked at with all levels of noise
LEAST_GAIN = 1e-6  # nats of a choice made again: rounding has less


@dataclass(frozen=True)
class Choice:
    """Which of a form's choices a unit takes: number; within: nats, what the rests show of it
    within themselves."""

    form: object
    number: int
    within: float

    @property
    def nats(self):
        """What the choice is worth by itself."""
        return self.within + float(self.form.chances[self.number])

    @property
    def columns(self):
        """Private Columns."""
        return self.form.choices[self.number]


@dataclass(frozen=True)
class Scored:
    """A tuple of Forms with its score (nats), Fit of each unit, and a tuple of Choice of each unit
    (what those are worth is in the score)."""

    forms: tuple
    score: float
    fits: tuple
    chosen: tuple

    @property
    def shared(self):
        return distinct_columns(self.forms)

    @property
    def names(self):
        return frozenset(f.effect for f in self.forms)

    @property
    def private(self):
        """[Columns] of each unit."""
        return [_private(choices) for choices in self.chosen]


class Model:
    """Units of one sensor with the statistics of one data set; scores sets of Forms."""

    def __init__(self, units, statistics, levels):
        self.units, self.statistics, self.levels = units, statistics, levels
        self._known, self._looked_at, self._roughly_known, self._priors = {}, {}, {}, {}
        self._eliminations, self._tried = {}, {}
        self._positive = evidence.positive(units)

    def scored(self, forms):
        """Scored of a tuple of Forms."""
        return reduce(self.extended, forms, self._empty)

    def extended(self, base, form):
        """Scored of a Scored set with one more Form; what each session chooses for the others is
        chosen again beside it."""
        key = frozenset((*base.forms, form))
        if key not in self._known:
            rough = self._looked_at.get(key) or self._rough(base, form)
            self._known[key] = self._closer(self._rechosen(rough))
        return self._known[key]

    def best(self, base, forms):
        """[(Form, Scored of a base with it)] of the Forms that come near to the best one, which
        is first. Found with few levels of noise, then looked at with all of them."""
        known = self._roughly_known.setdefault((base.forms, base.chosen), {})
        new = [form for form in forms if form not in known]
        known.update(zip(new, self._roughly(base, new)))
        rough = sorted(enumerate(known[form] for form in forms),
                       key=lambda pair: (pair[1].score, pair[0]), reverse=True)
        self._looked_at.update((frozenset(scored.forms), scored) for _, scored in rough)
        return sorted(((forms[place], self.extended(base, forms[place]))
                       for place, _ in rough[:NEAR]), key=lambda pair: -pair[1].score)

    @cached_property
    def _empty(self):
        return self._closer(self._rough(None, None))

    def _roughly(self, base, forms):
        """[_rough(base, form)] of many forms; those that only add shared columns are taken
        together."""
        scored = [self._rough(base, form) if form.choices or form.free else None for form in forms]
        plain = [place for place, done in enumerate(scored) if done is None]
        free, private = _free(base.forms), base.private
        shared = [distinct_columns((*base.forms, forms[place])) for place in plain]
        for places in forms_at_once.by_size(shared).values():
            index, prior = (np.stack([getattr(shared[k], name) for k in places])
                            for name in ("index", "prior"))
            fits = [forms_at_once.fit(
                unit, statistics, index, prior, self._prior(number, free),
                self._levels_tried(number, free),
                self._elimination(number, private[number]))
                for number, (unit, statistics) in enumerate(zip(self.units, self.statistics))]
            scores = _worth(base.chosen) + evidence.score(
                fits, Columns(index, prior), self.units[0].apart, self._positive)
            for number, k in enumerate(places):
                scored[plain[k]] = Scored(
                    (*base.forms, forms[plain[k]]), float(scores[number]),
                    tuple(forms_at_once.fit_of_form(fit, number) for fit in fits), base.chosen)
        return scored

    def _rough(self, base, form):
        """Scored of a base with one more Form (both None: of no form), looked at with few levels
        of noise; what is private in the base stays as it is."""
        forms = () if base is None else (*base.forms, form)
        shared, free = distinct_columns(forms), _free(forms)
        likeliest, there = [], []
        for place, unit in enumerate(self.units):
            choices = () if base is None else base.chosen[place]
            added = [(one,) for one in self._choice(place, shared, choices, form, free)] \
                if form is not None and form.choices and not unit.between else ((), ())
            likeliest.append((*choices, *added[0]))
            there.append((*choices, *added[1]))
        # A session by itself has no need of what the others say it has.
        return max((self._fitted(forms, shared, free, chosen)
                    for chosen in dict.fromkeys([tuple(likeliest), tuple(there)])),
                   key=lambda scored: scored.score)

    def _fitted(self, forms, shared, free, chosen):
        """Scored of forms with these choices, looked at with few levels of noise."""
        return self._scored(forms, shared, chosen, [
            self._fit(place, shared, _private(choices), free, self._levels_tried(place, free))
            for place, choices in enumerate(chosen)])

    def _scored(self, forms, shared, chosen, fits):
        """Scored of forms with the evidence.Fit of each unit."""
        score = evidence.score(fits, shared, self.units[0].apart, self._positive)[0]
        return Scored(forms, float(score) + _worth(chosen), tuple(fits), chosen)

    def _fit(self, place, shared, private, free, points):
        """evidence.Fit of one unit at these points of its grid."""
        return evidence.fit(self.units[place], self.statistics[place], shared, private,
                            self._prior(place, free), points, self._elimination(place, private))

    def _rechosen(self, rough):
        """The Scored set with every session's choices made again beside all the others, as long
        as that makes it likelier: where a jump is depends on what else there is."""
        changed = len(rough.forms) > 1
        while changed:
            changed = False
            for form in (f for f in rough.forms if f.choices):
                chosen = tuple(self._with_choice(place, rough, form)
                               for place in range(len(self.units)))
                if chosen == rough.chosen:
                    continue
                other = self._fitted(rough.forms, rough.shared, _free(rough.forms), chosen)
                if other.score > rough.score + LEAST_GAIN:
                    rough, changed = other, True
        return rough

    def _with_choice(self, place, scored, form):
        """The choices of one unit with that of a form made again."""
        choices = scored.chosen[place]
        others = tuple(choice for choice in choices if choice.form != form)
        if len(others) == len(choices):
            return choices
        best, _ = self._choice(place, scored.shared, others, form, _free(scored.forms))
        return tuple(best if choice.form == form else choice for choice in choices)

    def _closer(self, rough):
        """The Scored set looked at with all levels of noise around its likeliest."""
        shared, free = rough.shared, _free(rough.forms)
        return self._scored(rough.forms, shared, rough.chosen, [
            self._fit(place, shared, private, free, unit.around(int(fit.index[0])))
            for place, (unit, fit, private) in enumerate(zip(
                self.units, rough.fits, rough.private))])

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
        """Elimination of private columns from one unit, made once."""
        if not len(private):
            return None
        key = (place, private.index.tobytes(), private.prior.tobytes())
        if key not in self._eliminations:
            while len(self._eliminations) >= KEPT * len(self.units):
                del self._eliminations[next(iter(self._eliminations))]
            self._eliminations[key] = Elimination(
                self.units[place], self.statistics[place], private)
        return self._eliminations[key]

    def _choice(self, place, shared, beside, form, free):
        """(the likeliest Choice of a form in one unit, beside a tuple of Choice of the others; the
        likeliest of those that are something)."""
        unit, tried = self.units[place], []
        elimination = self._elimination(place, _private(beside))
        for numbers in forms_at_once.by_size(form.choices).values():
            # Integrated out by its prior a column is the same, shared or private.
            index, prior = (np.hstack([
                np.tile(getattr(shared, name), (len(numbers), 1)),
                np.stack([getattr(form.choices[n], name) for n in numbers])])
                for name in ("index", "prior"))
            likelihoods = forms_at_once.fit(
                unit, self.statistics[place], index, prior, self._prior(place, free),
                self._levels_tried(place, free), elimination).evidence
            for number, likelihood in zip(numbers, likelihoods.tolist()):
                within = unit.within.get((form.effect, form.variant, number), 0.0)
                tried.append((likelihood + within + form.chances[number], number, within))
        something = [one for one in tried if len(form.choices[one[1]])] or tried
        return tuple(Choice(form, number, within)
                     for _, number, within in (max(tried), max(something)))


def _private(choices):
    """Columns of a tuple of Choice."""
    return sum((choice.columns for choice in choices), NONE)


def _worth(chosen):
    """Nats of all units' choices by themselves."""
    return sum(choice.nats for choices in chosen for choice in choices)


def _free(forms):
    """Names of the levels that may be anything."""
    return frozenset().union(*(form.free for form in forms))
