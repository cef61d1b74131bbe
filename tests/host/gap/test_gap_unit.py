"""A session's sufficient statistics against the plain algebra, point by point of the grid."""
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from sixflip_host.diagnosis import adequacy
from sixflip_host.diagnosis.elimination import NONE
from sixflip_host.experiment import (
    attitude_fit,
    blocks,
    covariance,
    linear_model,
    nominal_rows,
)
from sixflip_host.experiment.noise_arrays import flicker_kernel
from sixflip_host.experiment.nominal_rows import Rows
from sixflip_host.experiment.projection import across_blocks, lateral_basis
from sixflip_host.experiment.terms import Design
from sixflip_host.simulation import scenario, simulated_session

SECONDS = np.array([2.0, 2.0, 2.5, 2.5, 2.5, 4.0, 1.5, 1.5, 3.0, 3.0])
T = np.cumsum(SECONDS) - 0.5 * SECONDS + 7.0 * np.array([0, 0, 1, 1, 1, 2, 3, 3, 4, 4])
SHARES = np.array([0.7, 1.0, 1.8])
PLACES = (slice(0, 2), slice(2, 5), slice(5, 6), slice(6, 8), slice(8, 10))
FREE = (1, 3)  # placements that lean: free across gravity


class Plain:
    """A session of five placements, with so many columns of effects, and the same in matrices of
    all readings."""

    def __init__(self, loud=2):
        rng = np.random.default_rng(12)
        n = 3 * len(T)
        self.base, self.lateral, self.free, parts = np.zeros((n, n)), [], [], []
        for number, place in enumerate(PLACES):
            k = place.stop - place.start
            own = slice(3 * place.start, 3 * place.stop)
            root = rng.standard_normal((3 * k, 3 * k))
            base = root @ root.T + 0.5 * np.eye(3 * k)
            self.base[own, own] = base
            columns = np.zeros((n, 2))
            up = rng.standard_normal(3)
            columns[own] = np.tile(lateral_basis(up / np.linalg.norm(up)).T, (k, 1))
            free = number in FREE
            (self.free if free else self.lateral).append(columns)
            parts.append((place, base, columns[own, :0 if free else 2],
                          across_blocks(columns[own]) if free else np.eye(3 * k)))
        self.lateral, self.free = np.hstack(self.lateral), np.hstack(self.free)
        self.kernel = np.kron(flicker_kernel(T, SECONDS), np.diag(SHARES))
        self.common = rng.standard_normal((n, 1))
        self.columns = np.hstack([rng.standard_normal((n, loud)), np.zeros((n, 1))])
        self.nuisance, self.y = rng.standard_normal((n, 4)), rng.standard_normal(n)
        design = Design("slope", "", list(map(str, range(loud + 1))), [0] * (loud + 1),
                        self.columns, np.full(loud + 1, 10.0))
        self.unit = linear_model.unit(Rows(
            self.y, covariance.in_time(T, SECONDS, SHARES, parts), self.nuisance,
            ((0.0, 0.3, 20.0), (0.01, 1.0)), (), self.common), [design])
        # Contrasts: all readings across what is a nuisance.
        self.across = linalg.null_space(np.hstack([self.nuisance, self.free]).T)

    def covariance(self, placement, flicker):
        whole = self.base + placement ** 2 * self.lateral @ self.lateral.T \
            + flicker ** 2 * self.kernel + self.common @ self.common.T
        return self.across.T @ whole @ self.across


@pytest.fixture(scope="module")
def plain():
    return Plain()


@pytest.mark.parametrize("few", [0, covariance.FEW])  # group by group, and one matrix of all
@pytest.mark.parametrize("loud", [2, 60])  # fewer than there are contrasts, and more
def test_statistics_are_those_of_the_covariance_at_every_point(loud, few, monkeypatch):
    monkeypatch.setattr(covariance, "FEW", few)
    plain = Plain(loud)
    unit, q = plain.unit, plain.across
    assert unit.freedom == q.shape[1] and len(unit.grid) == 6
    assert unit.silent.tolist() == [False] * loud + [True]
    few = np.array([1, loud, 0])
    others = np.random.default_rng(1).standard_normal((len(plain.y), 3))
    quadratic, projections = unit.statistics(np.stack([unit.contrasts(y) for y in others.T], 1))
    for index, point in enumerate(unit.grid):
        c = plain.covariance(*point)
        inverse, s, z = np.linalg.inv(c), q.T @ plain.columns, q.T @ plain.y
        products = s.T @ inverse @ s
        assert unit.gram.at_all_points(few)[index] == pytest.approx(products[np.ix_(few, few)])
        assert unit.gram.blocks(np.array([index]), few[:1], few) == pytest.approx(
            products[None, few[:1]][:, :, few])
        assert unit.gram.each(np.array([index]), few[None, :2])[0, 0] == pytest.approx(
            products[np.ix_(few[:2], few[:2])])
        assert unit.gram.at(index) == pytest.approx(products)
        assert unit.logdet[index] == pytest.approx(0.5 * np.linalg.slogdet(c)[1])
        assert unit.quadratic[index] == pytest.approx(z @ inverse @ z)
        assert unit.inner[index] == pytest.approx(s.T @ inverse @ z)
        other = q.T @ others
        assert quadratic[index] == pytest.approx(np.einsum("ir,ij,jr->r", other, inverse, other))
        assert projections[index] == pytest.approx(s.T @ inverse @ other)
        assert unit.noise_energy(*point) == pytest.approx(np.trace(c))
        known = q.T @ plain.common
        # What the readings leave open of a coefficient of standard deviation 1.
        left = 1.0 - known.T @ inverse @ known
        assert 0.0 < left < 0.9
        fitted = replace(unit, rows=replace(unit.rows, fitted=True))
        assert fitted.noise_energy(*point) == pytest.approx(
            np.trace(c) - (1.0 - left) * float((known ** 2).sum()))
        assert unit.chi2(unit.z, index) == pytest.approx(z @ inverse @ z)
        assert unit.weight(index) == pytest.approx(np.trace(inverse))


def test_points_that_are_not_asked_for_say_so(plain):
    unit, z = plain.unit, plain.unit.z[:, None]
    quadratic, projections = unit.statistics(z, unit.coarse)
    others = np.setdiff1d(np.arange(len(unit.grid)), unit.coarse)
    assert 0 < len(others) < len(unit.grid)
    assert np.isnan(quadratic[others]).all()
    assert quadratic[unit.coarse, 0] == pytest.approx(unit.quadratic[unit.coarse])
    assert projections[unit.coarse, :, 0] == pytest.approx(unit.inner[unit.coarse])


@pytest.mark.parametrize("likelihood, kept", [
    ((0, 0, 0, 0, -9, 0), (0, 4)), ((0, 0, 0, 0, -11, 0), (0,)), ((-50, 0, 0, 0, 0, 0), (0, 4))])
def test_a_louder_level_far_behind_a_quieter_one_is_not_tried(plain, likelihood, kept):
    assert plain.unit.coarse.tolist() == [0, 4]  # the quietest, and the same flicker with leaning
    assert plain.unit.tried(np.array(likelihood, float)).tolist() == list(kept)


def test_contrasts_have_the_size_of_what_the_nuisance_leaves(plain):
    left = plain.across @ (plain.across.T @ plain.y)
    assert plain.unit.z @ plain.unit.z == pytest.approx(left @ left)
    assert plain.unit.in_rows(plain.unit.z) == pytest.approx(left)
    assert plain.unit.contrasts(plain.y + plain.nuisance @ [1, 2, 3, 4]
                                + plain.free @ [5, 6, 7, 8]) == pytest.approx(plain.unit.z)


def test_a_draw_has_the_covariance_of_its_point(plain):
    unit = plain.unit
    index = unit.grid.index((0.3, 1.0))
    chi2 = unit.statistics(unit.draw(index, np.random.default_rng(2), 40000))[0][index]
    assert chi2.mean() == pytest.approx(unit.freedom, rel=0.01)
    assert chi2.var() == pytest.approx(2 * unit.freedom, rel=0.05)


def test_the_factor_multiplied_out_is_the_covariance(plain):
    groups = plain.unit.rows.groups
    whole = covariance.dense(groups, 0.3, 1.0)
    expected = plain.base + 0.09 * plain.lateral @ plain.lateral.T + plain.kernel
    assert whole == pytest.approx(expected)
    factor = covariance.Factor(groups, [0.3], 1.0)
    root = factor.coloured(np.eye(len(plain.y)))
    assert root == pytest.approx(np.linalg.cholesky(expected))
    assert factor.whitened(root)[0] == pytest.approx(np.eye(len(plain.y)), abs=1e-9)
    both = covariance.Factor(groups, [0.1, 0.3], 1.0)
    inverse = both.whitened_back(both.whitened(np.eye(len(plain.y))))
    assert inverse[1] == pytest.approx(np.linalg.inv(expected))
    assert both.at([1]).whitened(root) == pytest.approx(factor.whitened(root))


def test_placements_that_are_loosened_say_nothing_across(plain):
    loose = linear_model.unit(plain.unit.rows.loosened(), [])
    q = linalg.null_space(np.hstack([plain.nuisance, plain.free, plain.lateral]).T)
    z = q.T @ plain.y
    c = q.T @ (plain.base + plain.kernel + plain.common @ plain.common.T) @ q
    assert loose.freedom == len(z) and len(loose.grid) == 2
    assert loose.quadratic[1] == pytest.approx(z @ np.linalg.solve(c, z))


def test_innovations_are_white(plain):
    unit, index = plain.unit, plain.unit.grid.index((0.3, 1.0))
    z = unit.draw(index, np.random.default_rng(3), 2000)
    rng = np.random.default_rng(4)
    found = []
    for k in range(200):
        drawn = linear_model.unit(Rows(
            unit.in_rows(z[:, k]) + plain.nuisance @ rng.standard_normal(4), unit.rows.groups,
            unit.rows.nuisance, ((0.3,), (1.0,)), (), unit.rows.common), unit.designs)
        left, leverage = drawn.innovations((0.3, 1.0), np.zeros(0, int), 0.0)
        found.append(left / np.sqrt(1.0 - leverage))
    assert found[0].shape == (8, 3)  # three whole placements, and pairs of two that lean
    assert np.std(found) == pytest.approx(1.0, rel=0.05)


def test_how_a_hand_puts_a_box_down_has_any_distribution():
    """Some placements lie far off, as a heading does on a table that leans; a sensor that jumps
    along gravity shows all the same."""
    number, rng = 30, np.random.default_rng(9)
    t = np.cumsum(np.full(2 * number, 2.5))
    parts, y, jump = [], np.zeros((number, 6)), np.zeros((number, 6))
    for k in range(number):
        across = np.tile(np.delete(np.eye(3), k % 3, axis=0).T, (2, 1))
        parts.append((slice(2 * k, 2 * k + 2), 0.01 * np.eye(6), across, np.eye(6)))
        y[k] = across @ (rng.standard_normal(2) * (6.0 if k % 10 == 4 else 0.5))
        jump[k] = np.tile(np.eye(3)[k % 3], 2) * (3.0 if k % 10 == 4 else 0.0)
    y += 0.1 * rng.standard_normal(y.shape)
    silent = Design("slope", "", ["x"], [0], np.zeros((6 * number, 1)), np.ones(1))

    def odd(readings, loose):
        unit = linear_model.unit(Rows(
            readings.ravel(), covariance.in_time(t, np.full(2 * number, 2.5), np.ones(3), parts),
            np.tile(np.eye(3), (2 * number, 1)), ((0.5, 2.0), (0.01,))), [silent])
        left = adequacy.innovations(unit, (2.0, 0.01), NONE, 0.0, loose)
        assert np.isfinite(left).sum() == (4 if loose else 6) * number
        return adequacy.oddity(left)[0]
    assert odd(y, True) == "" and odd(y, False) == "heavy tails"
    assert odd(y + jump, True) == "heavy tails"


def made_of(number):
    """Unit of so many placements of two blocks each, each in an attitude of its own."""
    rng = np.random.default_rng(5)
    seconds = np.full(2 * number, 2.5)
    t = np.cumsum(seconds) + np.repeat(10.0 * np.arange(number), 2)
    parts = []
    for k in range(number):
        up = rng.standard_normal(3)
        columns = np.tile(lateral_basis(up / np.linalg.norm(up)).T, (2, 1))
        parts.append((slice(2 * k, 2 * k + 2), np.eye(6), columns[:, :2 * (k % 2)],
                      np.eye(6) if k % 2 else across_blocks(columns)))
    n = 6 * number
    design = Design("slope", "", ["x"] * 20, [0] * 20, rng.standard_normal((n, 20)), np.ones(20))
    return linear_model.unit(Rows(
        rng.standard_normal(n), covariance.in_time(t, seconds, np.ones(3), parts),
        rng.standard_normal((n, 12)), ((0.5,), (0.1,))), [design])


def test_twice_the_placements_need_no_more_than_twice_the_memory():
    """A matrix of all readings would need four times as much, its factor eight times as long."""
    peaks = []
    for number in (150, 300):
        tracemalloc.start()
        unit = made_of(number)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        # chi2 of white noise that the covariance takes for more than it is
        assert unit.freedom == 5 * number - 12 and 0.0 < unit.quadratic[0] < unit.freedom
    assert peaks[1] < 2.4 * peaks[0]
    assert peaks[1] < (5 * 300) ** 2 * 8


@pytest.mark.parametrize("few", [0, covariance.FEW])
@pytest.mark.parametrize("asked", [[60], [3, 3], [], [60, 5, 3, 5], [4]])
def test_what_was_asked_for_first_is_nothing_to_what_is_asked_for_next(asked, few, monkeypatch):
    monkeypatch.setattr(covariance, "FEW", few)
    once, asked, points = Plain(60).unit.gram, np.array(asked, dtype=int), np.array([2, 0, 2])
    again, every = Plain(60).unit.gram, np.arange(61)
    part = once.blocks(points, asked, every)
    single = once.each(points, asked[:, None])
    products = again.blocks(points, every, every)
    assert part.shape == (3, len(asked), 61) and single.shape == (3, len(asked), 1, 1)
    assert part == pytest.approx(products[:, asked])
    assert single[:, :, 0, 0] == pytest.approx(products[:, asked, asked])
    assert once.blocks(points, every, every) == pytest.approx(products)
    if len(asked):
        assert once.rows(points, asked) == pytest.approx(products[:, asked])


@pytest.mark.parametrize("leaning", [0, 1, 12])
def test_the_columns_of_a_bias_are_its_own_however_many_poses_lean(leaning):
    """Where none leans the misalignments are known beforehand to a degree."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 3})
    session = blocks.session_of("s", simulated_session.session(plan, 0))
    lean = np.unique(session.placement[session.face < 0])
    assert len(lean) >= 12
    session = session.part([p for p in range(session.placements()) if p not in lean[leaning:]])
    rows = nominal_rows.rows("accel", session, attitude_fit.fit(session))
    for axis, column in enumerate(rows.bias):
        assert np.array_equal(rows.nuisance[:, column],
                              np.kron(np.ones(session.n), np.eye(3)[axis]))
    known = rows.common
    assert (known is None) == (leaning > 0) and rows.fitted == (leaning == 0)
    if known is not None:
        assert known.shape == (3 * session.n, 6)
        up = attitude_fit.fit(session).up[session.placement]
        assert np.allclose(known[0::3, 0], nominal_rows.ASKEW_MG * up[:, 1])
