"""A box moved by hand, in numpy: sessions with a known sensor, as captures.

Rests are attitudes C (body axes as columns in the world's frame, world z up); a move turns from
one to the next along the shortest way with a wobble on top, starting and ending at rest.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from sixflip.poses.faces import AXIS, SIGN, pose_code
from sixflip_host.capture.capture_file import Capture

LSB_G, LSB_DPS, G = 16384.0, 65.5, 9.80665
RAD = np.pi / 180


class Sensor:
    """measured = K true + b: K (3, 3), b in g or deg/s; per_g (3, 3) deg/s a g of force."""

    def __init__(self, seed, noise_mg=3.0, noise_dps=0.1, per_g=None):
        rng = np.random.default_rng([seed, 7])
        self.K = np.eye(3) + rng.normal(0, 0.01, (3, 3))
        self.b = rng.normal(0, 0.04, 3)
        self.Kw = np.eye(3) + rng.normal(0, 0.01, (3, 3))
        self.bw = rng.normal(0, 1.5, 3)
        self.per_g = np.zeros((3, 3)) if per_g is None else np.asarray(per_g)
        self.noise_g, self.noise_dps = noise_mg * 1e-3, noise_dps

    def counts(self, force, rate, rng):
        """force (n, 3) g, rate (n, 3) rad/s -> int16 accel and gyro."""
        a = force @ self.K.T + self.b + rng.normal(0, self.noise_g, force.shape)
        w = (rate / RAD) @ self.Kw.T + self.bw + force @ self.per_g.T
        w = w + rng.normal(0, self.noise_dps, rate.shape)
        clip = lambda v: np.clip(np.rint(v), -32768, 32767).astype(np.int16)
        return clip(a * LSB_G), clip(w * LSB_DPS)

    def vector_error_mg(self, A, o):
        """RMS over all directions of |A (K f + b) + o - f|, mg. A (3, 3), o (3,) g."""
        E = A @ self.K - np.eye(3)
        e = A @ self.b + o
        return 1e3 * np.sqrt(np.sum(E**2) / 3 + e @ e)


def face_attitude(face, heading, tilt):
    """Face's axis up on a table tilted by the rotation `tilt`, turned by heading (rad)."""
    up = np.zeros(3)
    up[AXIS[face]] = SIGN[face]
    to_z = Rotation.align_vectors([[0, 0, 1.0]], [up])[0]
    return tilt * Rotation.from_euler("z", heading) * to_z


def six_faces(seed, tilt_deg=2.0, flip_error_deg=0.0, scatter_deg=0.0, hand_deg=0.0):
    """[(label, Rotation)] of the paper's session: every face, then the same face flipped."""
    rng = np.random.default_rng([seed, 3])
    direction = rng.uniform(0, 2 * np.pi)
    tilt = Rotation.from_rotvec(
        tilt_deg * RAD * np.array([np.cos(direction), np.sin(direction), 0.0])
    )
    out = []
    for face, name in enumerate(("Z+", "Z-", "X+", "X-", "Y+", "Y-")):
        heading = rng.uniform(0, 2 * np.pi)
        turn = np.pi + (flip_error_deg + rng.normal(0, 1) * hand_deg) * RAD
        for letter, at in (("a", heading), ("b", heading + turn)):
            shake = Rotation.from_rotvec(rng.normal(0, scatter_deg * RAD, 3) * [1, 1, 0])
            out.append((name + letter, shake * face_attitude(face, at, tilt)))
    return out


def free_poses(seed, n):
    """n attitudes spread over all directions."""
    rotations = Rotation.random(n, random_state=seed)
    return [("L%d" % (k + 1), rotations[k]) for k in range(n)]


def move(start, end, n, rate_hz, rng, wobble_deg):
    """Attitudes (n,) from start to end, smooth, and body rates (n, 3)."""
    vector = (start.inv() * end).as_rotvec()
    amplitude = rng.normal(0, wobble_deg * RAD, (2, 3))

    def at(seconds):
        u = np.clip(seconds * rate_hz / (n - 1), 0, 1)[:, None]
        smooth = u**3 * (10 - 15 * u + 6 * u * u)
        bump = (16 * u * u * (1 - u) ** 2) ** 2
        aside = bump * (amplitude[0] * np.sin(7 * u) + amplitude[1] * np.cos(11 * u))
        return start * Rotation.from_rotvec(smooth * vector) * Rotation.from_rotvec(aside)

    t = np.arange(n) / rate_hz
    h = 1e-4
    rates = (at(t - h).inv() * at(t + h)).as_rotvec() / (2 * h)
    return at(t), rates


def session(sensor, poses, seed, rest_s=4.0, move_s=2.5, rate_hz=100.0, wobble_deg=15.0,
            labels=True, gyro=True):
    """Capture of the poses [(label, Rotation)] with hand moves between them."""
    rng = np.random.default_rng([seed, 11])
    force, rate, pose = [], [], []
    previous = None
    for label, attitude in poses:
        if previous is not None:
            path, w = move(previous, attitude, int(move_s * rate_hz), rate_hz, rng, wobble_deg)
            force.append(path.inv().apply([0, 0, 1.0]))
            rate.append(w)
            pose.append(np.zeros(len(w), dtype=np.int16))
        n = int(rest_s * rate_hz)
        force.append(np.tile(attitude.inv().apply([0, 0, 1.0]), (n, 1)))
        rate.append(np.zeros((n, 3)))
        pose.append(np.full(n, pose_code(label), dtype=np.int16))
        previous = attitude
    accel, turn = sensor.counts(np.vstack(force), np.vstack(rate), rng)
    t_us = np.rint(np.arange(len(accel)) * 1e6 / rate_hz).astype(np.int64)
    meta = {"sensor": "mpu6050", "rate_hz": rate_hz, "g": G, "accel_lsb_per_g": LSB_G,
            "gyro_lsb_per_dps": LSB_DPS, "gyro_range_dps": 500}
    return Capture(meta, t_us, accel, turn if gyro else None,
                   pose=np.concatenate(pose) if labels else None)


def on_the_floor(ramp=True, turned_deg=180.3):
    """Poses of a vehicle: rests on an uneven floor, turned on the spot, a ramp both ways."""
    floor = Rotation.from_rotvec(np.radians([0.4, 0.3, 0.0]))

    def at(heading, pitch):
        return floor * Rotation.from_euler("ZY", [heading, pitch], degrees=True)

    poses = [("Z+a", at(0, 0)), ("Z+b", at(turned_deg, 0)), ("Z+a", at(0.2, 0))]
    if ramp:
        poses += [("L1", at(5, -10)), ("L2", at(184, 10)), ("L3", at(3, -10))]
    return poses
