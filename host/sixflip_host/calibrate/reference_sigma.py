"""Standard errors of the accelerometer's parameters again, in numpy.

Three sources: noise within the poses, the scatter of placing the box, found from what the
faces' means leave over and widened for its few degrees of freedom (Student's t, 4, 95 %), and
a steady drift of the zeros, found from a and b of each face along gravity.
"""

import numpy as np

from sixflip.poses.faces import AXIS, face_of_code

STUDENT = 2.78 / 2


def sigma_P(poses, X, P, residual, variance, g, times):
    """4 x 3 standard errors, rows 0..2 without unit, row 3 in m/s².

    poses     codes (n,); X (n, 4) measured rows in g with their 1; P (4, 3) in g
    residual  (n, 3) what every placement leaves over, g, averaged over those of one pose
    variance  (n, 3) of every placement's mean, g²
    times     (n,) when each was made, in any unit
    """
    faces = np.array([face_of_code(int(pose)) for pose in poses])
    upright = np.array([AXIS[face] for face in faces])[:, None] == np.arange(3)
    H = np.linalg.pinv(X)
    found = noise = weight = 0.0
    for face in np.unique(faces):
        mine = faces == face
        kept = mine / mine.sum() - X[mine].mean(axis=0) @ H
        found += mine.sum() * (residual[mine].mean(axis=0) ** 2).sum()
        noise += mine.sum() * (kept ** 2 @ variance).sum()
        weight += mine.sum() * (kept ** 2 @ ~upright).sum()
    scatter = max(0.0, found - noise) / weight * STUDENT ** 2 if weight else 0.0
    drift = _drift(faces, upright, X @ P, variance, times)
    out = np.sqrt(H ** 2 @ (variance + ~upright * scatter)
                  + np.outer((H @ (times - times.mean())) ** 2, drift))
    out[3] *= g
    return out


def _drift(faces, upright, corrected, variance, times):
    """(3,) g² per unit of time squared, beyond what noise explains: a straight line through
    what an axis reads along gravity while it lies on one face."""
    own = np.array([times[faces == face].mean() for face in faces])
    lever = np.where(upright, (times - own)[:, None], 0.0)
    weight = (lever ** 2).sum(axis=0)
    excess = (lever * corrected).sum(axis=0) ** 2 - (lever ** 2 * variance).sum(axis=0)
    return np.maximum(excess, 0.0) / np.where(weight, weight, np.inf) ** 2


def mean_variance(placements, lsb_per_g):
    """(n, 3) variance in g² of the mean of every placement: noise, and rounding when it is small.

    Rounding: with a noise of s counts the error of a mean is up to exp(-2 pi² s²)/pi counts
    (Widrow and Kollar, Quantization Noise, 2008, ch. 4), half its square on average.
    """
    noise = np.array([one.noise[:3] for one in placements])
    n = np.array([[one.n] for one in placements])
    inner = np.maximum(noise ** 2 - 1 / 12, 0)
    rounding = np.exp(-2 * np.pi ** 2 * inner) / np.pi
    return (noise ** 2 / n + rounding ** 2 / 2) / lsb_per_g ** 2
