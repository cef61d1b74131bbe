"""A capture cut into what an experiment is made of: rests in poses, and the moves between them.

session_of() makes the Session of a capture, whose rests are cut into blocks. The moves have one
definition for all who integrate the gyro over them: the diagnosis' turns (turns.py) and the
refinement's rotations (calibrate/gyro_moves.py).
"""
import copy
from dataclasses import dataclass

import numpy as np

from sixflip.poses import faces

from .. import progress
from ..capture import registers, rests, rests_by_variance, shaken_rests
from ..capture.find_poses import HELD_BY_HAND, by_a_person, find_poses
from . import block_measures, thermometer, way_memory
from .session import Session

# Of a labelled rest: without its edges it has two short means, whose difference tells its noise
# (block_measures.white); in a log of few rows a second, samples enough for a mean of its own.
SHORTEST_S, FEWEST_SAMPLES = 0.8, 8
# Of the usual noise of a column: what the four samples around one span at most that agree (of
# normal noise 2.1 on average, more than 8 in less than one of a million), and how far one is off
# that no noise is.
AGREE, SPIKE = 8.0, 12.0
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


def session_of(name, capture, runs=None):
    """Session of a capture; poses are found where nobody labelled any. runs: list of rests.Run,
    rests that were found in a way of their own, taken as labelled. The capture itself is not
    changed."""
    progress.doing("the rests of %s" % name)
    rate = float(capture.meta["rate_hz"])
    t_s = (capture.t_us - capture.t_us[0]) * 1e-6
    timeless = len(capture) > 1 and t_s[-1] <= 0.0
    if timeless:
        t_s = np.arange(len(capture)) / rate
    labelled = runs is not None or by_a_person(capture)
    if not labelled and (capture.pose is None or not (capture.pose > 0).any()):
        capture = _labelled(capture)
    runs = tuple(runs_of(capture) if runs is None else runs)
    smooth = thermometer.of_capture(capture, t_s)
    return Session(name, capture, rate, t_s, timeless, labelled, runs, smooth,
                   way_memory.Way(capture, rate, t_s),
                   **block_measures.of_runs(capture, runs, rate, t_s, labelled, smooth))


def with_whole_rests(session):
    """The Session with those rests made one between which it stood still: of those that nobody
    labelled, of what is not turned over."""
    if session.labelled or session.turned_over:
        return session
    whole = tuple(shaken_rests.joined(session.capture, session.runs))
    return session if whole == session.runs else session.of_runs(whole)


def runs_of(capture, by_hand=False):
    """list of rests.Run: the labelled rests of a capture that are long enough; by_hand: those that
    a hand held as well."""
    held = () if by_hand else capture.meta.get(HELD_BY_HAND, ())
    return rests.labelled(capture.pose,
                          max(FEWEST_SAMPLES, SHORTEST_S * float(capture.meta["rate_hz"])),
                          {faces.pose_code(name) for name in held})


def _labelled(capture):
    """The capture with the poses that are found in it."""
    labelled = copy.copy(capture)
    labelled.meta = dict(capture.meta)
    if capture.accel is None:
        return rests_by_variance.label_still_gyro(labelled)
    try:
        find_poses(_without_spikes(capture)).label(labelled)
    except (ValueError, IndexError, ZeroDivisionError):
        labelled.pose = np.zeros(len(capture), np.int16)
    return labelled


def _without_spikes(capture):
    """The capture with the median of the four samples around each that is alone far off while
    those agree: a bit that is read wrongly moves no box, and cuts no rest in two."""
    calm = copy.copy(capture)
    for sensor in ("accel", "gyro"):
        counts = getattr(capture, sensor)
        if counts is None or len(counts) < 5:
            continue
        around = registers.beside(counts).astype(float)
        middle = np.median(around, axis=0)
        noise = np.maximum(1.4826 / np.sqrt(2.0) * np.median(np.abs(np.diff(
            counts.astype(float), axis=0)), axis=0), 1.0)
        alone = (np.ptp(around, axis=0) < AGREE * noise) & (
            np.abs(counts[2:-2] - middle) > SPIKE * noise)
        whole = np.array(counts)
        whole[2:-2] = np.where(alone, np.rint(middle), counts[2:-2]).astype(counts.dtype)
        setattr(calm, sensor, whole)
    return calm


def distinct(sessions):
    """(sessions without those that repeat one before them, the repeated ones)."""
    kept, repeated = [], []
    for session in sessions:
        same = any(len(session.capture) == len(other.capture)
                   and all(np.array_equal(getattr(session.capture, k), getattr(other.capture, k))
                           for k in ("t_us", "accel", "gyro")) for other in kept)
        (repeated if same else kept).append(session)
    return kept, repeated


def same_chip(sessions):
    """(those of the first one's sensor, the others): different chips have different causes.
    Different ranges of one chip do not matter: everything is in mg and deg/s."""
    chip = sessions[0].capture.meta["sensor"]
    return ([s for s in sessions if s.capture.meta["sensor"] == chip],
            [s for s in sessions if s.capture.meta["sensor"] != chip])


def moves_of(session):
    """tuple of Move: one between each two neighbouring placements of a Session."""
    return tuple(move_after(session, place) for place in range(len(session.runs) - 1))


def move_after(session, place):
    """The Move from placement number `place` of a Session to the next."""
    run, following = session.runs[place], session.runs[place + 1]
    # What is read late is still read when the box lies still again.
    longer = int(LATE_S * session.rate)
    first = run.end - 1 - min(longer, (run.end - run.first) // 4)
    end = following.first + 1 + min(longer, (following.end - following.first) // 4)
    face = faces.face_of_code(run.code)
    flip = face >= 0 and run.code != following.code and face == faces.face_of_code(following.code)
    return Move(place, first, end, flip, registers.gyro_railed(session.capture, first, end),
                float(np.diff(session.t_s[first:end]).max()))
