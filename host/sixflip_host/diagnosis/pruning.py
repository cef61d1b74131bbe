"""Which members of a set of hypotheses stand beside the others.

No part has the very form of the library, and what has no name has no known form at all. What a
large member leaves of its form must not be taken for a small one beside it, nor for noise.
"""
import numpy as np

from . import discrepancy, evidence, hypotheses
from .odds import PRESENT

NOISE_FORM = 0.2  # of a name's gain, that its true form may leave to noise that wanders


def pruned(model, best, cost):
    """The set (scored_sets.Scored of a scored_sets.Model) without members that cost
    (cutoffs.Cutoffs) more than they gain: beside the others a member has to gain more than a share
    of what they gain, nats, in the set without it: of two that are nearly alike each does most of
    what the other does, and neither would look large beside the other."""
    while best.forms:
        without = {form: model.scored(tuple(f for f in best.forms if f is not form))
                   for form in best.forms}
        gains = {form: best.score - fewer.score for form, fewer in without.items()}
        alone = {f: max(gains[f], _alone(model, f)) for f in best.forms}
        needed = {form: cost.nats(form) + PRESENT + max(
            [_unknown(form, f, cost) * (
                alone[f] if f.generic or form.effect == "drift"
                else max(gains[f], energies[f]) if discrepancy.may_be_left_by(form, f)
                else gains[f])
             for f in best.forms if f is not form and not _seen_within(best, form, f, cost)],
            default=0.0)
            for form, energies in ((form, _energies(fewer)) for form, fewer in without.items())}
        weakest = min(best.forms, key=lambda f: gains[f] - needed[f])
        if gains[weakest] >= needed[weakest]:
            break
        best = without[weakest]
    return best


def _seen_within(best, form, other, cost):
    """Whether a walk beside a name is there by what it does within the rests alone, where a name
    that is a function of the pose alone leaves nothing of its form."""
    if form.effect != "drift" or other.generic \
            or hypotheses.domain(other.effect) != "orientation":
        return False
    return sum(choice.within for choices in best.chosen for choice in choices
               if choice.form == form) >= cost.nats(form) + PRESENT


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


def _energies(scored):
    """{Form: nats lost without it at the levels of noise found, by its coefficients and their
    covariance [Wald, Trans. AMS 54 (1943) 426]}. Without it more noise would be taken for usual,
    so what it gains grows as a logarithm of its size only, and what its form leaves with the
    square."""
    shared = scored.shared
    if not len(shared):
        return dict.fromkeys(scored.forms, 0.0)
    theta, covariance = (v[0] for v in evidence.coefficients(scored.fits, shared))
    energies = {}
    for form in scored.forms:
        mine = np.flatnonzero(np.isin(shared.index, form.columns))
        block = covariance[np.ix_(mine, mine)]
        energies[form] = 0.5 * float(theta[mine] @ np.linalg.solve(block, theta[mine])) \
            if len(mine) else 0.0
    return energies
