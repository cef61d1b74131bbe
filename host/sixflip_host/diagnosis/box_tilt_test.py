"""Crooked faces as a cause: tested beside the causes found, the box no longer a nuisance but for
what any box is off, of which nothing is said.

Twelve free angles take up much that is none: they are looked for last, where all else is
explained, nothing in the registers moves readings near zero, and no nonlinearity was found: what
its true form differs from the library's by would be called a crooked box (GAP 1).

Where the box is a nuisance of the fit its faces leave no gap behind. How far they lie off right
angles is worth a word all the same: twelve parameters of a sensor take up three of the angles
between six faces, and what the others are off is seen.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from sixflip.poses import faces
from sixflip_sim.effects import typical

from ..experiment import linear_model, nominal_rows, projection
from . import aliases, cutoffs, gap_figures, hypotheses, odds, scored_sets
from .posterior import Posterior

# Standard deviation of the faces of any box.
USUAL_DEG = typical.size("box_tilt", "mpu6050", "accel")[0]
BENT = ("orientation", "amplitude")  # domains of what bends the reading itself


def possible(gap):
    """Whether a crooked box would be told from all else that a SensorGap shows."""
    if gap.unexplained or gap.drift or gap.model.conditions.coarse:
        return False
    if bent(gap.causes):
        return False
    return max(s.rounding_accel.max() for s in gap.sessions) <= nominal_rows.COARSE_MG


def bent(causes):
    """Whether one of the causes bends the reading itself."""
    return any(hypotheses.domain(c.effect) in BENT for c in causes)


def search(gap):
    """(list of Cause, Data they were found in) of a SensorGap of the accelerometer."""
    data, scored = _scored(gap, _usual(_certified(gap, few=True)))
    # What gains less than any cost is spared the rest of the search, and a cost of its own.
    if scored is None or scored[1].score - scored[0].score <= cutoffs.LEAST_NATS:
        return [], data
    units = _certified(gap, few=False)
    off = _usual(units)
    data, (without, best) = _scored(gap, off)
    forms = hypotheses.forms_of(units, gap.settings.without)
    boxes = [f for f in forms if f.effect == "box_tilt"]
    # No cause has the very form of the library, and what that leaves leans the faces as well.
    cost = cutoffs.for_protocol(off, boxes, gap.noise).member + gap.cost.form * max(
        (cause.score for cause in gap.causes), default=0.0)
    gain = best.score - without.score
    if gain <= cost:
        return [], data
    # How far its faces lean is all that they do, what is usual with it.
    data, (_, best) = _scored(gap, units)
    gains = dict.fromkeys((f.effect for f in best.forms), gain)
    places = {f.effect: odds.shares({"": cost, f.effect: gain}) for f in best.forms}
    said = Posterior(best, gap.cost, places, gains)
    return [c for c in aliases.causes(said, units, forms) if c.effect == "box_tilt"], data


def _certified(gap, few):
    """The units of a SensorGap with a box that is no nuisance; few: with the columns of the causes
    found and of the box alone, at levels of noise next to those found, else with those of every
    name, which may not be told from it, in the same places, at all levels."""
    looked_at = {form.effect for form in gap.posterior.best.forms}
    designs = gap.units[0].designs
    kept = [k for k, design in enumerate(designs) if design.effect in looked_at or (
        design.effect == "box_tilt" if few
        else not (design.generic or design.choices or design.beside))]
    first = np.cumsum([0] + [len(design.keys) for design in designs])
    wanted = None if few else np.concatenate([np.arange(first[k], first[k + 1]) for k in kept])
    units = []
    for unit, point, (session, model) in zip(gap.units, gap.adequacy.index, gap.parts):
        near = [unit.grid[k] for k in unit.around(point)]
        levels = tuple(tuple(sorted(set(values))) for values in zip(*near))
        # Beside a box that is no nuisance the readings tell the misalignments.
        rows = replace(unit.rows, nuisance=nominal_rows.accel_nuisance(session, model, True),
                       levels=levels if few else unit.rows.levels, bias=(0, 4, 8),
                       scale=(1, 6, 11), common=None, fitted=False)
        units.append(linear_model.unit(
            rows, [unit.designs[k] for k in kept] if few else unit.designs, wanted,
            signature=unit.signature, within=unit.within))
    return units


def _usual(units):
    """The units with what the faces of any box are off as a nuisance. It is alike in all sessions,
    of which each has its own: so each has so much more that all together leave it as large."""
    made = []
    for unit in units:
        places = np.concatenate([np.full(len(d.keys), d.effect == "box_tilt")
                                 for d in unit.designs])
        off = unit.raw(np.flatnonzero(places)) * USUAL_DEG * np.sqrt(len(units))
        known = unit.rows.common
        rows = replace(unit.rows, common=off if known is None else np.hstack([known, off]))
        made.append(linear_model.unit(rows, unit.designs, np.flatnonzero(~unit.silent),
                                      signature=unit.signature, within=unit.within))
    return made


def _scored(gap, units):
    """(Data, (Scored without a crooked box, the best with one)); None instead of the two where no
    box can be told from the rest."""
    data = gap_figures.data_of(units)
    forms = hypotheses.forms_of(units, gap.settings.without)
    mine = [f for f in forms if f.effect == "box_tilt"]
    if not mine:
        return data, None
    model = scored_sets.Model(units, data.statistics, gap.noise)
    same = tuple(f for f in forms if any(
        (f.effect, f.variant, f.axis, f.record) == (c.effect, c.variant, None, c.record)
        for c in gap.posterior.best.forms))
    return data, (model.scored(same), max((model.scored((*same, f)) for f in mine),
                                          key=lambda s: s.score))


WORTH_DEG = 0.2  # 3.5 mg across gravity
PLACEMENT_MG = 1.2  # 0.07 deg: a box set down by hand
SEEN = 0.2  # of the best seen direction: what a tilted table alone lets show is not used
MG_A_DEG = 1000.0 * np.radians(1.0)  # of gravity, across a face that leans


@dataclass(frozen=True)
class Crooked:
    """deg {face name: degrees off}, p, flipped: True when the table's tilt is not in it; leaning:
    True when poses beside the faces would tell a sensor that bends, which a box that is not square
    spans on the faces alone (GAP 1)."""

    deg: dict
    p: float
    flipped: bool
    leaning: bool

    @property
    def worst(self):
        return max(self.deg.values(), default=0.0)

    def remark(self):
        """A sentence, or "" where every face is as square as by hand."""
        if self.worst < WORTH_DEG or self.p > 1e-3:
            return ""
        face = max(self.deg, key=self.deg.get)
        return "face %s lies %.1f deg off the others: a crooked box%s or placement, %s" % (
            face, self.deg[face], "" if self.flipped else ", a tilted table",
            "not the sensor" if self.leaning else
            "or a sensor that bends: faces alone do not tell which")


def squareness(session, nominal):
    """Crooked of a session with labelled faces, or None."""
    on = session.face >= 0
    if not session.labelled or len(np.unique(session.face[on])) < 5:
        return None
    rows = np.repeat(on, 3)
    y = nominal_rows.accel_rows(session, nominal)[rows]
    seen_faces = sorted(set(session.face[on].tolist()))
    places, flipped = [], True
    for face in seen_faces:
        for basis in projection.lateral_basis(nominal_rows.face_axes([face])[0]):
            places.append(np.where((session.face == face)[on, None], basis, 0.0).reshape(-1))
        codes = session.code[session.face == face] % 2
        flipped = flipped and len(np.unique(codes)) == 2
    places = np.stack(places, 1)
    # With flips the table's tilt changes sign on each face, and is a nuisance like the twelve.
    nuisance = nominal_rows.accel_nuisance(session, nominal, True)[rows, :None if flipped else 12]
    # The least-norm solution leaves to the faces only what no sensor takes up.
    left = y - nuisance @ np.linalg.lstsq(nuisance, y, rcond=1e-9)[0]
    own = places - nuisance @ np.linalg.lstsq(nuisance, places, rcond=1e-9)[0]
    size, _, rank, _ = np.linalg.lstsq(own, left, rcond=SEEN)
    if not rank:
        return None
    deg = np.linalg.norm(size.reshape(-1, 2), axis=1) / MG_A_DEG
    chi2 = float((size ** 2).sum()) / PLACEMENT_MG ** 2
    return Crooked({faces.pose_name(2 * f + 1)[:2]: float(d) for f, d in zip(seen_faces, deg)},
                   float(special.chdtrc(rank, chi2)), flipped, bool((~on).any()))
