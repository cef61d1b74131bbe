"""Sessions of a known sensor, honest ones and ones in which something goes wrong.

A second opinion: numpy alone, nothing of the product's simulator, no formula of its solver.
Every fault is one function that changes the plan of a session before it is sampled, or its
labels and counts afterwards, and every session knows its truth, so that a verdict can be held
against the error that was really made.

    measured = A (true specific force in g) + b, noise, whole counts
"""

import numpy as np

from sixflip.poses.faces import AXIS, FACES, SIGN, pose_code
from sixflip_host.capture.capture_file import Capture

G = 9.80665
POSES = [face + letter for face in FACES for letter in "ab"]
# LSB per g, noise mg, scale spread, gyro LSB per deg/s (0: none), range g
SENSORS = {"mpu6050": (16384.0, 3.3, 0.01, 65.5, 2), "adxl345": (256.0, 4.0, 0.04, 0.0, 16)}
RATE_HZ, REST, MOVE = 100, 400, 120
MOST_BIAS_MG, SCATTER_DEG, FLIP_DEG = 120.0, 0.05, 0.4


def turn(axis, degrees):
    """Rotation matrix about a vector (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    a = np.radians(degrees)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(a) * K + (1 - np.cos(a)) * K @ K


class Rest:
    """One placement: label, face it lies on, heading on the table, degrees of what is wrong."""

    def __init__(self, label, heading, table):
        self.label, self.heading, self.table = label, heading, table
        self.face = FACES.index(label[:2])
        self.square = np.eye(3)     # face of the box against the ideal one, turns with the box
        self.lean = np.zeros(2)     # deg about the table's x and y: something under this one
        self.push = None            # (share of the capture, deg about a level axis)
        self.shake = 0.0            # deg/s and 20 mg a deg/s, the box is held by hand
        self.samples = REST


class Session:
    """seed, sensor name, tilt -> the plan; `capture()` samples it. Faults change `rests`,
    `A`, `b`, `after` (a list of functions on the finished capture)."""

    def __init__(self, seed, sensor="mpu6050", tilt_deg=2.0, scatter_deg=SCATTER_DEG,
                 flip_deg=FLIP_DEG, gyro=True):
        self.rng = rng = np.random.default_rng([seed, 90210])
        self.sensor, self.tilt = sensor, tilt_deg
        self.lsb, self.noise_mg, spread, self.gyro_lsb, self.range_g = SENSORS[sensor]
        self.gyro_lsb *= gyro
        self.A = turn(rng.normal(size=3), rng.uniform(0, 2)) @ (
            np.diag(rng.normal(1, spread, 3)) + rng.normal(0, 0.005, (3, 3)))
        self.b = rng.uniform(-MOST_BIAS_MG, MOST_BIAS_MG, 3) / 1000
        self.w0 = rng.uniform(-5, 5, 3)
        self.scatter, self.flip = scatter_deg, flip_deg
        way = rng.uniform(0, 2 * np.pi)
        table = turn([np.cos(way), np.sin(way), 0], tilt_deg)
        self.rests, self.after = [], []
        for face in FACES:
            heading = rng.uniform(0, 360)
            self.rests.append(Rest(face + "a", heading, table))
            self.rests.append(Rest(face + "b", heading + 180 + rng.normal(0, flip_deg), table))

    def at(self, label):
        """The first placement with this label."""
        return next(rest for rest in self.rests if rest.label == label)

    def force(self, rest):
        """(n, 3) specific force in box axes while the box rests, g."""
        up = np.array([0, 0, 1.0])
        lean = rest.lean + self.rng.normal(0, self.scatter, 2)
        normal = turn([1, 0, 0], lean[0]) @ turn([0, 1, 0], lean[1]) @ rest.table.T @ up
        out = np.tile(self._in_box(rest, normal), (rest.samples, 1))
        if rest.push:
            share, degrees = rest.push
            way = self.rng.uniform(0, 2 * np.pi)
            pushed = turn([np.cos(way), np.sin(way), 0], degrees) @ normal
            out[int(share * rest.samples):] = self._in_box(rest, pushed)
        if rest.shake:
            t = np.arange(rest.samples)[:, None] / RATE_HZ
            phase = self.rng.uniform(0, 6, 3)
            out = out + 0.02 * rest.shake * np.sin(2 * np.pi * 3 * t + phase)
        return out

    def _in_box(self, rest, on_table):
        """A direction given in the axes of the table's top, in the axes of the box."""
        k, sign = AXIS[rest.face], SIGN[rest.face]
        x, y, z = turn([0, 0, 1], -rest.heading) @ on_table
        out = np.zeros(3)
        out[k], out[(k + 1) % 3], out[(k + 2) % 3] = sign * z, x, sign * y
        return rest.square @ out

    def capture(self):
        """The Capture of the session; labels as the operator gave them."""
        rng, force, pose, rate = self.rng, [], [], []
        previous = before = None
        for rest in self.rests:
            here = self.force(rest)
            if previous is not None:
                s = np.linspace(0, 1, MOVE)[:, None]
                force.append(previous * (1 - s) + here[0] * s + rng.normal(0, 0.1, (MOVE, 3)))
                rate.append(rng.normal(0, 60, (MOVE, 3)))
                if rest.face == before.face:
                    turned = (rest.heading - before.heading + 180) % 360 - 180
                    rate[-1][:] = 0
                    rate[-1][:, AXIS[rest.face]] = SIGN[rest.face] * turned * RATE_HZ / MOVE
                pose.append(np.zeros(MOVE, np.int16))
            force.append(here)
            rate.append(np.zeros_like(here) + rest.shake)
            pose.append(np.full(len(here), pose_code(rest.label), np.int16))
            previous, before = here[-1], rest
        force, rate = np.vstack(force), np.vstack(rate)
        clean = force @ self.A.T + self.b + rng.normal(0, self.noise_mg / 1e3, force.shape)
        accel = _counts(clean * self.lsb, min(32767, self.range_g * self.lsb - 1))
        gyro = None
        meta = {"sensor": self.sensor, "rate_hz": RATE_HZ, "g": G, "accel_lsb_per_g": self.lsb,
                "accel_range_g": self.range_g}
        if self.gyro_lsb:
            meta.update(gyro_lsb_per_dps=self.gyro_lsb, gyro_range_dps=500)
            gyro = _counts((rate + self.w0 + rng.normal(0, 0.1, rate.shape)) * self.gyro_lsb,
                           32767)
        t_us = np.arange(len(accel), dtype=np.int64) * (1000000 // RATE_HZ)
        capture = Capture(meta, t_us, accel, gyro, pose=np.concatenate(pose))
        for change in self.after:
            change(capture)
        return capture

    def error_mg(self, P):
        """RMS over all directions of |corrected - true|, mg; P 4 x 4 for m/s² as solved."""
        P = np.asarray(P, float)
        C, d = P[:3, :3].T, P[3, :3] / G
        E = C @ self.A - np.eye(3)
        return 1e3 * float(np.sqrt((E ** 2).sum() / 3 + ((C @ self.b + d) ** 2).sum()))

    def truth(self):
        """P 4 x 4 that undoes the sensor, its scale [3] and v [3] in m/s² (Li Eq. 5)."""
        C = np.linalg.inv(self.A)
        P = np.eye(4)
        P[:3, :3], P[3, :3] = C.T, -C @ self.b * G
        return P, np.diag(C).copy(), -self.b * G


def _counts(values, most):
    return np.clip(np.rint(values), -most - 1, most).astype(np.int16)


# -- what can go wrong: fault(session, where, size), where an index into what it says


def none(session, where=0, size=0):
    """Nothing: an honest session."""


def pose_missing(session, where, size=0):
    """One of the twelve was forgotten."""
    del session.rests[where % 12]


def face_missing(session, where, size=0):
    """One of the six was forgotten."""
    face = where % 6
    session.rests = [rest for rest in session.rests if rest.face != face]


def swapped(session, where, size=0):
    """Two labels exchanged, any of the 60 pairs on different faces."""
    pairs = [(i, j) for i in range(12) for j in range(i) if i // 2 != j // 2]
    i, j = pairs[where % len(pairs)]
    one, other = session.rests[i], session.rests[j]
    one.label, other.label = other.label, one.label


def letters_swapped(session, where, size=0):
    """a and b of one face exchanged: harmless, either may come first."""
    one, other = session.rests[2 * (where % 6):][:2]
    one.label, other.label = other.label, one.label


def mislabelled(session, where, size=0):
    """One capture has another's label, any of 12 x 11."""
    one = session.rests[where % 12]
    one.label = [label for label in POSES if label != one.label][where // 12 % 11]


def extra_mislabelled(session, where, size=0):
    """A thirteenth capture with a wrong letter or face: any of 12 x 11."""
    first = session.rests[where % 12]
    again = Rest(first.label, first.heading, first.table)
    again.label = [label for label in POSES if label != first.label][where // 12 % 11]
    session.rests.append(again)


def crooked(session, where, size=8.0):
    """A face of the box is not square: what sticks to it turns with the box."""
    way = session.rng.uniform(0, 2 * np.pi)
    face = where % 6
    axis = np.zeros(3)
    axis[(AXIS[face] + 1) % 3], axis[(AXIS[face] + 2) % 3] = np.cos(way), np.sin(way)
    for rest in session.rests:
        if rest.face == face:
            rest.square = turn(axis, size)


def crooked_pair(session, where, size=8.0):
    """Two faces at once, not opposite ones, each crooked in its own direction."""
    crooked(session, where, size)
    crooked(session, ((where % 6 // 2 + 1 + where // 6 % 2) * 2 + where // 12 % 2) % 6, size)


def lozenge(session, where, size=8.0):
    """Two opposite faces, parallel to each other and crooked to all others."""
    crooked(session, where, size)
    square = session.at(FACES[where % 6] + "a").square
    for rest in session.rests:
        if rest.face == where % 6 ^ 1:
            rest.square = square


def leaning(session, where, size=1.0):
    """Something lies under one single capture."""
    way = session.rng.uniform(0, 2 * np.pi)
    session.rests[where % 12].lean = size * np.array([np.cos(way), np.sin(way)])


def pushed(session, where, size=1.0):
    """The box is pushed over by some angle while it is captured."""
    session.rests[where % 12].push = (session.rng.uniform(0.1, 0.9), size)


def turned(session, where, size=0.0):
    """A flip by `size` degrees instead of 180, on one face."""
    one, other = session.rests[2 * (where % 6):][:2]
    other.heading = one.heading + size + session.rng.normal(0, session.flip)


def all_turned(session, where, size=0.0):
    """Every flip by `size` degrees instead of 180."""
    for face in range(6):
        turned(session, face, size)


def table_moved(session, where, size=1.0):
    """The table tilts otherwise from some capture on."""
    way = session.rng.uniform(0, 2 * np.pi)
    table = turn([np.cos(way), np.sin(way), 0], size) @ session.rests[0].table
    for rest in session.rests[1 + where % 11:]:
        rest.table = table


def inverted(session, where, size=0):
    """One, two or three axes are turned round: seven ways."""
    signs = [-1.0 if (where % 7 + 1) >> k & 1 else 1.0 for k in range(3)]
    session.A, session.b = np.diag(signs) @ session.A, np.diag(signs) @ session.b


def exchanged(session, where, size=0):
    """Axes in another order: five ways."""
    order = [(1, 0, 2), (0, 2, 1), (2, 1, 0), (1, 2, 0), (2, 0, 1)][where % 5]
    session.A, session.b = session.A[list(order)], session.b[list(order)]


def wrong_range(session, where, size=2.0):
    """The header claims a range that the chip does not have."""
    factor = (size, 1 / size)[where % 2]
    session.after.append(lambda capture: capture.meta.update(
        accel_lsb_per_g=capture.meta["accel_lsb_per_g"] * factor,
        accel_range_g=capture.meta["accel_range_g"] / factor))


def _rows(capture, where):
    """First and last sample of one of the twelve."""
    rows = np.flatnonzero(capture.pose == where % 12 + 1)
    return rows[0], rows[-1] + 1


def stale(session, where, size=0):
    """The sensor hangs in one capture, all axes or (where >= 12) one of them."""
    def change(capture):
        first, end = _rows(capture, where)
        axes = slice(None) if where % 48 < 12 else (where // 12 - 1) % 3
        capture.accel[first:end, axes] = capture.accel[first, axes]
    session.after.append(change)


def saturated(session, where, size=0):
    """Full scale on the axis of gravity in one capture."""
    def change(capture):
        first, end = _rows(capture, where)
        face = where % 12 // 2
        most = min(32767, session.range_g * session.lsb - 1)
        capture.accel[first:end, AXIS[face]] = SIGN[face] * most
    session.after.append(change)


def spikes(session, where, size=2.0):
    """Torn reads: now and then a count of a capture is far off, by `size` g."""
    def change(capture):
        first, end = _rows(capture, where)
        at = session.rng.integers(first, end, 8)
        capture.accel[at, where % 3] = _counts(size * session.lsb, 32767)
    session.after.append(change)


def shaken(session, where, size=1.0):
    """The box was held by hand in one capture."""
    session.rests[where % 12].shake = size


def warmed(session, where, size=20.0):
    """The bias creeps by `size` mg from the first capture to the last, b in the middle."""
    def change(capture):
        creep = np.linspace(-0.5, 0.5, len(capture.accel)) * size / 1e3 * session.lsb
        capture.accel[:, where % 3] += np.rint(creep).astype(np.int16)
    session.after.append(change)
