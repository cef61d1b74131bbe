"""A tray of boards without boards: what the firmware says when a jig is laid, and the person who
lays it as the tray asks. The rules of a pose's name are those of sixflip.poses.pose_label."""

from sixflip import __version__
from sixflip_host.tray import leading, tray_events
from sixflip_host.tray.jig import AS_THE_JIG, jig_to_own, vector
from sixflip_host.tray.tray_value import tray

TWELVE = [face + letter for face in AS_THE_JIG for letter in "ab"]
LIE_S = 6.0


class ScriptedBoard:
    """misses: numbers of the jig's layings (from 0) that it does not take; never: faces of its own
    that it never takes; stuck_from, lost_at: the laying from which its readings are the same, or
    before which it is unplugged; says: its first events, in place of a session's."""

    def __init__(self, mounting=AS_THE_JIG, misses=(), stuck_from=99, lost_at=99,
                 firmware=__version__, missing=TWELVE, says=None,
                 gyro=True, never=()):
        self.mounting, self.misses = mounting, set(misses)
        self.stuck_from, self.lost_at = stuck_from, lost_at
        self.firmware, self.says, self.gyro = firmware, says, gyro
        self.missing = list(missing)
        self.last = self.jig = ""
        self.never = never
        self.rested = self.stopped = False

    def hello(self, port):
        if self.says is not None:
            return self.says
        return [{"event": "hello", "id": "id" + port, "chip": "MPU6050",
                 "firmware": self.firmware},
                {"event": "calibrating", "missing": list(self.missing)}]

    def lay(self, number, pose):
        """The events of a rest, the jig lying in a pose of its own."""
        own = jig_to_own(self.mounting)[pose[:2]]
        same = (own, pose) == (self.last[:2], self.jig)
        self.jig, self.rested = pose, False
        return self.rest(number, own, same)

    def rest(self, number, own, same=False):
        if not self.missing or self.stopped:
            return []
        state = {"event": "state", "state": "moving", "missing": list(self.missing),
                 "live": [1000 * v for v in vector(own)] + [0] * 3 * self.gyro, "reason": ""}
        if number >= self.stuck_from:
            return [dict(state, reason="stale")]
        if number in self.misses or own in self.never:
            self.misses.discard(number)
            return [dict(state, reason="noisy", value=9.0, limit=4.0, unit="x noise"),
                    {"event": "refused", "pose": own + "a", "reason": "noisy", "value": 9.0,
                     "limit": 4.0, "unit": "x noise"}]
        free = [own + letter for letter in "ab" if own + letter in self.missing]
        if same and self.last not in self.missing:
            free = [self.last]
        if not free:
            return [state, {"event": "refused", "pose": own, "reason": "already done"},
                    dict(state, pose=own, reason="already done")]
        self.last, self.rested = free[0], True
        self.missing = [pose for pose in self.missing if pose != self.last]
        found = [state, dict(state, state="capturing", pose=self.last, left_s=4),
                 {"event": "pose", "pose": self.last, "n": 400, "missing": list(self.missing)},
                 dict(state, missing=list(self.missing))]
        if not self.missing:
            found += [{"event": "capture", "samples": 5000},
                      {"event": "solved", "verdict": "good", "reason": "tilt 2.0 degrees"},
                      {"event": "saved", "slot": "a", "sequence": 1}]
        return found

    def obey(self, number, command):
        if command["cmd"] == "stop":
            self.stopped = True
        if command["cmd"] != "redo":
            return []
        face = command["face"]
        lies = self.jig and jig_to_own(self.mounting)[self.jig[:2]] == face
        self.missing += [face + c for c in "ab" if face + c not in self.missing]
        if self.last[:2] == face:
            self.last = ""
        told = [{"event": "redo", "face": face, "missing": list(self.missing)}]
        return told + (self.rest(number, face) if lies else [])


class Rig:
    """boards: {port: ScriptedBoard}. tray: what is known of them; laid: the jig's poses so far;
    told: every (port, command)."""

    def __init__(self, boards):
        self.boards, self.now = boards, 0.0
        self.tray = tray(dict.fromkeys(boards))
        self.laid, self.told = [], []
        for port in boards:
            self.hear(port, boards[port].hello(port))

    def hear(self, port, events):
        for event in events:
            self.take(tray_events.after(self.tray, port, event, self.now))

    def take(self, answer):
        self.tray, commands = answer
        self.told += commands
        for port, command in commands:
            self.hear(port, self.boards[port].obey(len(self.laid) - 1, command))

    def lay(self, pose):
        """The person lays the jig, and time goes by."""
        number = len(self.laid)
        self.laid.append(pose)
        for port, board in self.boards.items():
            if number == board.lost_at:
                self.take(tray_events.left(self.tray, port, port + ": the board went away",
                                           self.now))
            elif number < board.lost_at:
                self.hear(port, board.lay(number, pose))
        self.now += LIE_S
        self.take(leading.tick(self.tray, self.now))

    def asked(self):
        """The pose that the person is asked for; one that the jig lies in is only left alone."""
        face = self.tray.face
        again = self.laid and self.laid[-1][:2] == face and self.tray.letter == "b"
        flipped = {"a": "b", "b": "a"}
        return face + (flipped[self.laid[-1][2]] if again else self.tray.letter)

    def play(self, most=40):
        """Laid as asked until all is over."""
        while not self.tray.over:
            assert len(self.laid) < most, self.tray.log
            self.lay(self.asked())
        return self

    def member(self, port):
        return self.tray.member(port)
