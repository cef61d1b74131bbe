"""The session before goes on, or one face of it is taken again: what there is is taken over.

Its capture is copied block by block into the new one, without the samples that led to what is
taken again: so a face can be redone any number of times, and the capture does not grow. How
long ago the session was nobody knows: the time goes on after GAP_S, a note says so, and no move
across it is used. Both placements of a face are taken again, so that it has a tilt of its own if
the table was moved meanwhile; but the sensor must be as warm as it was, for a bias that drifts
is not the table's.
"""

import json
from array import array

from sixflip.capture import blocks as cb
from sixflip.capture.scan import CaptureMoves, Scan, first_of, samples_in
from sixflip.capture.writer import BlockWriter
from sixflip.poses.faces import FACES, face_of_code

from ..capture.meta import columns, expected_bytes, meta_bytes, session_number
from ..flash_files import GOOD, NEW, REFUSED, UNSAVED, free_bytes, remove
from ..sensor import READ
from .session_values import SessionBefore, SessionRequest

GAP_S = 60
WARMER_C = 3.0  # 2.7 mg at the 0.9 mg/degC typical of an MPU6050's Z axis
RESERVE = 32768  # bytes that stay free beside the copy
SLACK = 32  # samples: blocks are copied whole
SAME = ("sensor", "who_am_i", "accel_lsb_per_g", "gyro_lsb_per_dps", "rate_hz")


def _last(root):
    """The newest session's file and its Scan, gone through; ValueError."""
    for name in (REFUSED, UNSAVED, GOOD):
        try:
            with open(root + name, "rb") as f:
                scan = Scan(f)
                for _ in scan.each():
                    pass
        except OSError:
            continue
        if not scan.blocks.placements:
            raise ValueError("the session before has no accepted pose")
        return name, scan
    raise ValueError("there is no session before this one")


def _fits(firmware, scan, number):
    """ValueError when the session was another sensor's, or a colder one's."""
    old = json.loads(str(scan.blocks.meta_bytes, "utf-8"))
    new = json.loads(str(meta_bytes(firmware, number), "utf-8"))
    for key in SAME:
        if old.get(key) != new.get(key):
            raise ValueError("%s was %s in the session before and is %s"
                             % (key, old.get(key), new.get(key)))
    imu = firmware.sensor.imu
    if scan.blocks.columns != columns(imu):
        raise ValueError("the session before has other columns")
    sample = array("h", [0] * 7)
    if imu.has_temp and firmware.sensor.read_into(sample) == READ:
        n = sum([p.n for p in scan.blocks.placements])
        mean = sum([p.sums[6] for p in scan.blocks.placements]) / n
        warmer = (sample[6] - mean) / imu.temp_lsb_per_c
        if abs(warmer) > WARMER_C:
            raise ValueError("the sensor is %.1f degC %s than in the session before, %.0f is "
                             "the limit" % (abs(warmer), "warmer" if warmer > 0 else "colder",
                                            WARMER_C))


def _that_stay(placements, face):
    """The placements without those of a face that is redone (-1: of faces that are half done);
    ValueError when there is nothing to go on with."""
    if face >= 0:
        return [p for p in placements if face_of_code(p.pose) != face]
    if [p for p in placements if p.pose > 12]:
        raise ValueError("the session before followed a plan")
    if len(placements) == 12:
        raise ValueError("nothing is missing in the session before")
    faces = [face_of_code(p.pose) for p in placements]
    # a face alone of its pair is taken again: the table may have been moved since
    stay = [p for p in placements if faces.count(face_of_code(p.pose)) == 2]
    if not stay:
        raise ValueError("no face is done in the session before")
    return stay


def _stretches(placements, stay):
    """[begin, end) of the samples to copy: of those that stay, and of the moves between two."""
    stretches = []
    begin = 0  # of a move from one that stays, or from the session's start
    for p in placements:
        end = p.first + p.n
        if p in stay:
            stretches.append((p.first if begin is None else begin, end))
        begin = end if p in stay else None
    return stretches


def _no_room(root, name, bytes):
    """Why there is no room for a copy of so many bytes, "" when there is."""
    free = free_bytes(root)
    if free is not None and free < bytes + RESERVE and name == REFUSED:
        remove(root + UNSAVED)  # older than what goes on, and of no record
        free = free_bytes(root)
    if free is None or free >= bytes + RESERVE:
        return ""
    return "%d bytes are free, a copy of the session before takes %d" % (free, bytes)


def _copy(firmware, name, meta, stay, face, stretches, room):
    """The samples of the stretches (none without room), the placements that stay and the notes in
    a new file: (moves, samples dropped, samples copied, bytes). The placements that stay find
    their samples there from now on."""
    firsts = [p.first for p in stay]  # in the old file
    at = dropped = 0
    with open(firmware.board.root + NEW, "wb") as f, open(firmware.board.root + name, "rb") as g:
        scan = Scan(g)
        moves = CaptureMoves(stay, scan.blocks.columns,
                             int(1000000 / firmware.settings["rate_hz"] + 0.5),
                             firmware.sensor.imu.gyro_rail, firmware.sensor.imu.gyro_lsb_per_dps)
        writer = BlockWriter(f.write, meta, scan.blocks.columns, 1)
        for kind, block in scan.each():
            if kind == cb.SAMPLES or kind == cb.STEPS:
                n = samples_in(block)
                if [1 for begin, end in stretches if begin < at + n and end > at]:
                    moves.block(block)
                    if room:
                        f.write(block)
                else:
                    moves.skip(n)
                    dropped += n
                at += n
            elif kind == cb.POSE and first_of(block) in firsts:
                # it comes right after its samples: what was dropped by now was before them
                p = stay[firsts.index(first_of(block))]
                p.first -= dropped
                writer.pose(p)
            elif kind == cb.NOTE:
                f.write(block)
        writer.note("%s, after a pause of unknown length: %d s stand for it"
                    % (FACES[face] + " again" if face >= 0 else "continued", GAP_S))
        return moves.moves(), dropped, at - dropped if room else 0, f.tell()


def _read_before(firmware, face, unasked):
    """The SessionBefore, its capture copied; face: 0..5 is taken again, -1: what is missing is
    taken. ValueError or OSError when there is nothing to go on from."""
    root = firmware.board.root
    name, scan = _last(root)
    blocks = scan.blocks
    session = session_number(firmware.board)
    stay = _that_stay(blocks.placements, face)
    _fits(firmware, scan, session)
    stretches = _stretches(blocks.placements, stay)
    samples = sum([end - begin + 2 * SLACK for begin, end in stretches])
    reason = _no_room(root, name, expected_bytes(samples, blocks.columns))
    room = not reason
    if face >= 0 and not room:
        raise ValueError(reason)
    if scan.sums_only():
        reason = "so did the session before; its flips do not count for the gyro"
    meta = meta_bytes(firmware, session, unasked)
    moves, dropped, kept, size = _copy(firmware, name, meta, stay, face, stretches, room)
    return SessionBefore(session, stay, moves, scan.samples() - dropped, kept, size,
                         scan.seconds + GAP_S, scan.us, reason)


def run(firmware, request):
    """The SessionRequest with the session before in it. Where there is none to go on from: one for
    all six faces, or None and an error event when a face was to be taken again."""
    face = request.face
    try:
        before = _read_before(firmware, face, request.unasked)
    except (ValueError, OSError) as e:
        remove(firmware.board.root + NEW)
        if face < 0:
            firmware.events.emit("afresh", reason=str(e))
            return SessionRequest()
        firmware.events.error("face %s cannot be taken again: %s" % (FACES[face], e),
                          "calibrate all faces")
        return None
    return SessionRequest(goes_on=True, face=face, before=before, unasked=request.unasked)
