"""Six faces, each with a flip: paces the samples, keeps them, obeys the host.

Between the ends of two windows nothing is allocated: no event, no host line, no float.
"""

from array import array

from sixflip.poses import session as machine

from ..sensor import BusLost, pacer
from .teller import Teller, names


class GuidedSession:
    """run() -> "complete", "timed out", "stopped", "changed" or "bus lost"; the results are in

    .session (placements, moves) and .ended (a sentence, "" when complete).
    """

    def __init__(self, unit, store):
        settings = unit.settings
        imu = unit.sensor.imu
        rate_hz = settings["rate_hz"]
        self._unit = unit
        self._store = store
        chip = (imu.accel_lsb_per_g, imu.gyro_lsb_per_dps, imu.accel_rail, imu.gyro_rail, rate_hz)
        if unit.taken is None:
            self.session = machine.Session(*chip, pose_samples=settings["pose_samples"],
                                           timeout_s=settings["timeout_s"])
        else:
            from .asked_session import session
            self.session = session(unit, chip)
        self._teller = Teller(unit.board, self.session, rate_hz, unit.events)
        self.ended = ""

    def run(self):
        sensor = self._unit.sensor
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
            self._unit.board.led(False)

    def _sample_until_done(self):
        unit = self._unit
        sample = array("h", [0] * 7)
        next_sample = pacer(unit.board, unit.sensor, unit.settings["rate_hz"]).next
        feed = self.session.feed
        keep = self._store.add
        step = self._teller.step
        while True:
            dt = next_sample(sample)
            if dt < 0:
                if unit.sensor.shifted:
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
        command = self._unit.host.poll()
        if command is None:
            return ""
        if command["cmd"] == "stop":
            self.ended = "stopped by the host"
            return "stopped"
        try:
            from .session_commands import obey  # most sessions hear none
            obey(command, self._unit, self.session, self._store, self._teller)
        except MemoryError:
            self._unit.events.error("no memory for this now", "fewer placements taken")
        return ""
