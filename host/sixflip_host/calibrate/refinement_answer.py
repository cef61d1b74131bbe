"""A refinement as the numbers people use: P, T S v, bias, flips, verdict; JSON-able."""

import numpy as np

from sixflip.accelerometer.scale_form import scale_form

from .joint_refinement import ACCEL_NAMES, GYRO_PER_G, GYRO_SCALE, N_ACCEL, N_GYRO
from .refinement_residuals import LEVEL, SCATTER

DEG = 180.0 / np.pi
OFF_HALF_TURN = 1.0  # degrees: a flip further off is flagged, when it is beyond doubt
WILD_SCALE = 0.2  # METHOD 1: refuse |scale - 1| above
MOVES_DISAGREE = 3.0  # degrees rms
POOR_FIT = 10.0  # residuals this many times the expected: something is wrong with a rest
ENOUGH = 10.0  # times narrower than the data sheets' spread
NAMED = 0.3  # share of a parameter in the open directions above which it is named
LISTED = 9  # names in a sentence; more are counted


def accelerometer(result, g):
    """P, T, scale, v and their standard errors, m/s2; form of `solve --json`."""
    A, o = result.accelerometer()

    def matrix(p):
        P = np.zeros((4, 4))
        P[:3, :3], P[3, :3], P[3, 3] = p[:9].reshape(3, 3).T, p[9:12] * g, 1.0
        return P

    P = matrix(result.p)
    T, scale, v, _ = scale_form(P.tolist())
    covariance = result.covariance[:N_ACCEL, :N_ACCEL]
    # v = A^-1 o: dv = A^-1 (do - dA v)
    inverse = np.linalg.inv(A)
    dv = np.hstack([-inverse[:, [i]] * (inverse @ o)[None, :] for i in range(3)] + [inverse])
    sigma_v = np.sqrt(np.einsum("ij,jk,ik->i", dv, covariance, dv))
    sigma = result.sigma()
    sigma_P = matrix(sigma)
    sigma_P[3, 3] = 0.0
    return {"P": P.tolist(), "T": T, "scale": scale, "v": (np.array(v)).tolist(),
            "sigma": {"P": sigma_P.tolist(), "scale": sigma[[0, 4, 8]].tolist(),
                      "v": (sigma_v * g).tolist()},
            "terms": int(result.free[:N_ACCEL].sum())}


def gyro(result):
    """P (4 x 3), bias, sigma, pull of gravity; the scale that owes nothing to the flips.

    true rate = [w - pull f, 1] P: w measured rad/s, f the corrected force in g, pull in rad/s
    a g (per_g_dps in deg/s a g, None when not estimated); bias is the reading without force.
    """
    M, offset, per_g = result.gyro()
    A, o = result.accelerometer()
    sigma = result.sigma()[N_ACCEL : N_ACCEL + N_GYRO].reshape(3, 7)
    estimated = bool(result.free[GYRO_PER_G].any())
    # Inside, W's last columns act on the uncorrected force m = A^-1 (f - o).
    by_force = per_g @ np.linalg.inv(A)
    offset = offset - by_force @ o
    pull = -np.linalg.solve(M, by_force)
    moves = result.first
    return {"P": np.vstack([M.T, offset]).tolist(),
            "bias_dps": (-np.linalg.solve(M, offset) * DEG).tolist(),
            "sigma": {"P": np.vstack([sigma[:, :3].T, sigma[:, 3]]).tolist()},
            "per_g_dps": (pull * DEG).tolist() if estimated else None,
            "per_g_sigma_dps": (sigma[:, 4:] * DEG).tolist() if estimated else None,
            "scale_from_moves": moves.p[GYRO_SCALE].tolist(),
            "scale_from_moves_sigma": moves.sigma()[GYRO_SCALE].tolist()}


def flips(session, result):
    """{face: {angle_deg, sigma_deg, measured_deg, off, reason}} of every flip."""
    answer = {}
    excess, sigma = result.excess()
    measured, measured_sigma = result.first.excess()
    for k, flip in enumerate(session.flips):
        name = session.names[flip.a][:2]
        if flip.move is None:
            answer[name] = {"angle_deg": 180.0, "sigma_deg": None, "measured_deg": None,
                            "off": False, "reason": "no gyro over this flip, 180 assumed"}
            continue
        by_gyro, error = measured[k] * DEG, measured_sigma[k] * DEG
        off = bool(abs(by_gyro) > max(OFF_HALF_TURN, 3.0 * error))
        answer[name] = {"angle_deg": 180.0 + float(excess[k] * DEG),
                        "sigma_deg": float(sigma[k] * DEG),
                        "measured_deg": 180.0 + float(by_gyro),
                        "off": off, "reason": "%+.1f deg off a half turn, compensated" % by_gyro
                        if off else ""}
    return answer


def angles(session, result):
    """{face: rad} for accelerometer.solve: the turn from a to b, right-handed about the face."""
    excess, _ = result.excess()
    return {flip.face: np.pi + float(excess[k])
            for k, flip in enumerate(session.flips) if flip.move is not None}


def left_open(session, result):
    """(singular directions that touch the accelerometer, other parameters hardly narrowed)."""
    columns = np.flatnonzero(result.free)
    jacobian = result.jacobian[:, columns]
    if "level" in result.residuals:
        # A table believed level does determine the axes; that it need not be is said elsewhere.
        at = 0
        for name, residual in result.residuals.items():
            if name == "level":
                jacobian[at : at + len(residual)] *= LEVEL / SCATTER
            at += len(residual)
    names = [result.names[k] for k in columns]
    lost = undetermined(jacobian, names, result.first.typical[columns])
    shares = lost[0][1] if lost else {}
    return ([d for d in lost if any(n in ACCEL_NAMES for n in shares)],
            [n for n in shares if n not in ACCEL_NAMES])


def undetermined(jacobian, names, typical, enough=ENOUGH):
    """Directions the residuals leave open: list of (singular value, {name: share}).

    Singular values of the scaled Jacobian. Each column is divided by the residual's noise and
    multiplied by what a sensor of the trade typically has in that parameter. A singular value of
    s then says that the session narrows that direction s-fold; below ENOUGH it hardly says
    anything, and a number quoted for it would be noise amplified (six faces and |a| = g alone:
    16 mg, with a perfect cost).

    jacobian (n, p) of whitened residuals; names and typical sizes of the p parameters.
    """
    scaled = np.asarray(jacobian) * np.asarray(typical)[None, :]
    if len(scaled) < scaled.shape[1]:
        scaled = np.vstack([scaled, np.zeros((scaled.shape[1] - len(scaled), scaled.shape[1]))])
    _, values, right = np.linalg.svd(scaled, full_matrices=False)
    weak = values < enough
    if not weak.any():
        return []
    # The basis within the weak space is arbitrary; its projector is not.
    share = np.sum(right[weak] ** 2, axis=0)
    order = np.argsort(-share)
    shares = {names[k]: float(share[k]) for k in order if share[k] > NAMED}
    return [(float(value), shares) for value in values[weak]]


def not_determined_words(lost, parameters):
    """One line for a person: which parameters these poses cannot tell."""
    if not lost:
        return ""
    names = sorted(lost[0][1], key=lambda name: not name.startswith("accelerometer"))
    more = " and %d more" % (len(names) - LISTED) if len(names) > LISTED else ""
    return (
        "these poses determine %d of %d parameters; not determined: %s%s "
        "(add poses leaning about 45 degrees between the faces, or label the faces and flip)"
        % (parameters - len(lost), parameters, ", ".join(names[:LISTED]), more)
    )


def verdict(session, result, lost):
    """(good | doubtful | refused, one sentence)."""
    A, _ = result.accelerometer()
    off = moves_off_deg(session, result)
    if off is not None and off > MOVES_DISAGREE:
        return "refused", ("gravity at the two ends of the moves and the gyro disagree by %.1f "
                           "deg: is a gyro axis swapped or inverted?" % off)
    if lost:
        return "refused", not_determined_words(lost, int(result.free.sum()))
    if np.abs(np.diag(A) - 1.0).max() > WILD_SCALE:
        return "refused", "an axis has a scale of %.2f, expected 0.8 to 1.2" % (
            np.diag(A)[np.argmax(np.abs(np.diag(A) - 1.0))])
    ratio, k = worst_rest(session, result)
    if ratio > POOR_FIT:
        return "doubtful", "gravity at rest %s is %.1f mg off" % (
            session.names[k], 1e3 * (np.linalg.norm(result.equations.forces(result.p)[k]) - 1))
    if session.alone:
        return "doubtful", "no flips on %s: the table's tilt is in the result" % ", ".join(
            sorted({session.names[k][:2] for k in session.alone}))
    return "good", ""


def moves_off_deg(session, result):
    """RMS angle between gravity after a move and gravity before it, turned by the gyro."""
    if "moves" not in result.residuals:
        return None
    error = np.repeat(session.move_error, 3) * result.equations.sigma["moves"]
    left = (result.residuals["moves"] * error).reshape(-1, 3)
    return float(np.sqrt(np.mean(np.sum(left**2, axis=1))) * DEG)


def norm_off_mg(result):
    """|a| - g of every rest, mg."""
    return 1e3 * (np.linalg.norm(result.equations.forces(result.p), axis=1) - 1.0)


def worst_rest(session, result):
    """(|norm residual| over the median one, index of the rest)."""
    off = np.abs(np.linalg.norm(result.equations.forces(result.p), axis=1) - 1.0)
    usual = max(float(np.median(off)), 1e-4)
    k = int(np.argmax(off))
    return off[k] / usual, k
