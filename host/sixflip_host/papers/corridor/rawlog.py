"""Logs that MRPT's rbpf-slam reads: pairs of a movement and a laser scan.

MRPT's serialisation, little endian: a class name's length with the top bit set, the name, a
version, the fields, 0x88. The versions are those of MRPT 2.5; later ones read them. Logs of
observations only, as carmen2rawlog writes, end rbpf-slam with a crash: it looks for a movement.
"""

import gzip
import math
import struct

import numpy as np

from ... import atomic_write
from ...errors import BadFile

END = b"\x88"
TICKS = 10_000_000          # of 100 ns, as Windows counts them, from 1601
EPOCH = 116_444_736_000_000_000
BEAM_RAD = math.radians(0.25)


def write(path, odometry, scans, t_s, motion, aperture=2.0 * math.pi, reach_m=8.0):
    """Write a compressed rawlog; BadFile where there is no scan in it.

    odometry (n, 3) m, m, rad; scans (n, beams) m, NaN for no echo, each beam in the middle of
    its part of the aperture, counter-clockwise; t_s (n,); motion: the engine's idea of the
    odometry's noise, see movement()
    """
    if not len(scans) or not np.isfinite(scans).any():
        raise BadFile("%s: no scans to write, expected one with each of %d poses"
                      % (path, len(odometry)))
    log, before = [], odometry[0]
    for number, (pose, scan, t) in enumerate(zip(odometry, scans, t_s)):
        stamp = EPOCH + int(t * TICKS)
        # rbpf-slam puts beam k of N into its map at k / N of the aperture and matches it at
        # k / (N - 1). What is half a beam of turn an update cancels where every other scan
        # goes round the other way.
        other_way = number % 2 == 1
        log += [actions(movement(between(before, pose), motion, stamp)),
                frame(laser(scan, aperture, reach_m, other_way, stamp))]
        before = pose
    atomic_write.write_bytes(path, gzip.compress(b"".join(log), 1, mtime=0))


def between(pose, other):
    """(x, y, turn) of one pose seen from another."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    dx, dy = other[0] - pose[0], other[1] - pose[1]
    turn = (other[2] - pose[2] + math.pi) % (2.0 * math.pi) - math.pi
    return c * dx + s * dy, c * dy - s * dx, turn


def mrpt_object(name, version, fields):
    """One object of a class of MRPT."""
    name = name.encode()
    return bytes([len(name) | 0x80]) + name + bytes([version]) + fields + END


def actions(*moves):
    """CActionCollection."""
    return mrpt_object("CActionCollection", 0, struct.pack("<I", len(moves)) + b"".join(moves))


def frame(*observations):
    """CSensoryFrame."""
    return mrpt_object("CSensoryFrame", 2,
                 struct.pack("<I", len(observations)) + b"".join(observations))


def movement(step, motion, stamp):
    """CActionRobotMovement2D by odometry with a Gaussian model.

    motion: standard deviations a1 m/m, a2 m/rad, a3 rad/m, a4 rad/rad, and of every step m, rad
    """
    pose = mrpt_object("CPose2D", 1, struct.pack("<3d", *step))
    unused = struct.pack("<I6f", 10, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # Thrun's model
    return mrpt_object("CActionRobotMovement2D", 7, struct.pack("<I", 0) + pose
                 + struct.pack("<I6f", 0, *motion) + unused + struct.pack("<??Q", 0, 0, stamp))


def laser(scan, aperture, reach_m, other_way, stamp):
    """CObservation2DRangeScan of a lidar in the robot's middle."""
    scan = scan[::-1] if other_way else scan
    valid = np.isfinite(scan)
    pose = mrpt_object("CPose3D", 3, struct.pack("<12d", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1))
    label = b"lidar"
    return mrpt_object(
        "CObservation2DRangeScan", 7,
        struct.pack("<f?f", aperture, not other_way, reach_m) + pose + struct.pack("<I", len(scan))
        + np.where(valid, scan, 0.0).astype("<f4").tobytes() + valid.astype("u1").tobytes()
        + struct.pack("<fQf", 0.01, stamp, BEAM_RAD) + struct.pack("<I", len(label)) + label
        + struct.pack("<d?", 0.0, False))
