"""What a member of a set costs: simulated nulls and strangers of the very protocol, in a cache.

Nulls: contrasts without any effect are drawn with the levels of placement and flicker that the
data shows, and scored as the data is; the cost is a quantile of the largest gain of any
hypothesis (so the search itself is in it). Strangers, of which names take up a part: mimicry.py.
"""
import hashlib
import json
import math
import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import atomic_write
from . import evidence, forms_at_once, mimicry
from .elimination import NONE
from .mimicry import Mimicry
from .odds import CHANCE, COST, RARER

RUNS = 160  # of which the upper tenth, 16, tell the scale of the tail to a quarter
FIRST = 16  # of them, which tell the levels of noise that all are likely at
REACH = 3  # steps of the grid about the levels simulated: costs as of all of it to 0.1 nats
UPPER = 0.1  # of them: a tail is exponential [Pickands, Annals of Statistics 3 (1975) 119]
TIMES_USUAL = 1.6  # of the usual levels, that a null has at most
SMALLEST_SCALE = 1e-6  # nats: all nulls gain the same
MARGIN_NATS = 1.0  # noise is not quite what it is simulated as
LEAST_NATS = 4.0  # GAP: 95 % of the prototype's nulls in one search with the noise known exactly
FORMAT = 61  # of the cache: another one where what is kept, or how it is made, has changed


@dataclass(frozen=True)
class Cutoffs:
    """member: nats that a member of a set must gain; beside: share of what a stranger in the set
    gains that another member must gain as well; form: the same of what a named member gains,
    whose form a part has not exactly: a seventh of its size, squared; own: {Form: nats} of those
    forms whose cost is not the member's; mimicry: of the strangers."""

    member: float
    beside: float
    form: float = 0.02
    own: dict = field(default_factory=dict)
    mimicry: Mimicry = Mimicry()

    def nats(self, form):
        """Nats that this member of a set must gain; what is not in the library is rarer, unless it
        is no more than a level of noise. What takes a stranger's columns in, as a discrepancy
        beside its own, gains by chance what that does."""
        return (RARER if form.generic and not form.free else 0.0) + max(
            (nats for other, nats in self.own.items() if other == form or
             form.discrepancy and np.isin(other.columns, form.columns).any()), default=self.member)


def folder():
    """Where costs are kept: SIXFLIP_THRESHOLDS, or a folder of the cache."""
    if os.environ.get("SIXFLIP_THRESHOLDS"):
        return Path(os.environ["SIXFLIP_THRESHOLDS"])
    root = os.environ.get("SIXFLIP_CACHE")
    if not root:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "sixflip"
    return Path(root) / "thresholds"


def least_nats(number):
    """Nats below which none of so many forms is taken in. A habit of the hand is in the moves, and
    no lot of their signs shows it; so the nulls alone are not trusted with less than what holds
    for any: exp(nats) of a predictive likelihood is 1 on average without an effect, and the
    largest of `number` exceeds `number` / CHANCE in at most CHANCE [Markov's inequality]."""
    return COST + math.log(number) + MARGIN_NATS


def for_protocol(units, forms, levels):
    """Cutoffs in this protocol; where no form is left to compete, none can gain by chance."""
    if not forms:
        return Cutoffs(LEAST_NATS, mimicry.LEAST_SHARE)
    empty = [evidence.fit(u, u.statistics(), NONE, NONE, levels.prior(u, ())) for u in units]
    points = [_usual(u, int(f.index[0]), levels) for u, f in zip(units, empty)]
    name = folder() / ("%s.json" % _key(units, forms, levels, points))
    try:
        kept = json.loads(name.read_text())
        return _cutoffs(float(kept["member"]), Mimicry(
            tuple(map(float, kept["alike"])), tuple(map(float, kept["left"]))))
    except (OSError, ValueError, KeyError, TypeError):
        cutoffs = _cutoffs(simulated(units, forms, levels, points),
                           mimicry.simulated(units, forms, levels, points))
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        strangers = cutoffs.mimicry
        kept = {"member": cutoffs.member, "alike": strangers.alike, "left": strangers.left}
        atomic_write.write_bytes(str(name), json.dumps(kept).encode())
    except OSError:
        pass  # a cache that cannot be written is no error
    return cutoffs


def _cutoffs(member, strangers):
    return Cutoffs(member, strangers.least(), mimicry=strangers)


def _usual(unit, point, levels):
    """The point of a unit's grid nearest to one that the data shows, with no more flicker and
    placement, or change from one switch-on to the next, than is usual: a null is what the chip
    and the hand do anyhow."""
    top = [level if unit.between else TIMES_USUAL * level for level in levels.usual(unit)]
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
        (f.effect, f.variant, str(f.axis), f.record, len(f.shared)) for f in forms))).encode())
    for form in forms:
        if form.of_fleet:  # of data sheets the sizes belong to the program
            h.update(repr((form.effect, form.variant, str(form.axis), [
                "%.2g" % x for x in form.shared.prior])).encode())
    return h.hexdigest()[:24]


def simulated(units, forms, levels, points):
    """One cost for all forms, from RUNS simulated data sets."""
    start, scale = _tail(_by_chance(units, forms, levels, points).max(axis=0))
    return _cost(start + scale * math.log(UPPER / CHANCE))


def simulated_each(units, forms, levels, points):
    """{Form: cost}, from RUNS simulated data sets. What a form gains by chance is counted in the
    scale of its own upper tail, and the cost is where the largest of all forms lies in CHANCE of
    the nulls: the search is in it, and no form's tail hides another [Westfall and Young,
    Resampling-Based Multiple Testing (1993), section 2.3]."""
    gains = _by_chance(units, forms, levels, points)
    tails = [_tail(row) for row in gains]
    largest = np.max([(row - start) / scale for row, (start, scale) in zip(gains, tails)], axis=0)
    start, scale = _tail(largest)
    beyond = start + scale * math.log(UPPER / CHANCE)
    return {form: _cost(own + width * beyond) for form, (own, width) in zip(forms, tails)}


def _by_chance(units, forms, levels, points):
    """(forms, RUNS) nats that each form gains alone in nulls."""
    generator = np.random.default_rng(20190919)
    prior = [levels.prior(u, ()) for u in units]
    drawn = [u.draw(k, generator, RUNS) for u, k in zip(units, points)]
    near = [mimicry.likely(u, u.statistics(z[:, :FIRST], own), level, own)
            for u, z, level, own in zip(units, drawn, prior, (
                u.around(k, REACH) for u, k in zip(units, points)))]
    statistics = [u.statistics(z, own) for u, z, own in zip(units, drawn, near)]
    gains = np.zeros((len(forms), RUNS))
    for free in {form.free for form in forms}:
        mine = [k for k, form in enumerate(forms) if form.free == free and not form.choices]
        gains[mine] = forms_at_once.scores(
            units, statistics, [forms[k].shared for k in mine],
            [levels.prior(u, free) for u in units], near, "what chance alone shows",
            units[0].apart, evidence.positive(units))
    own = [k for k, form in enumerate(forms) if form.choices]
    for unit, sums, level, points in zip(units, statistics, prior, near) if own else ():
        gains[own] += _of_choices(unit, sums, [forms[k] for k in own], level, points)
    return gains - forms_at_once.scores(units, statistics, [NONE], prior, near)


def _of_choices(unit, statistics, forms, level, points):
    """(F, RUNS) evidence of a unit with the likeliest choice of each of these Forms; what lies
    between the sessions has none."""
    if unit.between:
        return forms_at_once.evidences(unit, statistics, [NONE], level, points)
    choices = [choice for form in forms for choice in form.choices]
    found = forms_at_once.evidences(unit, statistics, choices, level, points) + np.concatenate(
        [form.chances for form in forms])[:, None]
    last = np.cumsum([len(form.choices) for form in forms])
    return np.array([each.max(axis=0) for each in np.split(found, last[:-1])])


def _tail(gains):
    """(start, scale) of the upper tenth of what nulls gain: the tail of a log likelihood ratio
    is exponential."""
    start = float(np.quantile(gains, 1.0 - UPPER))
    above = gains[gains > start]
    return start, max(float(np.mean(above - start)) if len(above) else 0.0, SMALLEST_SCALE)


def _cost(quantile):
    return max(LEAST_NATS, quantile + MARGIN_NATS)
