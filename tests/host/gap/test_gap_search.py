"""The search over sets of hypotheses, on sets whose scores are known: what stands in the place of
what, and what stands beside it."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.diagnosis import (
    cutoffs,
    discrepancy,
    hypotheses,
    members,
    odds,
    posterior,
    scored_sets,
)
from sixflip_host.diagnosis.elimination import Columns
from sixflip_host.diagnosis.evidence import Levels
from sixflip_host.experiment import covariance, linear_model
from sixflip_host.experiment.nominal_rows import Rows
from sixflip_host.experiment.terms import Design

USUAL = Levels(1.0, 0.01, 1.0, 1.0)


class Scores:
    """A model of which the score of each set is known."""

    def __init__(self, scores):
        self.scores = {frozenset(names.split()): score for names, score in scores.items()}

    def scored(self, forms):
        return scored_sets.Scored(tuple(forms), self.scores[frozenset(f.effect for f in forms)],
                                  (), ())

    def extended(self, base, form):
        return self.scored((*base.forms, form))

    def best(self, base, forms):
        return sorted(((form, self.extended(base, form)) for form in forms),
                      key=lambda pair: -pair[1].score)


@pytest.mark.parametrize("beside, likeliest", [(5.0, "drift"), (21.0, "jump")])
def test_noise_stands_for_a_stranger_only_where_that_adds_nothing(beside, likeliest):
    """What wanders takes up most of a jump, too. Where the jump added 21 nats to it, it was the
    drift alone that was said."""
    model = Scores({"": 0.0, "drift": 57.0, "jump": 44.0, "drift jump": 57.0 + beside})
    forms = [hypotheses.Form("drift"), hypotheses.Form("jump")]
    found = posterior.search_sets(model, forms, cutoffs.Cutoffs(8.7, 0.15))
    assert [form.effect for form in found.best.forms] == [likeliest]
    assert found.alternatives(likeliest) == [likeliest]


@pytest.mark.parametrize("scores, likeliest", [
    ({"hysteresis": 83.0, "cubic": 85.0, "bend": 88.0}, "cubic"),
    ({"hysteresis": 87.0, "bend": 83.0}, "hysteresis"),
    ({"hysteresis": 83.0, "bend": 88.0}, "bend")])
def test_a_name_is_held_against_what_it_may_be_no_more_than(monkeypatch, scores, likeliest):
    """A memory that levels off bends, too: where nothing else has a name for a bend it stood for
    one. What bends is asked in the place of such a memory alone."""
    monkeypatch.setattr(discrepancy, "alone", lambda model, forms, form: hypotheses.Form(
        "bend") if form.effect == "hysteresis" else None)
    model = Scores({"": 0.0, **scores})
    forms = [hypotheses.Form(name) for name in scores if name != "bend"]
    found = posterior.search_sets(model, forms, cutoffs.Cutoffs(8.7, 0.15), most=1)
    assert [form.effect for form in found.best.forms] == [likeliest]
    assert found.alternatives(likeliest)[0] == likeliest


def test_a_name_may_do_by_another_variant_what_a_stranger_does_beside_it(monkeypatch):
    """A warm-up of many time constants was the shortest of them and something nameless in time:
    the longest with a discrepancy, likelier than both, was never tried."""
    class OfVariants(Scores):
        def scored(self, forms):
            names = frozenset(f.effect if f.generic else f.variant for f in forms)
            return scored_sets.Scored(tuple(forms), self.scores[names], (), ())

    def wider(model, forms, scored, cost, form):
        return model.scored([replace(f, variant="wide") if f.variant == "slow" else f
                             for f in scored.forms])
    monkeypatch.setattr(posterior, "_wider", wider)
    one = Columns(np.array([0]), np.ones(1))
    quick, slow = (hypotheses.Form("warm_up", variant, shared=one) for variant in (
        "quick", "slow"))
    model = OfVariants({"": 0.0, "quick": 60.0, "slow": 50.0, "time": 40.0, "quick time": 110.0,
                        "slow time": 70.0, "wide": 105.0})
    cost = cutoffs.Cutoffs(8.0, 0.15)
    both = model.scored((quick, hypotheses.Form("time", shared=one)))
    for score, likeliest in ((105.0, "wide"), (90.0, "quick")):
        model.scores[frozenset(["wide"])] = score
        found = posterior._absorbed(model, (quick, slow), both, cost)
        assert found.forms[0].variant == likeliest
        assert (found is both) == (likeliest == "quick")


@pytest.mark.parametrize("effect, other, within, seen", [
    ("drift", "g_sensitivity", (10.0, 10.0), True), ("drift", "g_sensitivity", (2.0, 2.0), False),
    ("drift", "warm_up", (10.0, 10.0), False), ("drift", "hysteresis", (10.0, 10.0), False),
    ("drift", "orientation", (10.0, 10.0), False), ("jump", "quadratic", (10.0, 10.0), False)])
def test_only_a_walk_is_seen_within_the_rests_and_beside_what_the_pose_alone_does(
        effect, other, within, seen):
    form = hypotheses.Form(effect)
    best = scored_sets.Scored((form,), 0.0, (), tuple(
        (scored_sets.Choice(form, 0, nats),) for nats in within))
    cost = cutoffs.Cutoffs(8.0, 0.15)
    assert members._seen_within(best, form, hypotheses.Form(other), cost) == seen


@pytest.mark.parametrize("alike, kept", [(0.95, 1), (0.0, 2)])
def test_of_two_that_are_nearly_alike_one_stands_for_what_lies_between_them(alike, kept):
    """A bend of another form was `asymmetry` and `cross_quadratic` at once: each does what the
    other does, so that neither looked large beside the other. Unlike ones stand both."""
    n, generator = 60, np.random.default_rng(5)
    u = np.linspace(-1.0, 1.0, n)
    first, other = np.sqrt(2.0) * np.sin(np.pi * u), np.sqrt(2.0) * np.cos(np.pi * u)
    second = alike * first + np.sqrt(1.0 - alike ** 2) * other
    columns = np.zeros((2, n, 3))
    columns[0, :, 2], columns[1, :, 2] = first, second
    designs = [Design(effect, "", ["z"], [2], column.reshape(-1, 1), np.array([10.0]))
               for effect, column in zip(("quadratic", "asymmetry"), columns)]
    groups = covariance.alone(np.eye(3 * n), np.zeros((3 * n, 0)), np.eye(3 * n))
    units = [linear_model.unit(Rows(
        (2.0 * columns.sum(axis=0) + generator.standard_normal((n, 3))).reshape(-1), groups,
        np.kron(np.ones((n, 1)), np.eye(3)), ((0.0,), (0.01, 1.0))), designs) for _ in range(2)]
    model = scored_sets.Model(units, [u.statistics() for u in units], USUAL)
    forms = hypotheses.forms_of(units, drift=False)
    both = model.scored(tuple(forms))
    cost = cutoffs.Cutoffs(6.0, 0.06)
    gains = [both.score - model.scored((form,)).score for form in forms]
    assert min(gains) > cost.member + odds.PRESENT
    assert len(members.pruned(model, both, cost).forms) == kept


def test_what_differs_from_session_to_session_leaves_nothing_to_a_name_within_them():
    """A hysteresis had to gain half of what an unusual change at switching on did."""
    cost = cutoffs.Cutoffs(5.0, 0.5)
    named, nameless = (hypotheses.Form(name, shared=Columns(np.array([0]), np.ones(1)))
                       for name in ("hysteresis", "orientation"))
    level = hypotheses.Form("session", free=frozenset(["switch_on"]))
    assert members._unknown(named, level, cost) == 0.0
    assert members._unknown(named, nameless, cost) == 0.5
    assert members._unknown(named, named, cost) == cost.form


@pytest.mark.parametrize("of_another_form, axes", [(False, {0, 2}), (True, {2})])
def test_what_a_form_that_is_not_the_library_s_leaves_to_other_axes_names_none(
        of_another_form, axes):
    """6 mg that went as a sine along z were "cubic" on x as well, where nothing was."""
    gains = {0: 11.7, 1: -1.1, 2: 154.4}
    form = hypotheses.Form("cubic", "", None, tuple("xyz"), (0, 1, 2), Columns(
        np.arange(3), np.ones(3)), powers=(1, 1, 1), discrepancy=of_another_form)
    model = SimpleNamespace(units=[SimpleNamespace(apart=False)], extended=lambda others, added:
                            SimpleNamespace(score=sum(gains[axis] for axis in added.axes)))
    posterior = SimpleNamespace(cost=SimpleNamespace(form=0.02))
    assert members._needed_axes(model, [form], posterior, SimpleNamespace(score=0.0),
                                [form]) == axes
