"""The statistics of the gap on small made-up problems whose answer is known."""
import numpy as np
import pytest
from scipy import stats

from sixflip_host.gap import shrinkage, thermometer, where, which
from sixflip_host.gap.nominal_fit import Unit
from sixflip_host.gap.regressors import Design


def unit(generator, theta=0.0, n=40):
    """A session of n blocks of one axis that matters, with a slope in it."""
    slope = np.zeros((n, 3))
    slope[:, 0] = np.linspace(-1.0, 1.0, n)
    other = np.zeros((n, 3))
    other[:, 1] = generator.standard_normal(n)
    design = Design("slope", "", ["x"], [0], slope.reshape(-1, 1), np.array([100.0]))
    rival = Design("other", "", ["y"], [1], other.reshape(-1, 1), np.array([100.0]))
    y = (theta * slope + generator.standard_normal((n, 3))).reshape(-1)
    nuisance = np.kron(np.ones((n, 1)), np.eye(3))
    return Unit(y, nuisance, np.eye(3 * n), np.zeros((3 * n, 0)), np.eye(3 * n),
                ((0.0,), (0.01, 1.0)), [design, rival])


def test_the_score_is_the_log_density_of_the_session_held_out():
    generator = np.random.default_rng(5)
    units = [unit(generator, 2.0), unit(generator, 2.0)]
    data = which.Data(units)
    columns, prior = np.array([0]), np.array([100.0])
    found = which.score(data, columns, prior)[0] - data.base[0]
    fits = which.fits(data, columns, prior)
    expected = 0.0
    for held, train in ((0, 1), (1, 0)):
        theta, spread = which.coefficients([fits[train]], prior)
        s = units[held].columns[:, 0]
        for fit, sign, mean, extra in ((fits[held], 1, theta[0, 0] * s, spread[0, 0, 0]),
                                       (which.fits(data, columns[:0], prior[:0])[held], -1, 0 * s,
                                        0.0)):
            point = units[held].grid[fit.index[0]]
            cov = units[held].covariance(*point) + extra * np.outer(s, s)
            expected += sign * stats.multivariate_normal.logpdf(units[held].z, mean, cov)
    assert found == pytest.approx(expected, abs=1e-6)


def test_only_the_effect_that_is_there_gains():
    generator = np.random.default_rng(8)
    data = which.Data([unit(generator, 3.0), unit(generator, 3.0)])
    gains = {o.effect: g[0] for o, g in which.gains(data, which.candidates(data.units)).items()}
    assert gains["slope"] > 20.0
    assert gains["other"] < 2.0


def test_a_coefficient_that_differs_between_sessions_does_not_gain():
    generator = np.random.default_rng(9)
    data = which.Data([unit(generator, 3.0), unit(generator, -3.0)])
    options = [o for o in which.candidates(data.units) if o.effect == "slope"]
    assert next(iter(which.gains(data, options).values()))[0] < 0.0


def test_fieller_covers_the_true_share_and_owns_up_to_too_small_a_gap():
    generator = np.random.default_rng(3)
    covered = number = 0
    for _ in range(600):
        mean = generator.standard_normal(200)
        predicted = 0.8 * mean + 0.1 * generator.standard_normal(200)
        z = mean + generator.standard_normal(200)
        true = (2 * predicted @ mean - predicted @ predicted) / (mean @ mean)
        share, interval = shrinkage.fieller(z @ z - 200, 2 * predicted @ z - predicted @ predicted,
                                            200, predicted @ predicted, predicted @ z)
        if interval:
            number += 1
            covered += interval[0] <= true <= interval[1]
    assert number > 550
    assert 0.84 <= covered / number <= 0.97
    assert shrinkage.fieller(3.0, 2.0, 200, 1.0, 1.5) == (None, None)


def test_false_discoveries_are_held_down():
    generator = np.random.default_rng(4)
    named = 0
    for _ in range(300):
        tested = [where.Place("accel", "x", "time", 0.1, p) for p in generator.uniform(size=20)]
        named += bool(where.controlled(tested))
    assert named <= 12


def test_a_lag_is_a_lag_and_a_lead_undoes_it_to_first_order():
    t = np.arange(0.0, 900.0)
    felt = 22.0 + 9.0 * (1.0 - np.exp(-t / 300.0))
    meter = thermometer.Thermometer(t, felt)
    late = meter.lagged(t, 20.0)
    true = felt - 9.0 * np.exp(-t / 300.0) * 20.0 / 300.0
    assert np.abs(late - true)[150:].max() < 0.05
    again = thermometer.Thermometer(t, late).lagged(t, -20.0)
    assert np.abs(again - felt)[150:].max() < 0.08
