"""A session under way: samples are paced and kept, events and the lamp tell, the host is obeyed.

Between the ends of two windows nothing is allocated: no event, no host line, no float.
"""

from array import array

from sixflip.poses import session as machine
from sixflip.poses.faces import FACES, pose_name

from .. import led
from ..sensor import BusLost, pacer


def names(codes):
    """Names of pose codes."""
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
        """A Placement was accepted."""
        self._lamp.flash(led.ACCEPTED)
        n = placement.n
        self._events.emit("pose", pose=pose_name(placement.pose), n=n,
                          mean=[s / n for s in placement.sums], noise=placement.noise,
                          **self._todo())

    def refused(self):
        """A rest was refused; the session says why."""
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


class GuidedSession:
    """Feeds a session of sixflip.poses with samples and a CaptureStore with the same.

    run() -> "complete", "timed out", "stopped", "changed" (somebody wrote to the chip's offset
    registers) or "bus lost"; session has the placements and moves, ended is a sentence, "" when
    complete.
    """

    def __init__(self, firmware, store, session):
        self._firmware = firmware
        self._store = store
        self.session = session
        self._teller = Teller(firmware.board, session, firmware.settings["rate_hz"],
                              firmware.events)
        self.ended = ""

    def run(self):
        """How the session ended, see above."""
        sensor = self._firmware.sensor
        self._teller.state()
        try:
            sensor.check()  # whatever was changed before is set up anew
            sensor.shifted = ""
            ended = self._sample_until_done()
            if ended == "complete":
                sensor.check()
            if not sensor.shifted:
                return ended
            self.ended = sensor.shifted + ": what was captured since is not to be trusted"
            return "changed"
        except BusLost as e:
            self.ended = str(e)
            return "bus lost"
        finally:
            self._firmware.board.led(False)

    def _sample_until_done(self):
        firmware = self._firmware
        sample = array("h", [0] * 7)
        next_sample = pacer(firmware.board, firmware.sensor, firmware.settings["rate_hz"]).next
        feed = self.session.feed
        keep = self._store.add
        step = self._teller.step
        while True:
            dt = next_sample(sample)
            if dt < 0:
                if firmware.sensor.shifted:
                    return "changed"
                # the attempt is thrown away, everything accepted stays
                self.session.interrupt()
                self._store.note("bus recovered or chip configured again")
                continue
            event = feed(dt, sample)
            keep(dt, sample)
            step()
            if event:
                ended = self._window_ended(event)
                if ended:
                    return ended

    def _window_ended(self, event):
        session = self.session
        for code in session.withdrawn:
            self._store.withdraw(code)
        taken = event == machine.POSE or event == machine.COMPLETE
        if taken:
            self._store.pose(session.placements[-1])
        try:
            if taken:
                self._teller.pose(session.placements[-1])
            elif event == machine.REFUSED:
                self._teller.refused()
            self._teller.state()
        except MemoryError:
            pass  # a line less is told; of the session nothing is lost
        if event == machine.TIMED_OUT:
            self.ended = "timed out: no new pose for %d s (%s); still missing: %s%s" % (
                session.timeout_s, session.obstacle, " ".join(names(session.missing())),
                "" if session.gyro_lsb_per_dps
                else "; without a gyro a flip shows only when the box is lifted")
            return "timed out"
        if session.state == "done":
            return "complete"
        return self._listen()

    def _listen(self):
        """One line of the host; "stopped" when it ends the session."""
        command = self._firmware.host.poll()
        if command is None:
            return ""
        if command["cmd"] == "stop":
            self.ended = "stopped by the host"
            return "stopped"
        try:
            from ..commands import obey_in_session  # most sessions hear none
            obey_in_session(command, self._firmware, self.session, self._store, self._teller)
        except MemoryError:
            self._firmware.events.error("no memory for this now", "fewer placements taken")
        return ""
