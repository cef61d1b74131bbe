"""Noise whose level changes from second to second of one rest, as under a sound that comes and
goes, or in bursts too frequent to stand out of the others.

Steady noise has half seconds that are louder and softer by chance, each by itself (two lines that
beat have not, and are found before). Where the level changes, a loud one is beside a loud one: the
correlation of the ranks of neighbours is what chance does not make [Wald & Wolfowitz, Ann. Math.
Stat. 14 (1943) 378].
"""
import math

import numpy as np
from scipy import special

# Windows of a chain, in which each is at most so many lengths after the one before: what changes
# from one chain to the next may be the place that the box was put down on. In fewer windows than
# that, ten seconds, the correlation is not normal so far out as it is judged.
LONGEST_GAP, FEWEST = 4.0, 20


def changes(power, first, length, least):
    """(times as loud in the louder quarter as in the softer one, p of that by steady noise) of the
    axis that says most; power (w, 3) counts² of windows of `length` samples from `first` (w,) on,
    of which less than least (3,) counts² tells how near the mean is to the edge of a code."""
    order = np.argsort(first)
    power, first = power[order], first[order]
    chains = np.split(np.arange(len(first)),
                      1 + np.flatnonzero(np.diff(first) > LONGEST_GAP * length))
    chains = [chain for chain in chains if len(chain) >= FEWEST]
    if not chains:
        return 1.0, 1.0
    from scipy import stats  # it takes a second to import
    found = []
    for axis in range(3):
        level = [np.log(np.maximum(power[chain, axis], least[axis])) for chain in chains]
        level = [x - np.median(x) for x in level]
        every = np.concatenate(level)
        score = special.ndtri((stats.rankdata(every) - 0.5) / len(every))
        score = np.split(score, np.cumsum([len(x) for x in level])[:-1])
        pairs = sum(len(x) - 1 for x in score)
        together = sum(float(x[1:] @ x[:-1]) for x in score) / pairs
        p = 3.0 * float(special.ndtr(-together * math.sqrt(pairs)))
        # What neighbours have in common is the level's.
        spread = np.subtract(*np.quantile(every, [0.75, 0.25])) * math.sqrt(max(together, 0.0))
        found.append((math.exp(0.5 * spread), min(p, 1.0)))
    return min(found, key=lambda one: one[1])
