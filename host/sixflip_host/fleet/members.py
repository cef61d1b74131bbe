"""The boards of one chip and range as arrays: an estimate of every parameter of each, with its
covariance, and how well a parameter repeats from session to session.

What a board reads changes a little from switch-on to switch-on; that is no error of the estimate
and no difference between boards. Its variance comes from boards with several sessions, a change
that all of them share (the second session was the cooling one) left out.
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from ..experiment.signal_measures import MEDIAN_OF_SQUARE
from . import analysis, effects, parameters, store
from .effect_blocks import Block, EffectBlocks

FEWEST_PAIRS = 8  # boards with two sessions that a repeatability is taken from


@dataclass(frozen=True, eq=False)
class Change:
    """How each board differs from its own history: change (n, k) of the last session against the
    mean of those before, nan with one session; common (k,): what all boards changed by; variance
    (n, k)."""

    names: tuple
    change: np.ndarray
    variance: np.ndarray
    common: np.ndarray | float = 0.0


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


KEYS = "board", "batch", "written", "failure", "chip", "accel_range_g", "gyro_range_dps", "at"
COLUMNS = (*KEYS, "values", "covariances", *("%s_%s" % (what, s) for s in effects.FORMS
                                             for what in ("precision", "score")))


def by_kind(rows, keys=None):
    """[Members], the most boards first, of rows that can be gone over again and again; those that
    failed are left out. keys: the same rows with the columns KEYS, which are read faster. What is
    in memory of a board is its name: once over the rows, what all boards tell together is summed,
    once more, and each board's estimates are put into their place."""
    kinds = {}
    for row in rows if keys is None else keys:
        if _solved(row):
            kinds.setdefault(_kind(row), []).append((row["batch"], row["board"]))
    kinds = {kind: _Kind(kind, sorted(names)) for kind, names in kinds.items()}
    for step in (_Kind.look, _Kind.take):
        for row in rows:
            if _solved(row):
                step(kinds[_kind(row)], row)
    return sorted((one.members() for one in kinds.values()), key=lambda one: -len(one.boards))


def _solved(row):
    return not row["failure"] and len(row["at"]) > 0


def _kind(row):
    return row["chip"], *(None if math.isnan(row[name]) else row[name]
                          for name in ("accel_range_g", "gyro_range_dps"))


def _sessions(row):
    """[Estimate] of a row in the order of time."""
    made = analysis.estimates(row)
    return [made[k] for k in np.argsort(row["at"], kind="stable")]


class _Kind:
    """The boards of one chip and range while their rows go by."""

    def __init__(self, kind, names):
        self.kind, self.names = kind, names
        self.place = {name: k for k, name in enumerate(names)}
        n = len(names)
        self.steps = {block: store.Stored(n, (2, len(own)))
                      for block, own in parameters.BLOCKS.items()}
        self.total = {sensor: effects.nothing(sensor).precision for sensor in effects.FORMS}
        self.seen = None

    def look(self, row):
        """First time over: steps from session to session, and what the rests tell in all."""
        number, sessions = self.place[row["batch"], row["board"]], _sessions(row)
        if len(sessions) > 1:
            for name, steps in self.steps.items():
                (before, R), (last, S) = (one.of(name) for one in sessions[-2:])
                steps.put(number, [last - before, np.diag(R + S)])
        for sensor, total in self.total.items():
            total += analysis.information(row, sensor).precision

    def take(self, row):
        """Second time over: the board's estimates."""
        if self.seen is None:
            self._prepare()
        number, sessions = self.place[row["batch"], row["board"]], _sessions(row)
        for name, (block, change) in self.calibration.items():
            its = [one.of(name) for one in sessions]
            wandering = np.diag(self.repeats[name] ** 2)
            y, R = _pooled([(value, R_s + wandering) for value, R_s in its])
            block.y.put(number, y)
            block.R.put(number, R)
            self.any[name] |= bool(np.isfinite(y).any())
            if len(its) > 1 and self.enough[name]:
                before, spread = _pooled([(value, R_s + wandering) for value, R_s in its[:-1]])
                change.change.put(number, its[-1][0] - before)
                change.variance.put(number, np.diag(spread + its[-1][1] + wandering))
        for sensor, seen in self.seen.items():
            seen.put(number, analysis.information(row, sensor))

    def _prepare(self):
        n = len(self.names)
        self.repeats, self.enough, self.calibration = {}, {}, {}
        for name, own in parameters.BLOCKS.items():
            self.repeats[name], self.enough[name] = _repeatability(self.steps.pop(name)[:])
            k = len(own)
            self.calibration[name] = (
                Block(name, own, store.Stored(n, (k,)), store.Stored(n, (k, k))),
                Change(own, store.Stored(n, (k,)), store.Stored(n, (k,)), np.zeros(k)))
        self.any = dict.fromkeys(self.calibration, False)
        self.seen = {sensor: EffectBlocks(sensor, self.kind[0], total, n)
                     for sensor, total in self.total.items()}

    def members(self):
        """Members of what went by."""
        blocks, changes, repeats, unseen = [], [], {}, []
        for name, (block, change) in self.calibration.items():
            if self.any[name]:
                blocks.append(block)
                repeats.update(zip(block.names, self.repeats[name]))
            if self.enough[name]:
                changes.append(replace(change, common=np.array([
                    np.median(c[np.isfinite(c)]) if np.isfinite(c).any() else 0.0
                    for c in change.change[:].T])))
        for seen in self.seen.values():
            blocks += seen.blocks
            unseen += seen.unseen
        ranges = [math.nan if value is None else value for value in self.kind[1:]]
        return Members(self.kind[0], *ranges, tuple(board for _, board in self.names),
                       tuple(batch for batch, _ in self.names), blocks, changes, repeats,
                       tuple(unseen))


def _repeatability(steps):
    """((k,) standard deviation from session to session, whether there are enough boards to say)
    of the last step of each board and its variance (n, 2, k), nan with one session."""
    own = np.zeros(steps.shape[2])
    there = np.isfinite(steps).any(axis=(1, 2)).sum() >= FEWEST_PAIRS
    for j in range(len(own)):
        use = np.isfinite(steps[:, :, j]).all(axis=1)
        if use.sum() >= FEWEST_PAIRS:
            step, noise = steps[use, :, j].T
            away = step - np.median(step)
            own[j] = max(0.0, 0.5 * (np.median(away ** 2) / MEDIAN_OF_SQUARE - np.median(noise)))
    return np.sqrt(own), bool(there)


def _pooled(sessions):
    """(y (k,), R (k, k)): the mean of estimates by their covariances; one where only one is
    whole. What none of them has stays unknown."""
    whole = [(y, R) for y, R in sessions if np.isfinite(y).all() and np.isfinite(R).all()]
    if not whole:
        return next(((y, R) for y, R in sessions if np.isfinite(y).any()), sessions[0])
    weights = [np.linalg.inv(R + 1e-18 * np.eye(len(R))) for _, R in whole]
    R = np.linalg.inv(sum(weights))
    return R @ sum(w @ y for w, (y, _) in zip(weights, whole)), R
