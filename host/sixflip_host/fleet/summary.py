"""A capture without its samples: what solve and the diagnosis of rests need, under 2 kB a pose.

The placements' exact sums and the moves between them are those that the board itself solves from
(shared/sixflip/poses/placement.py); the blocks are those of experiment/blocks.py. What only the
samples show (registers, clock, spectrum, how far the flips turned) is in it as its verdict.
"""
import copy
from dataclasses import dataclass, replace

import numpy as np

from sixflip.poses.placement import Move, Placement

from ..calibrate import flips_turned, solution
from ..capture import rests
from ..capture.capture_file import Capture
from ..capture.find_poses import find_poses
from ..diagnosis import samples_judged
from ..diagnosis.detect import saturation
from ..experiment import blocks, thermometer
from ..experiment.session import OF_BLOCKS, Session, fading

# What is a session's own; its vibration is what it and others agree on.
OF_SESSION = (*(name for name in OF_BLOCKS if name != "vibration"), "noise_accel", "noise_gyro",
              "rounding_accel", "rounding_gyro")
PATH = 36  # numbers of Move.path
KEPT = ("sensor", "rate_hz", "rate", "accel_lsb_per_g", "gyro_lsb_per_dps", "temp_lsb_per_c",
        "temp_offset_c", "accel_range_g", "gyro_range_dps", "g", "device_id", "session", "time",
        "held_by_hand")


class SummarisedCapture(Capture):
    """A Capture whose samples are gone: placements() and moves() are those that were summed."""

    def __init__(self, meta, placements, moves, gyro, labelled):
        empty = np.zeros((0, 3), np.int16)
        super().__init__(meta, np.zeros(0, np.int64), empty, empty if gyro else None)
        self.pose = np.zeros(0, np.int16) if labelled else None
        self._placements, self._moves = placements, moves

    def placements(self):
        return list(self._placements)

    def moves(self):
        return list(self._moves)


@dataclass(frozen=True, eq=False)
class SummarySession(Session):
    """A Session without samples. starts (placements,): s since the capture's begin at
    which each began; friction (n, forms, 3) and turned (n, times, 3):
    Session's, the latter None where there is no gyro."""

    starts: np.ndarray = None
    friction: np.ndarray = None
    turned: np.ndarray = None

    def part(self, placements):
        keep = np.isin(self.placement, list(placements))
        return replace(super().part(placements), **self._remembering(keep))

    def of_runs(self, runs):
        places = [self.runs.index(run) for run in runs]
        keep = np.isin(self.placement, places)
        number = np.full(len(self.runs), -1)
        number[places] = np.arange(len(places))
        cut = {name: getattr(self, name) for name in OF_BLOCKS}
        cut = {name: value if value is None else value[keep] for name, value in cut.items()}
        cut["placement"] = number[cut["placement"]]
        return replace(self, runs=tuple(runs), starts=self.starts[places],
                       **self._remembering(keep), **cut)

    def _remembering(self, keep):
        return {name: None if getattr(self, name) is None else getattr(self, name)[keep]
                for name in ("friction", "turned")}

    def remembered(self, up, tau_s):
        return fading(self.starts, up, tau_s)[self.placement]


@dataclass(frozen=True, eq=False)
class Summary:
    """What is left of one capture.

    about     dict of JSON: meta, labelled, found_labelled, remarks, flips, samples, bounds
    arrays    {name: array}: placement_*, move_*, halves, runs, thermometer, friction, turned,
              block_*
    """

    about: dict
    arrays: dict

    @property
    def meta(self):
        return self.about["meta"]

    def placements(self):
        """list of Placement, as capture.placements() gave them."""
        a = self.arrays
        return [Placement(int(code), int(first), int(n), sums.tolist(), noise.tolist(), int(span))
                for (code, first, n, span), sums, noise in zip(
                    a["placement_of"], a["placement_sums"], a["placement_noise"])]

    def moves(self):
        """list of Move, as capture.moves() gave them."""
        return [_move(row.tolist()) for row in self.arrays["move_of"]]

    def capture(self):
        """SummarisedCapture, for whoever asks for placements, moves and meta."""
        return SummarisedCapture(self.meta, self.placements(), self.moves(),
                                 "gyro_lsb_per_dps" in self.meta and self.about["gyro"],
                                 self.about["labelled"])

    def solved(self, g=None):
        """solution.Solution of what was summed; that of the capture itself, to the last digit."""
        capture, flips = self.capture(), flips_turned.FlipsTurned(self.about["flips"]["reason"])
        for face, degrees, sigma in self.about["flips"]["measured"]:
            flips.measured[face] = (degrees, sigma)
        flips.angles = dict(self.about["flips"]["angles"])
        return solution.of_placements(capture, flips, self.about["labelled"], g,
                                      halves=self.arrays["halves"].tolist(),
                                      remarks=self.about["remarks"])

    def session(self):
        """SummarySession of the blocks."""
        a = self.arrays
        values = {name: a.get("block_" + name) for name in OF_SESSION}
        smooth = None
        if "thermometer" in a:
            t0 = float(a["thermometer"][0])
            c = a["thermometer"][1:]
            smooth = thermometer.of_course(t0 + thermometer.STEP_S * np.arange(len(c)), c)
        runs = tuple(rests.Run(*row) for row in a["runs"][:, :3].tolist())
        return SummarySession(
            self.about["name"], self.capture(), float(self.meta["rate_hz"]),
            np.array(self.about["bounds"]), False, self.about["found_labelled"], runs, smooth,
            None, starts=a["starts"], friction=a["friction"], turned=a.get("turned"), **values)


def summarise(name, capture):
    """Summary of a capture with samples, less its damage; the capture itself is not changed."""
    ((_, capture),), damages = samples_judged.without_damage([(name, capture)])
    solved = solution.solve(copy.copy(capture))
    labelled = capture.pose is not None
    placed = capture if labelled else _with_poses(capture)
    session = blocks.session_of(name, capture)
    judged = samples_judged.judge([session], damages=damages)
    session, = judged.sessions
    if any(f.effect == "saturation" and f.sensor == "accel" for f in judged.findings):
        session = session.without_samples(saturation.railed(session))
    about = {
        "name": name, "labelled": labelled, "found_labelled": session.labelled,
        "gyro": capture.gyro is not None,
        "meta": {key: capture.meta[key] for key in KEPT if key in capture.meta},
        "remarks": solved.remarks + list(capture.assumed) + [one.words for one in damages],
        "bounds": [0.0, float(session.t_s[-1])],
        "flips": {"reason": solved.flips.reason,
                  "angles": [[int(k), float(v)] for k, v in solved.flips.angles.items()],
                  "measured": [[int(k), *map(float, v)] for k, v in
                               solved.flips.measured.items()]},
        "samples": _verdict(judged)}
    return Summary(about, {**_placed(placed, solved), **_blocks(session)})


def _with_poses(capture):
    posed = copy.copy(capture)
    posed.meta = dict(capture.meta)
    find_poses(posed).label(posed)
    return posed


def _placed(capture, solved):
    """The arrays that solve needs."""
    places, moves = solved.placements, solved.moves
    return {
        "placement_of": np.array([[p.pose, p.first, p.n, p.duration_us] for p in places],
                                 np.int64).reshape(-1, 4),
        "placement_sums": np.array([p.sums for p in places], np.int64).reshape(-1, 7),
        "placement_noise": np.array([p.noise for p in places], float).reshape(-1, 6),
        "move_of": np.array([_row(m) for m in moves], np.int64).reshape(-1, 14 + PATH),
        "halves": np.array(solution.halves(capture, solved), float).reshape(-1, 3)}


def _row(move):
    path = [0] * PATH if move.path is None else list(move.path)
    return [move.before, move.after, move.first, move.n, *move.gyro_sums, move.duration_us,
            *move.late, int(move.saturated), move.largest_gap_us, *path][:14 + PATH]


def _move(row):
    path = row[14:]
    move = Move(*row[:4], row[4:7], row[7], row[8:12], bool(row[12]), row[13])
    move.path = path if any(path) else None
    return move


def _blocks(session):
    """The arrays that the diagnosis of rests needs."""
    arrays = {"block_" + name: getattr(session, name) for name in OF_SESSION
              if getattr(session, name) is not None}
    arrays["runs"] = np.array([(*run,) for run in session.runs], np.int64).reshape(-1, 3)
    arrays["starts"] = np.array([session.t_s[run.first] for run in session.runs], float)
    arrays["friction"] = session.friction
    if session.gyro is not None:
        arrays["turned"] = session.turned
    if session.thermometer is not None:
        arrays["thermometer"] = np.concatenate([session.thermometer.t[:1], session.thermometer.c])
    return arrays


def _verdict(judged):
    """What only samples show, as it stands in answers: numbers and words."""
    return {"findings": [{
        "sensor": f.sensor, "effect": f.effect, "axes": list(f.axes), "domain": f.domain,
        "score_nats": float(f.score), "words": f.words,
        "value": {k: float(v) for k, v in f.value.items()}, "unit": f.unit,
        "plausible": bool(f.plausible), "share": None if f.share is None else float(f.share),
        "number": float(f.number), "place": {k: float(v) for k, v in f.place.items()}}
        for f in judged.findings],
        "nameless": [{"sensor": p.sensor, "axis": p.axis, "domain": p.domain, "p": p.p}
                     for p in judged.nameless],
        "scaled": judged.scaled, "remarks": list(judged.remarks)}
