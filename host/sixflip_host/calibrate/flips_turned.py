"""By how much every flip really turned, for the solve of the six faces (METHOD 1).

By the gyro, with a scale that does not come from these flips but from gravity at both ends of
the face-to-face moves (joint_refinement.py): there the flips are free in the first pass, and
in the second drawn to 180 degrees by no more than the hand was found to scatter, so that good
flips lose nothing.
"""

import numpy as np

from sixflip.gyro.flips import NO_FLIP
from sixflip.poses.faces import FACES

from ..errors import SixflipError

# The gyro's own error of half a turn: a scale good to 1.5 % only makes good flips worse.
NOT_DETERMINED_DEG = 2.7
OFF_DEG = 1.0


class FlipsTurned:
    """angles   {face 0..5: rad} for accelerometer.solve; {}: 180 degrees assumed
    measured  {face 0..5: (deg, sigma deg)} by the moves alone
    reason    why 180 degrees are assumed, or ""
    """

    def __init__(self, reason=""):
        self.angles, self.measured, self.reason = {}, {}, reason

    def off(self, face):
        """Whether this flip was no half turn, beyond doubt."""
        degrees, sigma = self.measured[face]
        return abs(degrees - 180.0) > max(OFF_DEG, 3.0 * sigma)

    def words(self):
        """Sentences for a person."""
        if not self.measured:
            return ["flips: 180 degrees assumed: " + self.reason]
        off = ["flip of %s was %.1f degrees: %s" % (
            FACES[face], degrees, "compensated" if face in self.angles else
            "too far off half a turn to be used") for face, (degrees, _) in
            sorted(self.measured.items()) if self.off(face)]
        return off or ["flips: half turns, by the face-to-face moves"]


def by_moves(capture, far_pairs=True):
    """The FlipsTurned of a labelled capture.

    far_pairs  as rests_and_moves.from_session: for labels, not for poses found
    """
    if capture.sums_only:
        return FlipsTurned("no samples of the moves were kept")
    if capture.gyro is None:
        return FlipsTurned("the capture has no gyro columns")
    if capture.pose is None or not capture.pose.any():
        return FlipsTurned("no poses were found")
    from . import joint_refinement, refinement, refinement_answer
    try:
        session, _ = refinement.session_of(capture, far_pairs=far_pairs)
        turned = [flip for flip in session.flips if flip.move is not None]
        if not turned:
            return FlipsTurned("the gyro saw no flip")
        result = joint_refinement.refine(session)
        lost, _ = refinement_answer.left_open(session, result)
        verdict, why = refinement_answer.verdict(session, result, lost)
    except (SixflipError, ValueError, IndexError, np.linalg.LinAlgError) as error:
        return FlipsTurned("the moves tell nothing (%s)" % error)
    if verdict == "refused":
        return FlipsTurned("the moves tell nothing (%s)" % why)
    return _weighed(session, result)


def _weighed(session, result):
    measured, sigma = np.degrees(result.first.excess())
    excess, _ = result.excess()
    seen = [k for k, flip in enumerate(session.flips) if flip.move is not None]
    if not np.all(sigma[seen] < NOT_DETERMINED_DEG):
        return FlipsTurned("the face-to-face moves do not determine the gyro's scale "
                           "(an angle would be good to %.1f degrees only)" % sigma[seen].max())
    flips = FlipsTurned()
    for face in sorted({session.flips[k].face for k in seen}):
        mine = [k for k in seen if session.flips[k].face == face]
        flips.measured[face] = (180.0 + float(measured[mine].mean()), float(sigma[mine].max()))
        # more captures of a face than two stand at headings which no single angle tells
        if len(mine) == 1 and abs(excess[mine[0]]) < NO_FLIP:
            flips.angles[face] = np.pi + float(excess[mine[0]])
    return flips
