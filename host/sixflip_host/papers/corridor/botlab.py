"""A real recording: a robot drives 6 m in an arena and turns by 903°, mapped by the same engine.

The MAEBot's log of University of Michigan's ROB 550 (see the recording's README): gyro, wheels
and lidar. Every other scan is held out of the map and measured against it, so no truth from
outside is needed. It shows what removing the bias brings. There was no session of six flips.
"""

import dataclasses
import math
from pathlib import Path

import numpy as np

from ...errors import BadFile
from . import rawlog, slam
from .drive import integrate
from .floor_plan import wrapped

RECORDING = Path("botlab_maebot_lidar_imu_odom") / "convex_decoded.npz"
LSB_US_PER_DEG = 131e6      # the recording's README: 131 LSB per deg/s, integrated over µs
# The robot's own odometry, src/maebot/odometry.cpp of the recording's source.
METRES_PER_TICK, BASELINE_M = 0.100528 / 1200.0, 0.08
REST_S = 2.1                # the recording's README: the first 2.1 s are at rest
BINS = 360
RESOLUTION_M = 0.02
REACH_M = 6.0               # of the lidar, an RPLIDAR A1
STANDARD = slam.Engine("odometry proposal", 0, 30, slam.ODOMETRY, slam.FLAT)
GMAPPING = slam.LADDER[2]
LADDER = (slam.LADDER[0], STANDARD, GMAPPING)
READINGS = ("raw", "rest", "wheels")


@dataclasses.dataclass(frozen=True)
class Recording:
    """t_s (n,) of the encoders; driven (n,) m; yaw {reading: (n,)} rad; scan_t (m, beams) s,
    scan_range m and scan_angle rad, counter-clockwise, (m, beams), NaN for no echo."""

    t_s: np.ndarray
    driven: np.ndarray
    yaw: dict
    scan_t: np.ndarray
    scan_range: np.ndarray
    scan_angle: np.ndarray

    def odometry(self, reading, scale=1.0):
        """(n, 3) poses at the encoders' times; scale: of the turns that were read."""
        return integrate((0.0, 0.0, 0.0), self.driven, scale * self.yaw[reading])


def load(path):
    """The Recording in a .npz; BadFile where it is none or has no scans."""
    try:
        with open(path, "rb") as whole, np.load(whole) as file:
            data = {name: file[name] for name in file.files}
        return _recording(data, path)
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise BadFile("%s: is not the recording of the lidar, wheels and gyro: %s" % (
            path, error)) from None


def _recording(data, path):
    if not len(data["scan_time_us"]):
        raise BadFile("%s: a log without scans, expected some" % path)
    # Host and robot have a clock each; what arrived fastest tells how far they are apart.
    offset = (data["enc_log_us"] - data["enc_robot_us"]).min()
    zero = data["enc_robot_us"][0]
    t_s = (data["enc_robot_us"] - zero) * 1e-6
    ticks = data["enc_ticks"] - data["enc_ticks"][0]
    left, right = METRES_PER_TICK * ticks.T
    imu_s = (data["imu_log_us"] - offset - zero) * 1e-6
    turned = np.radians(data["imu_gyroint_lsb_us"][:, 2] / LSB_US_PER_DEG)
    still = imu_s < imu_s[0] + REST_S
    bias = np.polyfit(imu_s[still], turned[still], 1)[0]
    raw = np.interp(t_s, imu_s, turned - turned[0])
    angle = -np.asarray(data["scan_theta_rad"], dtype=float)      # the recording's is clockwise
    ranges_m = np.asarray(data["scan_range_m"], dtype=float)
    ranges_m = np.where((ranges_m > 0.0) & np.isfinite(angle), ranges_m, np.nan)
    when = (data["scan_time_us"] - zero) * 1e-6
    return Recording(t_s, 0.5 * (left + right), {
        "raw": raw, "rest": raw - bias * t_s, "wheels": (right - left) / BASELINE_M},
        when, ranges_m, wrapped(angle))


def held_out(program, recording, engine, reading, scale=1.0, part=slice(None)):
    """Mean distance in mm of every other scan's points from the walls of the map that the engine
    made of the rest.

    scale: of the turns the reading saw; part: of the scans
    """
    from scipy.spatial import cKDTree
    odometry = recording.odometry(reading, scale)
    middle, clouds = unskewed(recording, odometry, part)
    mapped = slam.run(program, engine, middle[::2], np.array([binned(c) for c in clouds[::2]]),
                      np.arange(len(middle[::2])) * 0.3, reach_m=REACH_M, resolution=RESOLUTION_M)
    tree = cKDTree(mapped.walls)
    distances = []
    for k in range(1, len(clouds), 2):
        step = rawlog.between(middle[k - 1], middle[k])
        distances.append(tree.query(moved(clouds[k], after(mapped.path[k // 2], step)))[0])
    return 1e3 * float(np.concatenate(distances).mean())


def unskewed(recording, odometry, part):
    """(poses (n, 3) in the middle of each scan, [points (k, 2) seen from there]): each beam was
    sent from where the robot was at its own moment."""
    poses, clouds = [], []
    for when, far, angle in zip(recording.scan_t[part], recording.scan_range[part],
                                recording.scan_angle[part]):
        seen = np.isfinite(far)
        sent = np.array([np.interp(when[seen], recording.t_s, column) for column in odometry.T])
        middle = np.array([np.interp(0.5 * (when[seen][0] + when[seen][-1]), recording.t_s, column)
                           for column in odometry.T])
        at = sent[2] + angle[seen]
        points = sent[:2] + far[seen] * np.stack([np.cos(at), np.sin(at)])
        c, s = np.cos(middle[2]), np.sin(middle[2])
        clouds.append((points.T - middle[:2]) @ np.array([[c, -s], [s, c]]))
        poses.append(middle)
    return np.array(poses), clouds


def binned(points):
    """(BINS,) ranges at equal angles from behind: of each bin's points the one nearest to its
    middle, NaN without."""
    place = (np.arctan2(points[:, 1], points[:, 0]) + math.pi) * BINS / (2.0 * math.pi)
    bins = np.minimum(place.astype(int), BINS - 1)
    ranges_m = np.full(BINS, np.nan)
    for k in np.argsort(-np.abs(place - bins - 0.5)):
        ranges_m[bins[k]] = np.hypot(*points[k])
    return ranges_m


def moved(points, pose):
    """Points (n, 2) seen from a pose, in the frame of the pose."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


def after(pose, step):
    """A pose and a step as it is seen from there."""
    return np.array([*moved(np.array([step[:2]]), pose)[0], pose[2] + step[2]])
