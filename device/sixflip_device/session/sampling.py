"""A guided session, its raw capture streamed to flash.

No correction is active while samples are taken: raw means raw.
"""

from sixflip.poses.session import Session

from ..capture.files import refuse_first
from ..capture.meta import columns, expected_bytes, meta_bytes, session_number
from ..capture.store import CaptureStore
from ..flash_files import FLAG, remove
from .guided_session import GuidedSession, names
from .session_values import SessionResult

HANDLING_S = 6  # of a pose, at most: for the size of a capture


def new_store(firmware, request):
    """(number of the session, its CaptureStore) of a SessionRequest."""
    board = firmware.board
    mask = columns(firmware.sensor.imu)
    if request.before is not None:
        from ..capture.session_stores import ContinuedStore
        number = request.before.session
        return number, ContinuedStore(board.root, meta_bytes(firmware, number, request.unasked),
                                      mask, request.before)
    rate_hz = firmware.settings["rate_hz"]
    if request.plan:
        poses, samples = len(request.plan), sum(request.lengths)
    else:
        poses, samples = 12, 12 * firmware.settings["pose_samples"]
    samples += (HANDLING_S * poses + 2 * request.hold_s) * rate_hz
    number = session_number(board)
    where = board.root, meta_bytes(firmware, number, request.unasked), mask
    if not request.record:
        return number, CaptureStore(*where, expected_bytes(samples, mask))
    from ..capture.session_stores import RecordedStore
    return number, RecordedStore(board, *where, expected_bytes(samples, mask))


def new_session(firmware, request):
    """The sixflip.poses Session of a SessionRequest, that of the session before taken over."""
    imu = firmware.sensor.imu
    settings = firmware.settings
    chip = (imu.accel_lsb_per_g, imu.gyro_lsb_per_dps, imu.accel_rail, imu.gyro_rail,
            settings["rate_hz"])
    if request.plan:
        from sixflip.poses.planned_session import PlannedSession  # most sessions have no plan
        return PlannedSession(chip, request.plan, request.lengths, request.hold_s,
                              settings["timeout_s"])
    session = Session(*chip, pose_samples=settings["pose_samples"],
                      timeout_s=settings["timeout_s"])
    if request.before is not None:
        from sixflip.poses.planned_session import continue_from
        before = request.before
        continue_from(session, before.placements, before.samples, before.moves)
    return session


def run(firmware, request):
    """The SessionResult of a SessionRequest."""
    remove(firmware.board.root + FLAG)
    number, store = new_store(firmware, request)
    session = new_session(firmware, request)
    firmware.correction = None
    firmware.events.emit("calibrating", missing=names(session.missing()),
                         plan=session.wanted is not None, session=number,
                         sums_only=store.sums_only, reason=store.reason, recorded=store.recorded)
    guided = GuidedSession(firmware, store, session)
    how = "interrupted"
    try:
        how = guided.run()
    finally:
        # after Ctrl-C too: what was captured stays readable
        has_capture = store.finish(how == "complete", session.placements)
        if how == "interrupted" and has_capture:
            refuse_first(firmware.board.root)
    firmware.events.emit("capture", samples=store.samples, kept=store.kept,
                         sums_only=store.sums_only, bytes=store.bytes, reason=store.reason)
    return SessionResult(number, how, guided.ended, session.placements, session.moves,
                         names(session.missing()), has_capture)
