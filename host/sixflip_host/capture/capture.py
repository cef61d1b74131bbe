"""A capture: the raw counts of one session, as the chip gave them."""

from . import pose_sums
from .capture_header import ACCEL, GYRO, MAG, STANDARD_G


class Capture:
    """Raw counts of one session, as the chip gave them.

    meta    dict of the JSON line (without `samples`); unknown keys are kept
    t_us    int64 (n,) microseconds, not decreasing
    accel   int16 (n, 3) counts; gyro, mag likewise or None; temp int16 (n,) or None; accel is
            None only where read() was asked for captures of a gyro alone, too
    pose    int16 (n,) codes of sixflip.poses.faces, 0 while moving; None when nobody labelled
    board_placements, notes, truncated, sums_only, taken, complete, withdrawn
            what only a board's own file knows, see capture_binary
    recorded (int64 stamps of all rows that were recorded, indices of those that are here) where
            some of them were left out, or None, see clock
    assumed sentences on what a foreign file did not say, see open_recording
    """

    def __init__(self, meta, t_us, accel, gyro=None, temp=None, mag=None, pose=None):
        self.meta = meta
        self.t_us = t_us
        self.accel = accel
        self.gyro = gyro
        self.temp = temp
        self.mag = mag
        self.pose = pose
        self.board_placements = None
        self.notes = []
        self.assumed = []
        self.recorded = None
        self.truncated = None
        self.sums_only = False
        self.taken = len(t_us)
        self.complete = True
        self.withdrawn = []

    def __len__(self):
        return len(self.t_us)

    @property
    def g(self):
        """Gravity the capture claims for its place, m/s²."""
        return self.meta.get("g", STANDARD_G)

    def columns(self):
        """Names of the columns there are, in the order they are written."""
        names = ["t_us", *(ACCEL if self.accel is not None else ())]
        names += GYRO if self.gyro is not None else ()
        names += ("temp",) if self.temp is not None else ()
        names += MAG if self.mag is not None else ()
        return names + (["pose"] if self.pose is not None else [])

    def placements(self):
        """Every unbroken run of a label as a sixflip.poses.placement.Placement; sums are exact.

        Where the board did not keep all samples, the placements are the board's.
        """
        if self.sums_only:
            return list(self.board_placements)
        if self.accel is None:
            return []
        return pose_sums.placements(self)

    def moves(self):
        """What lies between consecutive placements, as sixflip.poses.placement.Move."""
        return pose_sums.moves(self, self.placements())
