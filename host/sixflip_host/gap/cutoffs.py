"""What a member of a set costs: simulated nulls of the very protocol, kept in a cache.

Contrasts without any effect are drawn with the levels of placement and flicker that the data
shows, and scored as the data is; the cost is a quantile of the largest gain of any hypothesis
(so the search itself is in it).
"""
import hashlib
import json
import math
import os
from pathlib import Path

import numpy as np

from .. import atomic_write, progress
from . import evidence
from .evidence import NONE

RUNS = 160
UPPER = 0.1
CHANCE = 0.005  # two sensors, the gyro's turns, the box and the spectra share 5 %, with room
TIMES_USUAL = 1.6  # of the usual levels, that a null has at most
MARGIN_NATS = 1.0  # noise is not quite what it is simulated as
LEAST_NATS = 4.0  # GAP: 95 % of the prototype's nulls in one search with the noise known exactly
FORMAT = 8


def folder():
    """Where costs are kept."""
    root = os.environ.get("SIXFLIP_CACHE")
    if not root:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "sixflip"
    return Path(root) / "thresholds"


def of(units, forms, levels):
    """Nats that a member of a set costs in this protocol."""
    empty = [evidence.fit(u, u.statistics(), NONE, NONE, levels.prior(u, ())) for u in units]
    points = [_usual(u, int(f.index[0]), levels) for u, f in zip(units, empty)]
    name = folder() / ("%s.json" % _key(units, forms, levels, points))
    try:
        return float(json.loads(name.read_text())["cost"])
    except (OSError, ValueError, KeyError, TypeError):
        cost = simulated(units, forms, levels, points)
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        atomic_write.write_bytes(str(name), json.dumps({"cost": cost}).encode())
    except OSError:
        pass  # a cache that cannot be written is no error
    return cost


def _usual(unit, point, levels):
    """The point of a unit's grid nearest to one that the data shows, with no more flicker and
    placement than is usual: a null is what the chip and the hand do anyhow."""
    if unit.between:
        return point
    top = (TIMES_USUAL * levels.placement, TIMES_USUAL * levels.flicker)
    low = [k for k, pair in enumerate(unit.grid) if pair[0] <= top[0] and pair[1] <= top[1]]
    wanted = [min(a, b) for a, b in zip(unit.grid[point], top)]
    return min(low or [point], key=lambda k: sum(
        abs(np.log(max(a, 1e-9) / max(b, 1e-9))) for a, b in zip(unit.grid[k], wanted)))


def _key(units, forms, levels, points):
    """Hash of what the null distribution depends on: poses, timing (to whole seconds), the
    hypotheses and the levels; not of the noise in the directions of gravity."""
    h = hashlib.sha256(b"%d %d" % (FORMAT, RUNS))
    for unit, point in zip(units, points):
        h.update(repr((unit.signature, unit.freedom, point)).encode())
    h.update(repr((levels, sorted(
        (f.effect, f.variant, str(f.axis), len(f.shared)) for f in forms))).encode())
    return h.hexdigest()[:24]


def simulated(units, forms, levels, points):
    """The cost from RUNS simulated data sets."""
    generator = np.random.default_rng(20190919)
    statistics = [u.statistics(u.draw(k, generator, RUNS)) for u, k in zip(units, points)]
    prior = [levels.prior(u, ()) for u in units]
    base = [evidence.fit(u, s, NONE, NONE, p) for u, s, p in zip(units, statistics, prior)]
    nothing = evidence.score(base, NONE)
    largest = np.full(RUNS, -np.inf)
    for form in progress.steps(forms, "what chance alone shows"):
        gain = _gain(form, units, statistics, prior, levels, base) - nothing
        largest = np.maximum(largest, gain)
    return _quantile(largest)


def _gain(form, units, statistics, prior, levels, base):
    """(RUNS,) score of a set of this form alone."""
    if form.free:
        prior = [levels.prior(u, form.free) for u in units]
    if not form.choices:
        return evidence.score([evidence.fit(u, s, form.shared, NONE, p) for u, s, p in zip(
            units, statistics, prior)], form.shared)
    total = 0.0
    for unit, one, level, plain in zip(units, statistics, prior, base):
        if unit.between:
            total = total + plain.evidence
            continue
        best = np.max([evidence.fit(unit, one, NONE, choice, level).evidence
                       for choice in form.choices], axis=0)
        total = total + best - math.log(len(form.choices))
    return total


def _quantile(scores):
    """Gain that a null data set exceeds with probability CHANCE: the tail of a largest log
    likelihood ratio is exponential, its scale is taken from the upper tenth of the runs."""
    start = float(np.quantile(scores, 1.0 - UPPER))
    scale = float(np.mean(scores[scores > start] - start)) if (scores > start).any() else 0.0
    return max(LEAST_NATS, start + scale * math.log(UPPER / CHANCE) + MARGIN_NATS)
