"""A session with an operator who feeds it, and what came of it."""
from array import array

from synthetic_operator import Operator

from sixflip.poses import session as machine
from sixflip.poses.faces import pose_name
from sixflip.poses.session import Session


def make(**options):
    """A session and an operator who feeds it."""
    own = {}
    for key in ("wanted", "timeout_s", "pose_samples", "rate_hz"):
        if key in options:
            own[key] = options.pop(key)
    dps = options.get("dps", 65.5)
    lsb = options.get("lsb", 16384)
    rail = 32767 if lsb == 16384 else 4095
    session = Session(lsb, dps, rail, 32767, own.pop("rate_hz", 100), **own)
    return session, Operator(session.feed, **options)


def poses(session):
    return [pose_name(p.pose) for p in session.placements]


class Recorder:
    """Between operator and session: keeps reasons and states, and exact totals if asked to.

    Totals are kept at every window's end: placements and moves begin and end there.
    """

    WINDOW = 25  # samples, at 100 Hz

    def __init__(self, session, keep=False):
        self.session = session
        self.totals = [array("i", [0]) for _ in range(7)] if keep else []
        self.running = [0] * 7
        self.refusals = []
        self.states = []
        self.reasons = []

    def __call__(self, dt_us, sample):
        event = self.session.feed(dt_us, sample)
        if self.totals:
            for i in range(7):
                self.running[i] += sample[i]
            if self.session.samples % self.WINDOW == 0:
                for total, v in zip(self.totals, self.running):
                    total.append(v)
        if event == machine.REFUSED:
            s = self.session
            self.refusals.append((s.reason, s.value, s.limit, s.unit))
        if event:
            self.states.append(self.session.state)
            self.reasons.append(self.session.reason)
        return event

    def total(self, i, begin, end):
        """Sum of column i over samples begin to end; IndexError off the windows' ends."""
        if begin % self.WINDOW or end % self.WINDOW:
            raise IndexError("%d to %d are not ends of windows" % (begin, end))
        return self.totals[i][end // self.WINDOW] - self.totals[i][begin // self.WINDOW]
