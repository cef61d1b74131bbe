"""Every gyro, every reading, every step of the ladder: the maps, how good they are, told by the
world they were made of, and their picture."""

import concurrent.futures
import dataclasses
import os

import numpy as np

from ... import progress
from ...figures import canvas, save
from . import drive, floor_plan, slam

CORRIDOR = floor_plan.Corridor()
OFF_M = 0.15                # a wall drawn farther from the real one than that is in another place
SEEN_M = 8.0                # of a corner's walls, from the corner: the lidar's reach
CLOSES_M = 1.0              # nearer than half of the corridor: the end lies in the beginning
WALL, DRAWN, WAY = "#2a6f97", "#202020", "#c0392b"
MARGIN_M = 6.0


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


@dataclasses.dataclass(frozen=True)
class Result:
    """What came out of one gyro: quality {(engine, reading): Quality}, and, where they were
    asked for, its Drive and maps {(engine, reading): Map}."""

    seed: int
    quality: dict
    driven: drive.Drive = None
    maps: dict = None


def run(program, gyros, seed, corridor, ladder=slam.LADDER, jobs=None, keep=None):
    """[Result] of so many gyros, the first with its maps; keep: a folder for the first's logs."""
    results = []
    tasks = [(engine, reading) for engine in ladder for reading in drive.READINGS]
    with concurrent.futures.ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        for number in range(gyros):
            progress.doing("gyro %d of %d" % (number + 1, gyros))
            driven = drive.make(corridor, seed + number)
            logs = None if number else keep
            maps = dict(zip([(engine.name, reading) for engine, reading in tasks], pool.map(
                lambda task, driven=driven, logs=logs: slam.run(
                    program, task[0], driven.odometry(task[1]), driven.scans, driven.t_s,
                    reach_m=drive.REACH_M, keep=log_folder(logs, *task)), tasks)))
            quality = {key: measured(driven, mapped) for key, mapped in maps.items()}
            kept = {} if number else {"driven": driven, "maps": maps}
            results.append(Result(seed + number, quality, **kept))
    return results


def log_folder(folder, engine, reading):
    """The folder of one log, where a folder was named."""
    return folder and folder / ("%s-%s" % (engine.name, reading)).replace(" ", "_")


def measured(driven, mapped):
    """Quality of the Map of a Drive."""
    path = placed(driven, mapped.path)
    heading = np.unwrap(path[:, 2]) - driven.pose[:, 2]
    off = floor_plan.distances(driven.corridor.walls(), placed(driven, mapped.walls))
    return Quality(float(np.degrees(heading[-1])),
                   float(np.abs(corners(driven, heading)).max()),
                   float(np.hypot(*(path[-1] - driven.pose[-1])[:2])), float(off.mean()),
                   float((off >= OFF_M).mean()))


def corners(driven, heading):
    """(4,) degrees by which each corner is not what it is, from errors of heading (n,) rad: the
    mean of those seen within SEEN_M of it afterwards less that of those before."""
    errors = []
    for number, place in enumerate(driven.corridor.corners()):
        near = np.hypot(*(driven.pose[:, :2] - place).T) <= SEEN_M
        before, after = (heading[near & (driven.leg == k)].mean() for k in (number, number + 1))
        errors.append(np.degrees(after - before))
    return np.array(errors)


def placed(driven, points):
    """Points (n, 2) or poses (n, 3) of the map's frame in that of the floor."""
    first = driven.pose[0]
    c, s = np.cos(first[2]), np.sin(first[2])
    on_floor = np.array(points, dtype=float)
    on_floor[:, :2] = points[:, :2] @ np.array([[c, s], [-s, c]]) + first[:2]
    on_floor[:, 2:] += first[2]
    return on_floor


def draw(path, result):
    """Write a PNG of three steps of the ladder (rows) and three readings (columns)."""
    engines = list(dict.fromkeys(key[0] for key in result.maps))
    figure, axes = canvas(len(engines), len(drive.READINGS), 12.0, 8.6)
    truth = result.driven
    half = 0.5 * np.array([truth.corridor.length, truth.corridor.depth]) + MARGIN_M
    for row, engine in enumerate(engines):
        for column, reading in enumerate(drive.READINGS):
            here, mapped = axes[row][column], result.maps[engine, reading]
            quality = result.quality[engine, reading]
            for wall in truth.corridor.walls():
                here.plot(*wall.T, color=WALL, lw=0.6)
            here.plot(*placed(truth, mapped.walls).T, ".", color=DRAWN, ms=0.8)
            here.plot(*placed(truth, mapped.path)[:, :2].T, color=WAY, lw=0.7)
            here.set(xlim=(-half[0], half[0]), ylim=(-half[1], half[1]), aspect="equal",
                     xticks=[], yticks=[])
            here.set_title("%s, %s: corner %.1f°, closure %.2f m" % (
                engine, reading, quality.corner_deg, quality.closure_m), fontsize=9)
    figure.suptitle("The map of a looped corridor (black) over its walls (blue), and the way the "
                    "robot thinks it went (red)", fontsize=11)
    save(figure, path)
