"""The nominal model of a planned capture, and what it leaves of each effect: its signature.

Everything is linear algebra on the rows of a plan (protocols.py). Signatures, silent
effects and the alias index between two signatures are defined in experiment/projection.py.
"""
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sixflip.poses import faces
from sixflip_sim.effects.library import EFFECTS

from ..experiment import terms
from ..experiment.projection import NEGLIGIBLE, basis, by_axis, rank, without
from . import protocols
from .protocols import Rows

# Which effects have a signature in rests and turns; the order is that of the printed table.
ACCEL = ("thermal_bias", "thermal_scale", "warm_up", "thermal_rate", "quadratic",
         "cross_quadratic", "cubic", "asymmetry", "vibration_rectification", "saturation",
         "hysteresis", "creep", "box_tilt", "table_tilt", "local_gravity", "supply")
GYRO = ("thermal_bias", "thermal_scale", "warm_up", "thermal_rate", "quadratic", "cubic",
        "asymmetry", "saturation", "g_sensitivity", "hysteresis", "earth_rate", "supply")
# Shapes at which a signature is looked at: a supply that differs from the 3.3 V of a board, a rail
# below the 1 g that a face reads, a vibration. A signature does not depend on their sizes.
SHAPES = {"supply": {"volts": 3.4}, "saturation": {"level": 0.95},
          "vibration_rectification": {"vibration_mg": protocols.SHAKE_MG}}
GYRO_SHAPES = {"saturation": {"level": 50.0}}  # deg/s, below protocols.FLIP_DPS


@dataclass(frozen=True, eq=False)
class PlannedModel:
    """Nominal columns of one sensor for the rows (protocols.Rows) of a plan, and the signatures
    of the effects beside them.

    sensor "accel": a 3x3 matrix common to all sessions; a bias, the table's tilt (unless tilt is
    False) and two free angles of each leaning pose per session; the box's tilt unless it is
    certified. sensor "gyro": the 3x3 matrix of the turns, a bias per session and the horizontal
    Earth rate.
    """

    rows: Rows
    sensor: str = "accel"
    certified_box: bool = False
    tilt: bool = True

    @property
    def own(self):
        """Nuisances that are effects too: they are looked at beside the other nuisances."""
        return ("table_tilt",) if self.certified_box else ("table_tilt", "box_tilt")

    @cached_property
    def space(self):
        """(3n, r): orthonormal basis of what the nominal parameters take up."""
        number = np.bincount(self.rows.placement)
        leaning = [self.tilts_of(p) / np.sqrt(number[p])
                   for p in np.unique(self.rows.placement[self.rows.leaning])]
        return np.hstack([*(leaning if self.sensor == "accel" else ()), self._common])

    @cached_property
    def _common(self):
        """(3n, r): basis of what is common to many rows, across the leaning poses' own angles."""
        parts = [self._matrix(), self._biases()]
        if self.sensor == "accel":
            if self.tilt:
                parts.append(self._table())
            if not self.certified_box:
                parts.append(self._box())
        else:
            parts.append(self.raw("earth_rate")[1][:, 1:])
        return basis(self._across_leaning(np.hstack(parts)))

    def left(self, columns):
        """What the nominal parameters leave of columns (3n, k)."""
        return without(self._common, self._across_leaning(columns))

    def _across_leaning(self, columns):
        """Columns (3n, k) without two free angles for each leaning pose, where only the length of
        gravity is known: taken off pose by pose, so that it costs no more than there are rows."""
        lean = self.rows.leaning
        if self.sensor != "accel" or not lean.any():
            return columns
        at = self.rows.at
        turns = np.stack([np.stack(at.table_x, 1), np.stack(at.table_y, 1)], 1)[lean]
        _, pose, number = np.unique(self.rows.placement[lean], return_inverse=True,
                                    return_counts=True)
        left = columns.reshape(self.rows.n, 3, -1).copy()
        mean = np.zeros((len(number), 2, left.shape[2]))
        np.add.at(mean, pose, turns @ left[lean])
        left[lean] -= turns.transpose(0, 2, 1) @ (mean / number[:, None, None])[pose]
        return left.reshape(columns.shape)

    def _matrix(self):
        felt = self.rows.at.f if self.sensor == "accel" else self.rows.at.w
        return by_axis(felt).reshape(3 * self.rows.n, -1)

    def _biases(self):
        return by_axis([self.rows.session == s for s in np.unique(self.rows.session)]).reshape(
            3 * self.rows.n, -1)

    def _table(self):
        """Two columns a session; poses that lean stand on no table."""
        columns = terms.columns_of(EFFECTS["table_tilt"](), self.rows.at, self.rows.n)[2]
        flat = np.repeat(~self.rows.leaning, 3)
        return np.hstack([columns * (flat & np.repeat(self.rows.session == s, 3))[:, None]
                          for s in np.unique(self.rows.session)])

    def _box(self):
        return terms.columns_of(EFFECTS["box_tilt"](), self.rows.at, self.rows.n)[2]

    def tilts_of(self, placement):
        """The two small turns of one placement as columns (3n, 2), a unit for a radian."""
        mask = self.rows.placement == placement
        columns = np.zeros((self.rows.n, 3, 2))
        for k, direction in enumerate((self.rows.at.table_x, self.rows.at.table_y)):
            columns[mask, :, k] = np.stack(direction, 1)[mask]
        return columns.reshape(3 * self.rows.n, 2)

    @cached_property
    def _without_box(self):
        return PlannedModel(self.rows, self.sensor, True)

    @cached_property
    def _without_table(self):
        return PlannedModel(self.rows, self.sensor, self.certified_box, False)

    def without_own(self, name):
        """The PlannedModel without the nuisance that `name`, box_tilt or table_tilt, is."""
        return self._without_table if name == "table_tilt" else self._without_box

    @property
    def freedom(self):
        """Residual degrees of freedom: equations less the rank of the nominal model."""
        return 3 * self.rows.n - self.space.shape[1]

    def raw(self, name):
        """(keys, columns) of an effect before projection."""
        shapes = GYRO_SHAPES if self.sensor == "gyro" and name in GYRO_SHAPES else SHAPES
        effect = EFFECTS[name](self.sensor, {}, shapes.get(name))
        keys, _, columns = terms.columns_of(effect, self.rows.at, self.rows.n)
        return keys, columns

    def signature(self, name):
        """Columns (3n, k) of an effect that the nominal parameters cannot take up; None when
        nothing is left of it, which is what silent means. A nuisance is not taken up by
        itself."""
        columns = self.raw(name)[1]
        left = (self.without_own(name) if name in self.own else self).left(columns)
        energy = (columns ** 2).sum()
        return left if (left ** 2).sum() > NEGLIGIBLE * max(energy, 1e-300) else None


def even_contrasts(rows):
    """How many residual degrees of freedom say something about the sensor: of any function of
    the face alone, three channels, what the 12 parameters do not take up."""
    free = by_axis([rows.face == face for face in range(len(faces.FACES))]).reshape(
        3 * rows.n, -1)
    return rank(PlannedModel(rows, certified_box=True, tilt=False).left(free), free)
