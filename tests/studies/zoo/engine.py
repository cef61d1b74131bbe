"""Motions out of MuJoCo: a box that is turned over by hand, and a rover that drives and stops.

Knows neither the diagnosis nor the simulator of this project: what it returns is the engine's own
accelerometer and gyro (and velocity and attitude, for the defects to be made of).
"""
from dataclasses import dataclass

import mujoco
import numpy as np

STEP_S = 0.001
GRAVITY = 9.80665
SITES = """<site name="imu" pos="0 0 0"/><site name="arm" pos="0.04 -0.015 0.02"/>"""
SENSORS = "".join(
    '<accelerometer site="%s"/><gyro site="%s"/><framelinvel objtype="site" objname="%s"/>'
    '<framequat objtype="site" objname="%s"/>' % ((s,) * 4) for s in ("imu", "arm"))
BOX = """<mujoco><option timestep="%g" gravity="0 0 %g" integrator="implicitfast"/><worldbody>
<body name="hand" mocap="true" pos="0 0 0.5"/>
<body name="box" pos="0 0 0.5"><freejoint/>
<geom type="box" size=".03 .02 .012" mass=".08" contype="0" conaffinity="0"/>%s</body></worldbody>
<equality><weld body1="hand" body2="box" solref="0.02 1"/></equality>
<sensor>%s</sensor></mujoco>""" % (STEP_S, -GRAVITY, SITES, SENSORS)
WHEEL = """<body pos="%g %g -0.03"><joint type="slide" axis="0 0 1" stiffness="900" damping="25"/>
<geom type="box" size="0.01 0.01 0.01" mass="0.05" contype="0" conaffinity="0"/>
<body><joint name="%s" type="hinge" axis="0 1 0" damping="0.02"/>
<geom type="sphere" size="0.05" mass="0.1" friction="%g 0.01 0.001"/></body></body>"""
ROVER = """<mujoco><option timestep="%g" gravity="0 0 %g" integrator="implicitfast"/>
<worldbody><geom type="plane" size="50 50 1"/>%%s
<body name="chassis" pos="0 0 0.085"><freejoint/>
<geom type="box" size="0.15 0.1 0.03" mass="2"/>%s%s</body></worldbody>
<actuator><velocity joint="fl" kv="0.4"/><velocity joint="fr" kv="0.4"/>
<velocity joint="rl" kv="0.4"/><velocity joint="rr" kv="0.4"/></actuator>
<sensor>%s</sensor></mujoco>""" % (
    STEP_S, -GRAVITY, SITES,
    "".join(WHEEL % (x, y, n, f) for n, x, y, f in (
        ("fl", 0.1, 0.13, 1.0), ("fr", 0.1, -0.13, 1.0), ("rl", -0.1, 0.13, 0.5),
        ("rr", -0.1, -0.13, 0.5))), SENSORS)
UP = {"Z+": (0, 0, 1), "Z-": (0, 0, -1), "X+": (1, 0, 0), "X-": (-1, 0, 0), "Y+": (0, 1, 0),
      "Y-": (0, -1, 0)}


@dataclass(frozen=True)
class Motion:
    """t (n,) s; of the point that is looked at: force (n, 3) m/s2 and rate (n, 3) rad/s in the
    body, velocity (n, 3) m/s in the world, turn (n, 3, 3) body to world; centre_force (n, 3):
    what the body's centre feels; labels: [(name, first, end)] of samples."""

    t: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    velocity: np.ndarray
    turn: np.ndarray
    centre_force: np.ndarray
    labels: tuple

    def every(self, k):
        """Every k-th sample of it."""
        return Motion(*(x[::k] for x in (self.t, self.force, self.rate, self.velocity, self.turn,
                                         self.centre_force)),
                      tuple((n, -(-a // k), b // k) for n, a, b in self.labels))


def motion(model, commands, site, labels=()):
    """Run the model; commands: function(step, data) that sets what drives it."""
    data = mujoco.MjData(model)
    count = commands.count
    rows = np.empty((count, 26))
    for i in range(count):
        commands(i, data)
        mujoco.mj_step(model, data)
        rows[i] = data.sensordata
    centre, arm = rows[:, :13], rows[:, 13:]
    own = arm if site == "arm" else centre
    q = own[:, 9:13]
    return Motion(np.arange(count) * STEP_S, own[:, :3], own[:, 3:6], own[:, 6:9], rotations(q),
                  centre[:, :3], tuple(labels))


def rotations(q):
    """(n, 3, 3) from quaternions (n, 4), w first."""
    w, x, y, z = q.T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1)], -2)


class Hand:
    """Places where a box is held, and smooth ways between them; swings on the way."""

    def __init__(self, seed, quick):
        rng = self.rng = np.random.default_rng(seed)
        self.rest_s, self.move_s = (2.0, 1.2) if quick else (4.0, 2.0)
        self.q, self.p, self.labels = [], [], []
        self.at = np.array([1.0, 0.0, 0.0, 0.0])
        self.place = np.array([0.0, 0.0, 0.5])
        faces = list(UP)
        rng.shuffle(faces)
        self.rest("Z+a")
        for face in faces:
            self.go(towards(np.array(UP[face], float), rng.uniform(-0.5, 0.5)))
            self.rest(face + "a")
            self.go(turned(self.at, np.array(UP[face], float),
                           np.pi * rng.choice([-1.0, 1.0])), flat=True)
            self.rest(face + "b")
        for number in range(4 if quick else 8):
            v = rng.normal(size=3)
            self.go(towards(v / np.linalg.norm(v), rng.uniform(-3.0, 3.0)))
            self.rest("L%d" % (number + 1))
        self.swing(6.0)
        self.go(towards(np.array([0.0, 0.0, 1.0]), 0.0))
        self.rest("Z+a")
        self.quaternion, self.position = np.concatenate(self.q), np.concatenate(self.p)
        self.count = len(self.quaternion)

    def add(self, q, p):
        self.q.append(q)
        self.p.append(p)
        self.at, self.place = q[-1], p[-1]

    def rest(self, name):
        n = int(self.rest_s / STEP_S)
        first = sum(len(x) for x in self.q)
        # The weld needs a moment to settle; nobody would label the place before that.
        self.labels.append((name, first + 300, first + n - 20))
        self.add(np.repeat(self.at[None], n, 0), np.repeat(self.place[None], n, 0))

    def go(self, q, flat=False):
        n = int(self.move_s * self.rng.uniform(0.9, 1.4) / STEP_S)
        s = np.linspace(0.0, 1.0, n)
        s = s ** 3 * (10 - 15 * s + 6 * s * s)  # no jerk at the ends
        there = self.place + self.rng.uniform(-0.1, 0.1, 3) * (1, 1, 0)
        lift = 0.0 if flat else self.rng.uniform(0.05, 0.15)
        p = self.place + s[:, None] * (there - self.place)
        p[:, 2] += lift * np.sin(np.pi * s) ** 2
        self.add(slerp(self.at, q, s), p)

    def swing(self, seconds):
        n = int(seconds / STEP_S)
        t = np.arange(n) * STEP_S
        fade = np.sin(np.pi * t / seconds) ** 2
        axis, other = self.rng.normal(size=(2, 3))
        angle = fade * 1.2 * np.sin(2 * np.pi * self.rng.uniform(0.8, 1.3) * t)
        q = np.array([turned(turned(self.at, axis, a), other, 0.6 * b) for a, b in zip(
            angle, fade * np.sin(2 * np.pi * 0.7 * t))])
        p = self.place + fade[:, None] * 0.08 * np.sin(
            2 * np.pi * self.rng.uniform(0.5, 1.0, 3) * t[:, None])
        self.add(q, p)

    def __call__(self, i, data):
        data.mocap_quat[0], data.mocap_pos[0] = self.quaternion[i], self.position[i]


def times(a, b):
    """The product of two quaternions."""
    w, v = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[w], v])


def turned(q, axis, angle):
    """q, then a turn about an axis of the body."""
    axis = axis / np.linalg.norm(axis)
    return times(q, np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * axis]))


def towards(up, heading):
    """A quaternion (body to world) with an axis of the body upwards."""
    z = np.array([0.0, 0.0, 1.0])
    axis, cosine = np.cross(up, z), up @ z
    if cosine < -0.999999:
        q = np.array([0.0, 1.0, 0.0, 0.0])
    else:
        q = np.concatenate([[1.0 + cosine], axis])
        q /= np.linalg.norm(q)
    return times(np.array([np.cos(heading / 2), 0, 0, np.sin(heading / 2)]), q)


def slerp(a, b, s):
    """(n, 4) on the shorter way from a to b."""
    cosine = a @ b
    if cosine < 0:
        b, cosine = -b, -cosine
    angle = np.arccos(np.clip(cosine, -1, 1))
    if angle < 1e-6:
        return np.repeat(a[None], len(s), 0)
    q = (np.sin((1 - s) * angle)[:, None] * a + np.sin(s * angle)[:, None] * b) / np.sin(angle)
    return q / np.linalg.norm(q, axis=1)[:, None]


def box(seed, site="imu", quick=False):
    """A box on its six faces with flips, leaning, swung: two or three minutes at 1 kHz."""
    hand = Hand(seed, quick)
    model = mujoco.MjModel.from_xml_string(BOX)
    return motion(model, hand, site, hand.labels)


class Drive:
    """Speeds of the wheels: drives, turns and stops."""

    def __init__(self, seed, seconds):
        rng = np.random.default_rng(seed)
        self.count = int(seconds / STEP_S)
        self.speed = np.zeros((self.count, 2))
        at = int(4.0 / STEP_S)
        while at < self.count - 9.0 / STEP_S:
            n = int(rng.uniform(1.5, 3.5) / STEP_S)
            forward, turn = rng.uniform(-6.0, 12.0), rng.uniform(-5.0, 5.0)
            s = np.sin(np.pi * np.linspace(0.0, 1.0, n))[:, None] ** 0.7
            self.speed[at:at + n] = s * (forward - turn, forward + turn)
            at += n
            if rng.random() < 0.4:
                at += int(rng.uniform(2.0, 3.5) / STEP_S)

    def __call__(self, i, data):
        left, right = self.speed[i]
        data.ctrl[:] = left, right, left, right


def rover(seed, site="imu", seconds=60.0):
    """A rover with four wheels over a floor with bumps and a slope, with stops."""
    rng = np.random.default_rng(seed + 7919)
    bumps = "".join(
        '<geom type="box" size="%g 0.6 %g" pos="%g %g 0" euler="%g %g %g"/>' % (
            rng.uniform(0.1, 0.5), rng.uniform(0.004, 0.012), rng.uniform(-4, 4),
            rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(0, 180))
        for _ in range(40))
    model = mujoco.MjModel.from_xml_string(ROVER % bumps)
    return motion(model, Drive(seed, seconds), site)
