"""Stage 4: never a name inside an unresolved class.

A class is what holds 95 % of a member's place in the likeliest set (posterior.py), and every
effect that reproduces more than 0.9 of the one that stands there (alias index, in the metric of
the noise, nominal model and the other causes projected out; averaged over coefficients, or of the
very sizes found), or that less than 3 standard deviations tell from it. One session that tells
them apart by itself is enough: the others must not dilute it. What lies between sessions counts
as much in the alias index as all that lies within them: there are few such contrasts, but no
error in the form of an effect can turn them round.
"""
import math
from dataclasses import dataclass, field, replace

import numpy as np

from ..experiment.terms import is_stranger
from ..experiment.way_memory import LEVELLING
from . import discrepancy, evidence, odds

SAME, SIGMAS = 0.9, 3.0  # GAP stage 4: alias index and distinguishability of one class


@dataclass(frozen=True, eq=False)
class Cause:
    """One effect found: chosen (tuple of Form; its own, then those of the same class that do a
    part of its work), score (nats); place: {name: probability} of what
    stands here, "" nothing; members ({effect: why it cannot be told}), alike: those of them that
    cannot be told from the effect in principle; theta (k,), covariance (k, k) over the form's
    columns; letters of the axes that are told and variants, ((probability, Cause), ...) of it in
    each variant of its effect that is as likely: see members.in_full. Of its size, see
    effect_estimates.sized: value and interval {key: ...} of the effect in its variant and shape
    (see hypotheses.Form), plausible, share of the excess, domain, unit."""

    effect: str
    chosen: tuple
    score: float
    place: dict
    members: dict = field(default_factory=dict)
    alike: frozenset = frozenset()
    theta: np.ndarray | None = None
    covariance: np.ndarray | None = None
    variants: tuple = ()
    value: dict = field(default_factory=dict)
    interval: dict = field(default_factory=dict)
    letters: tuple = ()
    plausible: bool = True
    share: float | None = None
    domain: str | None = None
    unit: str | None = None
    variant: str = ""
    shape: tuple = ()

    @property
    def keys(self):
        return self.chosen[0].keys

    @property
    def axes(self):
        return self.chosen[0].axes

    @property
    def names(self):
        return [self.effect] + sorted(self.members)

    @property
    def probabilities(self):
        """{name: probability} of the names of its class, the likeliest first. Names that cannot
        be told in principle share what they have together alike: which of them fits better is
        a matter of their form, not of what is there."""
        probabilities = {name: self.place.get(name, 0.0) for name in self.names}
        alike = [name for name in self.names if name == self.effect or name in self.alike]
        equal = sum(probabilities[name] for name in alike) / len(alike)
        probabilities.update(dict.fromkeys(alike, equal))
        return dict(sorted(probabilities.items(), key=lambda pair: -pair[1]))

    @property
    def nameless(self):
        """Probability that what stands here has no name."""
        return odds.nameless(self.place)


def causes(posterior, units, forms, thermometer=True):
    """list of Cause of the named members of a Posterior's best set, largest score first;
    thermometer: there is one, else what goes as a warm-up may go with the temperature."""
    best = posterior.best
    shared = best.shared
    if not len(shared):
        return []
    theta, covariance = (v[0] for v in evidence.coefficients(best.fits, shared))
    grams, each = _grams(units, best.fits)
    of_members = []
    for form in best.forms:
        if form.generic or not len(form.shared):
            continue
        place = _places(shared.index, form.columns)
        likely = {name: "probability %.2f" % posterior.places[form.effect][name]
                  for name in posterior.alternatives(form.effect)
                  if name not in ("", form.effect, "drift") and not is_stranger(name)}
        alike = _aliases(form, theta[place], likely, forms, best.forms, grams, each)
        if form.effect == "warm_up" and not thermometer:
            alike["thermal_bias"] = "no temperature was recorded"
        of_members.append(Cause(
            form.effect, (form,), posterior.gains[form.effect], posterior.places[form.effect],
            {**likely, **alike}, frozenset(alike), theta[place],
            covariance[np.ix_(place, place)]))
    kept = []
    for cause in sorted(of_members, key=lambda c: -c.score):
        same = [k for k, other in enumerate(kept) if _same_cause(cause, other)]
        if same:
            kept[same[0]] = _joined(kept[same[0]], cause, shared.index, theta, covariance)
        else:
            kept.append(cause)
    return kept


def _same_cause(cause, other):
    """Whether two members of a set are one cause: on an axis that both have, each is in the
    class of the other."""
    axes = {axis for form in other.chosen for axis in form.axes}
    return cause.effect in other.members and other.effect in cause.members and bool(
        axes.intersection(cause.axes))


def _joined(cause, other, columns, theta, covariance):
    """The cause with the forms of the other, which does a part of its work; theta and covariance
    of the set's shared columns."""
    chosen = (*cause.chosen, *other.chosen)
    places = [place for form in chosen for place in _places(columns, form.columns)]
    return replace(cause, chosen=chosen, theta=theta[places],
                   covariance=covariance[np.ix_(places, places)])


def _grams(units, fits):
    """([gram (K, K) within sessions, between them], [gram of each session])."""
    grams, each = [0.0, 0.0], []
    for unit, fit in zip(units, fits):
        gram = unit.gram.at(fit.index[0])
        grams[bool(unit.between)] = grams[bool(unit.between)] + gram
        each += [] if unit.between else [gram]
    return grams, each


def _places(columns, wanted):
    return [int(np.flatnonzero(columns == w)[0]) for w in wanted]


def _aliases(form, theta, known, forms, beside, grams, each):
    """{effect: why} of every other one but the known that cannot be told from a form with these
    sizes in principle, the other members of the set projected out."""
    own = [i for i, power in enumerate(form.powers) if power == 1]
    every, whole = form.columns, theta
    mine, theta, reasons = every[own], theta[own], {}
    even = balanced(grams, mine)
    for name in dict.fromkeys(f.effect for f in forms if not f.generic and len(f.shared)):
        if name == form.effect or name in known:
            continue
        others = [f.columns for f in beside if f.effect not in (name, form.effect)]
        others = np.concatenate([*others, np.zeros(0, dtype=int)]).astype(int)
        free = others[~np.isin(others, mine)]
        # What a memory that levels off reproduces of a bend is its own bend, and no memory.
        rivals = [f for f in forms if f.effect == name and f.axis is None and not f.record
                  and LEVELLING not in f.variant]
        spaces = [f.columns for f in rivals]
        left = reproduced(even, mine, theta, spaces, free)
        if left is None:
            continue
        # A discrepancy is a part of what a name of another variable would have to reproduce; one
        # of the same variable could have the same discrepancy.
        same = any(discrepancy.alike(form, rival) for rival in rivals)
        columns, sizes = (mine, theta) if same else (every, whole)
        apart = reproduced(grams[0] + grams[1], columns, sizes, spaces,
                           others[~np.isin(others, columns)])[1]
        if left[0] > SAME and not any(_told(g, mine, theta, spaces, free)
                                      for g in each if len(each) > 1):
            reasons[name] = "alias index %.2f" % left[0]
        elif apart < SIGMAS:
            reasons[name] = "%.1f standard deviations apart" % apart
    return reasons


def balanced(grams, mine):
    """Both grams together, the energy of `mine` between sessions as large as within them."""
    within, between = (np.trace(np.atleast_2d(g)[np.ix_(mine, mine)]) if np.ndim(g) else 0.0
                       for g in grams)
    return grams[0] + grams[1] * (within / between if min(within, between) > 0.0 else 1.0)


def _told(gram, mine, theta, spaces, others):
    """Whether one session's gram alone tells an effect from another's variants."""
    likeness = reproduced(gram, mine, theta, spaces, others)
    return likeness is not None and likeness[0] <= SAME and likeness[1] >= SIGMAS


def reproduced(gram, mine, theta, alternatives, others):
    """(largest alias index, least distance in standard deviations) over the alternatives; the
    index is averaged over the coefficients `mine`, or of these very ones where that is more."""
    best = None
    for columns in alternatives:
        space = np.concatenate([columns, others]).astype(int)
        inner = gram[np.ix_(mine, mine)]
        after_others = _left(gram, mine, others.astype(int), inner)
        left = _left(gram, mine, space, inner)
        norms = np.diag(after_others)
        good = norms > 1e-9 * np.maximum(np.diag(inner), 1e-300)
        if not good.any():
            continue
        index = 1.0 - float(np.mean(np.diag(left)[good] / norms[good]))
        rest, whole = (max(float(theta @ g @ theta), 0.0) for g in (left, after_others))
        if whole > 0.0:
            index = max(index, 1.0 - rest / whole)
        apart = math.sqrt(rest)
        best = (max(index, best[0]), min(apart, best[1])) if best else (index, apart)
    return best


def _left(gram, mine, space, inner):
    """Gram matrix of `mine` after the columns `space` have been projected out."""
    if not len(space):
        return inner
    block = gram[np.ix_(space, space)]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    block = block / scale / scale[:, None] + 1e-9 * np.eye(len(space))
    cross = gram[np.ix_(space, mine)] / scale[:, None]
    return inner - cross.T @ np.linalg.solve(block, cross)


def alias_table(gram, options):
    """(names, index): A(row | column) of the first plain variants, for the report."""
    first = {}
    for o in options:
        if o.axis is None and not o.generic and not o.record:
            first.setdefault(o.effect, o)
    names = list(first)
    table = np.eye(len(names))
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            if i != j:
                likeness = reproduced(gram, first[a].columns, np.zeros(len(first[a].columns)),
                                      [first[b].columns], np.zeros(0))
                table[i, j] = likeness[0] if likeness else np.nan
    return names, table
