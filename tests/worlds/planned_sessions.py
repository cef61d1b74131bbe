"""Sessions planned placement by placement: raw samples whose truth is known, and what the board
makes of them.

A second opinion in numpy: nothing of the product's simulator, no formula of its solvers. The
samples go through the real session and the board's own phases (solve, judge), see run().

    measured = A(t) (true specific force in g) + b(t), noise, whole counts; the gyro likewise
"""

import itertools
import math
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from sixflip.chips import catalogue
from sixflip.gyro import solver as gyroscope
from sixflip.poses import session as machine
from sixflip.poses.faces import AXIS, SIGN
from sixflip.record.record import Record
from sixflip_device.session.calibrate_accelerometer import calibrate_accelerometer
from sixflip_device.session.calibrate_gyro import calibrate_gyro

G = 9.80665
RATE_HZ = 100
# accelerometer LSB per g and noise mg; gyro LSB per deg/s and noise deg/s; rails, counts
CHIPS = {"mpu6050": (16384.0, 3.0, 65.5, 0.05, 32767, 32767),
         "gy85": (256.0, 4.0, 14.375, 0.1, 4095, 32767)}
MOST_TILT_DEG, SCATTER_DEG, HAND_DEG, WOBBLE_DEG = 5.0, 0.05, 0.4, 10.0


def about(axis, degrees):
    """Rotation about a vector of any length."""
    axis = np.asarray(axis, float)
    return Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis))


class Rest:
    """One placement: its face, the heading in degrees at which the box lies there, seconds.

    square  rotation of the box against its ideal face; table: the table's own; push: (second,
            deg) of a push during the rest, tap: second of a knock that changes nothing
    by      how the box comes here: "flip" flat on the table, "over" through the air
    """

    def __init__(self, face, heading, table, by):
        self.face, self.heading, self.table, self.by = face, heading, table, by
        self.seconds = 5.4
        self.square = Rotation.identity()
        self.push = self.tap = None
        self.turned = None      # deg of a flip, with its sign; None: as the headings say


class Plan:
    """seed, chip -> twelve rests in random order of faces, and the sensor's truth.

    A, b (g), Aw, bw (deg/s): as the session begins; changes: [(first sample of which rest,
    function of the SimpleNamespace of these four)]; drift(t of 0..1) -> (3,) g, (3,) deg/s
    """

    def __init__(self, seed, chip="mpu6050"):
        self.rng = rng = np.random.default_rng([seed, 190])
        self.seed, self.chip = seed, chip
        self.lsb, self.noise_mg, self.gyro_lsb, self.noise_dps, *self.rails = CHIPS[chip]
        spread = 0.01 if chip == "mpu6050" else 0.03
        crooked = about(rng.normal(size=3), rng.uniform(0, 2)).as_matrix()
        self.A = crooked @ (np.diag(rng.normal(1, spread, 3)) + rng.normal(0, 0.005, (3, 3)))
        self.b = rng.uniform(-0.08, 0.08, 3)
        self.Aw = crooked @ (np.diag(1 + rng.uniform(-0.03, 0.03, 3))
                             + rng.normal(0, 0.005, (3, 3)))
        self.bw = rng.uniform(-3, 3, 3)
        self.tilt_deg = rng.uniform(0, MOST_TILT_DEG)
        way = rng.uniform(0, 2 * np.pi)
        table = about([np.cos(way), np.sin(way), 0], self.tilt_deg)
        self.wobble_deg = rng.uniform(0.2, 1) * WOBBLE_DEG
        free = rng.uniform() < 0.3      # the heading on the next face is any
        self.rests = []
        for face in rng.permutation(6) if seed % 2 else range(6):
            heading = rng.uniform(0, 360) if free or not self.rests else None
            self.rests.append(Rest(int(face), heading, table, "over"))
            way = rng.choice([-1, 1])
            self.rests.append(Rest(int(face), None, table, "flip"))
            self.rests[-1].turned = way * (180 + rng.normal(0, HAND_DEG))
        self.changes, self.after = [], []
        self.labels = None      # changes the labels of the session's placements
        self.drift = None
        self.says = ""

    def flips(self):
        """The rests that a flip leads to."""
        return [rest for rest in self.rests if rest.by == "flip"]


def _to_top(face):
    """A rotation that brings a face's axis to the table's normal."""
    up = np.zeros(3)
    up[AXIS[face]] = SIGN[face]
    if up[2] < -0.5:
        return Rotation.from_rotvec([np.pi, 0, 0])
    return Rotation.align_vectors([[0, 0, 1.0]], [up])[0]


def _laid(plan, rest, before):
    """Attitude (body to world) of a rest; before: the attitude before it."""
    if rest.by == "flip":
        return about(rest.table.apply([0, 0, 1.0]), rest.turned) * before
    up = np.zeros(3)
    up[AXIS[rest.face]] = SIGN[rest.face]
    if rest.heading is not None:
        at = Rotation.from_euler("z", np.radians(rest.heading)) * _to_top(rest.face)
    else:   # over an edge of the box, and the hand is not exact
        was = (rest.table.inv() * before).apply(up)
        axis = np.cross(was, [0, 0, 1.0])
        if np.linalg.norm(axis) < 0.1:
            edge = np.zeros(3)
            edge[(AXIS[rest.face] + plan.rng.integers(1, 3)) % 3] = plan.rng.choice([-1, 1])
            axis = (rest.table.inv() * before).apply(edge)
            axis[2] = 0
        angle = np.degrees(np.arccos(np.clip(was[2], -1, 1)))
        at = about(axis, angle) * rest.table.inv() * before
        left = at.apply(up)
        at = Rotation.align_vectors([[0, 0, 1.0]], [left])[0] * at
        at = Rotation.from_euler("z", np.radians(plan.rng.normal(0, 4))) * at
    return rest.table * at


def _path(plan, start, end, rest, n):
    """Attitudes (n) of a move, still at both ends."""
    u = np.arange(1, n + 1) / n
    s = u ** 3 * (10 - 15 * u + 6 * u * u)
    vector = (start.inv() * end).as_rotvec()
    if rest.by == "flip":       # the way that was turned, which may be the longer one
        normal = start.inv().apply(rest.table.apply([0, 0, 1.0]))
        vector = np.radians(rest.turned) * normal
        rest_of_it = (Rotation.from_rotvec(vector).inv() * start.inv() * end).as_rotvec()
        return (start * Rotation.from_rotvec(s[:, None] * vector)
                * Rotation.from_rotvec(s[:, None] * rest_of_it))
    bump = (16 * u * u * (1 - u) ** 2)[:, None]
    size = plan.rng.normal(0, np.radians(plan.wobble_deg), (2, 3))
    aside = bump * (size[0] * np.sin(7 * u)[:, None] + size[1] * np.cos(11 * u)[:, None])
    return (start * Rotation.from_rotvec(s[:, None] * vector)
            * Rotation.from_rotvec(aside))


class Samples:
    """attitude (n) Rotation, force (n, 3) g, rate (n, 3) deg/s in the body, which rest each
    sample belongs to (rest[i], and the move to it), dt_us"""


def sample(plan):
    """The counts (n, 7) of a plan; the plan then has `states`, its sensor before and after."""
    rng = plan.rng
    attitudes, tremor, which = [], [], []
    now, meant = None, None
    for index, rest in enumerate(plan.rests):
        target = meant = _laid(plan, rest, meant if meant is not None else Rotation.identity())
        target = target * rest.square
        scatter = rng.normal(0, SCATTER_DEG, 2)
        target = Rotation.from_euler("xy", np.radians(scatter)) * target
        if now is not None:
            n = int(rng.uniform(1.6, 2.6) * RATE_HZ)
            attitudes.append(_path(plan, now, target, rest, n).as_quat())
            tremor.append(np.full(n, 0.04))
            which.append(np.full(n, index))
        n = int((rest.seconds + (2 if now is None else 0)) * RATE_HZ)
        still = np.tile(target.as_quat(), (n, 1))
        shake = np.zeros(n)
        if rest.push:
            at, degrees = int(rest.push[0] * n), rest.push[1]
            way = rng.uniform(0, 2 * np.pi)
            target = about([np.cos(way), np.sin(way), 0], degrees) * target
            still[at:] = target.as_quat()
            shake[at:at + 5] = 0.15
        if rest.tap is not None:
            shake[int(rest.tap * n):][:4] = 0.3
        attitudes.append(still)
        tremor.append(shake)
        which.append(np.full(n, index))
        now = target
    which = np.concatenate(which)
    turn = Rotation.from_quat(np.vstack(attitudes))
    force = turn.inv().apply([0, 0, 1.0])
    force += np.concatenate(tremor)[:, None] * rng.normal(size=force.shape)
    rate = np.zeros_like(force)
    rate[1:] = np.degrees((turn[:-1].inv() * turn[1:]).as_rotvec()) * RATE_HZ
    return _counts(plan, which, force, rate)


def _counts(plan, which, force, rate):
    rng = plan.rng
    now = SimpleNamespace(A=plan.A, b=plan.b, Aw=plan.Aw, bw=plan.bw)
    plan.states = [SimpleNamespace(**vars(now))]
    accel, gyro = np.empty_like(force), np.empty_like(rate)
    edges = sorted({0, *(first for first, _ in plan.changes)})
    for first, end in zip(edges, [*edges[1:], len(plan.rests)]):
        for at, change in plan.changes:
            if at == first:
                change(now)
                plan.states.append(SimpleNamespace(**vars(now)))
        rows = (which >= first) & (which < end)
        accel[rows] = force[rows] @ now.A.T + now.b
        gyro[rows] = rate[rows] @ now.Aw.T + now.bw
    if plan.drift:
        t = np.linspace(0, 1, len(accel))
        da, dw = plan.drift(t)
        accel += da
        gyro += dw
        b, bw = now.b, now.bw
        plan.states = [SimpleNamespace(A=now.A, b=b + da[i], Aw=now.Aw, bw=bw + dw[i])
                       for i in (0, len(t) // 2, -1)]
        plan.states.append(SimpleNamespace(A=now.A, b=b + da.mean(axis=0), Aw=now.Aw, bw=bw))
    out = np.zeros((len(accel), 7), int)
    out[:, 6] = -3700
    accel = (accel + rng.normal(0, plan.noise_mg / 1e3, accel.shape)) * plan.lsb
    gyro = (gyro + rng.normal(0, plan.noise_dps, gyro.shape)) * plan.gyro_lsb
    out[:, :3] = np.clip(np.rint(accel), -plan.rails[0] - 1, plan.rails[0])
    out[:, 3:6] = np.clip(np.rint(gyro), -32768, 32767)
    for change in plan.after:
        change(out, which)
    return out


class Outcome:
    """verdict, reason, error_mg, sigma_mg of the accelerometer (None when not solved); gyro,
    gyro_reason, matrix_error, matrix_sigma; refused: why the session itself did not finish"""

    def good(self):
        return self.verdict == "good"

    def beyond(self):
        """Good, and off by more than 1 mg."""
        return self.good() and not self.error_mg <= 1.0

    def wrong(self):
        """Beyond, and by more than four of its standard errors."""
        return self.beyond() and not self.error_mg <= 4 * self.sigma_mg

    def gyro_wrong(self):
        return self.gyro == "good" and not self.matrix_error <= max(0.02, 4 * self.matrix_sigma)

    def gyro_beyond(self):
        return self.gyro == "good" and not self.matrix_error <= 4 * self.matrix_sigma


def run(plan):
    """The Outcome of a plan: through the session, then phase by phase as the board does."""
    s = machine.Session(plan.lsb, plan.gyro_lsb, *plan.rails, RATE_HZ)
    period = 1000000 // RATE_HZ
    feed = s.feed
    refusals = []
    for row in sample(plan).tolist():
        event = feed(period, row)
        if event >= machine.REFUSED:
            if event != machine.REFUSED:
                break
            refusals.append(s.reason)
    return judged(plan, s, refusals)


def judged(plan, s, refusals=()):
    """What the board's phases make of a Session."""
    out = Outcome()
    out.error_mg = out.sigma_mg = out.matrix_error = out.matrix_sigma = None
    out.gyro, out.gyro_reason, out.verdict = "none", "", "refused"
    out.session = s
    missing = s.missing()
    if missing:
        out.reason = "not finished, %d missing%s" % (len(missing), "; " + refusals[-1]
                                                    if refusals else "")
        return out
    if plan.labels:
        plan.labels(s.placements)
    record = Record()
    record.chip = plan.chip
    record.accel_lsb_per_g, record.gyro_lsb_per_dps = plan.lsb, plan.gyro_lsb
    calibration = calibrate_accelerometer(s.placements, s.moves, record, None, plan.rails[0])
    calibration = calibrate_gyro(calibration, s.placements, s.moves, None,
                                 catalogue.driver(plan.chip).gyro_tolerance)
    out.verdict, out.reason = calibration.verdict, calibration.reason
    if record.accel is None or out.verdict == "refused":
        return out
    told = calibration.facts["gyro"]
    if "bias_dps" in told:
        solved = gyroscope.solve_matrix(s.placements, s.moves, plan.gyro_lsb, record.accel["P"])
        out.gyro, out.gyro_reason = told["verdict"], told["reason"]
        out.matrix_error, out.matrix_sigma = _gyro_error(plan, solved.P, solved.sigma)
    out.error_mg, out.sigma_mg = _accel_error(plan, record.accel)
    return out


def _mixed(states, matrix, offset):
    """Every sensor (matrix, offset) whose axes are each as they were at some time: a step that
    an axis makes before or after its own faces is seen by nothing."""
    for which in itertools.product(states, repeat=3):
        yield (np.array([getattr(at, matrix)[i] for i, at in enumerate(which)]),
               np.array([getattr(at, offset)[i] for i, at in enumerate(which)]))


def _accel_error(plan, section):
    """RMS over all directions of |corrected - true|, mg, for the states of the sensor's axes
    that fit best, and what the stated standard errors make of it."""
    P, sigma = np.array(section["P"], float), np.array(section["sigma_P"], float)
    C, d = P[:3, :3].T, P[3, :3] / G
    errors = [math.sqrt((((C @ A - np.eye(3)) ** 2).sum()) / 3 + ((C @ b + d) ** 2).sum())
              for A, b in _mixed(plan.states, "A", "b")]
    stated = math.sqrt((sigma[:3, :3] ** 2).sum() / 3 + ((sigma[3, :3] / G) ** 2).sum())
    return 1e3 * min(errors), 1e3 * stated


def _gyro_error(plan, P, sigma):
    """Largest element of C A - 1, and the largest standard error of C."""
    C = np.array(P, float)[:3].T
    errors = [np.abs(C @ A - np.eye(3)).max() for A, _ in _mixed(plan.states, "Aw", "bw")]
    return min(errors), np.array(sigma, float)[:3].max()
