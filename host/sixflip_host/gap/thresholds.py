"""Thresholds by null simulation of the very protocol at hand, kept in a cache by protocol.

Contrasts without any effect are drawn with the levels of placement and flicker that the data
shows, and scored as the data is; the threshold is a quantile of the largest score over all
candidates (so the search itself is in it).
"""
import hashlib
import json
import math
import os
from pathlib import Path

import numpy as np

from .. import atomic_write, progress
from . import which

RUNS, BATCH = 240, 80
UPPER = 0.1
CHANCE = 0.004  # two sensors, the gyro's turns, the box and the spectra share 5 %, with room
LEAST_NATS = 6.0  # the prototype's 4.0 was 95 % for one search with the noise known exactly
MARGIN_NATS = 1.5  # flicker and placement are not what the simulation takes them for
FORMAT = 7


class Thresholds:
    """named, generic: nats a named effect or a generic discrepancy must gain."""

    def __init__(self, named, generic):
        self.named, self.generic = named, generic


def folder():
    """Where thresholds are kept."""
    root = os.environ.get("SIXFLIP_CACHE")
    if not root:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "sixflip"
    return Path(root) / "thresholds"


def of(units, options, levels):
    """Thresholds of a protocol; levels: index into each unit's grid."""
    name = folder() / ("%s.json" % key(units, options, levels))
    try:
        kept = json.loads(name.read_text())
        return Thresholds(float(kept["named"]), float(kept["generic"]))
    except (OSError, ValueError, KeyError, TypeError):
        found = simulated(units, options, levels)
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        atomic_write.write_bytes(str(name), json.dumps(
            {"named": found.named, "generic": found.generic}).encode())
    except OSError:
        pass  # a cache that cannot be written is no error
    return found


def key(units, options, levels):
    """Hash of what the null distribution depends on: poses, timing (to whole seconds), the
    candidates and the levels; not of the noise in the directions of gravity."""
    h = hashlib.sha256(b"%d %d" % (FORMAT, RUNS))
    for unit, level in zip(units, levels):
        h.update(repr((unit.signature, unit.freedom, level)).encode())
    h.update(repr(sorted((o.effect, o.variant, str(o.axis), len(o.columns)) for o in options)
                  ).encode())
    return h.hexdigest()[:24]


def simulated(units, options, levels):
    """Thresholds from RUNS simulated data sets."""
    generator = np.random.default_rng(20190919)
    named, generic = [], []
    for _ in progress.steps(range(RUNS // BATCH), "what chance alone shows"):
        draws = [u.draw(i, generator, BATCH) for u, i in zip(units, levels)]
        gains = which.gains(which.Data(units, draws), options)
        for out, kind in ((named, False), (generic, True)):
            mine = [v for o, v in gains.items() if o.generic == kind]
            if mine:
                out.append(np.max(mine, axis=0))
    return Thresholds(_quantile(named), _quantile(generic))


def _quantile(parts):
    """Score that a null data set exceeds with probability CHANCE: the tail of a largest log
    likelihood ratio is exponential, its scale is taken from the upper tenth of the runs."""
    if not parts:
        return LEAST_NATS
    scores = np.concatenate(parts)
    start = float(np.quantile(scores, 1.0 - UPPER))
    scale = float(np.mean(scores[scores > start] - start)) if (scores > start).any() else 0.0
    return max(LEAST_NATS, start + scale * math.log(UPPER / CHANCE) + MARGIN_NATS)
