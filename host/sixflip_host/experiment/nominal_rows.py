"""Readings at rest as rows of the nominal model: the readings, the columns of what is unknown (the
nuisance), and the covariance of what they err by.

Nuisance of the accelerometer: twelve parameters, of which the misalignments are known beforehand
to a degree where no pose leans; the lateral position of every pose (table and box; with a
certified box only what changes sign with the flip); two free angles of each leaning placement. Of
the gyro: a bias, the Earth's rate and the walk of the bias that any such chip has. Their
covariance is white / n + placement + flicker.
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects import typical

from . import block_measures, covariance, noise_arrays
from .attitude_fit import face_axes
from .projection import across_blocks, lateral_basis

# Levels that are tried of what a hand scatters a placement by, mg in each direction across
# gravity: closest about 0.05 degrees (0.87 mg), from a jig's hundredth of a degree to a careless
# two degrees, and the seven of a board without a box.
PLACEMENT_MG = (0.1, 0.45, 0.8, 1.4, 3.0, 8.0, 40.0, 120.0)
# Levels of flicker tried: factors of 1.4 apart where parts are (typical.FLICKER), two and more
# beyond; twice as much as the nearest is seen as no noise in a session of the recommended plan.
FLICKER_MG = (0.005, 0.01, 0.02, 0.033, 0.05, 0.075, 0.11, 0.15, 0.22, 0.4, 0.8, 1.6, 4.0)
FLICKER_DPS = (0.0002, 0.00045, 0.001, 0.0018, 0.0026, 0.0037, 0.0053, 0.0075, 0.011, 0.016, 0.025,
               0.04, 0.065, 0.1, 0.2)
EARTH_UP_DPS = 0.003  # 15 deg/h at a latitude of 45 degrees
# Levels tried of the Earth's horizontal rate, the box at an unknown azimuth: as much as upward,
# and what is left of it where the box nearly always lies the same way.
EARTH_DPS = (0.0005, 0.0012, EARTH_UP_DPS)
# Terms of a chip's own walk: what is left of it is an eighth of where it ends.
WALK_TERMS = 6
# Pairs of blocks from which on an axis' flicker is told from the others': twelve differences know
# a variance to 41 %, and no axis is taken to have more or less than twice what all have.
FEWEST_PAIRS, MOST_UNLIKE = 12, 2.0
STILL = 1e-6  # share of an axis that does not wander at all: not 0, which has no logarithm
# Of the twelve parameters' columns, as accel_nuisance has them, those of the misalignments. They
# are known beforehand to what the faces of a box may lie off right angles, a degree. Were they
# free, on a table that leans they would take up what the two poses of a face read differently.
# Where poses lean they are free: those tell three sums of two by themselves, and the three
# differences, by which the whole sensor turns, not.
MISALIGNED = [4 * i + 1 + j for i in range(3) for j in range(3) if i != j]
ASKEW_MG = 1000.0 * np.radians(1.0)
# mg that rounding leaves in the mean of a rest from which on it is a nuisance of the face: half of
# what a hand scatters a placement by (0.87 mg), below which that hides it.
COARSE_MG = 0.5


def _columns(n):
    return np.zeros((n, 3))


def accel_rows(session, nominal):
    """y (3n,) mg: corrected reading less gravity. Along the face's axis stands what |f| says
    (to all orders in the tilt), across it how far the placement lies off its face."""
    up = nominal.up[session.placement]
    on_face = (session.face >= 0)[:, None]
    axes = np.where(on_face, face_axes(session.face), up)
    change = (nominal.corrected(session.accel) - up) * 1000.0
    along = (change * up).sum(axis=1)[:, None]
    across = change - along * up + on_face * (up - axes) * 1000.0
    across -= axes * (across * axes).sum(axis=1)[:, None]
    return (along * axes + across).reshape(-1)


def accel_nuisance(session, nominal, certified):
    """Columns (3n, k) of what is unknown in every session, but the angles of leaning poses."""
    n, up = session.n, nominal.up[session.placement]
    columns = []
    for i in range(3):
        for value in (np.ones(n), up[:, 0], up[:, 1], up[:, 2]):
            column = _columns(n)
            column[:, i] = value
            columns.append(column)
    for face in np.unique(session.face[session.face >= 0]):
        on = session.face == face
        axis = face_axes([face])[0]
        sign = np.where(session.code % 2 == 1, 1.0, -1.0)  # codes 1, 3, ... are a, the others b
        columns += _lateral(session, on, axis, sign)
        if not certified:
            columns += _lateral(session, on, axis)
        if session.rounding_accel @ np.abs(axis) > COARSE_MG:
            # The same face rounds alike in every session: it says nothing along gravity.
            column = _columns(n)
            column[on] = axis
            columns.append(column)
    return np.stack([c.reshape(-1) for c in columns], 1)


def _lateral(session, mask, axis, weight=None):
    """Two columns: the placements in the mask turned about the two directions across axis."""
    columns = []
    for direction in lateral_basis(axis):
        column = _columns(session.n)
        column[mask] = direction
        if weight is not None:
            column *= weight[:, None]
        columns.append(column)
    return columns


def axis_shares(session, values, noise):
    """(3,) flicker variance of each axis over that of all: Z often has more. From neighbouring
    blocks of one rest, beyond white noise; towards 1 where that is too noisy to tell.

    values (n, 3) block means; noise (3,) of a mean over one second."""
    same = np.flatnonzero(np.diff(session.placement) == 0)
    if len(same) < FEWEST_PAIRS:
        return np.ones(3)
    squares = (np.diff(values, axis=0)[same] ** 2).mean(axis=0)
    over = (1.0 / session.seconds[same] + 1.0 / session.seconds[same + 1]).mean()
    excess = np.maximum(squares - over * noise ** 2, 0.0)
    doubt = 2.0 * over * (noise ** 2).mean() * np.sqrt(2.0 / len(same))
    alive = values.std(axis=0) > 0.0  # what always reads the same says nothing of the others
    if not alive.any():
        return np.ones(3)
    shares = (excess + doubt) / (excess[alive].mean() + doubt)
    return np.where(alive, np.clip(shares, 1.0 / MOST_UNLIKE, MOST_UNLIKE), STILL)


def _placements(session):
    """[(slice of blocks, placement)]: the blocks of each are neighbours."""
    edges = np.flatnonzero(np.diff(session.placement)) + 1
    starts = np.concatenate([[0], edges]).tolist()
    ends = np.concatenate([edges, [session.n]]).tolist()
    return [(slice(a, b), int(session.placement[a])) for a, b in zip(starts, ends)]


def _groups(session, values, noise, rounding, directions):
    """list of covariance.Group, one a placement. values (n, 3), noise, rounding (3,);
    directions(place, placement) -> (lateral (2, 3) or None, free (2, 3) or None): across which a
    placement scatters, or is free."""
    parts = []
    for place, placement in _placements(session):
        k = place.stop - place.start
        white = (noise ** 2 / session.seconds[place][:, None]).reshape(-1)
        base = np.diag(white) + np.kron(np.ones((k, k)), np.diag(rounding ** 2))
        lateral, free = (np.zeros((3 * k, 0)) if d is None else np.tile(d.T, (k, 1))
                         for d in directions(place, placement))
        basis = across_blocks(free) if free.shape[1] else np.eye(3 * k)
        parts.append((place, base, lateral, basis))
    return covariance.in_time(session.t, session.seconds,
                              axis_shares(session, values, noise), parts)


@dataclass(frozen=True, eq=False)
class Rows:
    """Readings of one session before projection: y (n,), groups (list of covariance.Group),
    nuisance (n, p), bias and scale: which of its columns are the sensor's, levels (of placement,
    of flicker), common (n, c): columns whose coefficients have a standard deviation of 1, known:
    degrees of freedom with which the size of its noise is known; fitted: y is without what the
    readings say of common, which the nominal sensor has taken up."""

    y: np.ndarray
    groups: list
    nuisance: np.ndarray
    levels: tuple
    bias: tuple = ()
    common: np.ndarray | None = None
    known: float = np.inf
    fitted: bool = False
    scale: tuple = ()

    def left(self):
        """(n, 3) what the nuisance leaves of the readings, by plain least squares."""
        taken = self.nuisance @ np.linalg.lstsq(self.nuisance, self.y, rcond=None)[0]
        return (self.y - taken).reshape(-1, 3)

    def turned_common(self):
        """(m, c) the columns of common in the basis of the groups."""
        if self.common is None:
            return np.zeros((sum(g.basis.shape[1] for g in self.groups), 0))
        return covariance.turned(self.groups, self.common)

    def loosened(self):
        """The same rows where every placement is free across its lateral directions."""
        groups = [covariance.Group(
            g.rows, g.base, np.zeros((len(g.base), 0)), g.kernel, g.from_before, g.to_later,
            g.decay, across_blocks(g.lateral) if g.lateral.shape[1] else g.basis)
            for g in self.groups]
        return replace(self, groups=groups, levels=(self.levels[0][:1], self.levels[1]))


def rows(kind, session, nominal, certified=False):
    """Rows of the accelerometer or the gyro of a session at rest."""
    if kind == "gyro":
        return _gyro_rows(session, nominal)

    def directions(place, placement):
        if session.face[place.start] < 0:
            return None, lateral_basis(nominal.up[placement])
        return lateral_basis(face_axes(session.face[place.start:place.start + 1])[0]), None
    groups = _groups(session, session.accel, session.noise_accel, session.rounding_accel,
                     directions)
    nuisance = accel_nuisance(session, nominal, certified)
    free = Rows(accel_rows(session, nominal), groups, nuisance, (PLACEMENT_MG, FLICKER_MG),
                (0, 4, 8), known=_known(session), scale=(1, 6, 11))
    if (session.face < 0).any():
        return free
    return replace(free, nuisance=np.delete(nuisance, MISALIGNED, 1), bias=(0, 2, 4),
                   scale=(1, 3, 5), common=ASKEW_MG * nuisance[:, MISALIGNED], fitted=True)


def _earth(session, up):
    """(3n, c) deg/s: the Earth's rate, its coefficients of a standard deviation of 1: upward, and
    of each face in both directions across it, where half a turn on the face inverts it: the box
    has a heading in the room, and is turned by half a circle, whatever else a hand does."""
    columns = [EARTH_UP_DPS * up.reshape(-1)]
    half = np.where(session.code % 2 == 1, EARTH_DPS[-1], -EARTH_DPS[-1])[:, None]
    for face in np.unique(session.face[session.face >= 0]) if session.labelled else ():
        on = (session.face == face)[:, None]
        columns += [(on * half * direction).reshape(-1)
                    for direction in lateral_basis(face_axes(np.array([face]))[0])]
    return np.stack(columns, 1)


def _walk(session):
    """(3n, c) deg/s: the walk of each axis' bias, its coefficients of a standard deviation of
    1."""
    chip = typical.chip_of(session.capture.meta["sensor"], "gyro")
    size = typical.WALK[chip] * np.sqrt(np.ptp(session.t))
    return size * np.kron(np.stack(noise_arrays.walk(session.t, WALK_TERMS), 1), np.eye(3))


def _gyro_rows(session, nominal):
    """Bias, and the Earth's rate and a walk known to a standard deviation."""
    up = nominal.up[session.placement]
    groups = _groups(session, session.gyro, session.noise_gyro, session.rounding_gyro,
                     lambda place, placement: (lateral_basis(nominal.up[placement]), None))
    return Rows(session.gyro.reshape(-1), groups, np.kron(np.ones((session.n, 1)), np.eye(3)),
                (EARTH_DPS, FLICKER_DPS), (0, 1, 2), known=_known(session),
                common=np.hstack([_earth(session, up), _walk(session)]))


def _known(session):
    return block_measures.freedom(session.first, session.end, session.rate)


def signature(session):
    """What a session's protocol is known by: poses, whole seconds, warming or cooling."""
    change = 0
    if session.temperature is not None:
        change = int(round(float(session.temperature[-1] - session.temperature[0]) / 3.0))
    return (tuple(session.code.tolist()),
            tuple((session.t - session.t[0]).round().astype(int).tolist()), change)
