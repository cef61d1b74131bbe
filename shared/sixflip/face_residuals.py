"""What a fit leaves over on every face, and how much of it noise and placing explain.

r is an AccelerometerResult still in g.
"""

import math

from sixflip.faces import AXIS, face_of_code
from sixflip.normal_equations import NormalEquations

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
    out = []
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
        out.append((face, n, left, kept))
    return out


def residual_variance(r, kept, axis, placing):
    """Variance of a face's residual along axis: (from noise, from scatter `placing`), g2."""
    noise = scatter = 0.0
    for i in range(len(kept)):
        k2 = kept[i] * kept[i]
        noise += k2 * r.variance[i][axis]
        if AXIS[face_of_code(r.poses[i])] != axis:
            scatter += k2
    return noise, scatter * placing * placing
