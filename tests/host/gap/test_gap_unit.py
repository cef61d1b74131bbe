"""A session's sufficient statistics against the plain algebra, point by point of the grid."""
import numpy as np
import pytest

from sixflip_host.gap.nominal_fit import Unit
from sixflip_host.gap.regressors import Design


@pytest.fixture
def unit():
    generator = np.random.default_rng(12)
    n = 30
    design = Design("slope", "", ["x", "y"], [0, 1], generator.standard_normal((n, 2)),
                    np.array([10.0, 10.0]))
    root = generator.standard_normal((n, n))
    return Unit(generator.standard_normal(n), generator.standard_normal((n, 4)),
                np.diag(generator.uniform(0.5, 2.0, n)), generator.standard_normal((n, 7)),
                root @ root.T, ((0.0, 0.3, 20.0), (0.01, 1.0)), [design])


def test_statistics_are_those_of_the_covariance_at_every_point(unit):
    z = np.random.default_rng(1).standard_normal((unit.freedom, 3))
    quadratic, projections = unit.statistics(z)
    for index, point in enumerate(unit.grid):
        inverse = np.linalg.inv(unit.covariance(*point))
        assert unit.gram[index] == pytest.approx(unit.columns.T @ inverse @ unit.columns)
        assert unit.logdet[index] == pytest.approx(
            0.5 * np.linalg.slogdet(unit.covariance(*point))[1])
        assert quadratic[index] == pytest.approx(np.einsum("ir,ij,jr->r", z, inverse, z))
        assert projections[index] == pytest.approx(unit.columns.T @ inverse @ z)


def test_a_draw_has_the_covariance_of_its_point(unit):
    index = unit.grid.index((0.3, 1.0))
    drawn = unit.draw(index, np.random.default_rng(2), 40000)
    inverse = np.linalg.inv(unit.covariance(0.3, 1.0))
    chi2 = np.einsum("ir,ij,jr->r", drawn, inverse, drawn)
    assert chi2.mean() == pytest.approx(unit.freedom, rel=0.01)
    assert chi2.var() == pytest.approx(2 * unit.freedom, rel=0.05)
