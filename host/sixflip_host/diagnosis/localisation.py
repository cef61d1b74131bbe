"""Stage 2: where the gap lies. A share of the excess and a test per domain and axis, false
discoveries controlled [Benjamini & Hochberg, JRSS B 57 (1995) 289]."""
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from ..experiment import covariance, linear_model
from . import between_sessions, box_tilt_test, hypotheses, odds

FALSE_DISCOVERIES = 0.01  # one in a hundred of the places shown is there by chance: a stated rate
LEAST_SHARE = 0.01  # of the excess: less is no place to look at
BROAD = ("along_gravity", "across_gravity")


@dataclass(frozen=True)
class Place:
    """sensor, axis ("x" ... or None), domain, share (0 to 1), p; named: of a cause found."""

    sensor: str
    axis: str | None
    domain: str
    share: float
    p: float
    named: bool = False

    def __post_init__(self):
        object.__setattr__(self, "share", float(np.clip(self.share, 0.0, 1.0)))
        object.__setattr__(self, "p", max(float(self.p), odds.SMALLEST))


def places(gap):
    """list of Place of a SensorGap, the largest share first; those of its causes lead. One in a
    hundred of the tests finds something by chance: where no set of hypotheses is likelier than
    none, and what is left is noise, there is nothing to be looked for."""
    something = gap.causes or gap.posterior.best.forms or not gap.adequacy.ok
    if not something:
        return across(gap)
    tested = [_tested(gap, option) for option in gap.options if option.generic
              and option.axis is not None]
    tested += across(gap) + along(gap) + session(gap)
    tested = strongest(controlled([t for t in tested if t is not None]))
    named = []
    for cause in gap.causes:
        for letter in cause.letters or [None]:
            named.append(Place(gap.kind, letter, cause.domain, cause.share or 0.0,
                               odds.chance(cause.score)))
    for form in gap.strangers:
        named += _strange(gap, form, tested)
    if "drift" in gap.posterior.best.names:
        gain = gap.posterior.gains["drift"]
        named += [Place(gap.kind, letter, "time", 1.0, odds.chance(gain))
                  for letter in (gap.drift.axes if gap.drift else ()) or (None,)]
    named = [replace(place, named=True) for place in named]
    known = {(p.axis, p.domain) for p in named}
    shown = named + [t for t in tested if (t.axis, t.domain) not in known
                     and t.share >= LEAST_SHARE]
    if not shown and not gap.adequacy.ok:
        # More than noise in all, and nowhere more than elsewhere.
        shown = [Place(gap.kind, None, gap.model.left_in, 1.0, gap.adequacy.p)]
    return sorted(shown, key=order)


def _strange(gap, form, tested):
    """Places of a nameless member of the likeliest set: its axes where it has any, else those
    that the tests of its domain show."""
    gain, domain = gap.posterior.gains[form.effect], hypotheses.domain(form.effect)
    share = gain / max(gain, 0.5 * gap.adequacy.excess_before, 1e-9)
    p = odds.chance(gain)
    letters = ["xyz"[axis] for axis, _ in gap.strange_axes[form.effect]] or [
        t.axis for t in tested if t.domain == domain] or [None]
    return [Place(gap.kind, letter, domain, share, p) for letter in letters]


def order(place):
    """Sort key: named causes, then domains, then what only says along or across gravity."""
    return not place.named, place.domain in BROAD, -place.share


def strongest(tested):
    """The one with the largest share of each axis and domain: several strangers may have one."""
    largest = {}
    for place in sorted(tested, key=lambda t: t.share):
        largest[place.axis, place.domain] = place
    return list(largest.values())


def _tested(gap, option):
    """What a generic discrepancy on one axis takes off the excess, sessions together for
    what belongs to the sensor, apart for time."""
    apart = option.effect == "time"
    taken = freedom = 0.0
    sums = None
    for statistics, unit, index in zip(gap.data.statistics, gap.units, gap.levels()):
        projections = statistics[1]
        gram = unit.gram.at(index, option.columns)
        inner = projections[index][option.columns, 0]
        if apart:
            gain, rank = _explained(gram, inner)
            taken, freedom = taken + gain, freedom + rank
        else:
            sums = (gram, inner) if sums is None else (sums[0] + gram, sums[1] + inner)
    if not apart:
        taken, freedom = _explained(*sums)
    if freedom < 1:
        return None
    excess = max(gap.adequacy.excess_before, taken - freedom, 1e-9)
    return Place(gap.kind, "xyz"[option.axis], hypotheses.domain(option.effect),
                 (taken - freedom) / excess, special.chdtrc(freedom, taken))


def _explained(gram, inner):
    """(reduction of chi2, rank)."""
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    values, vectors = np.linalg.eigh(gram / scale / scale[:, None])
    keep = values > 1e-6 * max(values.max(), 1e-300)
    turned = vectors[:, keep].T @ (inner / scale)
    return float((turned ** 2 / values[keep]).sum()), int(keep.sum())


ORDINARY_PLACEMENT_MG = 2.0  # 0.11 deg: a box set down by hand


def across(gap):
    """The attitude of the placements, where they scatter more than by hand, or of the faces."""
    if gap.kind != "accel":
        return []
    levels = [u.grid[i][0] for u, i in zip(gap.units, gap.adequacy.index) if not u.between]
    off = [c.worst * box_tilt_test.MG_A_DEG for c in gap.crooked if c and c.remark()]
    worst = max(levels + off)
    if worst <= ORDINARY_PLACEMENT_MG:
        return []
    share = 1.0 - (ORDINARY_PLACEMENT_MG / worst) ** 2
    # As many placements as there are, two directions each, against what a hand does.
    number = 2 * sum(s.placements() for s in gap.sessions)
    p = special.chdtrc(number, number * (worst / ORDINARY_PLACEMENT_MG) ** 2)
    return [Place("accel", None, "across_gravity", share, p)]


def along(gap):
    """What no position of a placement can touch: the sensor itself, not its attitude."""
    if gap.kind != "accel":
        return []
    chi2 = freedom = 0.0
    for unit, index in zip(gap.units, gap.adequacy.index):
        if unit.between:
            continue
        free = linear_model.unit(unit.rows.loosened(), [])
        if not free.freedom:
            continue
        chi2 += float(free.quadratic[index % unit.shape[1]])
        freedom += free.freedom
    if not freedom:
        return []
    excess = max(gap.adequacy.excess_before, chi2 - freedom, 1e-9)
    return [Place(gap.kind, None, "along_gravity", (chi2 - freedom) / excess,
                  special.chdtrc(freedom, chi2))]


def session(gap):
    """The biases, and the scales, of the sessions against each other, beyond what switching on
    changes."""
    changes = []
    excess = max(gap.adequacy.excess_before, 1e-9)
    for unit in (u for u in gap.units if u.between):
        z = unit.z.reshape(-1, 3)
        ordinary = between_sessions.ORDINARY_CHANGE[unit.between][gap.kind]
        variance = np.diag(covariance.dense(unit.groups, ordinary, 0.0)).reshape(-1, 3)
        for axis in range(3):
            chi2 = float((z[:, axis] ** 2 / variance[:, axis]).sum())
            changes.append(Place(gap.kind, "xyz"[axis], "session", max(chi2 - len(z), 0.0) / max(
                excess, chi2), special.chdtrc(len(z), chi2)))
    return changes


def controlled(tested):
    """Those that pass the false discovery rate."""
    by_p = sorted(tested, key=lambda t: t.p)
    last = -1
    for rank, place in enumerate(by_p):
        if place.p <= FALSE_DISCOVERIES * (rank + 1) / max(len(by_p), 1):
            last = rank
    return by_p[:last + 1]
