"""Sessions other than the six faces in any order: one that follows a plan, with a length for every
pose and a rest at both ends, and one that goes on with the placements of the session before.
"""

from sixflip.poses.faces import face_of_code
from sixflip.poses.placement_log import empty_move
from sixflip.poses.session import COMPLETE, POSE, WINDOW, Session

PAUSE_US = 60000000  # between the two sessions; its true length is unknown


def continue_from(session, placements, samples, moves=None):
    """Take over the placements and moves of an earlier session of so many samples.

    moves   to each of them and the one under way at its end (capture/scan.py); None: nothing
            is known of them
    """
    log = session._log
    for i, placement in enumerate(placements):
        log.open = moves[i] if moves else empty_move(placement.first)
        log.follow(False)  # the path is in the move, if it is known
        log.accept(placement)
    log.follow(False)
    log.open = moves[-1] if moves else empty_move(samples)
    log.open.largest_gap_us = PAUSE_US
    session.samples = samples
    session._away = True


class PlannedSession(Session):
    """args: those of Session up to the rate.

    wanted   codes in the order planned, repeats and leaning poses too
    lengths  samples of each of them
    hold_s   so long the box is to rest before the first pose and after the last: "resting"
    """

    def __init__(self, args, wanted, lengths, hold_s, timeout_s):
        Session.__init__(self, *args, pose_samples=min(lengths), wanted=wanted,
                         timeout_s=timeout_s)
        self._lengths = lengths
        self._hold_s = self._since = hold_s
        self._until = 0  # the end of the last rest

    def place(self):
        """Where in the plan the next pose stands; its length when there is none."""
        have = [p.pose for p in self.placements]
        for i in range(len(self.wanted)):
            if self.wanted[i] not in have:
                return i
            have.remove(self.wanted[i])
        return len(self.wanted)

    def undo(self):
        """Drop and answer the last placement alone: its pose may be there from before."""
        last = self.placements[-1]
        code = last.pose
        self._log.drop_at(len(self.placements) - 1)
        self._away = True
        if face_of_code(code) == self._rest_face:
            self._rested = False
        self._since = max(self._since, self._seconds)
        self._give_up_pose()
        if self._noise.known:
            self.state = "moving"
        return last

    def _accept(self, pose):
        event = Session._accept(self, pose)
        if event != COMPLETE or not self._hold_s:
            return event
        self._until = self._since = self._seconds + self._hold_s + 1
        self.state = "resting"
        return POSE

    def _wait(self):
        left = self._hold_s - self._seconds
        if self._until and self.place() == len(self.wanted):
            left = self._until - self._seconds
            self.state = "done" if left <= 0 else "resting"
            self.left_s = max(left, 1)
            return WINDOW
        if left > 0:
            self._settled = 0
        event = Session._wait(self)
        if left > 0 and self.state == "settling":
            self.state = "resting"
            self.left_s = left
        return event

    def _begin(self):
        self.windows = -(-self._lengths[self.place()] // self._window.length)
        self.pose_samples = self.windows * self._window.length
        return Session._begin(self)
