"""The score of sets of hypotheses on small made-up problems whose answer is known."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import integrate, linalg, stats

from sixflip_host.diagnosis import (
    aliases,
    cutoffs,
    effect_estimates,
    elimination,
    evidence,
    forms_at_once,
    hypotheses,
    members,
    mimicry,
    moves_unit,
    odds,
    posterior,
    scored_sets,
)
from sixflip_host.diagnosis.elimination import NONE, Columns
from sixflip_host.diagnosis.evidence import Levels
from sixflip_host.experiment import covariance, gram, linear_model
from sixflip_host.experiment.nominal_rows import Rows
from sixflip_host.experiment.terms import Design

USUAL = Levels(1.0, 0.01, 1.0, 1.0)


def unit(generator, theta=0.0, jump=0.0, n=40):
    """A session of n blocks of one axis that matters, with a slope and a jump in it."""
    slope = np.zeros((n, 3))
    slope[:, 0] = np.linspace(-1.0, 1.0, n)
    other = np.zeros((n, 3))
    other[:, 1] = generator.standard_normal(n)
    steps = np.zeros((n, 3, 3))
    for k, start in enumerate((10, 20, 30)):
        steps[:, 2, k] = np.arange(n) >= start
    y = theta * slope + generator.standard_normal((n, 3))
    y[:, 2] += jump * steps[:, 2, generator.integers(3)]
    jumps = Design("jump", "", ["z0", "z1", "z2"], [2, 2, 2], steps.reshape(-1, 3),
                   np.full(3, 10.0), [(0,), (1,), (2,)])
    designs = [Design("thermal_bias", "", ["x"], [0], slope.reshape(-1, 1), np.array([10.0])),
               Design("warm_up", "", ["y"], [1], other.reshape(-1, 1), np.array([10.0])), jumps]
    nuisance = np.kron(np.ones((n, 1)), np.eye(3))
    groups = covariance.alone(np.eye(3 * n), np.zeros((3 * n, 0)), np.eye(3 * n))
    return linear_model.unit(Rows(y.reshape(-1), groups, nuisance, ((0.0,), (0.01, 1.0))), designs)


def contrasts(unit, point):
    """(z, S, covariance) of a unit in as many rows as it has contrasts."""
    q = linalg.null_space(unit.space.T)
    whole = covariance.dense(unit.groups, *unit.grid[point])
    return q.T @ unit.z, q.T @ unit.columns, q.T @ whole @ q


def model_of(units):
    return scored_sets.Model(units, [u.statistics() for u in units], USUAL)


def form(units, effect):
    return next(f for f in hypotheses.forms_of(units) if f.effect == effect)


def found(units):
    forms = hypotheses.forms_of(units)
    return posterior.search_sets(model_of(units), forms, cutoffs.Cutoffs(
        cutoffs.simulated(units, forms, USUAL, [0] * len(units)), 0.06))


def test_the_score_is_the_log_density_of_the_session_held_out():
    generator = np.random.default_rng(5)
    units = [unit(generator, 0.1), unit(generator, 0.1)]
    shared = Columns(np.array([0]), np.array([1e4]))
    level = [USUAL.prior(u, ()) for u in units]
    fits = [evidence.fit(u, u.statistics(), shared, NONE, p) for u, p in zip(units, level)]
    expected = 0.0
    for held, train in ((0, 1), (1, 0)):
        theta, spread = evidence.coefficients([fits[train]], shared)
        point = int(fits[held].index[0])
        z, s, noise = contrasts(units[held], point)
        s = s[:, 0]
        expected += level[held][point] + stats.multivariate_normal.logpdf(
            z, theta[0, 0] * s, noise + spread[0, 0, 0] * np.outer(s, s))
        expected += 0.5 * units[held].freedom * np.log(2.0 * np.pi)
    assert evidence.score(fits, shared)[0] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("held", [forms_at_once.HELD, 1])  # all at once, and one at a time
def test_many_forms_at_once_score_as_one_after_the_other(monkeypatch, held, drawn=7):
    """Of one column and of two, with priors of their own, in several data sets; and what is
    private of each session."""
    monkeypatch.setattr(forms_at_once, "HELD", held)
    generator = np.random.default_rng(8)
    units = [unit(generator, 0.4, 3.0) for _ in range(3)]
    data = [u.statistics(generator.standard_normal((len(u.z), drawn)) + u.z[:, None])
            for u in units]
    level, every = [USUAL.prior(u, ()) for u in units], [np.arange(len(u.grid)) for u in units]
    columns = [NONE, Columns(np.array([0]), np.array([0.3])), Columns(np.array([1]), np.ones(1)),
               Columns(np.array([1, 0]), np.array([2.0, 5.0]))]
    bounded = np.arange(5) == 1
    for apart, positive in ((False, None), (True, None), (False, bounded), (True, bounded)):
        expected = [evidence.score([evidence.fit(u, s, own, NONE, p) for u, s, p in zip(
            units, data, level)], own, apart, positive) for own in columns]
        found = forms_at_once.scores(units, data, columns, level, every, "", apart, positive)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7)
    expected = [evidence.fit(units[0], data[0], NONE, own, level[0]).evidence for own in columns]
    found = forms_at_once.evidences(units[0], data[0], columns, level[0], every[0])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7)
    assert np.ptp(found, axis=1).min() > 1.0


@pytest.mark.parametrize("prior, rounding", [(1.0, 1e-3), (1e3, 3.0)])
def test_a_column_that_is_one_of_those_before_says_no_more(prior, rounding):
    """Beside a twin that all forms begin with nothing but rounding was left of it, less than
    nothing here, and a score was no number. Both are one column whose coefficient is wider by the
    root of two; of the wide prior a double has no more than some nats."""
    generator = np.random.default_rng(13)
    s, z = 1e4 * generator.standard_normal((60, 4)), generator.standard_normal((60, 3))
    s[:, 1] = s[:, 0]
    sums = (z ** 2).sum(axis=0)[None], (s.T @ z)[None]
    made = SimpleNamespace(gram=gram.Products((s.T @ s)[None]), logdet=np.zeros(1))

    def evidences(columns, width):
        index = np.array(columns)
        return forms_at_once.fit(made, sums, index, np.full(index.shape, width), np.zeros(1),
                                 np.arange(1)).evidence.reshape(len(columns), 3)
    both = evidences([[0, 1], [0, 2], [0, 3]], prior)
    np.testing.assert_allclose(both[0], evidences([[0]], np.sqrt(2.0) * prior)[0], atol=rounding)
    np.testing.assert_allclose(both[1:], np.concatenate([
        evidences([[0, 2]], prior), evidences([[0, 3]], prior)]), atol=1e-6)


def test_a_size_beyond_what_parts_have_is_unlikely_however_well_it_fits():
    generator = np.random.default_rng(7)
    units = [unit(generator, 50.0), unit(generator, 50.0)]
    narrow, wide = (evidence.score([evidence.fit(u, u.statistics(), one, NONE, np.zeros(2))
                                    for u in units], one)[0]
                    for one in (Columns(np.array([0]), np.array([size])) for size in (1.0, 100.0)))
    assert wide - narrow > 0.9 * np.log1p(50.0 ** 2)


@pytest.mark.parametrize("theta", [0.6, -0.6])
def test_of_what_is_positive_the_half_of_the_prior_is_integrated(theta):
    one = unit(np.random.default_rng(9), theta)
    shared = Columns(np.array([0, 1]), np.array([2.0, 3.0]))
    fit = evidence.fit(one, one.statistics(), shared, NONE, np.zeros(len(one.grid)))
    plain, half = (evidence.score([fit], shared, bounded=np.array(bounded))[0] for bounded in (
        [False, False, False, False, False], [True, False, False, False, False]))
    z, s, noise = contrasts(one, int(fit.index[0]))
    noise = noise + 9.0 * np.outer(s[:, 1], s[:, 1])

    def density(x):
        return stats.norm.pdf(x, 0.0, 2.0) * stats.multivariate_normal.pdf(z, x * s[:, 0], noise)
    below, above = (integrate.quad(density, *span, epsabs=0.0)[0] for span in ((-9, 0), (0, 9)))
    assert half - plain == pytest.approx(np.log(2.0 * above / (above + below)), abs=1e-6)


def test_private_columns_are_integrated_out_with_their_prior():
    one = unit(np.random.default_rng(6), 0.0, 3.0)
    private = Columns(np.array([2, 3]), np.array([0.7, 2.0]))
    fit = evidence.fit(one, one.statistics(), NONE, private, np.zeros(len(one.grid)))
    z, s, noise = contrasts(one, int(fit.index[0]))
    s = s[:, private.index]
    expected = stats.multivariate_normal.logpdf(
        z, np.zeros(one.freedom), noise + s @ np.diag(private.prior ** 2) @ s.T)
    assert fit.evidence[0] == pytest.approx(
        expected + 0.5 * one.freedom * np.log(2.0 * np.pi), abs=1e-6)


def test_only_the_effect_that_is_there_is_found():
    generator = np.random.default_rng(8)
    said = found([unit(generator, 3.0), unit(generator, 3.0)])
    assert said.best.names == {"thermal_bias"}
    assert said.places["thermal_bias"]["thermal_bias"] > 0.95


def test_nothing_is_found_where_nothing_is():
    generator = np.random.default_rng(18)
    wrong = sum(bool(found([unit(generator), unit(generator)]).best.forms) for _ in range(20))
    assert wrong <= 1


def test_a_coefficient_that_differs_between_sessions_does_not_gain():
    generator = np.random.default_rng(9)
    units = [unit(generator, 3.0), unit(generator, -3.0)]
    model = model_of(units)
    assert model.scored((form(units, "thermal_bias"),)).score < model.scored(()).score


def test_a_jump_of_each_sessions_own_is_a_stranger_beside_the_effect():
    generator = np.random.default_rng(10)
    said = found([unit(generator, 3.0, 4.0), unit(generator, 3.0, 4.0)])
    assert said.best.names == {"thermal_bias", "jump"}


def test_a_level_of_noise_beyond_the_usual_costs_unless_it_may_be_anything():
    one = unit(np.random.default_rng(11))
    usual, free = USUAL.prior(one, ()), USUAL.prior(one, {"flicker"})
    assert one.grid[1][1] == 1.0 and usual[1] < -10.0 and usual[0] == 0.0
    assert not free.any()


def test_what_coefficients_explain_is_the_same_by_one_factor_and_by_two():
    """One data set is worked out from the bordered matrix, several by solving for each."""
    generator = np.random.default_rng(8)
    columns = generator.standard_normal((5, 30, 4)) * np.array([1e-4, 1.0, 30.0, 1e3])
    y = generator.standard_normal((5, 30, 1)) * 1e3
    gram = columns.transpose(0, 2, 1) @ columns + np.diag([1.0, 1.0, 2.0, 3.0])
    inner, quadratic = columns.transpose(0, 2, 1) @ y, (y ** 2).sum(axis=1)
    left, logdet = evidence.known(gram, inner, quadratic)
    twice, same = evidence.known(gram, np.repeat(inner, 2, 2), np.repeat(quadratic, 2, 1))
    assert twice[:, :1] == pytest.approx(left, rel=1e-12)
    assert same == pytest.approx(logdet, rel=1e-12)


def test_a_metric_that_rounding_leaves_singular_is_whitened_as_well():
    """Beside one that is none the others stay as they are, whatever their columns are in size."""
    good, columns = np.diag([1e10, 1e2, 1e-8]), np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    singular = columns.T @ columns - 1e-17 * np.eye(3)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(singular)
    found = elimination.whitening(np.array([good, singular]))
    assert found.half_logdet[0] == pytest.approx(0.5 * np.log(1e4), abs=1e-9)
    np.testing.assert_allclose(found.matrix[0] @ good @ found.matrix[0].T, np.eye(3), atol=1e-9)
    assert np.isfinite(found.matrix).all() and found.half_logdet[1] < -10.0


def moves(generator, lag, varying=0.0):
    """Two sessions of 12 moves. A lag changes the first column by `lag` in each move, beside
    noise of 1, and may be `varying` more or less in each session; in two moves something large
    follows the second column, a rate, by chance."""
    units = []
    for _ in range(2):
        inner = generator.standard_normal((12, 2))
        inner[:2, 1] += 25.0 * generator.choice([-1.0, 1.0], 2)
        left = inner.copy()
        inner[:, 0] += lag
        prior = np.array([30.0, 30.0])
        designs = [Design(*names, [key], (0,), np.zeros((0, 1)), prior[:1]) for *names, key in (
            ("filter_lag", "", "tau"), ("motion", "rates", "x0"))]
        units.append(moves_unit.unit(
            np.tile(np.eye(2), (12, 1, 1)), inner, left, np.arange(2), np.zeros(0, int), prior,
            np.ones(2), designs, np.array([varying, 0.0])))
    return units


def costs_of_moves(units):
    forms = hypotheses.forms_of(units, drift=False)
    return forms, cutoffs.Cutoffs(0.0, 0.06, own=cutoffs.simulated_each(
        units, forms, moves_unit.NO_LEVELS, [0, 0]))


def test_what_one_form_gains_by_chance_does_not_hide_another():
    units = moves(np.random.default_rng(3), 1.5)
    forms, cost = costs_of_moves(units)
    model = scored_sets.Model(units, [u.statistics() for u in units], moves_unit.NO_LEVELS)
    lag, rate = (cost.own[f] for f in forms)
    assert lag < 15.0 < 4.0 * lag < rate
    assert cutoffs.simulated(units, forms, moves_unit.NO_LEVELS, [0, 0]) > 4.0 * lag
    found = posterior.search_sets(model, forms, cost)
    assert found.best.names == {"filter_lag"}
    assert found.places["filter_lag"]["filter_lag"] > 0.99


def test_a_lag_within_what_each_session_has_of_its_own_is_none():
    """The sums of a unit are those of readings whose covariance has the lag's own column in it."""
    for varying in (0.0, 1.0):
        units = moves(np.random.default_rng(3), 1.5, varying)
        forms, cost = costs_of_moves(units)
        model = scored_sets.Model(units, [u.statistics() for u in units], moves_unit.NO_LEVELS)
        names = posterior.search_sets(model, forms, cost).best.names
        assert names == (set() if varying else {"filter_lag"})
    # 12 moves, each of an information of 1: the mean is known to 1/12 and the session's own 1.
    assert units[0].gram.at(0)[0, 0] == pytest.approx(1.0 / (1.0 / 12.0 + 1.0))
    strong = moves(np.random.default_rng(3), 8.0, 1.0)
    forms, cost = costs_of_moves(strong)
    model = scored_sets.Model(strong, [u.statistics() for u in strong], moves_unit.NO_LEVELS)
    assert "filter_lag" in posterior.search_sets(model, forms, cost).best.names


def test_costs_of_each_form_keep_the_chance_of_any():
    """The signs are drawn by a generator that the costs have not seen."""
    units = moves(np.random.default_rng(3), 1.5)
    forms, cost = costs_of_moves(units)
    generator = np.random.default_rng(99)
    wrong = 0
    for _ in range(200):
        drawn = [u.statistics(u.draw(0, generator, 1)) for u in units]
        model = scored_sets.Model(units, drawn, moves_unit.NO_LEVELS)
        wrong += bool(posterior.search_sets(model, forms, cost).best.forms)
    assert wrong <= 4  # a chance of 0.5 % each


def smooth(named, n=40):
    """A session with a named effect of a form (n,) on each axis, and something nameless that is
    straight or bent."""
    u = np.linspace(-1.0, 1.0, n)
    each = np.eye(3)

    def columns(*forms):
        return np.concatenate([np.kron(form[:, None], each) for form in forms], axis=1)
    ten = np.full(6, 10.0)
    designs = [Design("thermal_bias", "", list("xyz"), [0, 1, 2], columns(named), ten[:3]),
               Design("time", "", ["x0", "y0", "z0", "x1", "y1", "z1"], [0, 1, 2, 0, 1, 2],
                      columns(u, u ** 2), ten)]
    groups = covariance.alone(np.eye(3 * n), np.zeros((3 * n, 0)), np.eye(3 * n))
    return linear_model.unit(Rows(np.zeros(3 * n), groups, np.kron(np.ones((n, 1)), each),
                                  ((0.0,), (0.01, 1.0))), designs)


def test_strangers_that_look_like_a_name_make_every_name_less_sure(monkeypatch):
    monkeypatch.setattr(mimicry, "STRANGERS", 30)
    taken = {}
    for name, form in (("alike", np.linspace(-1.0, 1.0, 40)), ("unlike", (-1.0) ** np.arange(40))):
        units = [smooth(form), smooth(form)]
        found = mimicry.simulated(units, hypotheses.forms_of(units), USUAL, [0, 0])
        taken[name] = found.whole()
        assert found.whole(0.1) >= found.whole(0.5) >= taken[name]
        assert found.beside(0.1) >= found.beside(0.9)
    assert 2.0 * taken["unlike"] < taken["alike"] > 0.1
    sure = [odds.of_name(0.99, mimicked, outside) for mimicked, outside in (
        (0.0, 1.0), (taken["unlike"], 0.0), (taken["unlike"], 1.0), (taken["alike"], 1.0))]
    assert odds.of_name(0.99, 0.2, 1.0, odds.BESIDE) < odds.of_name(0.99, 0.2, 1.0)
    assert sure[0] == 0.99 and sure == sorted(sure, reverse=True) and len(set(sure)) == 4


def test_where_no_form_is_left_to_compete_a_cost_is_not_simulated():
    """Half a session, whose few turns show no effect at all."""
    assert cutoffs.for_protocol([], [], USUAL).member == cutoffs.LEAST_NATS


def test_what_is_not_in_the_library_is_rarer_and_a_level_of_noise_is_not():
    cost = cutoffs.Cutoffs(5.0, 0.02)
    named, nameless = (hypotheses.Form(name, shared=Columns(np.array([0]), np.ones(1)))
                       for name in ("thermal_bias", "orientation"))
    level = hypotheses.Form("session", free=frozenset(["switch_on"]))
    assert cost.nats(nameless) - cost.nats(named) == pytest.approx(np.log(odds.INSIDE))
    assert cost.nats(level) == cost.nats(named) == 5.0


def lagging(generator, n=40):
    """A unit whose readings follow a course that it has twice, as it is and half a step behind: by
    half as much again would the second have to be larger."""
    one = np.zeros((n, 3))
    one[:, 0] = np.sin(np.linspace(0.0, 3.0, n))
    later = one / 1.5
    y = 4.0 * one + generator.standard_normal((n, 3))
    designs = [Design("thermal_bias", name, ["x"], [0], columns.reshape(-1, 1), np.array([50.0]))
               for name, columns in (("", one), ("lag 15 s", later))]
    groups = covariance.alone(np.eye(3 * n), np.zeros((3 * n, 0)), np.eye(3 * n))
    return linear_model.unit(Rows(y.reshape(-1), groups, np.kron(np.ones((n, 1)), np.eye(3)),
                                  ((0.0,), (0.01, 1.0))), designs)


def test_a_size_is_as_uncertain_as_the_lag_that_nothing_tells():
    units = [lagging(np.random.default_rng(seed)) for seed in (3, 4)]
    model, forms = model_of(units), hypotheses.forms_of(units)
    best = posterior.search_sets(model, forms, cutoffs.Cutoffs(5.0, 0.02))
    cause, = aliases.causes(best, units, forms)
    full = members.in_full(model, forms, best, cause)
    assert len(full.variants) == 2 and sum(p for p, _ in full.variants) == pytest.approx(1.0)
    gram = sum(u.gram.at(int(f.index[0])) for u, f in zip(units, best.best.fits))
    sizes = {one.chosen[0].variant: effect_estimates.effective(one, gram)[0]["x"]
             for _, one in full.variants}
    assert sizes["lag 15 s"] == pytest.approx(1.5 * sizes[""], rel=0.02)
    theta, spread = effect_estimates.effective(full, gram)
    sigma = {"x": float(np.sqrt(spread[0, 0]))}
    own, mixed = (effect_estimates._intervals(one, gram, theta, sigma)["x"]
                  for one in (cause, full))
    assert own == pytest.approx((theta["x"] - odds.Z_90 * sigma["x"],
                                 theta["x"] + odds.Z_90 * sigma["x"]))
    assert mixed[0] < sizes[""] and mixed[1] > sizes["lag 15 s"]
    assert own[1] - own[0] < 0.7 * (mixed[1] - mixed[0])


@pytest.mark.parametrize("needed, told", [({0}, set()), ({0, 2}, {2}), ({2}, {2})])
def test_no_axis_is_told_that_the_form_found_is_not_on(monkeypatch, needed, told):
    """A product on x was said to be on z, without a size there: of all three axes z needed it."""
    monkeypatch.setattr(members, "_needed_axes", lambda *found: needed)
    monkeypatch.setattr(members, "_without", lambda *found: None)
    cause = aliases.Cause("quadratic", (hypotheses.Form("quadratic", axis=2, axes=(2,)),), 9.0, {})
    assert members._told_axes(None, (), None, cause) == told
