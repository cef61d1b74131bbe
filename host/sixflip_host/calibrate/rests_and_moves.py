"""A capture as the refinement sees it: rests with their means, moves with their rotations."""

import numpy as np

from sixflip import RAIL
from sixflip.poses.faces import AXIS, LEANING, SIGN, face_of_code, is_b, pose_name
from sixflip.poses.placement import GAP_US

from ..errors import BadFile, CheckFailed
from .gyro_moves import GyroMoves

FLOOR_G = 5e-5  # standard error a mean is never better than: a chip's own flicker noise
FLOOR_RATE = 2e-5  # rad/s, likewise (0.001 deg/s)
MINIMUM_G = 0.5  # a rest reads between this and 2 g minus it, whatever its calibration
FACE_COSINE = 0.7  # of the angle between a rest and the axis its label names
RAD = np.pi / 180.0


class Flip:
    """Captures a and b of one face: indices of their rests, the move between or None.

    forward: +1 when a was taken first, -1 when b was.
    """

    def __init__(self, face, a, b, move, forward):
        self.face, self.a, self.b, self.move, self.forward = face, a, b, move, forward
        self.axis = np.zeros(3)
        self.axis[AXIS[face]] = SIGN[face]


class RestsAndMoves:
    """names [k]; codes (k,); force (k, 3) g and rate (k, 3) rad/s, means by the nominal scale;
    force_error, rate_error (k,): standard errors of those means; ends: (before, after) of
    every move kept; moves: GyroMoves; left_out: sentences; flips, alone (rests on a face that
    was never flipped); has_gyro.
    """

    def __init__(self, capture, runs, far_pairs=True):
        """runs: [(pose code, first, end)]. far_pairs: believe that a and b of a face belong to
        one table though the box was elsewhere in between; for labels, not for poses found."""
        if not runs:
            raise BadFile("the capture has no rests, expected labelled poses or still stretches")
        self.g = capture.g
        self.codes = [code for code, _, _ in runs]
        self.names = [pose_name(code) for code in self.codes]
        self.samples = [end - first for _, first, end in runs]
        force = capture.accel / float(capture.meta["accel_lsb_per_g"])
        self.force, self.force_error = _means(force, runs, FLOOR_G)
        self._refuse_contradictions(capture)
        self.has_gyro = capture.gyro is not None
        self.left_out = []
        self.ends, spans = [], []
        self.rate = self.rate_error = self.moves = None
        if self.has_gyro:
            rate = capture.gyro * (RAD / capture.meta["gyro_lsb_per_dps"])
            self.rate, self.rate_error = _means(rate, runs, FLOOR_RATE)
            spans = self._usable_moves(capture, runs)
            t = capture.t_us * 1e-6
            self.moves = GyroMoves(rate, force, t, spans)
            self.move_error = self._move_error(rate, runs, t)
        self.flips, self.alone = self._pair_flips(far_pairs)
        self._refuse_unusable(capture)

    def _usable_moves(self, capture, runs):
        """Spans of the moves that can be integrated; the others with the reason."""
        steps = np.diff(capture.t_us)
        usual = float(np.median(steps))
        rail = capture.meta.get("gyro_range_dps", np.inf) * capture.meta["gyro_lsb_per_dps"]
        rail = min(RAIL, rail) - 1
        spans = []
        for k in range(len(runs) - 1):
            first, last = runs[k][2] - 1, runs[k + 1][1]
            name = "%s to %s" % (self.names[k], self.names[k + 1])
            gap = float(steps[first:last].max())
            peak = np.abs(capture.gyro[first : last + 1].astype(np.int32)).max()
            if peak >= rail:
                self.left_out.append("move %s: the gyro is saturated" % name)
            elif usual <= 0:
                self.left_out.append("move %s: the timestamps stand still" % name)
            elif gap - usual > GAP_US:
                self.left_out.append(
                    "move %s: the timestamps jump by %.3f s" % (name, gap * 1e-6)
                )
            else:
                spans.append((first, last))
                self.ends.append((k, k + 1))
        return spans

    def _move_error(self, rate, runs, t):
        """Expected disagreement of the two gravities of each move, rad (and of a flip's angle)."""
        white = np.median([np.std(np.diff(rate[f:e], axis=0)) for _, f, e in runs]) / np.sqrt(2)
        walk = white * np.sqrt(np.median(np.diff(t)) * self.moves.seconds)
        ends = np.array(self.ends, dtype=int).reshape(-1, 2)
        gravity = np.hypot(self.force_error[ends[:, 0]], self.force_error[ends[:, 1]])
        return np.sqrt(walk**2 + gravity**2 + 1e-8)

    def _pair_flips(self, far_pairs):
        flips, alone = [], []
        for face in range(6):
            own = [k for k, code in enumerate(self.codes) if face_of_code(code) == face]
            made = []
            for k in own:
                if k + 1 in own and is_b(self.codes[k]) != is_b(self.codes[k + 1]):
                    move = self.ends.index((k, k + 1)) if (k, k + 1) in self.ends else None
                    a_first = not is_b(self.codes[k])
                    a, b = (k, k + 1) if a_first else (k + 1, k)
                    made.append(Flip(face, a, b, move, 1 if a_first else -1))
            if not made:
                a = [k for k in own if not is_b(self.codes[k])]
                b = [k for k in own if is_b(self.codes[k])]
                if a and b and far_pairs:
                    made.append(Flip(face, a[0], b[0], None, 1))
                else:
                    alone += own
            flips += made
        return flips, alone

    def _refuse_contradictions(self, capture):
        """Rests that gravity cannot explain, by name; a gyro that never moved."""
        for name, code, force in zip(self.names, self.codes, self.force):
            length = float(np.linalg.norm(force))
            if not MINIMUM_G < length < 2.0 - MINIMUM_G:
                raise CheckFailed("rest %s reads %.2f g, expected about 1 g" % (name, length))
            face = face_of_code(code)
            if face >= 0 and SIGN[face] * force[AXIS[face]] < FACE_COSINE * length:
                raise CheckFailed("rest %s is labelled %s, but gravity there is %s g" % (
                    name, name[:2], " ".join("%+.2f" % f for f in force)))
        if capture.gyro is not None and not np.ptp(capture.gyro, axis=0).all():
            raise CheckFailed("gyro %s reads the same in every sample, expected a live gyro"
                              % "xyz"[int(np.argmin(np.ptp(capture.gyro, axis=0)))])

    def _refuse_unusable(self, capture):
        if self.has_gyro and len(self.codes) > 1 and not self.ends:
            if all("saturated" in line for line in self.left_out):
                raise CheckFailed(
                    "the gyro is saturated in every move, expected turns slower than %g deg/s"
                    % capture.meta.get("gyro_range_dps", RAIL / capture.meta["gyro_lsb_per_dps"])
                )
            raise CheckFailed(
                "no move can be integrated (%s), expected even timestamps and rates below full "
                "scale" % self.left_out[0]
            )
        turned = [f for f in self.flips if f.move is not None]
        lost = [line for line in self.left_out if "saturated" in line]
        if self.has_gyro and self.flips and not turned and lost:
            raise CheckFailed(
                "the gyro is saturated in every flip (%s), expected flips slower than full scale"
                % lost[0]
            )

    def on_faces(self):
        return bool(self.flips or self.alone)

    def leaning(self):
        return [k for k, code in enumerate(self.codes) if code > LEANING]


def _means(values, runs, floor):
    """Means (k, 3) over the runs and the standard error (k,) of their components.

    White noise from differences of neighbours, so that a slow drift is not counted as noise.
    """
    means = np.array([values[f:e].mean(axis=0) for _, f, e in runs]).reshape(-1, 3)
    white = np.array(
        [np.sqrt(np.mean(np.diff(values[f:e], axis=0) ** 2) / 2) if e - f > 1 else np.nan
         for _, f, e in runs]
    )
    white = np.where(np.isnan(white), np.nanmedian(white) if len(white) else 0.0, white)
    n = np.array([e - f for _, f, e in runs])
    return means, np.sqrt(white**2 / np.maximum(n, 1) + floor**2)
