"""Every fault of hostile_sessions through `solve --flips 180`, as a new board would solve it,
and what the verdict made of it."""

import numpy as np

from sixflip_host.calibrate import solution
from tests.worlds import hostile_sessions as hostile

WRONG_MG = 3.0      # a correction this far off, RMS over all directions, must not be called good
MOST_TILT_DEG = 5.0

# What the verdict must do: "good" in 98 of 100, "refused" always, "never good", and for faults
# of a size that placing by hand has too "never wrong": good only where the error is small.
# "by gyro": never wrong with a gyro, "no claim" without: printed so that nobody is surprised.
CASES = (
    ("honest", hostile.none, 0, "good"),
    ("a and b exchanged", hostile.letters_swapped, 0, "good"),
    ("a pose missing", hostile.pose_missing, 0, "refused"),
    ("a face missing", hostile.face_missing, 0, "refused"),
    ("two poses swapped", hostile.swapped, 0, "refused"),
    ("one label wrong", hostile.mislabelled, 0, "refused"),
    ("a 13th, label wrong", hostile.extra_mislabelled, 0, "never wrong"),
    ("face crooked 8°", hostile.crooked, 8, "refused"),
    ("face crooked 3°", hostile.crooked, 3, "refused"),
    ("face crooked 1°", hostile.crooked, 1, "never good"),
    ("face crooked 0.3°", hostile.crooked, 0.3, "never wrong"),
    ("two faces crooked 8°", hostile.crooked_pair, 8, "refused"),
    ("two faces crooked 1°", hostile.crooked_pair, 1, "never good"),
    ("opposite faces 8° oblique", hostile.lozenge, 8, "never good"),
    ("one capture leans 8°", hostile.leaning, 8, "refused"),
    ("one capture leans 1°", hostile.leaning, 1, "never good"),
    ("one capture leans 0.3°", hostile.leaning, 0.3, "never wrong"),
    ("pushed by 8°", hostile.pushed, 8, "refused"),
    ("pushed by 1°", hostile.pushed, 1, "never wrong"),
    ("flip by 0°", hostile.turned, 0, "never wrong"),
    ("flip by 90°", hostile.turned, 90, "never wrong"),
    ("flip by 170°", hostile.turned, 170, "never wrong"),
    ("every flip by 90°", hostile.all_turned, 90, "never wrong"),
    ("every flip by 177°", hostile.all_turned, 177, "never wrong"),
    # Six flips short by the same angle look like another tilt, but not to the gyro.
    ("every flip by 170°", hostile.all_turned, 170, "by gyro"),
    ("table moved by 1°", hostile.table_moved, 1, "never wrong"),
    ("axis inverted", hostile.inverted, 0, "refused"),
    ("axes exchanged", hostile.exchanged, 0, "refused"),
    ("range twice or half", hostile.wrong_range, 2, "refused"),
    ("stale", hostile.stale, 0, "refused"),
    ("saturated", hostile.saturated, 0, "refused"),
    ("torn reads, 2 g", hostile.spikes, 2, "refused"),
    ("torn reads, 0.1 g", hostile.spikes, 0.1, "never wrong"),
    ("held by hand", hostile.shaken, 1, "never wrong"),
    ("bias creeps 50 mg", hostile.warmed, 50, "never good"),
    ("bias creeps 5 mg", hostile.warmed, 5, "never wrong"),
)


class Row:
    """name, must, runs, verdicts {word: count}, worst error of a good one in mg, and the
    (seed, where, verdict, reason) of every run in which the verdict was not what it must be."""

    def __init__(self, name, must):
        self.name, self.must = name, must
        self.runs, self.worst = 0, 0.0
        self.verdicts = {"good": 0, "doubtful": 0, "refused": 0}
        self.broken = []

    def add(self, verdict, error_mg, where, reason):
        """Count one session."""
        self.runs += 1
        self.verdicts[verdict] += 1
        good = verdict == "good"
        if good:
            self.worst = max(self.worst, error_mg)
        if self.must == "no claim":
            return
        if {"good": not good, "refused": verdict != "refused", "never good": good,
                "never wrong": False}[self.must] or (good and not error_mg <= WRONG_MG):
            self.broken.append((where, verdict, reason))

    def holds(self):
        """Whether the verdict did what it must."""
        if self.must == "good":
            return self.verdicts["good"] >= 0.98 * self.runs and self.worst <= WRONG_MG
        return not self.broken

    def line(self):
        """One line of the table."""
        counts = "".join("%9d" % self.verdicts[word] for word in ("good", "doubtful", "refused"))
        worst = "%11.2f" % self.worst if self.verdicts["good"] else "%11s" % "-"
        return "%-28s%s%s   %-12s%s" % (self.name, counts, worst, self.must,
                                        "" if self.holds() else "BROKEN")


HEAD = "%-28s%9s%9s%9s%11s   %s" % ("", "good", "doubtful", "refused", "worst, mg", "must be")


def judge(case, sensor, seeds):
    """The Row of one case over seeds; where the fault is goes round with the seed."""
    name, fault, size, must = case
    if must == "by gyro":
        must = "never wrong" if hostile.SENSORS[sensor][3] else "no claim"
    row = Row(name, must)
    for seed in seeds:
        tilt = np.random.default_rng([seed, 1]).uniform(0, MOST_TILT_DEG)
        session = hostile.Session(seed, sensor, tilt)
        fault(session, seed, size)
        found = solution.solve(session.capture(), half_turns=True)
        error = session.error_mg(found.accel.P) if found.accel else np.inf
        row.add(found.verdict, error, seed, found.reason)
    return row
