"""A planned session: the plan names the pose, gravity and gyro check it."""

from sixflip.faces import LEANING, face_of_code
from sixflip.pose_label import CROOKED_DEG, SAME_DEG, PoseLabel


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
