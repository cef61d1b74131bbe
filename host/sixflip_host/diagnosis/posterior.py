"""The posterior over sets of hypotheses, and what can be said of each one in the likeliest set.

Sets of at most four are searched from the empty one, the best few of each size going on (a beam),
then every member of the best set is held against every other hypothesis in its place. A set's
log probability is its score (scored_sets.py) less a cost for each member, set once for each
protocol by simulation (cutoffs.py). A class is the smallest set of names that holds 95 % in one
place.
"""
from dataclasses import dataclass

import numpy as np

from . import discrepancy, hypotheses, members, odds
from .odds import HOLDS, PRESENT
from .scored_sets import Scored

MOST, BEAM = 4, 3  # members of a set (GAP stage 3); sets that the search goes on with
FORM_COST = 1.0  # nats
# Of what a set must gain to be gone on with, what a discrepancy adds at most: it is half of what
# the form itself is, so that where that gains nothing there is nothing for it to be a part of.
MOST_OF_A_FORM = 0.75
WORTH_TRYING = 0.5  # of what a member must gain: two that need each other may share it unevenly


@dataclass(frozen=True)
class Posterior:
    """best: Scored of the likeliest set; cost: cutoffs.Cutoffs; places: {effect: {effect or "":
    probability}} of each member's place in the best set, the others being as they are ("" nothing
    there); gains: {effect: nats lost without it}."""

    best: Scored
    cost: object
    places: dict
    gains: dict

    def alternatives(self, effect):
        """Names that hold 95 % of a member's place, the likeliest first."""
        place, taken, total = self.places[effect], [], 0.0
        for name in sorted(place, key=lambda n: -place[n]):
            if total >= HOLDS:
                break
            taken.append(name)
            total += place[name]
        return taken

    def stranger_share(self, effect):
        """Probability that what stands in a member's place has no name."""
        return odds.nameless(self.places[effect])


def search_sets(model, forms, cost, most=MOST):
    """Posterior over sets of Forms; cost: cutoffs.Cutoffs."""
    def worth(scored):
        return _worth(scored, cost)
    empty = model.scored(())
    beam, reached = [empty], [empty]
    least = WORTH_TRYING * min((cost.nats(form) + PRESENT for form in forms), default=0.0)
    for _ in range(most):
        candidates = {}
        for base in beam:
            for _, candidate in model.best(base, _free(forms, base)):
                names = candidate.names
                if names not in candidates or worth(candidate) > worth(candidates[names]):
                    candidates[names] = candidate
        ordered = sorted(candidates.values(), key=worth, reverse=True)[:BEAM]
        reach = least + max(s.score for s in beam)
        if max((s.score for s in ordered), default=-np.inf) < reach - MOST_OF_A_FORM * least:
            break
        grown = sorted((_with_discrepancy(model, forms, candidate, cost) for candidate in ordered),
                       key=worth, reverse=True)
        if max(s.score for s in grown) < reach:
            break
        beam = grown
        reached += grown
    return _judged(model, forms, members.pruned(model, max(reached, key=worth), cost), cost)


def judge_likeliest(model, forms, cost, likeliest):
    """Posterior where the set that is likeliest for nearly the same data is known: a tuple of
    Forms of the same columns."""
    return _judged(model, forms, model.scored(likeliest), cost)


def _judged(model, forms, likely, cost):
    """Posterior of the set that comes of a likely one."""
    best = _refined(model, forms, likely, cost)
    places, gains = {}, {}
    for form in best.forms:
        places[form.effect], gains[form.effect] = _place(model, forms, best, form, cost)
    return Posterior(best, cost, places, gains)


def _free(forms, scored, instead=""):
    """The Forms of effects that a set has no member of; instead: the effect whose place is
    free."""
    taken = {f.effect for f in scored.forms}
    return [f for f in forms if f.effect not in taken and f.instead in ("", instead)]


def _worth(scored, cost):
    """Score less what the members cost, nats."""
    return scored.score - sum(cost.nats(form) + PRESENT for form in scored.forms)


def _refined(model, forms, best, cost):
    """The best set with members exchanged, one at a time, as long as that gains; without those
    that the others have made superfluous: of all that were come by, the best."""
    changed, reached = True, []
    while changed and best.forms:
        best, changed = members.pruned(model, best, cost), False
        reached.append(best)
        for form in best.forms:
            fewer = model.scored(tuple(f for f in best.forms if f is not form))
            better = max((rival for _, rival in _rivals(model, forms, fewer, form, cost)),
                         key=lambda s: _worth(s, cost))
            if _worth(better, cost) > _worth(best, cost) + 1e-3:
                best, changed = _with_discrepancy(model, forms, better, cost), True
                break
        if not changed:
            better = _absorbed(model, forms, best, cost)
            changed = _worth(better, cost) > _worth(best, cost) + 1e-3
            best = better if changed else best
    return max([best, *reached], key=lambda s: _worth(s, cost))


def _absorbed(model, forms, best, cost):
    """The likeliest set of this one and those in which a name does by another variant, with a
    discrepancy, what a stranger does beside it."""
    sets = [best]
    for stranger in (f for f in best.forms if f.generic):
        for name in (f for f in best.forms if not f.generic and len(f.shared)):
            others = model.scored(tuple(f for f in best.forms if f not in (stranger, name)))
            variants = [f for f in forms if (f.effect, f.axis) == (name.effect, name.axis)]
            sets += [_wider(model, forms, exchanged, cost, variant)
                     for variant, exchanged in model.best(others, variants)]
    return max(sets, key=lambda s: _worth(s, cost))


def _place(model, forms, best, form, cost):
    """({effect or "": probability}, gain in nats) of one member's place."""
    others = tuple(f for f in best.forms if f is not form)
    empty = model.scored(others)
    scores = {"": empty.score, form.effect: best.score - cost.nats(form)}
    for rival, exchanged in _rivals(model, forms, empty, form, cost):
        there = next(f for f in exchanged.forms if f.effect == rival.effect)
        scores[rival.effect] = max(exchanged.score - cost.nats(there),
                                   scores.get(rival.effect, -np.inf))
    return odds.shares(scores), best.score - empty.score


def _rivals(model, forms, fewer, form, cost):
    """[(Form, Scored of the set with it in the place of a member)] of those Forms that
    come near to the best one. Names compete with their discrepancy there, as they do in the set,
    but not those of time for a stranger's place, of which everything is a function. A stranger
    competes with every name of its variable: with a discrepancy that is near which was not
    without. Noise, which takes up something of everything, is in its place where the stranger adds
    nothing to that. What a member may be no more than competes as well (discrepancy.alone)."""
    rivals, seen = [], set()
    alone = discrepancy.alone(model, forms, form)
    if alone is not None and alone.effect not in fewer.names:
        rivals.append((alone, model.extended(fewer, alone)))
    free = _free(forms, fewer, form.effect)
    near = model.best(fewer, free)
    tried = {(rival.effect, rival.axis) for rival, _ in near}
    near += [(name, model.extended(fewer, name)) for name in discrepancy.names_of(free, form)
             if (name.effect, name.axis) not in tried]
    for rival, exchanged in near:
        if rival.effect == "drift" and form.generic and form.instead != "drift" and _adds(
                model, exchanged, form, cost):
            continue
        if (rival.effect, rival.axis) not in seen and not (
                form.generic and hypotheses.domain(rival.effect) == "time"):
            seen.add((rival.effect, rival.axis))
            exchanged = _wider(model, forms, exchanged, cost, rival)
        rivals.append((rival, exchanged))
    return rivals


def _adds(model, scored, form, cost):
    """Whether a form makes a set likelier."""
    return _worth(model.extended(scored, form), cost) > _worth(scored, cost)


def _with_discrepancy(model, forms, scored, cost):
    """The set with a discrepancy beside those named members that are likelier with one: another
    functional form of the same cause is neither a second name nor a stranger."""
    for form in scored.forms:
        scored = _wider(model, forms, scored, cost, form)
    return scored


def _wider(model, forms, scored, cost, form):
    """The set with a discrepancy beside this member where that is likelier; beside which variant
    of its effect is tried, unless the discrepancy is made of the variants themselves."""
    if form.generic:
        return scored
    others = tuple(f for f in scored.forms if f != form)
    variants = [form] if form.effect in discrepancy.OWN_FORMS else [
        other for other in forms if (other.effect, other.axis) == (form.effect, form.axis)]
    for other in variants:
        plain = model.scored((*others, other))
        wider = discrepancy.with_discrepancy(model, forms, plain, other)
        if wider is None:
            break
        extended = model.scored((*others, wider))
        if _worth(extended, cost) > _worth(scored, cost) + FORM_COST:
            scored = extended
    return scored
