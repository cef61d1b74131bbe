"""Every gyro, every reading, every step of the ladder: the maps and how good they are."""

import concurrent.futures
import dataclasses
import os

from ... import progress
from . import drive, floor_plan, measures, slam

CORRIDOR = floor_plan.Corridor()


@dataclasses.dataclass(frozen=True)
class Result:
    """What came out of one gyro: quality {(engine, reading): Quality}, and, where they were
    asked for, its Drive and maps {(engine, reading): Map}."""

    seed: int
    quality: dict
    made: drive.Drive = None
    maps: dict = None


def run(program, gyros, seed, corridor, ladder=slam.LADDER, jobs=None, keep=None):
    """[Result] of so many gyros, the first with its maps; keep: a folder for the first's logs."""
    results = []
    tasks = [(engine, reading) for engine in ladder for reading in drive.READINGS]
    with concurrent.futures.ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        for number in range(gyros):
            progress.doing("gyro %d of %d" % (number + 1, gyros))
            made = drive.make(corridor, seed + number)
            logs = None if number else keep
            maps = dict(zip([(engine.name, reading) for engine, reading in tasks], pool.map(
                lambda task, made=made, logs=logs: slam.run(
                    program, task[0], made.odometry(task[1]), made.scans, made.t_s,
                    reach_m=drive.REACH_M, keep=place(logs, *task)), tasks)))
            quality = {key: measures.of(made, one) for key, one in maps.items()}
            kept = {} if number else {"made": made, "maps": maps}
            results.append(Result(seed + number, quality, **kept))
    return results


def place(folder, engine, reading):
    """The folder of one log, where a folder was named."""
    return folder and folder / ("%s-%s" % (engine.name, reading)).replace(" ", "_")
