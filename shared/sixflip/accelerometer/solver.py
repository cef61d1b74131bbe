"""The accelerometer from still poses: [mx my mz 1] P = [tx ty tz 1] (Li Eq. 6-7, METHOD 1).

Solved on the means of the poses in g, one row a placement: noise in single samples would
attenuate the scale. The result is in m/s2.
"""

import math

from sixflip import STANDARD_G
from sixflip.accelerometer.scale_form import scale_form
from sixflip.accelerometer.sigma import spread
from sixflip.accelerometer.six_faces import LEVELS, corrected, pairs, pose_mean, truths
from sixflip.accelerometer.six_faces import solve as solve_means
from sixflip.poses.faces import face_of_code

G = STANDARD_G


class AccelerometerResult:
    """P 4 x 4 for row vectors in m/s2, last column 0 0 0 1, and the form T S (a + v).

    sigma_P 4 x 4, sigma_scale [3], sigma_v [3]: standard errors, P's units
    residual   {pose code: [x, y, z]} corrected mean minus truth, g
    tilts      {face: degrees}, empty without flips; tilt_deg their mean, tilt_spread_deg the
               largest difference, both None without flips
    across     {face: (in a, in b)} gravity across the face's axis, g
    level, rounds, g; noise_g: standard deviation of a single sample; scatter_g: of placing
    poses, means, variance: per placement used its code, mean [x, y, z] in g as measured,
               variance of that mean, g2
    """


def mean_in_g(placement, lsb_per_g):
    """The mean of a placement's exact sums, [x, y, z] in g."""
    n = placement.n * lsb_per_g
    return [placement.sums[k] / n for k in range(3)]


def solve(placements, lsb_per_g, g=G, level=None, angles=None):
    """Calibrate from a session's placements; leaning ones are left aside.

    level   "tilt solved" (default when all six faces have both captures), "flip average"
            (the paper), "no flips"; None: the best there is
    angles  {face: rad} turn really made from a to b, right-handed about the face's axis
    Returns an AccelerometerResult. Raises SingularSystem (a ValueError) when the poses do
    not determine the twelve parameters, ValueError when the level needs flips not made.
    """
    used = [p for p in placements if face_of_code(p.pose) >= 0 and p.n > 0]
    r = AccelerometerResult()
    r.g = g
    r.poses = [p.pose for p in used]
    r.means = [mean_in_g(p, lsb_per_g) for p in used]
    r.level = best_level(r.poses, level)
    r.P, r.across, r.rounds = solve_means(r.poses, r.means, r.level, angles)
    _summarise(r)
    spread(r, used, lsb_per_g)
    # From g to m/s2: only the offsets carry a unit.
    r.P = [row + [0.0] for row in r.P[:3]] + [[x * g for x in r.P[3]] + [1.0]]
    r.T, r.scale, r.v, _ = scale_form(r.P)
    return r


def best_level(poses, wanted=None):
    """The level to solve at; ValueError when the wanted one is unknown or lacks its flips."""
    flipped = len(pairs(poses)) == 6
    if wanted is None:
        return LEVELS[0] if flipped else LEVELS[2]
    if wanted not in LEVELS:
        raise ValueError("level %s: expected one of %s" % (wanted, ", ".join(LEVELS)))
    if wanted != LEVELS[2] and not flipped:
        raise ValueError("level %s needs both captures on all six faces" % wanted)
    return wanted


def _summarise(r):
    """Tilts in degrees and the residual of every pose."""
    r.tilts = {}
    for face in r.across:
        across = math.sqrt(sum([x * x for x in r.across[face][0]]))
        r.tilts[face] = math.degrees(math.asin(min(1.0, across)))
    tilts = list(r.tilts.values())
    r.tilt_deg = sum(tilts) / len(tilts) if tilts else None
    r.tilt_spread_deg = max(tilts) - min(tilts) if tilts else None
    truth = truths(r.poses, r.across if r.level == LEVELS[0] else {})
    left = [[x - y for x, y in zip(corrected(r.P, m), t)] for m, t in zip(r.means, truth)]
    r.residual = {}
    for pose in r.poses:
        r.residual[pose] = pose_mean(r.poses, left, pose)
