"""Standard errors of the accelerometer's parameters, and how large the residuals should be.

Three things move the mean of a pose: the sensor's noise, the box never lying twice the same
(about 0.05 degrees, which is 0.9 mg across gravity and almost nothing along it, METHOD 1), and a
zero that drifts. The noise is measured within the poses. The scatter of placing is found from
the residuals of the faces' means: 18 numbers for 12 parameters. Of the six left over four see
the scatter, so its part is widened as Student's t with four degrees of freedom asks for. A drift
shows along gravity between a and b of every face, because a flip does not change gravity there.

In all functions r is an AccelerometerResult (solver.py) whose P is still in g.
"""

import math

from sixflip.accelerometer.normal_equations import NormalEquations
from sixflip.accelerometer.scale_form import scale_form
from sixflip.accelerometer.six_faces import corrected
from sixflip.poses.faces import AXIS, face_of_code

PLACING = math.radians(0.05)


def influence(r):
    """Row i of C X': by how much placement i moves each of the four rows of P."""
    equations = NormalEquations(1)
    for m in r.means:
        equations.add(m + [1.0], [0.0])
    c = equations.inverse()
    return [[sum([c[i][j] * m[j] for j in range(3)]) + c[i][3] for i in range(4)]
            for m in r.means]


def face_residuals(r, h):
    """[face, rows, [x, y, z] in g, and per row how much of its error is left in it]."""
    rows = []
    for face in range(6):
        mine = [i for i in range(len(r.poses)) if face_of_code(r.poses[i]) == face]
        if not mine:
            continue
        n = len(mine)
        left = [0.0] * 3
        for pose in (2 * face + 1, 2 * face + 2):
            k = r.poses.count(pose)
            if k:
                left = [left[j] + r.residual[pose][j] * k / n for j in range(3)]
        m = [sum([r.means[i][k] for i in mine]) / n for k in range(3)] + [1.0]
        kept = [(1.0 / n if i in mine else 0.0) - sum([m[k] * h[i][k] for k in range(4)])
                for i in range(len(r.poses))]
        rows.append((face, n, left, kept))
    return rows


def residual_variance(r, kept, axis, placing):
    """Variance of a face's residual along axis: (from noise, from scatter `placing`), g2."""
    noise = scatter = 0.0
    for i in range(len(kept)):
        k2 = kept[i] * kept[i]
        noise += k2 * r.variance[i][axis]
        if AXIS[face_of_code(r.poses[i])] != axis:
            scatter += k2
    return noise, scatter * placing * placing


# t(4) at 95 % is 2.78; two sigma should reach as far.
STUDENT = 1.39


def mean_variance(noise, n):
    """Variance of the mean of n samples in counts2, noise in counts as measured.

    White noise, plus the error of rounding, which little noise does not average out:
    (1/pi) exp(-2 pi2 s2) counts at most (Widrow, Kollar: Quantization Noise, 2008, ch. 4).
    """
    s2 = noise * noise - 1.0 / 12.0
    rounding = math.exp(-19.74 * s2) / math.pi if s2 > 0.0 else 1.0 / math.pi
    return noise * noise / n + 0.5 * rounding * rounding


def _scatter(r, h):
    """Variance of placing the box, g2, from the residuals beyond the noise; never below 0."""
    squares = noise = weight = 0.0
    for _, n, left, kept in face_residuals(r, h):
        for axis in range(3):
            v, s = residual_variance(r, kept, axis, 1.0)
            squares += n * left[axis] * left[axis]
            noise += n * v
            weight += n * s
    return max(0.0, squares - noise) / weight if weight > 0.0 else 0.0


def _drift(r, used):
    """(per axis the square of a steady drift of its zero beyond the noise, g2 per 1000
    samples squared; the time of every placement in that unit, its mean taken out).

    An order of the faces exists for every axis in which a drift hides in its scale, and no
    residual shows it.
    """
    times = [p.first * 1e-3 for p in used]
    slope, weight, noise = [0.0] * 3, [0.0] * 3, [0.0] * 3
    for face in range(6):
        mine = [i for i in range(len(used)) if face_of_code(r.poses[i]) == face]
        k = AXIS[face]
        middle = sum([times[i] for i in mine]) / max(1, len(mine))
        for i in mine:
            t = times[i] - middle
            slope[k] += t * corrected(r.P, r.means[i])[k]
            weight[k] += t * t
            noise[k] += t * t * r.variance[i][k]
    middle = sum(times) / len(times)
    return ([max(0.0, slope[k] * slope[k] - noise[k]) / (weight[k] * weight[k])
             if weight[k] > 0.0 else 0.0 for k in range(3)], [t - middle for t in times])


def spread(r, used, lsb_per_g):
    """Fill noise_g, variance, scatter_g, sigma_P, sigma_scale, sigma_v of a solve in g."""
    r.variance = [[mean_variance(p.noise[k], p.n) / (lsb_per_g * lsb_per_g) for k in range(3)]
                  for p in used]
    total = sum([p.noise[k] * p.noise[k] for p in used for k in range(3)])
    r.noise_g = math.sqrt(total / (3 * len(used))) / lsb_per_g
    h = influence(r)
    variance = _scatter(r, h)
    r.scatter_g = math.sqrt(variance)
    variance *= STUDENT * STUDENT
    _, _, v, inverse = scale_form(r.P)
    P = [[0.0] * 3 for _ in range(4)]
    u = [0.0] * 3
    drift, times = _drift(r, used)
    moved = [sum([h[i][k] * times[i] for i in range(len(h))]) for k in range(4)]
    at_v = moved[3] - moved[0] * v[0] - moved[1] * v[1] - moved[2] * v[2]
    for j in range(3):
        u[j] = at_v * at_v * drift[j]
        for k in range(4):
            P[k][j] = moved[k] * moved[k] * drift[j]
    for i in range(len(h)):
        # First order: the error of v is A^-1 times that of the corrected vector at -v.
        at_v = h[i][3] - h[i][0] * v[0] - h[i][1] * v[1] - h[i][2] * v[2]
        for j in range(3):
            d = r.variance[i][j]
            if AXIS[face_of_code(r.poses[i])] != j:
                d += variance
            u[j] += at_v * at_v * d
            for k in range(4):
                P[k][j] += h[i][k] * h[i][k] * d
    r.sigma_P = [[math.sqrt(x) * (r.g if k == 3 else 1.0) for x in P[k]] + [0.0]
                 for k in range(4)]
    r.sigma_scale = [r.sigma_P[k][k] for k in range(3)]
    r.sigma_v = [r.g * math.sqrt(sum([inverse[i][j] * inverse[i][j] * u[j] for j in range(3)]))
                 for i in range(3)]
