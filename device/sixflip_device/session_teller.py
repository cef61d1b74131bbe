"""What a guided session says, to the host in events and to people with the lamp."""

from sixflip.faces import FACES, pose_name

from . import led

REPEAT_US = 500000  # a state that does not change is told again so often


def names(codes):
    return [pose_name(code) for code in codes]


class Teller:
    """Turns the state of a session.Session into events; step() once a sample for the lamp."""

    def __init__(self, board, session, rate_hz, events):
        self._board = board
        self._session = session
        self._rate_hz = rate_hz
        self._events = events
        self._lamp = led.Lamp(board, rate_hz)
        self._lamp.show(led.MEASURING)
        self._told = None
        self._told_at = board.ticks_us()
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

    def error(self, what, expected):
        self._events.error(what, expected)

    def _pose(self):
        session = self._session
        if session.candidate:
            return pose_name(session.candidate)
        return FACES[session.face] if session.face >= 0 else ""

    def state(self):
        """At once when it changed, else a few times a second at most."""
        session = self._session
        board = self._board
        self._lamp.show(led.STATES.get(session.state, led.WAITING))
        key = (session.state, session.candidate, session.face, session.reason)
        now = board.ticks_us()
        if key == self._told and board.ticks_diff(now, self._told_at) < REPEAT_US:
            return
        self._told = key
        self._told_at = now
        left = session.left_s
        if session.state == "capturing":
            left = (session.pose_samples - session.progress) / self._rate_hz
        self._events.emit("state", state=session.state, pose=self._pose(), reason=session.reason,
                          value=session.value, limit=session.limit, unit=session.unit,
                          progress=session.progress, total=session.pose_samples, left_s=left,
                          **self._todo())
