"""All rests and moves of a capture in one least squares: the answer as a dictionary."""

import numpy as np

from sixflip.poses.faces import LEANING

from ..capture import rests, rests_by_variance
from ..errors import BadFile, CheckFailed
from ..experiment import blocks
from . import joint_refinement, multiposition, refinement_record, rests_and_moves
from . import refinement_answer as answer
from .joint_refinement import GYRO_OFFSET, GYRO_PER_G, GYRO_SCALE, N_ACCEL, N_GYRO, SCALE

LABELS = "labels"
FEWEST_RESTS = 8        # from which the gyro's g-sensitivity is told from its bias
WORTH_NINE_TERMS = 2.0  # chi2/dof must fall this many times over before they are believed
TOLD = 0.5              # share of the prior variance a session must take away


def refine(capture, free=False, record=None, g_sensitivity="auto"):
    """The answer (a dictionary, JSON-able) of a capture; see the verb's options.

    record: a correction Record to keep the undetermined from.
    """
    session, source = session_of(capture, free)
    told, kept = None, None
    if record is not None:
        result, told, kept = refine_from_record(session, record)
    else:
        per_g = g_sensitivity == "on" or (
            g_sensitivity == "auto" and pulled_by_gravity(session))
        if g_sensitivity == "on" and not session.has_gyro:
            raise BadFile("no gyro columns, expected gx gy gz for --g-sensitivity on")
        result = joint_refinement.refine(session, per_g)
    return assemble(capture, session, result, source, told, kept)


def bias_of_rests(session):
    """Rest means of each gyro axis as bias + per_g . force, and without per_g.

    session: RestsAndMoves. Returns (chi2/dof without (3,), with (3,), per_g (3, 3) rad/s a g).
    """
    x = np.hstack([np.ones((len(session.force), 1)), session.force])
    weight = 1.0 / session.rate_error[:, None]
    chi2 = []
    for columns in (x[:, :1], x):
        fitted = np.linalg.lstsq(columns * weight, session.rate * weight, rcond=None)[0]
        left = (session.rate - columns @ fitted) * weight
        chi2.append((left**2).sum(axis=0) / (len(x) - columns.shape[1]))
    return chi2[0], chi2[1], fitted[1:].T


def pulled_by_gravity(session):
    """True when the rests say that g-sensitivity is there and can be told from the bias."""
    if not session.has_gyro or len(session.codes) < FEWEST_RESTS:
        return False
    spread = np.linalg.svd(session.force - session.force.mean(axis=0), compute_uv=False)
    if spread[-1] < 0.5:
        return False
    without, with_it, _ = bias_of_rests(session)
    return bool(without.mean() > WORTH_NINE_TERMS * max(with_it.mean(), 1.0))


def ageing(flips):
    """How far a calibrated sensor may be off its record: biases drift, shapes hardly do."""
    typical = np.full(N_ACCEL + N_GYRO + flips, 0.002)
    typical[SCALE] = 0.003
    typical[9:12] = 0.03  # g
    typical[GYRO_SCALE] = 0.01
    typical[GYRO_OFFSET] = np.radians(2.0)
    typical[GYRO_PER_G] = 0.0
    typical[N_ACCEL + N_GYRO :] = joint_refinement.FREE_FLIP
    return typical


def refine_from_record(session, record):
    """The joint refinement of what this session tells; (Refinement, solved names, kept names).

    For robots that cannot take all six faces. A vehicle can rest on the floor, turn on it, stand
    on a ramp both ways. Whatever that determines is estimated, starting from a correction record;
    a parameter the session does not narrow by half stays exactly as the record has it.
    """
    flips = len(session.flips)
    centre, typical = refinement_record.parameters(record, flips, session.g), ageing(flips)
    free = np.ones(len(centre), dtype=bool)
    free[GYRO_PER_G] = False
    if not session.has_gyro:
        free[N_ACCEL : N_ACCEL + N_GYRO] = False
    for k, flip in enumerate(session.flips):
        free[N_ACCEL + N_GYRO + k] = flip.move is not None
    sensor = np.arange(len(centre)) < N_ACCEL + N_GYRO
    while True:
        refined = joint_refinement.refine(session, centre=centre, typical=typical, free=free)
        share = 1.0 - (refined.sigma() / np.where(typical > 0, typical, 1.0)) ** 2
        weak = free & sensor & (share < TOLD)
        if not weak.any():
            break
        free[weak & (share <= share[weak].min() + 0.1)] = False
    # What is kept is as uncertain as its age, not certain because it was not touched.
    held = np.flatnonzero(~free & sensor)
    refined.covariance[held, held] = typical[held] ** 2
    told = [refined.names[k] for k in np.flatnonzero(free & sensor)]
    known = np.ones(len(centre), dtype=bool)
    known[GYRO_PER_G] = False
    if record.gyro is None and not session.has_gyro:
        known[N_ACCEL:] = False
    kept = [refined.names[k] for k in np.flatnonzero(~free & sensor & known)]
    return refined, told, kept


def session_of(capture, free=False, far_pairs=None):
    """(RestsAndMoves of a capture, where its rests come from, in words). far_pairs as there;
    default: where they are labelled."""
    runs, source = rests_of(capture, free)
    return rests_and_moves.from_session(blocks.session_of("the session", capture, runs),
                              source == LABELS if far_pairs is None else far_pairs), source


def rests_of(capture, free):
    """list of rests.Run and where they come from, in words."""
    if capture.pose is not None and capture.pose.any():
        runs = blocks.runs_of(capture, by_hand=True)
        if free:
            return renamed([(f, e) for _, f, e in runs]), "labels, taken as free poses"
        return runs, LABELS
    if free:
        lsb = float(capture.meta["accel_lsb_per_g"])
        if len(capture) < 2 * rests_by_variance.WINDOW:
            raise BadFile("%d samples, expected a session of rests" % len(capture))
        try:
            fit = multiposition.search(capture.accel * (capture.g / lsb), capture.g)
        except ValueError as error:
            raise CheckFailed(str(error))
        return renamed([(run.first, run.end) for run in fit.rests]), "found by |a| = g (Tedaldi)"
    from ..capture.find_poses import find_poses
    posed = find_poses(capture)
    return rests.labelled(np.asarray(posed.pose)), "found against the sensor's own noise"


def renamed(spans):
    """Spans as leaning poses L1, L2, ..."""
    return [rests.Run(LEANING + 1 + k, first, end) for k, (first, end) in enumerate(spans)]


def assemble(capture, session, result, source, told, kept):
    """Everything about a refinement in one dictionary."""
    lost, weak = answer.left_open(session, result) if told is None else ([], [])
    judged, reason = answer.verdict(session, result, lost)
    off = answer.norm_off_mg(result)
    refined = {
        "format": 1, "sensor": capture.meta["sensor"], "g": capture.g,
        "rests": len(session.codes), "rests_from": source, "moves": len(session.ends),
        "moves_left_out": list(session.left_out),
        "accel": answer.accelerometer(result, capture.g),
        "norm_off_mg": dict(zip(session.names, off.tolist())),
        "norm_off_mg_rms": float(np.sqrt(np.mean(off**2))),
        "gyro": answer.gyro(result) if session.has_gyro and session.ends else None,
        "moves_off_deg_rms": answer.moves_off_deg(session, result),
        "flips": answer.flips(session, result),
        "flip_spread_deg": None if result.hand is None else float(np.degrees(result.hand)),
        "equations": {name: {"number": n, "freedom": freedom,
                             "times_expected_error": result.equations.sigma[name]}
                      for name, (_, n, freedom) in result.groups.items()},
        "not_determined": [name for _, shares in lost[:1] for name in shares] + weak,
        "solved": told, "kept": kept, "verdict": judged, "reason": reason,
    }
    if not session.has_gyro:
        refined["gyro_missing"] = ("no gyro columns: flips are taken as 180 degrees and there is "
                                   "nothing to refine a gyro from")
    return refined
