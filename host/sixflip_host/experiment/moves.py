"""The moves of a session: which samples lead from each placement to the next.

One definition for all who integrate the gyro over them: the diagnosis' turns (turns.py) and the
refinement's rotations (calibrate/gyro_moves.py).
"""
from dataclasses import dataclass

import numpy as np

from sixflip.poses import faces

from ..capture import registers

LATE_S = 0.1  # the longest delay of the library's filter_lag


@dataclass(frozen=True)
class Move:
    """Samples first..end-1 from placement number `place` to the next, both ends at rest.

    flip: from one pose of a face to its other; railed: the gyro was cut off in it; longest_s: the
    longest step between two samples, s.
    """

    place: int
    first: int
    end: int
    flip: bool
    railed: bool
    longest_s: float


def of(session):
    """tuple of Move: one between each two neighbouring placements of a blocks.Session."""
    return tuple(after(session, place) for place in range(len(session.runs) - 1))


def after(session, place):
    """The Move from placement number `place` of a blocks.Session to the next."""
    run, following = session.runs[place], session.runs[place + 1]
    # What is read late is still read when the box lies still again.
    longer = int(LATE_S * session.rate)
    first = run.end - 1 - min(longer, (run.end - run.first) // 4)
    end = following.first + 1 + min(longer, (following.end - following.first) // 4)
    face = faces.face_of_code(run.code)
    flip = face >= 0 and run.code != following.code and face == faces.face_of_code(following.code)
    return Move(place, first, end, flip, registers.gyro_railed(session.capture, first, end),
                float(np.diff(session.t_s[first:end]).max()))
