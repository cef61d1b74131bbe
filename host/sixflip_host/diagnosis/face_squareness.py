"""How far the faces lie off right angles: the box or how it was put down, not the sensor.

Where each face points is a nuisance of the fit, so a crooked box leaves no gap behind; it is
worth a word all the same. Twelve parameters of a sensor take up three of the angles between six
faces; what the others are off is seen.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from sixflip.poses import faces

from ..experiment import nominal_rows, projection

WORTH_DEG = 0.2  # 3.5 mg across gravity
PLACEMENT_MG = 1.2  # 0.07 deg: a box set down by hand
SEEN = 0.2  # of the best seen direction: what a tilted table alone lets show is not used
MG_A_DEG = 1000.0 * np.radians(1.0)  # of gravity, across a face that leans


@dataclass(frozen=True)
class Crooked:
    """deg {face name: degrees off}, p, flipped: True when the table's tilt is not in it."""

    deg: dict
    p: float
    flipped: bool

    @property
    def worst(self):
        return max(self.deg.values(), default=0.0)

    def remark(self):
        """A sentence, or "" where every face is as square as by hand."""
        if self.worst < WORTH_DEG or self.p > 1e-3:
            return ""
        face = max(self.deg, key=self.deg.get)
        return ("face %s lies %.1f deg off the others: a crooked box%s or placement, not the "
                "sensor" % (face, self.deg[face], "" if self.flipped else ", a tilted table"))


def of(session, nominal):
    """Crooked of a session with labelled faces, or None."""
    on = session.face >= 0
    if not session.labelled or len(np.unique(session.face[on])) < 5:
        return None
    rows = np.repeat(on, 3)
    y = nominal_rows.accel_rows(session, nominal)[rows]
    found = sorted(set(session.face[on].tolist()))
    places, flipped = [], True
    for face in found:
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
    return Crooked({faces.pose_name(2 * f + 1)[:2]: float(d) for f, d in zip(found, deg)},
                   float(special.chdtrc(rank, chi2)), flipped)
