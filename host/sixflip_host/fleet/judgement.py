"""What the batch has in common, what single boards have, and which of them stand out.

A parameter is systematic where the batch's mean is not the nominal value, individual where the
boards differ by more than their estimates' errors [Cochran's Q; Higgins & Thompson, Statistics in
Medicine 21 (2002) 1539: I² below a quarter counts as none]. Tests of one batch are controlled
together [Holm, Scandinavian Journal of Statistics 6 (1979) 65].
"""
from dataclasses import dataclass

import numpy as np
from scipy import stats

from . import hierarchy, parameters

LEVEL = 0.01  # chance that any parameter of a batch is called systematic or individual wrongly
LOW_I2 = 0.25  # Higgins & Thompson: the lowest of their three marks
FALSE_BOARDS = 0.25  # boards that are named in a sound fleet of AMONG, on average
AMONG = 200
FEWEST_OF_BATCH = 8  # boards that are a batch of their own; fewer are judged with the others
KINDS = ("batch", "individual", "both", "neither")


@dataclass(frozen=True)
class Parameter:
    """name, unit; mean ± error over the batch; spread: standard deviation between its boards;
    nominal or None; systematic, individual: probabilities of so much by chance; i2; kind: one of
    KINDS; share of what the boards have that all of them have; aliases: other effects it may be;
    repeats: standard deviation from session to session or None."""

    name: str
    unit: str
    mean: float
    error: float
    spread: float
    nominal: float | None
    systematic: float
    individual: float
    i2: float
    kind: str
    share: float
    aliases: tuple = ()
    repeats: float = None


@dataclass(frozen=True)
class Outlier:
    """A board that stands out: parameter, value, mean and sigma that the batch gives it, sigmas
    away, chance of that; why: "differs" (from its batch) or "drifted" (from its own history)."""

    board: str
    parameter: str
    value: float
    mean: float
    sigma: float
    sigmas: float
    chance: float
    why: str


@dataclass(frozen=True)
class LotDifference:
    """parameter: mean of one batch less that of all others, its error, chance of that."""

    batch: str
    parameter: str
    difference: float
    error: float
    chance: float


@dataclass(frozen=True, eq=False)
class Batch:
    """name; boards (n,) and their own batches, lots (n,); populations: {block: (members.Block of
    these boards, Population)}; parameters: [Parameter]; outliers: [Outlier], the farthest first;
    cutoff: sigmas from which a board is named."""

    name: str
    boards: tuple
    lots: tuple
    populations: dict
    parameters: list
    outliers: list
    cutoff: float


def batches(members):
    """[Batch] of members.Members; those of few boards are judged together, as ""."""
    names = np.array(members.batches, object)
    large = [b for b in sorted(set(names)) if (names == b).sum() >= FEWEST_OF_BATCH]
    rest = np.flatnonzero(~np.isin(names, large))
    groups = [(b, np.flatnonzero(names == b)) for b in large]
    if len(rest):
        groups.append((names[rest[0]] if len(set(names[rest])) == 1 else "the others", rest))
    return [_batch(members, name, index) for name, index in groups]


def _batch(members, name, index):
    populations = {}
    for block in members.blocks:
        own = block.of(index)
        fitted = hierarchy.fit(own.y[:], own.R)
        if fitted is not None:
            populations[block.name] = own, fitted
    tests = _tests(populations)
    return Batch(name, tuple(members.boards[i] for i in index),
                 tuple(members.batches[i] for i in index), populations,
                 _judged(tests, members.repeats), *_standing_out(members, index, populations))


def _tests(populations):
    """[(Block, Population, column, p of the mean, p of the spread, I²)]"""
    tests = []
    for block, fitted in populations.values():
        y, variance = block.y[:], block.variance()
        for j, name in enumerate(block.names):
            use = np.isfinite(y[:, j])
            nominal = 0.0 if block.usual is not None else parameters.nominal(name)
            p_mean = np.nan
            if nominal is not None and use.sum() >= hierarchy.FEWEST:
                z = (fitted.mean[j] - nominal) / np.sqrt(fitted.error[j, j])
                p_mean = float(2.0 * stats.t.sf(abs(z), max(fitted.freedom, 1)))
            p_spread, i2 = _heterogeneity(y[use, j], variance[use, j],
                                          fitted.belongs[use] > 0.5)
            tests.append((block, fitted, j, p_mean, p_spread, i2, nominal))
    return tests


def _heterogeneity(y, variance, belongs):
    """(p, I²) of Cochran's Q over the boards that belong to the batch."""
    y, variance = y[belongs], variance[belongs]
    if len(y) < hierarchy.FEWEST:
        return np.nan, 0.0
    weight = 1.0 / variance
    mean = (weight * y).sum() / weight.sum()
    q, freedom = float((weight * (y - mean) ** 2).sum()), len(y) - 1
    return float(stats.chi2.sf(q, freedom)), max(0.0, 1.0 - freedom / max(q, 1e-300))


def _judged(tests, repeats):
    """[Parameter]; both kinds of tests are controlled over all parameters."""
    systematic = holm([t[3] for t in tests])
    individual = holm([t[4] for t in tests])
    parameters = []
    for (block, fitted, j, p_mean, p_spread, i2, nominal), all_of, each in zip(
            tests, systematic, individual):
        each = each and i2 >= LOW_I2
        name, spread = block.names[j], float(np.sqrt(max(fitted.spread[j, j], 0.0)))
        away = 0.0 if nominal is None else float(fitted.mean[j] - nominal)
        share = away ** 2 / max(away ** 2 + spread ** 2, 1e-300)
        kind = "both" if all_of and each else "batch" if all_of else \
            "individual" if each else "neither"
        parameters.append(Parameter(
            name, unit(block, name), float(fitted.mean[j]), float(np.sqrt(fitted.error[j, j])),
            spread, nominal, p_mean, p_spread, i2, kind, share, block.aliases, repeats.get(name)))
    return parameters


def unit(block, name):
    """The unit of a parameter of a block, for people."""
    from . import effects
    return effects.unit(name) if block.usual is not None else parameters.unit(name)


def holm(chances, level=LEVEL):
    """[bool]: which hypotheses are rejected [Holm 1979]; nan is none."""
    index = [k for k, p in enumerate(chances) if np.isfinite(p)]
    rejected = [False] * len(chances)
    for rank, k in enumerate(sorted(index, key=lambda k: chances[k])):
        if chances[k] > level / (len(index) - rank):
            break
        rejected[k] = True
    return rejected


def threshold(number):
    """Chance below which a board's parameter is named, so that FALSE_BOARDS of AMONG sound ones
    are; number of parameters that are looked at in a board."""
    return FALSE_BOARDS / AMONG / max(number, 1)


def _standing_out(members, index, populations):
    """([Outlier], cutoff in sigmas)."""
    changes = members.changes
    number = sum(len(block.names) for block, _ in populations.values()) \
        + sum(len(c.names) for c in changes)
    limit = threshold(number)
    outliers, freedom = [], max(len(index) - 1, 1)
    for block, fitted in populations.values():
        y, sigma = block.y[:], fitted.sigma(block.variance())
        away = (y - fitted.mean) / sigma
        chance = 2.0 * stats.t.sf(np.abs(away), max(fitted.freedom, 1))
        for b, j in np.argwhere(np.isfinite(y) & (chance < limit)):
            outliers.append(Outlier(members.boards[index[b]], block.names[j], float(y[b, j]),
                                    float(fitted.mean[j]), float(sigma[b, j]), float(away[b, j]),
                                    float(chance[b, j]), "differs"))
    for moved in changes:
        change, sigma = moved.change[index] - moved.common, np.sqrt(moved.variance[index])
        away = change / sigma
        chance = 2.0 * stats.t.sf(np.abs(away), freedom)
        for b, j in np.argwhere(np.isfinite(away) & (chance < limit)):
            outliers.append(Outlier(members.boards[index[b]], moved.names[j], float(change[b, j]),
                                    0.0, float(sigma[b, j]), float(away[b, j]),
                                    float(chance[b, j]), "drifted"))
    outliers.sort(key=lambda one: -abs(one.sigmas))
    return outliers, float(stats.t.isf(limit / 2.0, freedom))


def lots(batches):
    """[LotDifference] of the batches of one kind of board, beyond chance (Holm over all)."""
    if len(batches) < 2:
        return []
    tests = []
    for batch in batches:
        others = [b for b in batches if b is not batch]
        for name, (block, fitted) in batch.populations.items():
            theirs = [b.populations[name][1] for b in others if name in b.populations]
            if not theirs:
                continue
            for j, parameter in enumerate(block.names):
                weights = np.array([1.0 / t.error[j, j] for t in theirs])
                mean = float((weights * [t.mean[j] for t in theirs]).sum() / weights.sum())
                error = float(np.sqrt(fitted.error[j, j] + 1.0 / weights.sum()))
                difference = float(fitted.mean[j]) - mean
                freedom = max(1, min(fitted.freedom, *(t.freedom for t in theirs)))
                chance = float(2.0 * stats.t.sf(abs(difference) / error, freedom))
                tests.append(LotDifference(batch.name, parameter, difference, error, chance))
    return [one for one, sure in zip(tests, holm([t.chance for t in tests])) if sure]
