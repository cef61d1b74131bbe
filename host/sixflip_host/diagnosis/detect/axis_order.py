"""Axes of the accelerometer that are swapped or inverted against the labels of the faces, and
whose they are where there is no label."""
import math
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from sixflip.poses import faces

from .detection import Finding, present

# g, standard deviation of a reading from what an ideal part in that pose has: 80 mg of offset, 3 %
# of scale [MPU-6000 PS rev 3.4, table 6.2], and a degree or two of tilt.
OFF_G = 0.1
# Signed permutations, (3, 3) each: 3! orders, 2^3 signs.
SIGNED = [np.diag(signs) @ np.eye(3)[list(order)] for order in permutations(range(3))
          for signs in product((1.0, -1.0), repeat=3)]


def swapped(sessions):
    """[Finding] where the accelerometer's axes are not as the labels of the faces say: in all
    sessions, or one for each order that some of them have, else []."""
    everywhere = _swapped(sessions)
    if everywhere or len(sessions) == 1:
        return everywhere
    orders = {}
    for session in sessions:
        for finding in _swapped([session]):
            orders.setdefault(tuple(sorted(finding.value.items())), []).append(session)
    return [_of_files(finding, own) for own in orders.values() for finding in _swapped(own)]


def _of_files(finding, sessions):
    """The Finding of sessions that alone have it."""
    names = tuple(session.name for session in sessions)
    return replace(finding, files=names,
                   words="%s in %s alone" % (finding.words, ", ".join(names)))


def _swapped(sessions):
    """[Finding] of an order that all of these sessions have, else []."""
    means, axes = [], []
    for session in sessions:
        if not session.labelled or session.capture.accel is None:
            continue
        for code, first, end in session.runs:
            face = faces.face_of_code(code)
            if face >= 0:
                means.append(session.capture.accel[first:end].mean(axis=0)
                             / session.capture.meta["accel_lsb_per_g"])
                axes.append([faces.SIGN[face] * (k == faces.AXIS[face]) for k in range(3)])
    if len(means) < 4 or np.linalg.matrix_rank(np.array(axes)) < 3:
        return []
    means, axes = np.array(means), np.array(axes)
    matrix = np.linalg.lstsq(np.hstack([axes, np.ones((len(axes), 1))]), means,
                             rcond=None)[0][:3].T  # measured = matrix · true
    best = nearest(matrix)
    if (best == np.eye(3)).all():
        return []
    score = order_nats(means, axes, best)
    if not present(score):
        return []
    value = sources(best)
    return [Finding("axis_swap", "accel", sorted(value), value, "axis", score, "orientation",
                    "axes are swapped or inverted against the labels",
                    {k: (v, v) for k, v in value.items()},
                    share=explained(means - axes, means - axes @ best.T), number=len(means))]


def explained(before, after):
    """Share (0 to 1) of the squares of what is off before that is not after."""
    before, after = np.sum(np.square(before)), np.sum(np.square(after))
    return float(np.clip(1.0 - after / before, 0.0, 1.0)) if before > 0.0 else None


def order_nats(means, axes, order):
    """Log likelihood ratio (nats) of means (n, 3) g being gravity along axes (n, 3) read in
    another order (3, 3), against the plain order, or any matrix at all, which pays for its nine
    free numbers with half a logarithm of the readings each [Schwarz, Ann. Stat. 6 (1978) 461]."""
    free = np.linalg.lstsq(axes, means, rcond=None)[0]
    left = [float(((means - predicted) ** 2).sum()) for predicted in (
        axes @ order.T, axes, axes @ free)]
    named, plain, any_matrix = (-0.5 * squares / OFF_G ** 2 for squares in left)
    nameless = max(plain, any_matrix - 4.5 * math.log(means.size))
    return named - math.log(len(SIGNED)) - nameless


def nearest(matrix):
    """The signed permutation (3, 3) nearest to a matrix."""
    return max(SIGNED, key=lambda signed: (signed * matrix).sum())


def sources(order):
    """{axis: number of the axis that it reads, from 1, with its sign} of a signed permutation,
    without those that read their own."""
    swapped_axes = {}
    for i, row in enumerate(order):
        source = int(np.abs(row).argmax())
        signed = int(row[source]) * (source + 1)
        if signed != i + 1:
            swapped_axes["xyz"[i]] = signed
    return swapped_axes


def whose(read, labelled):
    """(sensor, (3, 3) what it reads of what is true) of a gyro that reads `read` (3, 3) of what
    the accelerometer tells. Without labels an accelerometer with its axes in another order is the
    same, mirrored or not, as what turns has no mirror image of its own: the one with the fewest
    axes to be put right is the likelier."""
    orders = [("gyro", read)]
    if not labelled and np.linalg.det(read) > 0.0:
        orders += [("accel", sign * read.T) for sign in (1.0, -1.0)]
    return min(orders, key=lambda one: len(sources(one[1])))
