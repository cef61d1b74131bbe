"""The boards of one chip and range as arrays: an estimate of every parameter of each, with its
covariance, and how well a parameter repeats from session to session.

What a board reads changes a little from switch-on to switch-on; that is no error of the estimate
and no difference between boards. Its variance comes from boards with several sessions, a change
that all of them share (the second session was the cooling one) left out.
"""
import math
from dataclasses import dataclass

import numpy as np

from sixflip_sim.effects import typical

from . import analysis, effects, parameters

FEWEST_PAIRS = 8  # boards with two sessions that a repeatability is taken from
MEDIAN_OF_CHI2 = 0.4549  # of one degree of freedom
TOLD_APART = 0.1  # share of an effect's information that those before it must leave, as aliases
TIMES_TYPICAL = 1000.0  # of an effect's size: what is not seen at all is known no better


@dataclass(frozen=True, eq=False)
class Block:
    """Estimates of one block: names (k,); y (n, k), nan unknown; R (n, k, k). usual (k,): sizes
    that are typical of an effect, None of a parameter of the calibration. aliases: other effects
    that this protocol cannot tell from this one."""

    name: str
    names: tuple
    y: np.ndarray
    R: np.ndarray
    usual: np.ndarray | None = None
    aliases: tuple = ()


@dataclass(frozen=True, eq=False)
class Change:
    """How each board differs from its own history: change (n, k) of the last session against the
    mean of those before, nan with one session, less what all boards changed; variance (n, k)."""

    names: tuple
    change: np.ndarray
    variance: np.ndarray


@dataclass(frozen=True, eq=False)
class Members:
    """Boards of one kind. chip, accel_range_g, gyro_range_dps; boards, batches (n,) names; blocks:
    [Block]; changes: [Change]; repeats: {parameter: standard deviation from session to session};
    unseen: names of effects that these protocols do not show."""

    chip: str
    accel_range_g: float
    gyro_range_dps: float
    boards: tuple
    batches: tuple
    blocks: list
    changes: list
    repeats: dict
    unseen: tuple

    def spelled(self):
        """Chip and ranges for people."""
        ranges = [form % value for form, value in (
            ("±%g g", self.accel_range_g), ("±%g °/s", self.gyro_range_dps))
            if math.isfinite(value)]
        return " ".join([self.chip, *ranges])


COLUMNS = ("board", "batch", "written", "failure", "chip", "accel_range_g", "gyro_range_dps", "at",
           "values", "covariances", *("%s_%s" % (what, s) for s in effects.FORMS
                                      for what in ("precision", "score")))


def of(rows):
    """[Members], the most boards first, of an iterable of rows; those that failed are left out."""
    kinds = {}
    for row in rows:
        if row["failure"] or not row["values"]:
            continue
        key = row["chip"], *(None if math.isnan(row[name]) else row[name]
                             for name in ("accel_range_g", "gyro_range_dps"))
        order = np.argsort(row["at"], kind="stable")
        made = analysis.estimates(row)
        kinds.setdefault(key, []).append((
            row["board"], row["batch"], [made[k] for k in order],
            {sensor: analysis.information(row, sensor) for sensor in effects.FORMS}))
    found = [_members(key, sorted(its, key=lambda one: one[:2])) for key, its in kinds.items()]
    return sorted(found, key=lambda one: -len(one.boards))


def _members(key, its):
    blocks, changes, repeats, unseen = [], [], {}, []
    for name in parameters.BLOCKS:
        block, change, widths = _repeated(name, [estimates for _, _, estimates, _ in its])
        if np.isfinite(block.y).any():
            blocks.append(block)
            repeats.update(zip(block.names, widths))
        if np.isfinite(change.change).any():
            changes.append(change)
    for sensor in effects.FORMS:
        seen, missing = _effects(sensor, key[0], [one[3][sensor] for one in its])
        blocks += seen
        unseen += missing
    ranges = [math.nan if value is None else value for value in key[1:]]
    return Members(key[0], *ranges, tuple(one[0] for one in its), tuple(one[1] for one in its),
                   blocks, changes, repeats, tuple(unseen))


def _repeated(name, boards):
    """(Block, Change, repeatability (k,)) of a block of the calibration's parameters; boards:
    [[Estimate] in the order of time]."""
    names = parameters.BLOCKS[name]
    k = len(names)
    sessions = [[one.of(name) for one in estimates] for estimates in boards]
    later = [(its[-1][0] - its[-2][0], np.diag(its[-1][1] + its[-2][1]))
             for its in sessions if len(its) > 1]
    own = np.zeros(k)
    if len(later) >= FEWEST_PAIRS:
        steps, noise = (np.array(part) for part in zip(*later))
        for j in range(k):
            use = np.isfinite(steps[:, j]) & np.isfinite(noise[:, j])
            if use.sum() >= FEWEST_PAIRS:
                away = steps[use, j] - np.median(steps[use, j])
                own[j] = max(0.0, 0.5 * (np.median(away ** 2) / MEDIAN_OF_CHI2
                                         - np.median(noise[use, j])))
    wandering = np.diag(own)
    y, R = np.full((len(boards), k), np.nan), np.full((len(boards), k, k), np.nan)
    change, variance = np.full((len(boards), k), np.nan), np.full((len(boards), k), np.nan)
    for b, its in enumerate(sessions):
        y[b], R[b] = _pooled([(value, R_s + wandering) for value, R_s in its])
        if len(its) > 1:
            before, spread = _pooled([(value, R_s + wandering) for value, R_s in its[:-1]])
            change[b] = its[-1][0] - before
            variance[b] = np.diag(spread + its[-1][1] + wandering)
    if len(later) >= FEWEST_PAIRS:
        with np.errstate(all="ignore"):
            middle = [np.median(c[np.isfinite(c)]) if np.isfinite(c).any() else 0.0
                      for c in change.T]
        change = change - middle
    else:
        change[:] = np.nan  # without a repeatability nobody knows what is a drift
    return Block(name, names, y, R), Change(names, change, variance), np.sqrt(own)


def _pooled(sessions):
    """(y (k,), R (k, k)): the mean of estimates by their covariances; one where only one is
    whole. What none of them has stays unknown."""
    whole = [(y, R) for y, R in sessions if np.isfinite(y).all() and np.isfinite(R).all()]
    if not whole:
        return next(((y, R) for y, R in sessions if np.isfinite(y).any()), sessions[0])
    weights = [np.linalg.inv(R + 1e-18 * np.eye(len(R))) for _, R in whole]
    R = np.linalg.inv(sum(weights))
    return R @ sum(w @ y for w, (y, _) in zip(weights, whole)), R


def _effects(sensor, chip, informations):
    """([Block] of each effect that the boards' rests can tell, [names] of those they cannot)."""
    names = effects.NAMES[sensor]
    total = sum(one.precision for one in informations)
    usual = np.array([abs(typical.size(n.split(".")[1], chip, sensor, n.split(".")[2])[0] or
                          typical.size(n.split(".")[1], chip, sensor)[0] or 1.0) for n in names])
    floor = (TIMES_TYPICAL * usual) ** -2.0
    kept, aliases, unseen = [], {}, []
    for effect in dict.fromkeys(n.split(".")[1] for n in names):
        mine = [k for k, n in enumerate(names) if n.split(".")[1] == effect]
        left, rival = _left(total, mine, kept, floor, names)
        if left >= TOLD_APART and _seen(total, mine, usual, len(informations)):
            kept += mine
        elif left < TOLD_APART and rival:
            aliases.setdefault(rival, []).append(effect)
        else:
            unseen.append("%s of the %s" % (effect, sensor))
    if not kept:
        return [], unseen
    y = np.full((len(informations), len(kept)), np.nan)
    R = np.full((len(informations), len(kept), len(kept)), np.nan)
    for b, one in enumerate(informations):
        precision = one.precision[np.ix_(kept, kept)]
        if not precision.any():
            continue
        R[b] = np.linalg.inv(precision + np.diag(floor[kept]))
        y[b] = R[b] @ one.score[kept]
    blocks = []
    for effect in dict.fromkeys(names[k].split(".")[1] for k in kept):
        at = [i for i, k in enumerate(kept) if names[k].split(".")[1] == effect]
        own = [kept[i] for i in at]
        blocks.append(Block("%s.%s" % (sensor, effect), tuple(names[k] for k in own), y[:, at],
                            R[:, at][:, :, at], usual[own], tuple(aliases.get(effect, ()))))
    return blocks, unseen


def _left(total, mine, kept, floor, names):
    """(share of the information on columns that the kept ones leave, the kept effect that takes
    most of it)."""
    own = total[np.ix_(mine, mine)]
    if not np.trace(own) > 0.0:
        return 0.0, None
    if not kept:
        return 1.0, None
    other = total[np.ix_(kept, kept)] + np.diag(floor[kept])
    cross = total[np.ix_(kept, mine)]
    taken = cross * np.linalg.solve(other, cross)
    shares = {}
    for k, part in zip(kept, taken):
        effect = names[k].split(".")[1]
        shares[effect] = shares.get(effect, 0.0) + float(part.sum())
    return 1.0 - float(taken.sum()) / float(np.trace(own)), max(shares, key=shares.get)


def _seen(total, mine, usual, number):
    """Whether a mean over the boards can tell an effect of its typical size."""
    own = np.diag(total)[mine]
    return bool((own > 0.0).any() and (1.0 / np.sqrt(own[own > 0.0])
                                       < usual[mine][own > 0.0]).any() and number)
