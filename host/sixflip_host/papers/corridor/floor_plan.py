"""A looped corridor with recessed doors and protruding pillars, and a lidar's view of it.

Li 2019, section 5: 2.7 m wide, a loop of about 130 m, "recessed doors and protruding pillars".
Lengths in metres, angles in radians, the origin in the middle of the floor.
"""

import dataclasses
import math

import numpy as np

from sixflip_sim import noise

WIDTH_M = 2.7               # Li 2019, section 5
DOOR_M, RECESS_M = 0.9, 0.25
PILLAR_M, PROTRUDES_M = 0.4, 0.2
APART_M = (2.5, 6.0)        # from one door or pillar of a wall to the next
CLEAR_M = 0.6               # of a wall's ends that stay plain
_WALLS = 0x711              # stream of noise.py


@dataclasses.dataclass(frozen=True)
class Corridor:
    """A rectangular loop; length and depth are those of its centre line."""

    length: float = 40.0
    depth: float = 25.0
    seed: int = 1

    @property
    def around(self):
        """Length of the centre line."""
        return 2.0 * (self.length + self.depth)

    def corners(self, outward=0.0):
        """(4, 2) counter-clockwise from the lower right one; outward: from the centre line."""
        x, y = 0.5 * self.length + outward, 0.5 * self.depth + outward
        return np.array([[x, -y], [x, y], [-x, y], [-x, -y]])

    def walls(self):
        """(n, 2, 2) segments from point to point."""
        segments = []
        for ring, side in enumerate((0.5 * WIDTH_M, -0.5 * WIDTH_M)):
            corners = self.corners(side)
            for k in range(4):
                begin, end = corners[k - 1], corners[k]
                segments.append(_wall(begin, end, 1.0 if ring == 0 else -1.0,
                                      noise.key(self.seed, _WALLS + 4 * ring + k)))
        return np.concatenate(segments)


def _wall(begin, end, outside, stream):
    """Segments of one wall; outside +1: recesses lie to the right of its direction."""
    along = (end - begin) / np.linalg.norm(end - begin)
    across = outside * np.array([along[1], -along[0]])
    points, at, k = [begin], CLEAR_M, 0
    while True:
        door = noise.bits(stream, 2 * k) & 1
        wide, deep = (DOOR_M, RECESS_M) if door else (PILLAR_M, -PROTRUDES_M)
        middle = 0.5 * (APART_M[0] + APART_M[1])
        at += middle + (APART_M[1] - middle) * noise.uniform(stream, 2 * k + 1)
        if at + wide + CLEAR_M > np.linalg.norm(end - begin):
            break
        points += [begin + at * along, begin + at * along + deep * across,
                   begin + (at + wide) * along + deep * across, begin + (at + wide) * along]
        at, k = at + wide, k + 1
    points = np.array([*points, end])
    return np.stack([points[:-1], points[1:]], axis=1)


def ranges(walls, origins, angles, reach):
    """Distances (n,) from each origin (n, 2) in its direction (n,) to the nearest wall; NaN
    where there is none within reach."""
    start, edge = walls[:, 0], walls[:, 1] - walls[:, 0]
    ray = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cross = ray[:, 0, None] * edge[:, 1] - ray[:, 1, None] * edge[:, 0]
    to = start[None] - origins[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (to[..., 0] * edge[:, 1] - to[..., 1] * edge[:, 0]) / cross
        part = (to[..., 0] * ray[:, 1, None] - to[..., 1] * ray[:, 0, None]) / cross
    hit = (far > 0.0) & (part >= 0.0) & (part <= 1.0)
    nearest = np.where(hit, far, np.inf).min(axis=1)
    return np.where(nearest <= reach, nearest, np.nan)


def distances(walls, points):
    """(n,) from each point (n, 2) to the nearest wall."""
    start, edge = walls[:, 0], walls[:, 1] - walls[:, 0]
    nearest = np.full(len(points), np.inf)
    for a, e in zip(start, edge):
        part = np.clip((points - a) @ e / (e @ e), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(*(points - a - part[:, None] * e).T))
    return nearest


def wrapped(angle):
    """Into -pi ... pi."""
    return (np.asarray(angle) + math.pi) % (2.0 * math.pi) - math.pi
