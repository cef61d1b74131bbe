"""P from pose means, in g: the paper's flip average and ours with the tilt solved (METHOD 1)."""

from sixflip.elimination import DOUBLE
from sixflip.face_axes import face_of_code
from sixflip.normal_equations import NormalEquations
from sixflip.pose_means import all_axes, corrected, face_means, pairs, pose_mean
from sixflip.table_tilt import in_plane, upright

ROUNDS = 20
STANDS_STILL = 1e-12 if DOUBLE else 1e-6
LEVELS = ("tilt solved", "flip average", "no flips")


def truths(poses, across):
    """Unit gravity in every pose, one after the other (a list would not fit a small heap).

    across {face: (in a, in b)} where the tilt is known
    """
    for pose in poses:
        face = face_of_code(pose)
        yield upright(face, across[face][1 - pose % 2] if face in across else None)


def fit(rows, truth):
    """P, 4 x 3: least squares of [row 1] P = truth. Raises SingularSystem."""
    equations = NormalEquations(3)
    for m, t in zip(rows, truth):
        equations.add(m + [1.0], t)
    return equations.solve()


def find_tilts(P, poses, means, angles=None):
    """{face: (in a, in b)} gravity across the axis of every face that was flipped, g."""
    across = {}
    for f in pairs(poses):
        a = corrected(P, pose_mean(poses, means, 2 * f + 1))
        b = corrected(P, pose_mean(poses, means, 2 * f + 2))
        across[f] = in_plane(a, b, f, angles.get(f) if angles else None)
    return across


def solve(poses, means, level, angles=None):
    """(P 4 x 3, across, rounds) from pose codes 1..12 and one [x, y, z] in g for each.

    Raises SingularSystem when an axis has no pose at all or the rows are singular.
    """
    all_axes(poses)
    if level == "flip average":
        P = fit(face_means(poses, means), [upright(f) for f in range(6)])
        return P, find_tilts(P, poses, means, angles), 1
    P = fit(means, truths(poses, {}))
    across = {}
    rounds = 1
    moved = 1.0
    while level == "tilt solved" and rounds < ROUNDS and not moved < STANDS_STILL:
        across = find_tilts(P, poses, means, angles)
        before, P = P, fit(means, truths(poses, across))
        rounds += 1
        moved = max([abs(x - y) for p, q in zip(P, before) for x, y in zip(p, q)])
    return P, across, rounds
