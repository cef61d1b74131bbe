"""The reference: everything again from the raw samples, in float64, by another route.

Least squares by numpy's SVD instead of normal equations; the table's tilt as unknowns of a
root search instead of repeated substitution; in-plane turns as complex numbers.
"""

import numpy as np

from sixflip.poses.faces import AXIS, FACES, SIGN, face_of_code, is_b

from ..errors import CheckFailed

# Student's t with 4 degrees of freedom is 2.78 at 95 %; two sigma should reach as far.
STUDENT = 2.78 / 2


class Reference:
    """P 4 x 4 (row vectors, m/s²), T 3 x 3, scale [3], v [3] (m/s²), as numpy arrays.

    tilts {face name: deg}, tilt_deg, tilt_spread_deg (None without flips)
    residual {pose code: array [3] in g}; sigma_P 4 x 3; residual_rms_g, noise_g
    """


def pose_means(placements, lsb_per_g):
    """Codes (n,) and means (n, 3) in g of the placements on faces; sums are exact integers."""
    used = [one for one in placements if face_of_code(one.pose) >= 0 and one.n]
    poses = np.array([one.pose for one in used], int)
    means = np.array([[s / one.n for s in one.sums[:3]] for one in used]) / lsb_per_g
    return poses, means.reshape(-1, 3)


def solve(placements, lsb_per_g, g, level="tilt solved", angles=None):
    """The Reference of a session; level as the board said it solved.

    angles {face index: turn from a to b, rad}, right-handed about the face's axis.
    Raises CheckFailed when the poses do not determine the parameters.
    """
    poses, means = pose_means(placements, lsb_per_g)
    X = np.column_stack([means, np.ones(len(means))])
    if len(X) < 4 or np.linalg.matrix_rank(X, tol=1e-4) < 4:
        raise CheckFailed("the poses of the capture do not determine the twelve parameters")
    flips = Flips(poses, means, angles or {})
    used = [one for one in placements if face_of_code(one.pose) >= 0 and one.n]
    across = np.zeros(len(flips.faces), complex)
    if level == "tilt solved":
        across = _root(lambda h: flips.seen(_lstsq(X, flips.truths(h))) - h, across)
    if level == "flip average":
        X_face = np.array([(flips.mean(X, 2 * f + 1) + flips.mean(X, 2 * f + 2)) / 2
                           for f in range(6)])
        P = _lstsq(X_face, np.array([_upright(face, 0) for face in range(6)]))
    else:
        P = _lstsq(X, flips.truths(across))
    solved = _summary(P, X, flips, across, g)
    left = np.array([solved.residual[int(pose)] for pose in poses])
    solved.sigma_P = _sigma_P(poses, X, P, left, _mean_variance(used, lsb_per_g), g,
                              np.array([one.first for one in used]) / 1000)
    solved.residual_rms_g = float(np.sqrt(np.mean(np.square(list(solved.residual.values())))))
    noise = [np.square(placement.noise[:3]) for placement in used]
    solved.noise_g = float(np.sqrt(np.mean(noise)) / lsb_per_g)
    return solved


def _lstsq(X, Y):
    return np.linalg.lstsq(X, Y, rcond=None)[0]


def _upright(face, across):
    """Unit gravity on a face, `across` (complex) of it lying in the table's plane."""
    k = AXIS[face]
    truth = np.zeros(3)
    truth[k] = SIGN[face] * np.sqrt(max(0.0, 1 - abs(across) ** 2))
    truth[(k + 1) % 3], truth[(k + 2) % 3] = np.real(across), np.imag(across)
    return truth


class Flips:
    """What the pairs a, b of every face say about the table."""

    def __init__(self, poses, means, angles):
        self.poses = poses
        self.means = means
        self.faces = [f for f in range(6) if 2 * f + 1 in poses and 2 * f + 2 in poses]
        # gravity as the body sees it turns by minus the box's own turn about the face's axis
        self.turn = np.array([np.exp(-1j * SIGN[f] * angles.get(f, np.pi)) for f in self.faces])

    def mean(self, rows, pose):
        """Mean of the rows of one pose."""
        return rows[self.poses == pose].mean(axis=0)

    def seen(self, P):
        """In-plane gravity of every capture a, from the corrected difference a - b."""
        in_plane = []
        for face, turn in zip(self.faces, self.turn):
            d = (self.mean(self.means, 2 * face + 1) - self.mean(self.means, 2 * face + 2)) @ P[:3]
            k = AXIS[face]
            in_plane.append((d[(k + 1) % 3] + 1j * d[(k + 2) % 3]) / (1 - turn))
        return np.array(in_plane)

    def truths(self, across):
        """True unit gravity (n, 3) of every placement, given `across` of the captures a."""
        gravity = []
        for pose in self.poses:
            face = face_of_code(int(pose))
            h = 0
            if face in self.faces:
                at = self.faces.index(face)
                h = across[at] * (self.turn[at] if is_b(int(pose)) else 1)
            gravity.append(_upright(face, h))
        return np.array(gravity)


def _root(function, start):
    """Complex vector h with function(h) = 0, by Newton's method with a numerical Jacobian."""
    def real(h):
        value = function(h[:len(start)] + 1j * h[len(start):])
        return np.concatenate([value.real, value.imag])

    h = np.concatenate([start.real, start.imag])
    for _ in range(20):
        value = real(h)
        step = 1e-6
        jacobian = np.column_stack([
            (real(h + step * unit) - real(h - step * unit)) / (2 * step)
            for unit in np.eye(len(h))])
        change = np.linalg.solve(jacobian, -value)
        h = h + change
        if np.abs(change).max() < 1e-14:
            break
    return h[:len(start)] + 1j * h[len(start):]


def _summary(P, X, flips, across, g):
    """The Reference with P in m/s² and everything derived from it."""
    summed = Reference()
    seen = flips.seen(P)
    tilts = np.degrees(np.arcsin(np.minimum(1.0, np.abs(seen))))
    summed.tilts = {FACES[face]: float(tilt) for face, tilt in zip(flips.faces, tilts)}
    summed.tilt_deg = float(tilts.mean()) if len(tilts) else None
    summed.tilt_spread_deg = float(np.ptp(tilts)) if len(tilts) else None
    left = X @ P - flips.truths(across)
    summed.residual = {int(pose): left[flips.poses == pose].mean(axis=0)
                       for pose in np.unique(flips.poses)}
    A = P[:3].T
    summed.scale = np.diag(A).copy()
    summed.T = A / summed.scale
    summed.v = np.linalg.solve(A, P[3]) * g
    summed.P = np.zeros((4, 4))
    summed.P[:3, :3], summed.P[3, :3], summed.P[3, 3] = P[:3], P[3] * g, 1
    return summed


def _sigma_P(poses, X, P, residual, variance, g, times):
    """4 x 3 standard errors, rows 0..2 without unit, row 3 in m/s².

    Three sources: noise within the poses, the scatter of placing the box, found from what the
    faces' means leave over and widened for its few degrees of freedom, and a steady drift of
    the zeros, found from a and b of each face along gravity.

    poses     codes (n,); X (n, 4) measured rows in g with their 1; P (4, 3) in g
    residual  (n, 3) what every placement leaves over, g, averaged over those of one pose
    variance  (n, 3) of every placement's mean, g²
    times     (n,) when each was made, in any unit
    """
    faces = np.array([face_of_code(int(pose)) for pose in poses])
    upright = np.array([AXIS[face] for face in faces])[:, None] == np.arange(3)
    H = np.linalg.pinv(X)
    seen = noise = weight = 0.0
    for face in np.unique(faces):
        mine = faces == face
        kept = mine / mine.sum() - X[mine].mean(axis=0) @ H
        seen += mine.sum() * (residual[mine].mean(axis=0) ** 2).sum()
        noise += mine.sum() * (kept ** 2 @ variance).sum()
        weight += mine.sum() * (kept ** 2 @ ~upright).sum()
    scatter = max(0.0, seen - noise) / weight * STUDENT ** 2 if weight else 0.0
    drift = _drift(faces, upright, X @ P, variance, times)
    sigma = np.sqrt(H ** 2 @ (variance + ~upright * scatter)
                    + np.outer((H @ (times - times.mean())) ** 2, drift))
    sigma[3] *= g
    return sigma


def _drift(faces, upright, corrected, variance, times):
    """(3,) g² per unit of time squared, beyond what noise explains: a straight line through
    what an axis reads along gravity while it lies on one face."""
    own = np.array([times[faces == face].mean() for face in faces])
    lever = np.where(upright, (times - own)[:, None], 0.0)
    weight = (lever ** 2).sum(axis=0)
    excess = (lever * corrected).sum(axis=0) ** 2 - (lever ** 2 * variance).sum(axis=0)
    return np.maximum(excess, 0.0) / np.where(weight, weight, np.inf) ** 2


def _mean_variance(placements, lsb_per_g):
    """(n, 3) variance in g² of the mean of every placement: noise, and rounding when it is small.

    Rounding: with a noise of s counts the error of a mean is up to exp(-2 pi² s²)/pi counts
    (Widrow and Kollar, Quantization Noise, 2008, ch. 4), half its square on average.
    """
    noise = np.array([one.noise[:3] for one in placements])
    n = np.array([[one.n] for one in placements])
    inner = np.maximum(noise ** 2 - 1 / 12, 0)
    rounding = np.exp(-2 * np.pi ** 2 * inner) / np.pi
    return (noise ** 2 / n + rounding ** 2 / 2) / lsb_per_g ** 2
