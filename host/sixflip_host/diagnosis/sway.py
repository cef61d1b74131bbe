"""What a person, a robot on its legs or a boat sways by while it is taken for at rest.

Its gyro reads that rightly, and gravity's direction in the accelerometer turns by as much: no
drift of the gyro does that to gravity. In either direction across gravity the angle is a Gaussian
process (Matern's of order 3/2, whose rate exists), of which the accelerometer's means and the
gyro's are both noisy readings. What the accelerometer says of the rate is taken off the gyro's
means, and how far it may be wrong is part of their noise [Rasmussen & Williams, Gaussian Processes
for Machine Learning (2006), sections 2.2, 4.2 and 9.4]. Whatever moves the accelerometer is there
in any case: whether the box turns, or only that sensor wanders, the gyro's likelihood decides.
"""
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from ..experiment.noise_arrays import flicker_kernel
from ..experiment.projection import lateral_basis
from . import odds

# Tried: standard deviations of the angle, from what a floor does to what a person does, and how
# long it goes one way, in lengths of a mean: what is faster is not in the means.
ANGLES_DEG = (0.003, 0.01, 0.03, 0.1, 0.3)
LASTS = (1.0, 3.0, 10.0)
SIMPSON = (1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0)  # of the begin, the middle and the end of a mean


@dataclass(frozen=True, eq=False)
class Sway:
    """rate (n, 3) deg/s by which the box turns in each mean; covariance (3, n, n) of each axis:
    how far the rates may be wrong."""

    rate: np.ndarray
    covariance: np.ndarray


@dataclass(frozen=True, eq=False)
class _Seen:
    """One direction across gravity: angle (m,) deg and rate (k,) deg/s as the sensors read them,
    without the level of each rest and of each session, by the bases (n, m) and (n, k); the
    covariances (m, m) and (k, k) of their noise; flicker (L, k, k) of the gyro, its levels."""

    angle: np.ndarray
    rate: np.ndarray
    bases: tuple
    angle_noise: np.ndarray
    rate_noise: np.ndarray
    flicker: np.ndarray

    def nats(self, of_angle, both, of_rate):
        """(nats of the angles, nats of the rates beside them) of a process whose means have these
        covariances (n, n): of the angles, of rates with angles, and of the rates."""
        mean, left = self.conditional(of_angle, both, of_rate)
        across, along = self.bases
        angle = across.T @ of_angle @ across + self.angle_noise
        rate = along.T @ left @ along + self.rate_noise
        return (_nats(self.angle, angle[None]),
                _nats(self.rate - along.T @ mean, rate + self.flicker))

    def conditional(self, of_angle, both, of_rate):
        """((n,) the rates that the angles foretell, (n, n) covariance of what is left)."""
        across = self.bases[0]
        felt = both @ across
        gain = np.linalg.solve(across.T @ of_angle @ across + self.angle_noise, felt.T).T
        return gain @ self.angle, of_rate - gain @ felt.T


def of_rest(rest, accel_flicker, gyro_flickers):
    """Sway of a long_rest.LongRest, or None where the gyro says nothing of one; accel_flicker: mg
    that the accelerometer has itself, gyro_flickers: levels that the gyro may have, deg/s."""
    if not {"accel", "gyro"} <= set(rest.values):
        return None
    rate, covariance = np.zeros((rest.n, 3)), np.zeros((3, rest.n, rest.n))
    first, second = lateral_basis(rest.up)
    for axis in (first, second):
        seen = _seen(rest, axis, accel_flicker, gyro_flickers)
        tried = [_process(rest, angle, lasts) for lasts in LASTS for angle in ANGLES_DEG]
        nats = [seen.nats(*process) for process in tried]
        best = max(range(len(tried)), key=lambda k: sum(nats[k]))
        still = _nats(seen.rate, seen.rate_noise + seen.flicker)
        if nats[best][1] - still <= odds.COST + odds.PRESENT:
            continue
        mean, left = seen.conditional(*tried[best])
        rate += mean[:, None] * axis
        covariance += axis[:, None, None] ** 2 * left
    return Sway(rate, covariance) if rate.any() else None


def _seen(rest, axis, accel_flicker, gyro_flickers):
    """_Seen of the turns about an axis (3,) across gravity."""
    # Gravity's direction turns against the box: u = up + up x angle.
    across = np.cross(rest.up, axis)
    values, noise = rest.values["accel"], rest.noise["accel"]
    scale = np.degrees(1.0) / max(float(np.linalg.norm(values.mean(axis=0))), 1e-9)
    same = rest.session[:, None] == rest.session
    kernel = flicker_kernel(rest.t, rest.seconds) * same
    bases = _across_levels(rest.rest), _across_levels(rest.session)
    angle_noise = scale ** 2 * (np.diag(noise ** 2 @ across ** 2) + accel_flicker ** 2 * kernel)
    rate_noise = np.diag(rest.noise["gyro"] ** 2 @ axis ** 2)
    angle_noise, rate_noise, kernel = (basis.T @ x @ basis for basis, x in zip(
        (*bases, bases[1]), (angle_noise, rate_noise, kernel)))
    return _Seen(bases[0].T @ (values @ across) * scale, bases[1].T @ (rest.values["gyro"] @ axis),
                 bases, angle_noise, rate_noise,
                 np.array(gyro_flickers)[:, None, None] ** 2 * kernel)


def _process(rest, angle, lasts):
    """Covariances (n, n) of the means of a process: of the angles, of rates with angles, of the
    rates, which are the angle at the end less that at the begin, over the time between."""
    half = 0.5 * rest.seconds
    nodes = np.concatenate([rest.t - half, rest.t, rest.t + half])
    lasts_s = lasts * float(np.median(rest.seconds))
    apart = np.sqrt(3.0) * np.abs(nodes[:, None] - nodes) / lasts_s
    session = np.tile(rest.session, 3)
    kernel = angle ** 2 * (1.0 + apart) * np.exp(-apart) * (session[:, None] == session)
    mean = np.hstack([weight * np.eye(rest.n) for weight in SIMPSON])
    change = np.hstack([k * np.diag(1.0 / rest.seconds) for k in (-1.0, 0.0, 1.0)])
    return mean @ kernel @ mean.T, change @ kernel @ mean.T, change @ kernel @ change.T


def _across_levels(number):
    """(n, m) orthonormal basis across a level of each of these numbers (n,)."""
    levels = (number[:, None] == np.unique(number)).astype(float)
    return linalg.qr(levels)[0][:, levels.shape[1]:]


def _nats(x, covariances):
    """Largest log likelihood of x (m,) by normal noise of one of these covariances (L, m, m)."""
    lower = np.linalg.cholesky(covariances)
    white = np.linalg.solve(lower, np.broadcast_to(x[:, None], (len(lower), len(x), 1)))[..., 0]
    return float((-np.log(np.diagonal(lower, axis1=1, axis2=2)).sum(axis=1)
                  - 0.5 * (white ** 2).sum(axis=1)).max())
