"""One drive around the loop: where the robot really was, what its sensors read, its odometry.

The robot rests, drives leg by leg at a constant speed, and turns on the spot at each corner.
Its gyro is that of a calibrated, simulated GY-85 with flicker, switched on anew; the heading is
computed by the board's own code from each of three readings of the same counts.
"""

import dataclasses
import math

import numpy as np

from sixflip import STANDARD_G
from sixflip.gyro.heading import Heading
from sixflip.record.correction import Correction
from sixflip_sim import noise, worlds
from sixflip_sim.effects import typical

from ...experiment import noise_arrays
from ...simulation import simulator
from ...simulation.simulated_session import capture_of
from .. import li_tables
from . import floor_plan

REST_S = 8.0
SPEED_MPS = 0.7             # a Kobuki, the base of the TurtleBot 2, at its fastest
TURN_S = 3.0
OVERLAP_M = 4.0             # driven on past the start, so that the end sees what the start saw
WHEELS = 0.005              # scatter of the wheels' scale, standard deviation
UPDATE_M, UPDATE_RAD = 1.0, 0.5     # Gmapping's defaults: linearUpdate, angularUpdate
BEAMS, REACH_M, SCAN_HZ, RANGE_M = 400, 8.0, 10.0, 0.01
READINGS = ("raw", "rest", "Sixflip")
_WHEELS, _LIDAR, _SWITCH_ON = 0x721, 0x722, 0x723      # streams of noise.py


@dataclasses.dataclass(frozen=True)
class Drive:
    """Everything of one drive that is the same for all readings, at the moments of the scans.

    t_s (n,); pose (n, 3) true x, y, heading; wheels (n,) metres driven, as counted by the
    wheels; scans (n, BEAMS) metres, NaN for no echo, once around counter-clockwise
    from behind; leg (n,) number of the leg, -1 in a turn; yaw {reading: (n,)} rad
    """

    corridor: floor_plan.Corridor
    t_s: np.ndarray
    pose: np.ndarray
    wheels: np.ndarray
    scans: np.ndarray
    leg: np.ndarray
    yaw: dict

    def odometry(self, reading):
        """(n, 3) poses from the wheels and a reading's heading, from the true first pose on."""
        yaw = self.pose[0, 2] + self.yaw[reading] - self.yaw[reading][0]
        return integrate(self.pose[0], self.wheels, yaw)


def integrate(first, driven, yaw):
    """(n, 3) poses from metres driven (n,) and headings (n,), along the chords' middle."""
    step = np.diff(driven, prepend=driven[0])
    middle = 0.5 * (yaw + np.concatenate([yaw[:1], yaw[:-1]]))
    return np.stack([first[0] + np.cumsum(step * np.cos(middle)),
                     first[1] + np.cumsum(step * np.sin(middle)), yaw], axis=1)


@dataclasses.dataclass(frozen=True)
class Route:
    """Metres driven and heading as functions of time, from the middle of the lower side."""

    corridor: floor_plan.Corridor

    def legs(self):
        """Metres of each straight stretch."""
        a, b = self.corridor.length, self.corridor.depth
        return [0.5 * a, b, a, b, 0.5 * a + OVERLAP_M]

    def pieces(self):
        """[(kind, seconds, metres or radians)] of the whole drive."""
        pieces = [("rest", REST_S, 0.0)]
        for number, metres in enumerate(self.legs()):
            if number:
                pieces.append(("turn", TURN_S, 0.5 * math.pi))
            pieces.append(("leg", metres / SPEED_MPS, metres))
        return pieces

    def at(self, t_s):
        """(pose (n, 3), leg (n,), metres (n,)) at the times (n,) in seconds."""
        x, y = 0.0, -0.5 * self.corridor.depth
        heading, begin, number, driven = 0.0, 0.0, -1, 0.0
        pose, leg = np.zeros((len(t_s), 3)), np.full(len(t_s), -1)
        metres = np.zeros(len(t_s))
        for kind, seconds, size in self.pieces():
            here = t_s >= begin
            tau = np.clip((t_s[here] - begin) / seconds, 0.0, 1.0)
            far = size * tau if kind == "leg" else 0.0 * tau
            turned = 0.0 * tau
            if kind == "turn":      # as sixflip_sim.scene turns
                turned = size * tau ** 3 * (10.0 - 15.0 * tau + 6.0 * tau ** 2)
            pose[here, 0] = x + far * math.cos(heading)
            pose[here, 1] = y + far * math.sin(heading)
            pose[here, 2] = heading + turned
            number += kind == "leg"
            leg[here], metres[here] = (number if kind == "leg" else -1), driven + far
            if kind == "leg":
                x, y = x + size * math.cos(heading), y + size * math.sin(heading)
                driven += size
            elif kind == "turn":
                heading += size
            begin += seconds
        return pose, leg, metres

    def seconds(self):
        """Duration of the drive."""
        return sum(seconds for _, seconds, _ in self.pieces())


def make(corridor, seed):
    """The Drive of a gyro; the seed is that of the part, its noise, the wheels and the lidar."""
    route = Route(corridor)
    record, truth = li_tables.calibrated(seed)
    counts = _readings(route, truth, seed)
    t_s, scan = _updates(route)
    pose, leg, metres = route.at(t_s)
    scale = 1.0 + WHEELS * noise.gauss(noise.key(seed, _WHEELS), 0)
    yaw = {"raw": _yaw(counts, li_tables.nominal(counts.meta), False, t_s),
           "rest": _yaw(counts, li_tables.nominal(counts.meta), True, t_s),
           "Sixflip": _yaw(counts, record, True, t_s)}
    return Drive(corridor, t_s, pose, scale * metres, _scans(corridor, route, t_s, scan, seed),
                 leg, yaw)


def _readings(route, truth, seed):
    """Capture of the gyro's counts over the drive, its bias moved by the switching-on."""
    stream = noise.key(seed, _SWITCH_ON)
    bias = [math.degrees(truth.gyro_bias[k])
            + li_tables.SWITCH_ON_DPS * noise.uniform(stream, k) for k in range(3)]
    floor = typical.FLOOR["itg3205"]
    world = worlds.make({
        "sensor": li_tables.SENSOR, "seed": seed + 700000, "order": [], "first_rest_s": 0.0,
        "accel_matrix": truth.accel_matrix, "gyro_matrix": truth.gyro_matrix,
        "accel_bias_mg": [1e3 * b / STANDARD_G for b in truth.accel_bias], "gyro_bias_dps": bias,
        "effects": [{"effect": "drift", "sensor": "gyro", "x": floor, "y": floor, "z": floor,
                     "seed": seed}]})
    for kind, seconds, size in route.pieces():
        if kind == "turn":
            world.scene.turn(int(seconds * 1e6), (0.0, 0.0, 1.0), size)
        else:
            world.scene.rest(int(seconds * 1e6))
    simulator.vectorise(world.model)
    return capture_of(world)


def _updates(route):
    """(times of the scans' middles, their numbers): at the start, then every UPDATE_M or
    UPDATE_RAD."""
    number = np.arange(int(REST_S * SCAN_HZ), int(route.seconds() * SCAN_HZ))
    t_s = (number + 0.5) / SCAN_HZ
    pose, _, metres = route.at(t_s)
    taken = [0]
    for k in range(1, len(number)):
        if (metres[k] - metres[taken[-1]] >= UPDATE_M
                or abs(pose[k, 2] - pose[taken[-1], 2]) >= UPDATE_RAD):
            taken.append(k)
    return t_s[taken], number[taken]


def _scans(corridor, route, t_s, scan, seed):
    """(n, BEAMS) ranges; each beam is sent from where the robot is at its own moment."""
    beam = np.arange(BEAMS)
    sent = t_s[:, None] + ((beam + 0.5) / BEAMS - 0.5) / SCAN_HZ
    pose, _, _ = route.at(sent.ravel())
    angle = pose[:, 2] + np.tile(2.0 * math.pi * (beam + 0.5) / BEAMS - math.pi, len(t_s))
    walls = corridor.walls()
    ranges_m = np.concatenate([floor_plan.ranges(walls, pose[k:k + BEAMS, :2], angle[k:k + BEAMS],
                                                 REACH_M) for k in range(0, len(pose), BEAMS)])
    stream = noise.key(seed, _LIDAR)
    k = (scan[:, None] * BEAMS + beam).ravel()
    scatter = noise_arrays.gauss(stream, k)
    return (ranges_m + RANGE_M * scatter).reshape(len(t_s), BEAMS)


def _yaw(counts, record, at_rest, t_s):
    """Headings (n,) rad at the times, by the board's correction and heading (Li Eq. 8).

    at_rest: the bias is the mean of the first rest.
    """
    correction, heading = Correction(record), Heading(g=record.g)
    if at_rest:
        still = counts.t_us < REST_S * 1e6
        correction.set_gyro_bias(counts.gyro[still].mean(axis=0).tolist())
    a = li_tables.affine(counts.accel, correction.accel)
    w = li_tables.affine(counts.gyro, correction.gyro)
    dt = np.diff(counts.t_us, prepend=counts.t_us[:1]) * 1e-6
    yaw = [heading.step(*sample)[2] for sample in zip(a.tolist(), w.tolist(), dt.tolist())]
    return np.interp(t_s, counts.t_us * 1e-6, yaw)
