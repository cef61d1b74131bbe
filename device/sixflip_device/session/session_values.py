"""What passes between the phases of a calibration; nothing is added to any of it later.

They are in a module of their own because an object keeps the module of its class in the heap, and
the code of a session is to leave it before the solver comes.
"""


class SessionRequest:
    """What session.sampling is to do; the six faces in any order unless it says otherwise.

    plan     codes of poses in the order planned, or None; lengths: samples of each of them;
             hold_s: seconds of rest before the first and after the last
    goes_on  the session before goes on; face: 0..5 for one that is taken again, -1 otherwise
    before   the SessionBefore that it goes on from (redo_session.py), None until it was read
    record   every block of the capture is sent to the host
    unasked  nobody asked: a board without a record calibrates by itself
    """

    def __init__(self, plan=None, lengths=(), hold_s=0, goes_on=False, face=-1, before=None,
                 record=False, unasked=False):
        self.plan = plan
        self.lengths = lengths
        self.hold_s = hold_s
        self.goes_on = goes_on
        self.face = face
        self.before = before
        self.record = record
        self.unasked = unasked


class SessionBefore:
    """The session before, as far as the one that goes on from it takes it over.

    session        the number of the new session, in the header of the copied capture
    placements     those that stay; their samples are found in the copy
    moves          to each of them, and the one under way at the end
    samples, kept, bytes   of the copy: samples there were, those that are in it, its size
    seconds, us    the time that the new session begins at
    sums_only, reason      no samples are kept, and why
    """

    def __init__(self, session, placements, moves, samples, kept, bytes, seconds, us, reason):
        self.session = session
        self.placements = placements
        self.moves = moves
        self.samples = samples
        self.kept = kept
        self.bytes = bytes
        self.seconds = seconds
        self.us = us
        self.sums_only = reason != ""
        self.reason = reason


class SessionResult:
    """What a session leaves.

    number             names the session in capture and record
    how, ended         "complete", "timed out", "stopped", "changed" or "bus lost", and a sentence
    placements, moves  of sixflip.poses.placement; missing: names of poses still to come
    has_capture        the capture's file, capture.new, is whole
    """

    def __init__(self, number, how, ended, placements, moves, missing, has_capture):
        self.number = number
        self.how = how
        self.ended = ended
        self.placements = placements
        self.moves = moves
        self.missing = missing
        self.has_capture = has_capture


class Calibration:
    """What a session comes to.

    record           sixflip.record.record.Record, complete but for what the board keeps
                     (mounting, terms) and its sequence number
    verdict, reason  of the accelerometer: "good", "doubtful" or "refused", and a sentence
    facts            what the host is told, for an event
    angles           {face 0..5: rad} of the flips whose turn an earlier gyro measured
    """

    def __init__(self, record, verdict, reason, facts, angles):
        self.record = record
        self.verdict = verdict
        self.reason = reason
        self.facts = facts
        self.angles = angles
