"""A guided session: a box on each of its six faces and turned once by 180 degrees on each, read by
an accelerometer and a gyro with misalignments."""
import numpy as np
from scipy.spatial.transform import Rotation

from sixflip.poses import faces
from sixflip_host.capture.capture import Capture

G, RATE_HZ = 9.80665, 100.0


def session(seed, accel=0.0, gyro=0.0, labels=True, rest_s=3.0, lean=0.2,
            limit_dps=500.0):
    """Capture of six faces, each laid down for about rest_s and turned once by half a turn by a
    hand that leans it on its way, by so many rad, on a table that leans; sensors that read
    (1 + accel) force, (1 + gyro) rate, this up to a limit."""
    generator = np.random.default_rng(seed)
    table = Rotation.from_rotvec(np.radians([*generator.normal(0.0, 1.0, 2), 0.0]))
    attitudes, poses = [], []
    for face in range(6):
        up = faces.SIGN[face] * np.eye(3)[faces.AXIS[face]]
        lying = Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])[0]
        for half in range(2):
            heading = generator.normal(np.pi * half, 0.01)
            attitudes.append(table * Rotation.from_rotvec([0.0, 0.0, heading]) * lying)
            poses.append(1 + 2 * face + half)
    way, labelled = [], []
    for k, (here, pose) in enumerate(zip(attitudes, poses)):
        rows = int(rest_s * generator.uniform(0.8, 1.4) * RATE_HZ)
        way += [here] * rows
        labelled += [pose] * rows
        if k + 1 < len(attitudes):
            whole = (attitudes[k + 1] * here.inv()).as_rotvec()
            leans = generator.normal(0.0, lean, 3)
            rows = int(generator.uniform(1.2, 2.2) * RATE_HZ)
            for share in (1.0 - np.cos(np.pi * np.arange(rows) / rows)) / 2.0:
                lifted = Rotation.from_rotvec(np.sin(np.pi * share) ** 2 * leans)
                way.append(lifted * Rotation.from_rotvec(share * whole) * here)
            labelled += [0] * rows
    attitude = Rotation.from_quat([x.as_quat() for x in way])
    steps = (attitude[:-1].inv() * attitude[1:]).as_rotvec() * RATE_HZ
    rate = 0.5 * (np.vstack([steps[:1], steps]) + np.vstack([steps, steps[-1:]]))
    force = attitude.inv().apply([0.0, 0.0, 1.0])
    meta = {"sensor": "mpu6050", "rate_hz": RATE_HZ, "g": G, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 65.5}
    force = force @ (np.eye(3) + accel).T + generator.normal(0.0, 0.004, force.shape)
    rate = np.degrees(rate) @ (np.eye(3) + gyro).T + generator.normal(0.0, 0.05, rate.shape)
    counts = [16384 * force, 65.5 * np.clip(rate, -limit_dps, limit_dps)]
    return Capture(meta, (np.arange(len(force)) * 1e6 / RATE_HZ).astype(np.int64),
                   *[np.clip(np.round(x), -32768, 32767).astype(np.int16) for x in counts],
                   pose=np.array(labelled, np.int16) if labels else None)
