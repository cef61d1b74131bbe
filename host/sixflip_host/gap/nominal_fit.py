"""Stage 1: the nominal model of one session by generalised least squares.

Nuisance of the accelerometer: twelve parameters; the lateral position of every pose (table and
box; with a certified box only what changes sign with the flip); two free angles of each leaning
placement. Of the gyro: a bias and the Earth's vertical rate. What is left after projection are
the contrasts z = Q' y. Their covariance is white / n + placement + flicker, the two last levels
by restricted maximum likelihood [Patterson & Thompson, Biometrika 58 (1971) 545] on a grid.

Everything later needs only z' C^-1 z, S' C^-1 z and S' C^-1 S for each point of the grid (S: the
columns of all effects), so that is all that is kept: any subset of effects is an indexing.
"""
import numpy as np
from scipy.linalg import solve_triangular

from sixflip_sim.effects.drift import TIMES_S

from .attitude_fit import face_axes

PLACEMENT_MG = (0.1, 0.45, 0.8, 1.4, 3.0, 8.0, 40.0)  # per direction; 0.05 deg: 0.87
FLICKER_MG = (0.005, 0.02, 0.033, 0.05, 0.075, 0.11, 0.15, 0.22, 0.4, 0.8, 1.6, 4.0)
EARTH_DPS = (0.0005, 0.003)  # the Earth's horizontal rate, the box at an unknown azimuth
FLICKER_DPS = (0.0002, 0.0007, 0.0014, 0.002, 0.003, 0.0045, 0.008, 0.016, 0.03, 0.1)
EARTH_UP_DPS = 0.003
# Flicker has neither a shortest nor a longest time: beside the library's 10 to 1000 s.
FURTHER_S = (0.3, 1.0, 3.0, 3000.0, 10000.0)
FEWEST_PAIRS, MOST_UNLIKE = 12, 2.0  # of blocks; an axis' flicker against all, at most
COARSE_MG = 0.5  # of what rounding leaves in the mean of a rest
NOTHING = 1e-7  # share of its energy below which a column is silent


def lateral_basis(axis):
    """(2, 3): two unit vectors across a unit vector."""
    aside = np.zeros(3)
    aside[np.argmin(np.abs(axis))] = 1.0
    first = np.cross(axis, aside)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)])


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
    """Columns (3n, k) of what is unknown in every session."""
    n, up = session.n, nominal.up[session.placement]
    columns = []
    for i in range(3):
        for value in (np.ones(n), up[:, 0], up[:, 1], up[:, 2]):
            one = _columns(n)
            one[:, i] = value
            columns.append(one)
    for placement in np.unique(session.placement[session.leaning]):
        columns += _lateral(session, session.placement == placement, nominal.up[placement])
    for face in np.unique(session.face[session.face >= 0]):
        on = session.face == face
        axis = face_axes([face])[0]
        sign = np.where(session.code % 2 == 1, 1.0, -1.0)  # codes 1, 3, ... are a, the others b
        columns += _lateral(session, on, axis, sign)
        if not certified:
            columns += _lateral(session, on, axis)
        if session.rounding_accel @ np.abs(axis) > COARSE_MG:
            # The same face rounds alike in every session: it says nothing along gravity.
            one = _columns(n)
            one[on] = axis
            columns.append(one)
    return np.stack([c.reshape(-1) for c in columns], 1)


def _lateral(session, mask, axis, weight=None):
    """Two columns: the placements in the mask turned about the two directions across axis."""
    found = []
    for direction in lateral_basis(axis):
        one = _columns(session.n)
        one[mask] = direction
        if weight is not None:
            one *= weight[:, None]
        found.append(one)
    return found


def placement_columns(session):
    """(3n, 2p): one lateral position a placement on a face."""
    columns = []
    for placement in np.unique(session.placement[~session.leaning]):
        on = session.placement == placement
        columns += _lateral(session, on, face_axes(session.face[on][:1])[0])
    if not columns:
        return np.zeros((3 * session.n, 0))
    return np.stack([c.reshape(-1) for c in columns], 1)


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
    return np.clip((excess + doubt) / (excess.mean() + doubt), 1.0 / MOST_UNLIKE, MOST_UNLIKE)


def flicker(session, shares):
    """(3n, 3n) covariance of unit flicker: of the means over the blocks of a sum of
    exponentials (Ornstein-Uhlenbeck processes), equally spaced in the logarithm of time.
    shares (3,): variance of each axis."""
    gap = np.abs(session.t[:, None] - session.t[None])
    kernel = np.zeros_like(gap)
    for tau in FURTHER_S + TIMES_S:
        half = session.seconds / (2.0 * tau)
        shrunk = np.sinh(np.minimum(half, 30.0)) / np.maximum(half, 1e-9)
        apart = np.maximum(gap - (session.seconds[:, None] + session.seconds[None]) / 2.0, 0.0)
        inside = np.exp(-np.minimum(half[:, None] + half[None], 60.0)) * np.outer(shrunk, shrunk)
        mean = np.exp(-apart / tau) * inside
        x = 2.0 * half
        np.fill_diagonal(mean, 2.0 / x * (1.0 - (1.0 - np.exp(-x)) / x))
        kernel += mean
    return np.kron(kernel, np.diag(shares))


class Unit:
    """One session (or a part of one) of one sensor, reduced to sufficient statistics.

    designs: list of Design, their columns side by side; slices: {(effect, variant): slice}.
    grid: list of (placement level, flicker level). gram (G, K, K), logdet (G,).
    signature: what the protocol is known by, see thresholds.py.
    """

    signature = ()
    within = {}  # (effect, number of its choice): nats that the blocks of the rests say for it
    between = False  # True for what lies between the sessions, see between.py

    def __init__(self, y, nuisance, white, lateral, kernel, levels, designs, fixed=None):
        u, s, _ = np.linalg.svd(nuisance, full_matrices=True)
        rank = int((s > 1e-9 * s[0]).sum())
        self.contrasts = u[:, rank:]
        self.freedom = self.contrasts.shape[1]
        self.z = self.contrasts.T @ y
        self.designs = designs
        raw = np.hstack([d.columns for d in designs])
        self.columns = self.contrasts.T @ raw
        energy, left = (raw ** 2).sum(axis=0), (self.columns ** 2).sum(axis=0)
        self.energy = 3.0 * (raw ** 2).mean(axis=0)  # of the rows of a column's own axis
        self.silent = left <= NOTHING * np.maximum(energy, 1e-300)
        self.columns[:, self.silent] = 0.0
        self.grid = [(a, b) for a in levels[0] for b in levels[1]]
        if not lateral.shape[1]:
            self.grid = [(levels[0][0], b) for b in levels[1]]
        self.shape = tuple(len({pair[k] for pair in self.grid}) for k in (0, 1))
        self.coarse = np.arange(len(self.grid)).reshape(self.shape)[::2, ::2].ravel()
        base = white if fixed is None else white + fixed
        q = self.contrasts
        self._parts = (q.T @ base @ q, q.T @ lateral, q.T @ kernel @ q)
        self._whiten()

    def _whiten(self):
        """One factorisation a flicker level. The placement level only rescales the directions
        in which placements move, so it enters by the eigenvalues of those [Woodbury; Golub &
        Van Loan, Matrix Computations, section 2.1.4]."""
        base, lateral, kernel = self._parts
        size, number = self.columns.shape[1], len(self.grid)
        self.gram, self.logdet = np.empty((number, size, size)), np.empty(number)
        self.flickers = []
        for level in dict.fromkeys(b for _, b in self.grid):
            one = Flicker(base + level ** 2 * kernel, self.columns, lateral)
            one.at = [(i, a) for i, (a, b) in enumerate(self.grid) if b == level]
            for index, placement in one.at:
                share = one.share(placement)
                self.gram[index] = one.gram - one.cross.T @ (share[:, None] * one.cross)
                self.logdet[index] = one.logdet + 0.5 * np.log1p(placement ** 2 * one.sizes).sum()
            self.flickers.append(one)

    def around(self, point):
        """Indices of a point of the grid and its neighbours."""
        a, b = divmod(point, self.shape[1])
        every = np.arange(len(self.grid)).reshape(self.shape)
        return every[max(a - 1, 0):a + 2, max(b - 1, 0):b + 2].ravel()

    def raw(self, columns):
        """(rows, k) columns before projection."""
        return np.hstack([d.columns for d in self.designs])[:, columns]

    def covariance(self, placement, level):
        """(m, m) of the contrasts for a placement and a flicker level."""
        white, lateral, kernel = self._parts
        return white + placement ** 2 * (lateral @ lateral.T) + level ** 2 * kernel

    def statistics(self, z=None):
        """(quadratic (G, R), projections (G, K, R)) of contrasts z (m, R), default the data's."""
        z = self.z[:, None] if z is None else z
        quadratic = np.empty((len(self.grid), z.shape[1]))
        projections = np.empty((len(self.grid), self.columns.shape[1], z.shape[1]))
        for one in self.flickers:
            half = solve_triangular(one.factor, z, lower=True)
            moved = one.lateral.T @ half
            squares, inner = (half ** 2).sum(axis=0), one.columns.T @ half
            for index, placement in one.at:
                share = one.share(placement)
                quadratic[index] = squares - share @ moved ** 2
                projections[index] = inner - one.cross.T @ (share[:, None] * moved)
        return quadratic, projections

    def draw(self, index, generator, number):
        """Contrasts (m, R) without any effect, with the levels of one point of the grid."""
        factor = np.linalg.cholesky(self.covariance(*self.grid[index]))
        return factor @ generator.standard_normal((self.freedom, number))


class Flicker:
    """White noise and one level of flicker, factored: factor (m, m); columns (m, K) and lateral
    (m, p) whitened, lateral turned to its principal directions, sizes (p,) their squares;
    cross (p, K), gram (K, K); logdet: half of the determinant's logarithm."""

    def __init__(self, covariance, columns, lateral):
        self.factor = np.linalg.cholesky(covariance)
        self.logdet = np.log(np.diag(self.factor)).sum()
        self.columns = solve_triangular(self.factor, columns, lower=True)
        self.lateral = solve_triangular(self.factor, lateral, lower=True)
        sizes, turned = np.linalg.eigh(self.lateral.T @ self.lateral)
        self.sizes, self.lateral = np.maximum(sizes, 0.0), self.lateral @ turned
        self.cross, self.gram = self.lateral.T @ self.columns, self.columns.T @ self.columns

    def share(self, placement):
        """(p,) what placements of this level take off, along each direction."""
        return placement ** 2 / (1.0 + placement ** 2 * self.sizes)


class Rows:
    """Readings of one session before projection: y (3n,), nuisance, columns of the twelve
    parameters' biases in it, white (3n, 3n), lateral, kernel, levels, fixed or None."""

    def __init__(self, y, nuisance, bias, white, lateral, kernel, levels, fixed=None):
        self.y, self.nuisance, self.bias = y, nuisance, bias
        self.white, self.lateral, self.kernel = white, lateral, kernel
        self.levels, self.fixed = levels, fixed

    def unit(self, designs):
        found = Unit(self.y, self.nuisance, self.white, self.lateral, self.kernel, self.levels,
                     designs, self.fixed)
        found.rows = self
        return found


def rows(kind, session, nominal, certified=False):
    """Rows of the accelerometer or the gyro."""
    if kind == "gyro":
        return gyro_rows(session, nominal)
    white = np.diag((session.noise_accel[None] ** 2 / session.seconds[:, None]).reshape(-1))
    return Rows(accel_rows(session, nominal), accel_nuisance(session, nominal, certified),
                (0, 4, 8), white, placement_columns(session),
                flicker(session, axis_shares(session, session.accel, session.noise_accel)),
                (PLACEMENT_MG, FLICKER_MG), rounding(session, session.rounding_accel))


def rounding(session, size):
    """(3n, 3n) covariance of what rounding leaves in each rest; size (3,)."""
    same = session.placement[:, None] == session.placement[None]
    return np.kron(same, np.diag(size ** 2))


def unit_of(kind, session, nominal, designs, certified=False):
    """Unit of one session."""
    return signed(rows(kind, session, nominal, certified).unit(designs), session)


def signed(unit, session):
    """The unit with its protocol's signature: poses, whole seconds, warming or cooling."""
    change = 0
    if session.temperature is not None:
        change = int(round(float(session.temperature[-1] - session.temperature[0]) / 3.0))
    unit.signature = (tuple(session.code.tolist()),
                      tuple((session.t - session.t[0]).round().astype(int).tolist()), change)
    return unit


def gyro_rows(session, nominal):
    """Rows of the gyro at rest: bias, and the Earth's rate known to a standard deviation."""
    n, up = session.n, nominal.up[session.placement]
    white = np.diag((session.noise_gyro[None] ** 2 / session.seconds[:, None]).reshape(-1))
    nuisance = np.kron(np.ones((n, 1)), np.eye(3))
    vertical = up.reshape(-1, 1)
    lateral = []
    for placement in np.unique(session.placement):
        lateral += _lateral(session, session.placement == placement, nominal.up[placement])
    lateral = np.stack([c.reshape(-1) for c in lateral], 1)
    kernel = flicker(session, axis_shares(session, session.gyro, session.noise_gyro))
    return Rows(session.gyro.reshape(-1), nuisance, (0, 1, 2), white, lateral, kernel,
                (EARTH_DPS, FLICKER_DPS), EARTH_UP_DPS ** 2 * vertical @ vertical.T
                + rounding(session, session.rounding_gyro))
