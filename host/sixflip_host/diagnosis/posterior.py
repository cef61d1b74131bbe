"""The posterior over sets of hypotheses, and what can be said of each one in the likeliest set.

Sets of at most four are searched from the empty one, the best few of each size going on (a beam),
then every member of the best set is held against every other hypothesis in its place. A set's
log probability is its score (scored_sets.py) less a cost for each member, set once for each
protocol by simulation (cutoffs.py). A class is the smallest set of names that holds 95 % in one
place.
"""
from dataclasses import dataclass

import numpy as np

from . import discrepancy, evidence, hypotheses, odds
from .odds import HOLDS, PRESENT
from .scored_sets import Scored

MOST, BEAM = 4, 3  # members of a set (GAP stage 3); sets that the search goes on with
FORM_COST = 1.0  # nats
NOISE_FORM = 0.2  # of a name's gain, that its true form may leave to noise that wanders
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
    return _judged(model, forms, _pruned(model, max(reached, key=worth), cost), cost)


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
        best, changed = _pruned(model, best, cost), False
        reached.append(best)
        for form in best.forms:
            fewer = model.scored(tuple(f for f in best.forms if f is not form))
            better = max((rival for _, rival in _rivals(model, forms, fewer, form, cost)),
                         key=lambda s: _worth(s, cost))
            if _worth(better, cost) > _worth(best, cost) + 1e-3:
                best, changed = _with_discrepancy(model, forms, better, cost), True
                break
    return max([best, *reached], key=lambda s: _worth(s, cost))


def _pruned(model, best, cost):
    """The set without members that cost more than they gain. No part has the very form of the
    library, and what has no name has no known form at all: beside the others a member has to
    gain more than a share of what they gain."""
    while best.forms:
        gains = _gains(model, best)
        alone = {f: max(gains[f], _alone(model, f)) for f in best.forms}
        energy = {f: max(gains[f], nats) for f, nats in _energies(best).items()}
        needed = {form: cost.nats(form) + PRESENT + max(
            [_unknown(form, f, cost) * (
                alone if f.generic or form.effect == "drift"
                else energy if discrepancy.may_be_left_by(form, f) else gains)[f]
             for f in best.forms if f is not form], default=0.0) for form in best.forms}
        weakest = min(best.forms, key=lambda f: gains[f] - needed[f])
        if gains[weakest] >= needed[weakest]:
            break
        best = model.scored(tuple(f for f in best.forms if f is not weakest))
    return best


def _unknown(form, other, cost):
    """Share of what another member gains that a member must gain itself: noise, or what differs
    from session to session anyhow, has no form that could be another one, and noise takes up
    whatever form a stranger has beyond what is described."""
    if other.effect == "drift" or other.free:
        return 0.0
    if form.effect == "drift":
        return 1.0 if other.generic else NOISE_FORM
    return cost.beside if other.generic else cost.form


def _alone(model, form):
    """Nats that a form gains by itself."""
    return model.scored((form,)).score - model.scored(()).score


def _gains(model, best):
    """{Form: nats lost without it}."""
    return {form: best.score - model.scored(tuple(f for f in best.forms if f is not form)).score
            for form in best.forms}


def _energies(best):
    """{Form: nats lost without it at the levels of noise found, by its coefficients and their
    covariance [Wald, Trans. AMS 54 (1943) 426]}. Without it more noise would be taken for usual,
    so what it gains grows as a logarithm of its size only, and what its form leaves with the
    square."""
    shared = best.shared
    if not len(shared):
        return dict.fromkeys(best.forms, 0.0)
    theta, covariance = (v[0] for v in evidence.coefficients(best.fits, shared))
    energies = {}
    for form in best.forms:
        mine = np.flatnonzero(np.isin(shared.index, form.columns))
        block = covariance[np.ix_(mine, mine)]
        energies[form] = 0.5 * float(theta[mine] @ np.linalg.solve(block, theta[mine])) \
            if len(mine) else 0.0
    return energies


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
    nothing to that."""
    rivals, seen = [], set()
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
