"""What a member of a set costs: simulated nulls and strangers of the very protocol, in a cache.

Nulls: contrasts without any effect are drawn with the levels of placement and flicker that the
data shows, and scored as the data is; the cost is a quantile of the largest gain of any
hypothesis (so the search itself is in it). Strangers: contrasts with something nameless in them,
of a form that no nameless hypothesis has either; what it leaves over beside the likeliest of
those is taken up by names. A name beside a stranger must gain more than that share; and how many
strangers a name explains better still says how often a name is given to a cause without one.
"""
import hashlib
import json
import math
import os
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import atomic_write, progress
from . import evidence
from .evidence import NONE
from .odds import CHANCE

RUNS = 160  # of which the upper tenth, 16, tell the scale of the tail to a quarter
FIRST = 16  # of them, which tell the levels of noise that all are likely at
REACH = 3  # steps of the grid about the levels simulated: costs as of all of it to 0.1 nats
UPPER = 0.1  # of them: a tail is exponential [Pickands, Annals of Statistics 3 (1975) 119]
TIMES_USUAL = 1.6  # of the usual levels, that a null has at most
SMALLEST_SCALE = 1e-6  # nats: all nulls gain the same
MARGIN_NATS = 1.0  # noise is not quite what it is simulated as
LEAST_NATS = 4.0  # GAP: 95 % of the prototype's nulls in one search with the noise known exactly
FORMAT = 16  # of the cache: another one where what is kept, or how it is made, has changed
STRANGERS = 3  # simulated for each nameless hypothesis
STRANGE_CHI2 = 200.0  # of a simulated stranger: ten times what a cost amounts to
SURE = 0.9  # share of the strangers beside which no name may be taken in
MIMICKED = 0.2  # where none are simulated: of those in a recommended capture it is 0.1 to 0.3
LEAST_SHARE, MOST_SHARE = 0.02, 0.5  # a form is never known better; beyond half it is no part


@dataclass(frozen=True)
class Cutoffs:
    """member: nats that a member of a set must gain; beside: share of what a stranger in the set
    gains that another member must gain as well; form: the same of what a named member gains,
    whose form a part has not exactly: a seventh of its size, squared; own: {Form: nats} of those
    forms whose cost is not the member's; mimicked: share of the strangers that some name explains
    better than all that is nameless."""

    member: float
    beside: float
    form: float = 0.02
    own: dict = field(default_factory=dict)
    mimicked: float = MIMICKED

    def of(self, form):
        """Nats that this member of a set must gain. What takes a stranger's columns in, as a
        discrepancy beside its own, gains by chance what that does."""
        return max((nats for one, nats in self.own.items() if one == form or
                    form.discrepancy and np.isin(one.columns, form.columns).any()),
                   default=self.member)


def folder():
    """Where costs are kept: SIXFLIP_THRESHOLDS, or a folder of the cache."""
    if os.environ.get("SIXFLIP_THRESHOLDS"):
        return Path(os.environ["SIXFLIP_THRESHOLDS"])
    root = os.environ.get("SIXFLIP_CACHE")
    if not root:
        root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "sixflip"
    return Path(root) / "thresholds"


def of(units, forms, levels):
    """Cutoffs in this protocol; where no form is left to compete, none can gain by chance."""
    if not forms:
        return Cutoffs(LEAST_NATS, LEAST_SHARE)
    empty = [evidence.fit(u, u.statistics(), NONE, NONE, levels.prior(u, ())) for u in units]
    points = [_usual(u, int(f.index[0]), levels) for u, f in zip(units, empty)]
    name = folder() / ("%s.json" % _key(units, forms, levels, points))
    try:
        kept = json.loads(name.read_text())
        return Cutoffs(float(kept["member"]), float(kept["beside"]),
                       mimicked=float(kept["mimicked"]))
    except (OSError, ValueError, KeyError, TypeError):
        beside, mimicked = left_to_names(units, forms, levels, points)
        found = Cutoffs(simulated(units, forms, levels, points), beside, mimicked=mimicked)
    try:
        name.parent.mkdir(parents=True, exist_ok=True)
        kept = {"member": found.member, "beside": found.beside, "mimicked": found.mimicked}
        atomic_write.write_bytes(str(name), json.dumps(kept).encode())
    except OSError:
        pass  # a cache that cannot be written is no error
    return found


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


def of_each(units, forms, levels, points):
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
    near = [_tried(u, u.statistics(z[:, :FIRST], own), level, own) for u, z, level, own in zip(
        units, drawn, prior, (u.around(k, REACH) for u, k in zip(units, points)))]
    statistics = [u.statistics(z, own) for u, z, own in zip(units, drawn, near)]
    base = [evidence.fit(u, s, NONE, NONE, p, own)
            for u, s, p, own in zip(units, statistics, prior, near)]
    nothing = evidence.score(base, NONE)
    return np.array([_gain(form, units, statistics, prior, near, levels, base) - nothing
                     for form in progress.steps(forms, "what chance alone shows")])


def _tried(unit, statistics, level, points):
    """Points of a unit's grid, of these, that any of the data sets is likely at."""
    return unit.tried(level[:, None] - 0.5 * statistics[0] - unit.logdet[:, None], points)


def _gain(form, units, statistics, prior, near, levels, base):
    """(RUNS,) score of a set of this form alone."""
    if form.free:
        prior = [levels.prior(u, form.free) for u in units]
    if not form.choices:
        fits = [evidence.fit(u, s, form.shared, NONE, p, own)
                for u, s, p, own in zip(units, statistics, prior, near)]
        return evidence.score(fits, form.shared, units[0].apart, evidence.positive(units))
    total = 0.0
    for unit, one, level, own, plain in zip(units, statistics, prior, near, base):
        if unit.between:
            total = total + plain.evidence
            continue
        best = np.max([evidence.fit(unit, one, NONE, choice, level, own).evidence
                       for choice in form.choices], axis=0)
        total = total + best - math.log(len(form.choices))
    return total


def left_to_names(units, forms, levels, points):
    """Of strangers of another form: (share of a stranger's gain that names take up beside it;
    share of them that a name explains better than all that is nameless, by Laplace's rule of
    succession)."""
    nameless = [f for f in forms if f.generic and f.axis is None and len(f.shared)]
    named = [f for f in forms if not f.generic and f.axis is None and len(f.shared)]
    if not nameless or not named:
        return LEAST_SHARE, MIMICKED
    generator = np.random.default_rng(20190920)
    data = _strange(units, nameless, points, generator)
    every = [u.statistics(z, u.coarse) for u, z in zip(units, data)]
    prior = [levels.prior(u, ()) for u in units]
    near = [_tried(u, one, level, u.coarse) for u, one, level in zip(units, every, prior)]

    def scored(shared, statistics=every):
        fits = [evidence.fit(u, one, shared, NONE, level, own)
                for u, one, level, own in zip(units, statistics, prior, near)]
        return evidence.score(fits, shared)
    nothing = scored(NONE)
    gains = np.array([scored(f.shared) for f in nameless]) - nothing
    best, shares = gains.argmax(axis=0), []
    names = np.max([scored(f.shared) for f in named], axis=0) - nothing
    strange = names < gains.max(axis=0)  # what a name explains better is no stranger
    for place in progress.steps(np.unique(best[strange]), "what strangers leave to names"):
        which = np.flatnonzero((best == place) & strange)
        alone = gains[place, which]
        mine = [(quadratic[:, which], inner[:, :, which]) for quadratic, inner in every]
        beside = np.max([scored(_together(nameless[place].shared, f.shared), mine)
                         for f in named], axis=0) - nothing[which] - alone
        shares += (np.maximum(beside, 0.0) / np.maximum(alone, LEAST_NATS)).tolist()
    return (float(np.clip(np.quantile(shares or [0.0], SURE), LEAST_SHARE, MOST_SHARE)),
            float((np.sum(~strange) + 1.0) / (len(strange) + 2.0)))


def _together(one, other):
    """Columns of both, each once."""
    new = ~np.isin(other.index, one.index)
    return one + evidence.Columns(other.index[new], other.prior[new])


def _strange(units, nameless, points, generator):
    """[contrasts (m, R)] of each unit: noise, and in every data set a combination of the columns
    of one nameless hypothesis on one axis, bent flat at both ends, the same in all sessions."""
    every = [[] for _ in units]
    for form in nameless:
        for number in range(STRANGERS):
            mine = form.columns[np.array(form.axes) == number % 3]
            if not len(mine):
                continue
            mix = generator.standard_normal(len(mine))
            raw = [np.zeros(0) if u.between else u.raw(mine) @ mix for u in units]
            width = np.sqrt(np.mean(np.concatenate(raw) ** 2)) + 1e-12
            moved = [np.zeros(len(u.z)) if u.between else u.contrasts(np.tanh(x / width))
                     for u, x in zip(units, raw)]
            chi2 = sum(u.chi2(m, k) for u, m, k in zip(units, moved, points))
            size = np.sqrt(STRANGE_CHI2 / max(chi2, 1e-9))
            for found, unit, m, k in zip(every, units, moved, points):
                found.append(size * m + unit.draw(k, generator, 1)[:, 0])
    return [np.stack(found, axis=1) for found in every]


def _tail(gains):
    """(start, scale) of the upper tenth of what nulls gain: the tail of a log likelihood ratio
    is exponential."""
    start = float(np.quantile(gains, 1.0 - UPPER))
    above = gains[gains > start]
    return start, max(float(np.mean(above - start)) if len(above) else 0.0, SMALLEST_SCALE)


def _cost(quantile):
    return max(LEAST_NATS, quantile + MARGIN_NATS)
