"""Second phase: a guided session, its raw capture streamed to flash.

The old correction is out of force while samples are taken (power_up.py): raw means raw.
"""

import sixflip.poses.session  # noqa: F401 - the longest source first, while there is room

from ..capture.store import CaptureStore
from ..flash_files import FLAG, remove
from ..power_up import free
from .guided_session import GuidedSession
from .teller import names


class Taken:
    """What is left of sampling.

    session     the number that names it in capture and record
    how, ended  "complete", "timed out", "stopped" or "bus lost", and a sentence
    placements, moves, missing (names)
    kept        the capture's file is whole
    """


def new_store(unit, number, samples):
    """The CaptureStore of a session that begins, of so many samples or fewer."""
    from ..capture.meta import columns, expected_bytes, meta_bytes
    mask = columns(unit.sensor.imu)
    what = unit.board.root, meta_bytes(unit, number), mask, expected_bytes(samples, mask)
    recording, unit.recording = unit.recording, False
    if not recording:
        return CaptureStore(*what)
    from ..capture.recorded_store import RecordedStore
    return RecordedStore(unit.board, *what)


def _store(unit, number):
    # twelve poses with six seconds of handling each
    return new_store(unit, number,
                     12 * (unit.settings["pose_samples"] + 6 * unit.settings["rate_hz"]))


def run(unit):
    remove(unit.board.root + FLAG)
    taken = Taken()
    if unit.taken is None:
        from ..capture.meta import session_number
        taken.session = session_number(unit.board)
        store = _store(unit, taken.session)
    else:
        from .asked_session import store_of
        store = store_of(unit, taken)
    unit.asked = False
    free(("sixflip_device.capture.meta", "sixflip.chips.header"))
    guided = GuidedSession(unit, store)
    unit.taken = None
    unit.events.emit("calibrating", missing=names(guided.session.missing()),
                     plan=guided.session.wanted is not None,
                     session=taken.session, sums_only=store.sums_only, reason=store.reason,
                     recorded=store.recorded)
    taken.how = "interrupted"
    try:
        taken.how = guided.run()
    finally:
        # after Ctrl-C too: what was captured stays readable
        taken.kept = store.finish(taken.how == "complete", guided.session.placements)
        if taken.how == "interrupted" and taken.kept:
            from ..capture.files import refuse_first
            refuse_first(unit.board.root)
    taken.ended = guided.ended
    taken.placements = guided.session.placements
    taken.moves = guided.session.moves
    taken.missing = names(guided.session.missing())
    unit.events.emit("capture", samples=store.samples, kept=store.kept,
                     sums_only=store.sums_only, bytes=store.bytes, reason=store.reason)
    unit.taken = taken
    return "checking" if taken.how == "complete" else "saving"
