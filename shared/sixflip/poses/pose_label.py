"""Which pose a rest of the box is: the face from gravity, a or b from the gyro.

A session without a plan takes the faces in any order and names what it finds. A planned session
knows which pose comes next, and gravity and gyro only check that it is the one. A rest that is
no pose is refused with a reason, the measured value and its limit.
"""

from sixflip.poses.faces import LEANING, face_of_code
from sixflip.poses.placement import has_gap, turned

CROOKED_DEG = 15.0  # live limit: a raw bias of 112 mg alone tilts gravity by 6.4 degrees
LEANING_DEG = 30.0  # from here on it rests on no face at all
HALF_TURN_DEG = 140.0  # 180 less 40: from here on a flip
SAME_DEG = 40.0  # up to here the box was put back as it was


def turned_deg(move, bias, lsb_per_dps, axis):
    """Degrees in 0..180 the box turned about an axis of its own, whole turns left out.

    0 where a gap in the samples hides so much that it is neither a flip nor none: a pose is
    taken again then, instead of a flip refused that was one.
    """
    if move.n == 0:
        return 0.0
    counts = turned(move, axis) - bias[axis] * (move.duration_us / 1e6)
    angle = abs(counts / lsb_per_dps) % 360
    angle = min(angle, 360 - angle)
    if SAME_DEG < angle < HALF_TURN_DEG and has_gap(move):
        return 0.0
    return angle


class PoseLabel:
    """code of the pose (0: refused), and reason, value, limit, unit of a refusal.

    last: code of the placement this rest follows on the same face, or 0; done: codes already
    there; turned: degrees since, 180 where there is no gyro; saturated: the gyro was.
    """

    def __init__(self, face, off_deg, last, done, turned, saturated):
        self.code = 0
        self.reason = ""
        if self.off_face(off_deg):
            return
        a = 1 + 2 * face
        code = a if a not in done else a + 1
        if last and turned <= SAME_DEG and not saturated:
            self.code = last
        elif last and self.no_flip(turned, saturated):
            return
        elif code in done:
            self.refuse("already done", 2, 2, "placements")
        else:
            self.code = code

    def refuse(self, reason, value, limit, unit):
        """Sets why the rest is no pose."""
        self.reason = reason
        self.value = value
        self.limit = limit
        self.unit = unit

    def off_face(self, off_deg):
        """Refuses a box that does not lie flat on a face; whether it did."""
        if off_deg > CROOKED_DEG:
            reason = "crooked" if off_deg <= LEANING_DEG else "leaning"
            self.refuse(reason, off_deg, CROOKED_DEG, "deg")
        return off_deg > CROOKED_DEG

    def no_flip(self, turned, saturated):
        """Refuse an angle that should have been a half turn; False where it was one."""
        if turned < HALF_TURN_DEG:
            reason = "saturated" if saturated else "not a flip"
            self.refuse(reason, turned, HALF_TURN_DEG, "deg")
        return turned < HALF_TURN_DEG


class PlannedLabel(PoseLabel):
    """Like PoseLabel; `want` is the next code of the plan (a leaning pose, a repeat).

    last: code of the placement this rest follows on the same face, 0 where a turn cannot be
    judged (another face in between, no gyro).
    """

    def __init__(self, want, face, off_deg, last, turned, saturated):
        self.code = 0
        self.reason = ""
        if want > LEANING:
            if off_deg <= CROOKED_DEG:
                self.refuse("not leaning", off_deg, CROOKED_DEG, "deg")
        elif self.off_face(off_deg):
            return
        elif face != face_of_code(want):
            self.refuse("wrong face", face, face_of_code(want), "face")
        elif last and last != want:
            self.no_flip(turned, saturated)
        elif last and (turned > SAME_DEG or saturated):
            self.refuse("turned", turned, SAME_DEG, "deg")
        if not self.reason:
            self.code = want
