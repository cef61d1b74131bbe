"""The solvers against numpy and scipy, which get there another way: SVD, joint least squares."""

import math

import flipped_box as box
import numpy as np
import pytest
from scipy.optimize import least_squares

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer.normal_equations import NormalEquations, SingularSystem, eliminate
from sixflip.accelerometer.scale_form import scale_form
from sixflip.gyro import solver as gyroscope

UP = np.array(box.UP, float)


def part(rng, spread=0.02):
    """A sensor's matrix and offset."""
    return np.eye(3) + rng.normal(0, spread, (3, 3)), rng.normal(0, 0.05, 3)


def session(seed, tilt_deg, noise_g=0.0, across=0.0):
    M, b = part(np.random.default_rng(seed))
    return box.placements(box.gravities(tilt_deg), M.tolist(), b.tolist(), noise_g, seed=seed + 1,
                          across=across), M, b


def rows(placements):
    return np.array([[*(np.array(p.sums[:3]) / (p.n * box.LSB)), 1.0] for p in placements])


@pytest.mark.parametrize("seed", range(20))
def test_weighted_normal_equations_are_the_svd_of_the_rows(seed):
    rng = np.random.default_rng(seed)
    X, Y, w = rng.normal(size=(15, 4)), rng.normal(size=(15, 2)), rng.uniform(0.1, 9, 15)
    equations = NormalEquations(2)
    for row, truth, weight in zip(X.tolist(), Y.tolist(), w.tolist()):
        equations.add(row, truth, weight)
    root = np.sqrt(w)[:, None]
    np.testing.assert_allclose(equations.solve(), np.linalg.pinv(root * X) @ (root * Y),
                               atol=1e-11)
    _, s, V = np.linalg.svd(root * X, full_matrices=False)
    np.testing.assert_allclose(equations.inverse(), V.T @ np.diag(s ** -2) @ V, atol=1e-11)


def test_a_rank_that_numpy_finds_lacking_is_refused():
    rng = np.random.default_rng(5)
    for _ in range(20):
        X = rng.normal(size=(9, 3)) @ rng.normal(size=(3, 4))
        assert np.linalg.matrix_rank(X) == 3
        with pytest.raises(SingularSystem):
            eliminate((X.T @ X).tolist(), [[1.0]] * 4)


@pytest.mark.parametrize("level", ["flip average", "no flips"])
def test_levels_with_a_known_truth(level):
    for seed in range(10):
        placements, _, _ = session(seed, 2.0, 0.004, 0.001)
        r = accelerometer.solve(placements, box.LSB, level=level)
        X, Y = rows(placements), np.repeat(UP, 2, axis=0)
        if level == "flip average":
            X, Y = X.reshape(6, 2, 4).mean(axis=1), UP
        P = np.linalg.pinv(X) @ Y
        P[3] *= accelerometer.G
        np.testing.assert_allclose(np.array(r.P)[:, :3], P, atol=1e-11)


def joint(placements):
    """P by scipy: twelve parameters and two angles of tilt a face, all at once.

    The tilt is an azimuth-free pair of small rotations, not the solver's half difference.
    """
    X = rows(placements)
    planes = [np.roll(np.eye(3), -1 - int(np.argmax(abs(u))), axis=0)[:2] for u in UP]

    def truth(angles):
        out = []
        for u, plane, (p, q) in zip(UP, planes, angles.reshape(6, 2)):
            length = math.hypot(p, q)
            across = np.sinc(length / math.pi) * (p * plane[0] + q * plane[1])
            out += [math.cos(length) * u + across, math.cos(length) * u - across]
        return np.array(out)

    def residual(x):
        return (X @ x[:12].reshape(4, 3) - truth(x[12:])).ravel()

    start = np.concatenate([np.eye(4)[:, :3].ravel(), np.full(12, 0.01)])
    found = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    return found.x[:12].reshape(4, 3), np.hypot(*found.x[12:].reshape(6, 2).T)


@pytest.mark.parametrize("tilt_deg", [0.5, 2.0, 5.0])
def test_tilt_solved_is_the_joint_least_squares(tilt_deg):
    for seed in range(3):
        placements, _, _ = session(seed, tilt_deg, 0.002, 0.0005)
        r = accelerometer.solve(placements, box.LSB)
        P, tilts = joint(placements)
        P[3] *= accelerometer.G
        # The two differ by noise along gravity times the tilt: thousandths of a mg.
        np.testing.assert_allclose(np.array(r.P)[:, :3], P, atol=2e-5)
        np.testing.assert_allclose([r.tilts[f] for f in range(6)], np.degrees(tilts), atol=2e-3)


def test_the_last_round_is_the_svd_of_its_own_truth():
    for seed in range(10):
        placements, _, _ = session(seed, 4.0, 0.004, 0.001)
        r = accelerometer.solve(placements, box.LSB)
        Y = []
        for face in range(6):
            for across in r.across[face]:
                t = np.array(across)
                Y.append(t + UP[face] * math.sqrt(1 - t @ t))
        P = np.linalg.lstsq(rows(placements), np.array(Y), rcond=None)[0]
        P[3] *= accelerometer.G
        np.testing.assert_allclose(np.array(r.P)[:, :3], P, atol=1e-11)


def test_the_form_with_scale_puts_p_together_again():
    rng = np.random.default_rng(1)
    for _ in range(50):
        A, o = np.eye(3) + rng.normal(0, 0.1, (3, 3)), rng.normal(0, 1, 3)
        T, S, v, inverse = scale_form(np.vstack([A.T, o]).tolist())
        np.testing.assert_allclose(np.array(T) @ np.diag(S), A, atol=1e-12)
        np.testing.assert_allclose(np.array(v), np.linalg.solve(A, o), atol=1e-12)
        np.testing.assert_allclose(inverse, np.linalg.inv(A), atol=1e-12)
        np.testing.assert_array_equal(np.diag(T), 1.0)


def test_standard_errors_are_those_of_many_sessions():
    """Empirical spread over sessions against the mean of the standard errors told."""
    M, b = part(np.random.default_rng(3))
    found, told = [], []
    for seed in range(120):
        r = accelerometer.solve(box.placements(box.gravities(2), M.tolist(), b.tolist(), 0.004,
                                               seed=seed, across=0.00087), box.LSB)
        found.append(np.concatenate([np.array(r.P)[:, :3].ravel(), r.v]))
        told.append(np.concatenate([np.array(r.sigma_P)[:, :3].ravel(), r.sigma_v]))
    ratio = np.mean(told, axis=0) / np.std(found, axis=0)
    # Wider than the spread where a hand's scatter has to be guessed from four numbers.
    assert ratio.min() > 0.8
    assert ratio.max() < 1.8


@pytest.mark.parametrize("seed", range(8))
def test_the_gyro_is_the_svd_of_weighted_turns(seed):
    M, _ = part(np.random.default_rng(seed))
    bias = np.random.default_rng(seed).normal(0, 2, 3)
    rests, moves = box.gyro_session(M.tolist(), bias.tolist(), 0.4, 0.05, seed=seed)
    r = gyroscope.solve(rests, moves, box.GYRO_LSB)
    X, Y, sigma = [], [], []
    for p in rests:
        X.append([*np.radians(np.array(p.sums[3:6]) / p.n / box.GYRO_LSB) * 4.0, 4.0])
        Y.append(np.zeros(3))
        white = np.radians(max(p.noise[3:6]) / box.GYRO_LSB) * 4.0 / math.sqrt(p.n)
        sigma.append(math.hypot(white, np.radians(0.005) * 4.0))
    for m in moves:
        face, other = [(rests[k].pose - 1) // 2 for k in (m.before, m.after)]
        if face == other:
            turn = np.radians(np.array(m.gyro_sums) / m.n / box.GYRO_LSB) * 2.5
            X.append([*turn, 2.5])
            Y.append(math.pi * UP[face] * np.sign((turn - np.radians(bias) * 2.5) @ UP[face]))
            sigma.append(np.radians(0.4))
    root = 1 / np.array(sigma)[:, None]
    P = np.linalg.lstsq(root * np.array(X), root * np.array(Y), rcond=None)[0]
    np.testing.assert_allclose(r.P, P, atol=1e-10)
    np.testing.assert_allclose(np.radians(r.bias_dps), -P[3] @ np.linalg.inv(P[:3]), atol=1e-10)
