"""What only a board's own file of a capture has a place for, under one key of a text's header.

Notes, poses that were withdrawn, what is wrong with the file, and the board's sums of the poses
where not all of the samples were kept: so both forms of a capture say the same.
"""

from typing import NamedTuple

from sixflip.poses.faces import pose_code, pose_name
from sixflip.poses.placement import Placement

from ..errors import BadFile
from .capture_rows import quoted

EXTRAS = "board_capture"
PAUSES = "write_pauses_us"
LOST = "lost_on_the_way"


def as_json(placement):
    """A board's placement as it stands under the key `placements`."""
    return {"pose": pose_name(placement.pose), "first": placement.first, "n": placement.n,
            "duration_us": placement.duration_us, "sums": list(placement.sums),
            "noise": list(placement.noise)}


def _placement(fields):
    sums, noise = [int(x) for x in fields["sums"]], [float(x) for x in fields["noise"]]
    first, n = int(fields["first"]), int(fields["n"])
    if len(sums) != 7 or len(noise) != 6 or first < 0 or n <= 0:
        raise ValueError("a placement contradicts itself")
    return Placement(pose_code(fields["pose"]), first, n, sums, noise, int(fields["duration_us"]))


def _lost(pair):
    return [int(pair[0]), [int(t) for t in pair[1]]] if pair else []


class Extras(NamedTuple):
    """notes: texts; withdrawn: pose codes; truncated: what is wrong with the file, or None;
    complete: no pose was missing; pauses: times in us after which the board wrote to its flash;
    taken: samples there were; placements: the board's, None where all samples are there; lost:
    [samples, times in us after which they are missing] that a recording over the port never got.
    """

    notes: list
    withdrawn: list
    truncated: str
    complete: bool
    taken: int
    placements: list
    pauses: list
    lost: list


def from_meta(meta, path):
    """The Extras in a capture's metadata; BadFile when they make no sense."""
    kept = meta.get(EXTRAS, {})
    try:
        return Extras([str(note) for note in kept.get("notes", [])],
                      [int(code) for code in kept.get("withdrawn", [])],
                      str(kept["truncated"]) if kept.get("truncated") else None,
                      kept.get("complete", False) is True, int(kept.get("taken", 0)),
                      [_placement(each) for each in kept["placements"]]
                      if "placements" in kept else None,
                      [int(t) for t in kept.get(PAUSES) or []], _lost(kept.get(LOST)))
    except (ValueError, TypeError, LookupError, AttributeError, OverflowError) as error:
        raise BadFile("%s: in its metadata the key %s makes no sense: %s" % (
            path, EXTRAS, quoted(str(error))))


def take(capture, path):
    """Sets on a capture what its metadata says of the board's file it came from."""
    extras = from_meta(capture.meta, path)
    capture.notes, capture.withdrawn = extras.notes, extras.withdrawn
    capture.truncated = extras.truncated
    capture.complete = extras.complete or EXTRAS not in capture.meta
    capture.taken = max(len(capture), extras.taken)
    if extras.placements is not None:
        capture.sums_only, capture.board_placements = True, extras.placements
