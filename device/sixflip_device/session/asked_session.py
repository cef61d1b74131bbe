"""What sampling does otherwise when a plan, or a face of the session before, was asked for."""

from sixflip.capture.writer import BlockWriter

from ..capture.meta import columns, meta_bytes, session_number
from ..capture.store import CaptureStore
from ..flash_files import NEW
from .sampling import new_store


class ContinuedStore(CaptureStore):
    """Goes on with the file that redo_session.py has begun; asked is what it found."""

    def __init__(self, root, meta, mask, asked):
        self._asked = asked
        CaptureStore.__init__(self, root, meta, mask)

    def _open(self, meta):
        asked, self._asked = self._asked, None
        if asked is None:  # once more, without samples
            return CaptureStore._open(self, meta)
        from sixflip.capture.scan import go_on
        if asked.sums_only:
            self._short(asked.reason)
        self.bytes, self.kept = asked.bytes, asked.kept
        try:
            self._file = open(self._root + NEW, "ab")  # noqa: SIM115 - open for a session
        except OSError as e:
            self._fail(e)
        self._writer = BlockWriter(self._write, None, self._columns, sums_only=self.sums_only)
        go_on(self._writer, asked.samples, asked.seconds, asked.us)
        return None


def store_of(unit, taken):
    """The CaptureStore; taken.session becomes a number of its own, or that of the file that
    goes on."""
    asked = unit.taken
    if asked.before:
        taken.session = asked.session
        return ContinuedStore(unit.board.root, meta_bytes(unit, taken.session),
                              columns(unit.sensor.imu), asked)
    taken.session = session_number(unit.board)
    rate_hz = unit.settings["rate_hz"]
    # six seconds of handling a pose
    samples = sum(asked.lengths) + (6 * len(asked.lengths) + 2 * asked.hold_s) * rate_hz
    return new_store(unit, taken.session, samples)


def session(unit, chip):
    """The session.Session; chip: what it wants to know of the sensor."""
    asked = unit.taken
    settings = unit.settings
    if asked.wanted:
        from sixflip.poses.planned_session import PlannedSession
        return PlannedSession(chip, asked.wanted, asked.lengths, asked.hold_s,
                              settings["timeout_s"])
    from sixflip.poses.planned_session import resume
    from sixflip.poses.session import Session
    made = Session(*chip, pose_samples=settings["pose_samples"], timeout_s=settings["timeout_s"])
    resume(made, asked.placements, asked.samples, asked.moves)
    return made
