"""All rests and moves of a session in one nonlinear least squares, with covariance.

Two passes. In the first every flip's angle is free: the gyro's scale comes from gravity at the
two ends of the moves alone (Tedaldi et al., ICRA 2014, eq. 14), not from the belief that flips
were 180 degrees. In the second the flips are taken to scatter about 180 degrees by what the
first pass found them to scatter, no more and no less: good flips lend their angle to the gyro,
bad ones take theirs from it. Between the passes each group of equations is given the error it
turned out to have (variance components from the leverages).
"""

import numpy as np
from scipy.optimize import least_squares

from .refinement_residuals import N_ACCEL, N_GYRO, SCATTER, Equations

RAD = np.pi / 180.0
FREE_FLIP = 30.0 * RAD  # spread of the flips' angles in the first pass
STEADIEST_HAND = 0.05 * RAD
MOST_STEPS = 100  # of a pass; where the equations agree it takes about five

ACCEL_NAMES = ["accelerometer %s%s" % (a, b) for a in "xyz" for b in "xyz"]
ACCEL_NAMES = [n.replace("xx", "x scale").replace("yy", "y scale").replace("zz", "z scale")
               for n in ACCEL_NAMES] + ["accelerometer %s bias" % a for a in "xyz"]
GYRO_NAMES = []
for _axis in "xyz":
    GYRO_NAMES += ["gyro %s" % ("%s scale" % _axis if _axis == b else _axis + b) for b in "xyz"]
    GYRO_NAMES += ["gyro %s bias" % _axis]
    GYRO_NAMES += ["gyro %s per g on %s" % (_axis, b) for b in "xyz"]

SCALE = np.array([0, 4, 8])
BELOW_DIAGONAL = np.array([3, 6, 7])
GYRO_SCALE = N_ACCEL + np.array([0, 8, 16])
GYRO_PER_G = N_ACCEL + np.array([7 * i + 4 + j for i in range(3) for j in range(3)])
GYRO_OFFSET = N_ACCEL + np.array([3, 10, 17])


def nominal(flips):
    """Parameters of a perfect sensor and perfect flips."""
    p = np.zeros(N_ACCEL + N_GYRO + flips)
    p[SCALE] = 1.0
    p[GYRO_SCALE] = 1.0
    return p


def out_of_factory(flips):
    """Typical size of every parameter's error: the prior, and the scale of the SVD."""
    typical = np.full(N_ACCEL + N_GYRO + flips, 0.02)
    typical[SCALE] = 0.03
    typical[9:12] = 0.1  # g
    typical[GYRO_SCALE] = 0.03
    typical[GYRO_OFFSET] = 5.0 * RAD  # rad/s
    typical[GYRO_PER_G] = 0.2 * RAD  # rad/s a g
    typical[N_ACCEL + N_GYRO :] = FREE_FLIP
    return typical


class Refinement:
    """p (size,), covariance (size, size), free (size,) bool: which were estimated.

    groups {name: (rms of the whitened residual, number, degrees of freedom)}; jacobian and
    residual of the data alone (no prior); typical; names; equations; first: the pass whose
    gyro scale owes nothing to the flips; hand: spread of the flips about 180 degrees, rad.
    """

    def sigma(self):
        return np.sqrt(np.diag(self.covariance))

    def accelerometer(self):
        """A (3, 3) and o (3,), g."""
        return self.p[:9].reshape(3, 3), self.p[9:12]

    def gyro(self):
        """M (3, 3), offset (3,) rad/s, per_g (3, 3) rad/s a g."""
        W = self.p[N_ACCEL : N_ACCEL + N_GYRO].reshape(3, 7)
        return W[:, :3], W[:, 3], W[:, 4:]

    def excess(self):
        """Of every flip: turn minus 180 degrees and its standard error, rad."""
        first = N_ACCEL + N_GYRO
        return self.p[first:], self.sigma()[first:]


def which_free(session, per_g):
    """Columns to estimate: nine accelerometer terms when no face fixes the axes."""
    flips = len(session.flips)
    free = np.ones(N_ACCEL + N_GYRO + flips, dtype=bool)
    if not session.on_faces():
        free[BELOW_DIAGONAL] = False
    if not per_g:
        free[GYRO_PER_G] = False
    if not session.has_gyro:
        free[N_ACCEL:] = False
    for k, flip in enumerate(session.flips):
        free[N_ACCEL + N_GYRO + k] = flip.move is not None
    return free


def one_pass(equations, start, centre, typical, free):
    """Least squares of the equations with a prior of `typical` about `centre`."""
    columns = np.flatnonzero(free)
    held = {}

    def evaluate(q):
        key = q.tobytes()
        if held.get("key") != key:
            p = centre.copy()
            p[columns] += typical[columns] * q
            groups = equations.evaluate(p)
            r = np.concatenate([r for r, _ in groups.values()] + [q])
            J = np.vstack([J[:, columns] * typical[columns] for _, J in groups.values()]
                          + [np.eye(len(q))])
            held.update(key=key, p=p, groups=groups, r=r, J=J)
        return held

    fit = least_squares(
        lambda q: evaluate(q)["r"].copy(), (start - centre)[columns] / typical[columns],
        lambda q: evaluate(q)["J"].copy(), method="lm", xtol=1e-10, ftol=1e-10, gtol=1e-10,
        max_nfev=MOST_STEPS,
    )
    at = evaluate(fit.x)
    refined = Refinement()
    refined.equations, refined.typical, refined.free = equations, typical, free
    refined.p = at["p"]
    inverse = np.linalg.inv(at["J"].T @ at["J"])
    refined.covariance = np.zeros((len(centre), len(centre)))
    refined.covariance[np.ix_(columns, columns)] = inverse * np.outer(
        typical[columns], typical[columns]
    )
    refined.groups = _group_errors(at["groups"], columns, refined.covariance)
    refined.jacobian = np.vstack([J for _, J in at["groups"].values()])
    refined.residuals = {k: r for k, (r, _) in at["groups"].items()}
    refined.names = ACCEL_NAMES + GYRO_NAMES + [
        "flip %s" % equations.session.names[f.a][:2] for f in equations.session.flips
    ]
    return refined


def _group_errors(groups, columns, covariance):
    inner = covariance[np.ix_(columns, columns)]
    errors = {}
    for name, (r, J) in groups.items():
        J = J[:, columns]
        freedom = len(r) - float(np.einsum("ni,ij,nj->", J, inner, J))
        errors[name] = (float(np.sqrt(r @ r / max(freedom, 1e-9))), len(r), freedom)
    return errors


def hand_spread(excess, covariance):
    """Spread of the true flip angles about 180 degrees, rad: its likeliest value, given what
    was measured with that covariance."""
    best, spread = -np.inf, STEADIEST_HAND
    for tau in np.geomspace(STEADIEST_HAND, FREE_FLIP, 60):
        total = covariance + tau**2 * np.eye(len(excess))
        likely = -np.linalg.slogdet(total)[1] - excess @ np.linalg.solve(total, excess)
        if likely > best:
            best, spread = likely, tau
    return spread


def refine(session, per_g=False, centre=None, typical=None, free=None):
    """The joint solution of a RestsAndMoves; see the module. Returns a Refinement.

    centre, typical: the parameters before this session and how far they may be off (default a
    nominal sensor out of the factory); free: columns to estimate (default which_free).
    """
    flips = len(session.flips)
    centre = nominal(flips) if centre is None else centre
    typical = out_of_factory(flips) if typical is None else typical
    free = which_free(session, per_g) if free is None else free
    equations = Equations(session)
    first = one_pass(equations, centre, centre, typical, free)
    # A hand may be steadier than supposed, but never better than the means are.
    noise = float(np.median(session.force_error))
    least = {"flips": noise / np.hypot(noise, SCATTER)}
    for name, (rms, _, freedom) in first.groups.items():
        if freedom > 2.0:
            equations.sigma[name] *= max(rms, least.get(name, 1.0))
    first = one_pass(equations, first.p, centre, typical, free)
    turned = np.flatnonzero(free[N_ACCEL + N_GYRO :]) + N_ACCEL + N_GYRO
    if not len(turned):
        first.first, first.hand = first, None
        return first
    hand = hand_spread(first.p[turned], first.covariance[np.ix_(turned, turned)])
    closer = typical.copy()
    closer[turned] = hand
    final = one_pass(equations, first.p, centre, closer, free)
    final.first, final.hand = first, hand
    return final
