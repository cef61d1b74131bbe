"""What a guided session says, to the host in events and to people with the lamp."""

from sixflip.poses.faces import FACES, pose_name

from .. import led


def names(codes):
    return [pose_name(code) for code in codes]


class Teller:
    """Turns the state of a session.Session into events; step() once a sample for the lamp."""

    def __init__(self, board, session, rate_hz, events):
        self._session = session
        self._rate_hz = rate_hz
        self._events = events
        self._lamp = led.Lamp(board, rate_hz)
        self._lamp.show(led.MEASURING)
        self._told = None
        self._repeated = 0
        self.step = self._lamp.step

    def pose(self, placement):
        self._lamp.flash(led.TAKEN)
        n = placement.n
        self._events.emit("pose", pose=pose_name(placement.pose), n=n,
                          mean=[s / n for s in placement.sums], noise=placement.noise,
                          **self._todo())

    def refused(self):
        session = self._session
        self._lamp.flash(led.REFUSED)
        self._events.emit("refused", pose=self._pose(), reason=session.reason,
                          value=session.value, limit=session.limit, unit=session.unit)

    def redo(self, what):
        """A face, or a pose of a plan, is to be taken again."""
        self._events.emit("redo", face=what, **self._todo())
        self._told = None

    def _todo(self):
        """What is still to be done; of a plan, which may be long, what is next."""
        session = self._session
        if session.wanted is None:
            return {"missing": names(session.missing())}
        at = session.place()
        return {"next": names(session.wanted[at:at + 1]), "at": at, "of": len(session.wanted)}

    def _pose(self):
        session = self._session
        if session.candidate:
            return pose_name(session.candidate)
        return FACES[session.face] if session.face >= 0 else ""

    def state(self):
        """Once a window: what is missing when something changed and with every eighth, else
        the vector. Both make a line that a full heap has no room for in one piece."""
        session = self._session
        self._lamp.show(led.STATES.get(session.state, led.WAITING))
        key = (session.state, session.candidate, session.face, session.reason)
        if key != self._told:
            self._told = key
            self._repeated = 0
        more = {"live": session.live()} if self._repeated % 8 else self._todo()
        self._repeated += 1
        left = session.left_s
        if session.state == "capturing":
            left = (session.pose_samples - session.progress) / self._rate_hz
        self._events.emit("state", state=session.state, pose=self._pose(), reason=session.reason,
                          value=session.value, limit=session.limit, unit=session.unit,
                          progress=session.progress, total=session.pose_samples, left_s=left,
                          **more)
