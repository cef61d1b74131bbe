"""A capture as the refinement sees it: rests with their means, moves with their rotations."""

from dataclasses import dataclass

import numpy as np

from sixflip import RAIL
from sixflip.poses.faces import AXIS, SIGN, face_of_code, is_b, pose_name
from sixflip.poses.placement import GAP_US

from ..errors import BadFile, CheckFailed
from ..experiment import blocks
from ..experiment.session import ReadOnlyArrays
from . import gyro_moves

FLOOR_G = 5e-5  # standard error a mean is never better than: a chip's own flicker noise
FLOOR_RATE = 2e-5  # rad/s, likewise (0.001 deg/s)
MINIMUM_G = 0.5  # a rest reads between this and 2 g minus it, whatever its calibration
FACE_COSINE = 0.7  # of the angle between a rest and the axis its label names
LEAST_RAD = 1e-4  # of a move: what the integration itself may leave
RAD = np.pi / 180.0


@dataclass(frozen=True, eq=False)
class Flip:
    """Poses a and b of one face (0..5): indices of their rests, index of the move between or None.

    forward: +1 when a was taken first, -1 when b was.
    """

    face: int
    a: int
    b: int
    move: int | None
    forward: int

    @property
    def axis(self):
        """(3,): the face's axis, upwards."""
        axis = np.zeros(3)
        axis[AXIS[self.face]] = SIGN[self.face]
        return axis


@dataclass(frozen=True, eq=False)
class RestsAndMoves(ReadOnlyArrays):
    """The blocks of a session as k rests, and the moves that can be integrated; arrays read only.

    session: blocks.Session; force (k, 3) g and rate (k, 3) rad/s, means by the nominal scale;
    force_error, rate_error (k,): standard errors of those means; ends: (before, after) of every
    move kept; moves: GyroMoves of them; move_error (moves,) rad: expected disagreement of the two
    gravities of each, and of a flip's angle; left_out: sentences; flips; alone: rests on a face
    that was never flipped. rate, rate_error, moves, move_error: None without a gyro.
    """

    session: blocks.Session
    force: np.ndarray
    force_error: np.ndarray
    rate: np.ndarray | None
    rate_error: np.ndarray | None
    ends: tuple
    moves: gyro_moves.GyroMoves | None
    move_error: np.ndarray | None
    left_out: tuple
    flips: tuple
    alone: tuple

    @property
    def g(self):
        return self.session.capture.g

    @property
    def codes(self):
        return [run.code for run in self.session.runs]

    @property
    def names(self):
        return [pose_name(code) for code in self.codes]

    @property
    def has_gyro(self):
        return self.session.gyro is not None

    def on_faces(self):
        return bool(self.flips or self.alone)


def from_session(session, far_pairs=True):
    """RestsAndMoves of a blocks.Session; BadFile or CheckFailed where nothing can be refined from
    it. far_pairs: believe that a and b of a face belong to one table though the box was elsewhere
    in between; for labels, not for poses found."""
    if not session.runs:
        raise BadFile("the capture has no rests, expected labelled poses or still stretches")
    force = session.rest_means(session.accel) * 1e-3
    _refuse_contradictions(session, force)
    force_error = _error(session, session.noise_accel * 1e-3, FLOOR_G)
    rate = rate_error = kept = move_error = None
    ends, left_out = (), ()
    if session.gyro is not None:
        rate = session.rest_means(session.gyro) * RAD
        rate_error = _error(session, session.noise_gyro * RAD, FLOOR_RATE)
        usable, left_out = _usable(session)
        ends = tuple((move.place, move.place + 1) for move in usable)
        kept = gyro_moves.from_session(session, usable)
        move_error = _move_error(session, kept, force_error, ends)
    flips, alone = _paired(session, ends, far_pairs)
    _refuse_unusable(session, ends, left_out, flips)
    return RestsAndMoves(session, force, force_error, rate, rate_error, ends, kept, move_error,
                         left_out, flips, alone)


def _error(session, noise, floor):
    """(k,): standard error of a component of the rests' means; noise (3,) of one second's."""
    seconds = np.bincount(session.placement, session.seconds, session.placements())
    return np.sqrt(np.mean(noise ** 2) / seconds + floor ** 2)


def _usable(session):
    """(tuple of blocks.Move that can be integrated, tuple of sentences on the others)."""
    usual = float(np.median(np.diff(session.t_s)))
    usable, left_out = [], []
    for move in blocks.moves_of(session):
        name = "%s to %s" % tuple(pose_name(run.code)
                                  for run in session.runs[move.place:move.place + 2])
        if move.railed:
            left_out.append("move %s: the gyro is saturated" % name)
        elif session.timeless or usual <= 0.0:
            left_out.append("move %s: the timestamps stand still" % name)
        elif move.longest_s - usual > GAP_US * 1e-6:
            left_out.append("move %s: the timestamps jump by %.3f s" % (name, move.longest_s))
        else:
            usable.append(move)
    return tuple(usable), tuple(left_out)


def _move_error(session, kept, force_error, ends):
    """(moves,) rad: the gyro's white noise summed over each move, gravity's error at both ends."""
    walk = np.sqrt(np.mean(session.noise_gyro ** 2) * kept.seconds) * RAD
    before, after = np.array(ends, dtype=int).reshape(-1, 2).T
    return np.sqrt(walk ** 2 + force_error[before] ** 2 + force_error[after] ** 2
                   + LEAST_RAD ** 2)


def _paired(session, ends, far_pairs):
    """(tuple of Flip, tuple of the rests on faces that were never flipped)."""
    codes = [run.code for run in session.runs]
    flips, alone = [], []
    for face in range(6):
        own = [k for k, code in enumerate(codes) if face_of_code(code) == face]
        made = []
        for k in own:
            if k + 1 in own and is_b(codes[k]) != is_b(codes[k + 1]):
                move = ends.index((k, k + 1)) if (k, k + 1) in ends else None
                a_first = not is_b(codes[k])
                a, b = (k, k + 1) if a_first else (k + 1, k)
                made.append(Flip(face, a, b, move, 1 if a_first else -1))
        if not made:
            a = [k for k in own if not is_b(codes[k])]
            b = [k for k in own if is_b(codes[k])]
            if a and b and far_pairs:
                made.append(Flip(face, a[0], b[0], None, 1))
            else:
                alone += own
        flips += made
    return tuple(flips), tuple(alone)


def _refuse_contradictions(session, force):
    """CheckFailed for rests that gravity cannot explain, by name, and a gyro that never moved."""
    for run, mean in zip(session.runs, force):
        name, face = pose_name(run.code), face_of_code(run.code)
        length = float(np.linalg.norm(mean))
        if not MINIMUM_G < length < 2.0 - MINIMUM_G:
            raise CheckFailed("rest %s reads %.2f g, expected about 1 g" % (name, length))
        if face >= 0 and SIGN[face] * mean[AXIS[face]] < FACE_COSINE * length:
            raise CheckFailed("rest %s is labelled %s, but gravity there is %s g" % (
                name, name[:2], " ".join("%+.2f" % f for f in mean)))
    gyro = session.capture.gyro
    if gyro is not None and not np.ptp(gyro, axis=0).all():
        raise CheckFailed("gyro %s reads the same in every sample, expected a live gyro"
                          % "xyz"[int(np.argmin(np.ptp(gyro, axis=0)))])


def _refuse_unusable(session, ends, left_out, flips):
    """CheckFailed where the gyro saw no move, or no flip of those that there are."""
    meta = session.capture.meta
    if session.gyro is not None and len(session.runs) > 1 and not ends:
        if all("saturated" in line for line in left_out):
            raise CheckFailed(
                "the gyro is saturated in every move, expected turns slower than %g deg/s"
                % meta.get("gyro_range_dps", RAIL / meta["gyro_lsb_per_dps"]))
        raise CheckFailed("no move can be integrated (%s), expected even timestamps and rates "
                          "below full scale" % left_out[0])
    lost = [line for line in left_out if "saturated" in line]
    if flips and lost and all(flip.move is None for flip in flips):
        raise CheckFailed("the gyro is saturated in every flip (%s), expected flips slower than "
                          "full scale" % lost[0])
