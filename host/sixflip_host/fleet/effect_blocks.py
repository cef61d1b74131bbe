"""The effects that the rests of many boards tell together, a block of estimates each, and those
that they cannot: too little is seen of them, or what others take leaves nothing."""
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects import typical

from . import effects, hierarchy, store

TOLD_APART = 0.1  # share of an effect's information that those before it must leave, as aliases
# Boards over which errors average out. What a protocol's own approximations leave, such as the
# second order of a leaning table, is the same in all of them: in 10,000 boards of
# tests/worlds/simulated_fleet.py it was four standard deviations of a single one's cubic.
AVERAGED = 200
TIMES_TYPICAL = 1000.0  # of an effect's size: what is not seen at all is known no better


@dataclass(frozen=True, eq=False)
class Block:
    """Estimates of one block: names (k,); y (n, k), nan unknown; R (n, k, k), both arrays or what
    store.py has in their place. usual (k,): sizes that are typical of an effect, None of a
    parameter of the calibration. aliases: other effects that this protocol cannot tell from this
    one."""

    name: str
    names: tuple
    y: np.ndarray
    R: np.ndarray
    usual: np.ndarray | None = None
    aliases: tuple = ()

    def variance(self):
        """(n, k): the diagonals of R."""
        return np.concatenate([np.einsum("nii->ni", self.R[cut])
                               for cut in hierarchy.cuts(len(self.R))])

    def of(self, index):
        """Block of some of the boards."""
        return replace(self, y=store.Picked(self.y, index), R=store.Picked(self.R, index))


class EffectBlocks:
    """Blocks of each effect that the rests of n boards can tell, and the names of those they
    cannot; total: the boards' information together."""

    def __init__(self, sensor, chip, total, n):
        names = effects.NAMES[sensor]
        usual = np.array([abs(typical.size(e, chip, sensor, key)[0] or
                              typical.size(e, chip, sensor)[0] or 1.0)
                          for e, key in (name.split(".")[1:] for name in names)])
        self.floor = (TIMES_TYPICAL * usual) ** -2.0
        self.kept, self.unseen, aliases = [], [], {}
        for effect in dict.fromkeys(name.split(".")[1] for name in names):
            mine = [k for k, name in enumerate(names) if name.split(".")[1] == effect]
            left, rival = _left(total, mine, self.kept, self.floor, names)
            if left >= TOLD_APART and _seen(total, mine, usual, n):
                self.kept += mine
            elif left < TOLD_APART and rival:
                aliases.setdefault(rival, []).append(effect)
            else:
                self.unseen.append("%s of the %s" % (effect, sensor))
        self.blocks, self.places = [], []
        for effect in dict.fromkeys(names[k].split(".")[1] for k in self.kept):
            at = [i for i, k in enumerate(self.kept) if names[k].split(".")[1] == effect]
            own = [self.kept[i] for i in at]
            self.blocks.append(Block(
                "%s.%s" % (sensor, effect), tuple(names[k] for k in own),
                store.Stored(n, (len(at),)), store.Stored(n, (len(at), len(at))), usual[own],
                tuple(aliases.get(effect, ()))))
            self.places.append(at)

    def put(self, number, information):
        """Take what a board's rests tell."""
        precision = information.precision[np.ix_(self.kept, self.kept)]
        if not precision.any():
            return
        R = np.linalg.inv(precision + np.diag(self.floor[self.kept]))
        y = R @ information.score[self.kept]
        for block, at in zip(self.blocks, self.places):
            block.y.put(number, y[at])
            block.R.put(number, R[np.ix_(at, at)])


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
    """Whether a mean over the boards can tell an effect of its typical size, AVERAGED of them at
    most."""
    own = np.diag(total)[mine] * min(1.0, AVERAGED / max(number, 1))
    return bool((own > 0.0).any() and (1.0 / np.sqrt(own[own > 0.0])
                                       < usual[mine][own > 0.0]).any())
