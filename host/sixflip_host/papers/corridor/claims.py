"""What the maps show, as numbers to print and as claims that hold or do not."""

import concurrent.futures
import os

import numpy as np

from . import botlab, drive, slam

# Degrees a corner before calibration: Li 2019, section 4.3, "about ±1° to ±3°".
BEFORE = (1.0, 3.0)
# What is claimed of the calibrated gyro. The limits were set before any map was made; what a
# corner, a closure and a closed loop are was settled after trial runs (experiment.py).
CORNER_DEG, HALF = 0.8, 0.5
CLOSURE_M, BEFORE_CLOSURE_M = 0.7, 1.0
RAW_CLOSES, SIXFLIP_CLOSES = 0.2, 0.8
BOTLAB_MM, BOTLAB_SLAM_MM, SCALE = 15.0, 12.0, 0.005
WINDOW = 0.0101
SCALES = (0.98, 0.99, 0.995, 0.9975, 1.0, 1.0025, 1.005, 1.01, 1.02)


def claim(text, value, holds):
    """One claim with what was found and whether it holds."""
    return {"claim": text, "found": value, "holds": bool(holds)}


def rows(results):
    """[{engine, reading, and of each measure its median and worst over the gyros; closed}]."""
    table = []
    for engine in dict.fromkeys(key[0] for key in results[0].quality):
        for reading in drive.READINGS:
            row = {"engine": engine, "reading": reading,
                   "closed": sum(result.quality[engine, reading].closes for result in results)}
            for name in ("heading_deg", "corner_deg", "closure_m", "wall_m", "off"):
                sizes = np.abs([getattr(result.quality[engine, reading], name)
                                for result in results])
                row[name] = {"median": float(np.median(sizes)), "worst": float(sizes.max())}
            table.append(row)
    return table


def corridor(rows, gyros):
    """The claims on the simulated corridor, from rows()."""
    at = {(row["engine"], row["reading"]): row for row in rows}
    plain, sampling, _ = (engine.name for engine in slam.LADDER)
    rest, ours = at[plain, "rest"], at[plain, "Sixflip"]
    corner = [row["corner_deg"] for row in (rest, ours)]
    closure = [row["closure_m"]["median"] for row in (rest, ours)]
    closed = [at[sampling, reading]["closed"] for reading in ("raw", "Sixflip")]
    return [
        claim("%s: a bias from the first rest alone leaves corners off by %g to %g° (median of "
              "each drive's worst), as in the paper" % (plain, *BEFORE),
              "%.2f°" % corner[0]["median"], BEFORE[0] <= corner[0]["median"] <= BEFORE[1]),
        claim("%s: Sixflip's record leaves no corner of any gyro off by more than %g°"
              % (plain, CORNER_DEG), "%.2f°" % corner[1]["worst"],
              corner[1]["worst"] <= CORNER_DEG),
        claim("%s: the median with the record is at most half of that without" % plain,
              "%.2f°" % corner[1]["median"],
              corner[1]["median"] <= HALF * corner[0]["median"]),
        claim("%s: the loop closes within %g m (median) with the record, and not within %g m "
              "without" % (plain, CLOSURE_M, BEFORE_CLOSURE_M), "%.2f and %.2f m" % (
                  closure[1], closure[0]),
              closure[1] <= CLOSURE_M and closure[0] >= BEFORE_CLOSURE_M),
        claim("%s: at most %d of %d loops close on the raw gyro" % (
            sampling, RAW_CLOSES * gyros, gyros), "%d" % closed[0],
              closed[0] <= RAW_CLOSES * gyros),
        claim("%s: at least %d of %d loops close with the record" % (
            sampling, -(-SIXFLIP_CLOSES * gyros // 1), gyros), "%d" % closed[1],
              closed[1] >= SIXFLIP_CLOSES * gyros),
    ]


def recorded(program, recording):
    """{ladder: {engine: {reading: mm}}, scales: {whole, halves}, best: [first, second]}."""
    scans = len(recording.scan_t)
    parts = {"whole": slice(None), "first half": slice(0, scans // 2),
             "second half": slice(scans // 2, scans)}
    tasks = [(engine, reading) for engine in botlab.LADDER for reading in botlab.READINGS]
    tasks += [(botlab.LADDER[0], "rest", scale, part) for part in parts.values()
              for scale in SCALES]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        mm = iter(list(pool.map(lambda task: botlab.held_out(program, recording, *task), tasks)))
    ladder = {engine.name: {reading: next(mm) for reading in botlab.READINGS}
              for engine in botlab.LADDER}
    scales = {name: [next(mm) for _ in SCALES] for name in parts}
    return {"ladder_mm": ladder, "scales": list(SCALES), "scale_mm": scales,
            "best_scale": {name: best(mm) for name, mm in scales.items()}}


def best(mm):
    """The scale of the smallest distance: the vertex of a parabola fitted to all SCALES within
    WINDOW of the smallest; the first or last of SCALES where it is the smallest."""
    k = int(np.argmin(mm))
    if k in (0, len(SCALES) - 1):
        return SCALES[k]
    near = [(scale, distance) for scale, distance in zip(SCALES, mm)
            if abs(scale - SCALES[k]) <= WINDOW]
    offset, distances = np.array(near).T
    a, b, _ = np.polyfit(offset - SCALES[k], distances, 2)
    return float(SCALES[k] - 0.5 * b / a) if a > 0 else SCALES[k]


def real(measures):
    """The claims on the recording, from recorded()."""
    plain, standard, _ = (engine.name for engine in botlab.LADDER)
    halves = [measures["best_scale"][name] for name in ("first half", "second half")]
    return [
        claim("recording, %s: with the bias of the first rest, scans held out lie within %g mm of "
              "the map's walls" % (plain, BOTLAB_MM),
              "%.1f mm" % measures["ladder_mm"][plain]["rest"],
              measures["ladder_mm"][plain]["rest"] <= BOTLAB_MM),
        claim("recording, %s: within %g mm" % (standard, BOTLAB_SLAM_MM),
              "%.1f mm" % measures["ladder_mm"][standard]["rest"],
              measures["ladder_mm"][standard]["rest"] <= BOTLAB_SLAM_MM),
        claim("recording: the best scale of the gyro is within %g %% of 1 on both halves"
              % (100 * SCALE), "%.4f and %.4f" % tuple(halves),
              all(abs(scale - 1.0) <= SCALE for scale in halves)),
    ]
