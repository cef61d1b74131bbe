"""How good a map is, told by the world it was made of."""

import dataclasses

import numpy as np

from . import floor_plan

OFF_M = 0.15                # a wall drawn farther from the real one than that is in another place
SEEN_M = 8.0                # of a corner's walls, from the corner: the lidar's reach
CLOSES_M = 1.0              # nearer than half of the corridor: the end lies in the beginning


@dataclasses.dataclass(frozen=True)
class Quality:
    """heading_deg: error at the end; corner_deg: error of the worst corner, see corners();
    closure_m: how far from where it is the robot thinks it is when it has come round; wall_m:
    mean distance of the map's walls to the nearest real one; off: share of them OFF_M away or
    more
    """

    heading_deg: float
    corner_deg: float
    closure_m: float
    wall_m: float
    off: float

    @property
    def closes(self):
        """Whether the walls of the loop's end were drawn on those of its beginning."""
        return self.closure_m <= CLOSES_M


def of(drive, found):
    """Quality of the Map of a Drive."""
    path = placed(drive, found.path)
    heading = np.unwrap(path[:, 2]) - drive.pose[:, 2]
    off = floor_plan.distances(drive.corridor.walls(), placed(drive, found.walls))
    return Quality(float(np.degrees(heading[-1])),
                   float(np.abs(corners(drive, heading)).max()),
                   float(np.hypot(*(path[-1] - drive.pose[-1])[:2])), float(off.mean()),
                   float((off >= OFF_M).mean()))


def corners(drive, heading):
    """(4,) degrees by which each corner is not what it is, from errors of heading (n,) rad: the
    mean of those seen within SEEN_M of it afterwards less that of those before."""
    found = []
    for number, place in enumerate(drive.corridor.corners()):
        near = np.hypot(*(drive.pose[:, :2] - place).T) <= SEEN_M
        before, after = (heading[near & (drive.leg == k)].mean() for k in (number, number + 1))
        found.append(np.degrees(after - before))
    return np.array(found)


def placed(drive, points):
    """Points (n, 2) or poses (n, 3) of the map's frame in that of the floor."""
    first = drive.pose[0]
    c, s = np.cos(first[2]), np.sin(first[2])
    found = np.array(points, dtype=float)
    found[:, :2] = points[:, :2] @ np.array([[c, s], [-s, c]]) + first[:2]
    found[:, 2:] += first[2]
    return found
