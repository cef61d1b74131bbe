"""A person who calibrates and makes one mistake, or a chip that does: raw samples, truth known.

A second opinion in numpy: nothing of the product's simulator, no formula of its solvers. The
samples go through the real session and the board's own phases (solve, judge), see run().

    measured = A(t) (true specific force in g) + b(t), noise, whole counts; the gyro likewise

A mistake is a function that changes the plan of a session (`Plan`) before it is sampled, or
its counts afterwards (`after`).
"""

import itertools
import math
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from sixflip.chips import catalogue
from sixflip.gyro import solver as gyroscope
from sixflip.poses import session as machine
from sixflip.poses.faces import AXIS, FACES, SIGN
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


# -- what can go wrong: mistake(plan), drawn from plan.rng; says: what was done, for the list


def none(plan):
    """Nothing goes wrong."""


def one_flip_short(plan):
    """One flip is by some other angle."""
    rest = plan.rng.choice(plan.flips())
    rest.turned = math.copysign(plan.rng.uniform(141, 219), rest.turned)
    plan.says = "%s by %.0f" % (FACES[rest.face], rest.turned)


def one_flip_170(plan):
    """One flip is by 170 degrees."""
    rest = plan.rng.choice(plan.flips())
    rest.turned = math.copysign(170, rest.turned)


def all_flips_alike(plan):
    """Every flip is by the same wrong angle, either way round."""
    angle = plan.rng.choice([-1, 1]) * plan.rng.uniform(1, 40)
    if plan.rng.uniform() < 0.5:
        angle /= 5      # near half a turn is where it is hard
    for rest in plan.flips():
        rest.turned = math.copysign(180 + angle + plan.rng.normal(0, HAND_DEG), rest.turned)
    plan.says = "by %.1f" % (180 + angle)


def hand_errors(plan):
    """Every flip is off by the hand of somebody who does not look."""
    size = plan.rng.uniform(1, 5)
    for rest in plan.flips():
        off = np.clip(plan.rng.normal(0, size), -10, 10)
        rest.turned = math.copysign(180 + off, rest.turned)
    plan.says = "by %.1f" % size


def wrong_axis(plan):
    """A flip is made over an edge: the box comes to lie on another face, or on its own again."""
    rest = plan.rng.choice(plan.flips())
    rest.by = "over"
    if plan.rng.uniform() < 0.5:
        rest.face = int((rest.face & ~1) + plan.rng.integers(2, 6)) % 6
    plan.says = "onto %s" % FACES[rest.face]


def nudged_table(plan):
    """The table's tilt changes between two poses."""
    first = int(plan.rng.integers(1, 12))
    size = 10 ** plan.rng.uniform(-1.3, 0.7)
    way = plan.rng.uniform(0, 2 * np.pi)
    for rest in plan.rests[first:]:
        rest.table = about([np.cos(way), np.sin(way), 0], size) * rest.table
    plan.says = "%.2f deg at pose %d" % (size, first)


def pushed(plan):
    """The box is pushed over a little while it is captured."""
    rest = plan.rng.choice(plan.rests)
    rest.push = (plan.rng.uniform(0.1, 0.9), 10 ** plan.rng.uniform(-1.3, 1))
    plan.says = "%.2f deg" % rest.push[1]


def tap(plan):
    """Somebody knocks at the table."""
    for rest in plan.rng.choice(plan.rests, 3):
        rest.tap = plan.rng.uniform(0.1, 0.8)
        rest.seconds += 5


def _parted(plan, first):
    """Whether a step before pose `first` parts every pair of opposite faces: it is a scale and
    a misalignment then, and no residual knows (paired orders, as the guide's, never do that)."""
    return first == 6 and len({rest.face // 2 for rest in plan.rests[:6]}) == 3


def _at(plan):
    first = int(plan.rng.integers(1, 12))
    return 5 if _parted(plan, first) else first


def parted_step(plan):
    """The accelerometer's offset jumps when one face of each pair is done."""
    for half in (plan.rests[:6], plan.rests[6:]):
        for index, rest in enumerate(half):
            rest.face = 2 * (index // 2) + (half[0] is not plan.rests[0])
    offset_step(plan, 6)


def offset_step(plan, first=None):
    """The accelerometer's offset jumps between two poses."""
    first, size = first or _at(plan), 10 ** plan.rng.uniform(0, 1.7)
    vector = plan.rng.normal(size=3) if plan.rng.uniform() < 0.5 else np.eye(3)[
        plan.rng.integers(3)]
    vector = 1e-3 * size * vector / np.linalg.norm(vector)

    def change(now):
        now.b = now.b + vector
    plan.changes.append((first, change))
    plan.says = "%.1f mg at pose %d" % (size, first)


def scale_step(plan):
    """The accelerometer's scale jumps between two poses."""
    first, size = _at(plan), 10 ** plan.rng.uniform(-3, -1.3)
    axes = np.ones(3) if plan.rng.uniform() < 0.5 else np.eye(3)[plan.rng.integers(3)]

    def change(now):
        now.A = np.diag(1 + size * axes) @ now.A
    plan.changes.append((first, change))
    plan.says = "%.1f mg/g at pose %d" % (1e3 * size, first)


def gyro_offset_step(plan):
    """The gyro's offset jumps between two poses."""
    first, size = _at(plan), 10 ** plan.rng.uniform(-1, 0.7)
    vector = size * np.eye(3)[plan.rng.integers(3)]

    def change(now):
        now.bw = now.bw + vector
    plan.changes.append((first, change))
    plan.says = "%.2f deg/s at pose %d" % (size, first)


def gyro_scale_step(plan):
    """The gyro's scale jumps between two poses."""
    first, size = _at(plan), plan.rng.choice([-1, 1]) * 10 ** plan.rng.uniform(-2.5, -0.9)
    axes = np.ones(3) if plan.rng.uniform() < 0.5 else np.eye(3)[plan.rng.integers(3)]

    def change(now):
        now.Aw = np.diag(1 + size * axes) @ now.Aw
    plan.changes.append((first, change))
    plan.says = "%.1f %% at pose %d" % (100 * size, first)


def creep(plan):
    """The accelerometer's offset creeps all the while."""
    vector = plan.rng.normal(size=3)
    vector *= 1e-3 * 10 ** plan.rng.uniform(0, 1.5) / np.linalg.norm(vector)
    plan.drift = lambda t: (t[:, None] * vector, 0 * t[:, None] * vector)
    plan.says = "%.1f mg" % (1e3 * np.linalg.norm(vector))


def warm_up(plan):
    """Both chips' offsets follow their temperature as it settles."""
    accel, gyro = plan.rng.normal(size=3), plan.rng.normal(size=3)
    accel *= 1e-3 * 10 ** plan.rng.uniform(0, 1.5) / np.linalg.norm(accel)
    share = plan.rng.uniform(0.1, 1)
    plan.drift = lambda t: ((1 - np.exp(-t / share))[:, None] * accel,
                            (1 - np.exp(-t / share))[:, None] * gyro)
    plan.says = "%.1f mg" % (1e3 * np.linalg.norm(accel))


def byte_swaps(plan):
    """Now and then the two bytes of a reading are exchanged."""
    share = 10 ** plan.rng.uniform(-4, -2)

    def change(counts, which):
        hit = plan.rng.uniform(size=(len(counts), 6)) < share
        raw = counts[:, :6].astype(np.int16)
        counts[:, :6] = np.where(hit, raw.byteswap(), raw)
    plan.after.append(change)
    plan.says = "%.2g of readings" % share


def mislabelled(plan):
    """Two captures on different faces have each other's label."""
    def relabel(placements):
        faces = plan.rng.choice(6, 2, replace=False)
        one, other = (next(p for p in placements if p.pose in (2 * face + 1, 2 * face + 2))
                      for face in faces)
        one.pose, other.pose = other.pose, one.pose
    plan.labels = relabel


def crooked_face(plan):
    """A face of the box is out of square."""
    face = int(plan.rng.integers(6))
    axis = np.zeros(3)
    way = plan.rng.uniform(0, 2 * np.pi)
    axis[(AXIS[face] + 1) % 3], axis[(AXIS[face] + 2) % 3] = np.cos(way), np.sin(way)
    size = 10 ** plan.rng.uniform(-1, 0.7)
    for rest in plan.rests:
        if rest.face == face:
            rest.square = about(axis, size)
    plan.says = "%.2f deg" % size


MISTAKES = (
    ("nothing", none), ("one flip by 170", one_flip_170), ("one flip by any angle",
                                                          one_flip_short),
    ("all flips alike by a wrong angle", all_flips_alike), ("hand errors up to 10", hand_errors),
    ("turned about the wrong axis", wrong_axis), ("table nudged", nudged_table),
    ("pushed", pushed), ("knocked at", tap), ("offset step", offset_step),
    ("scale step", scale_step), ("gyro offset step", gyro_offset_step),
    ("gyro scale step", gyro_scale_step), ("creep", creep), ("warm-up", warm_up),
    ("byte swaps", byte_swaps), ("two captures mislabelled", mislabelled),
    ("offset step that parts every pair", parted_step), ("face out of square", crooked_face),
)
# No flip shows a face that is not square to the others (METHOD 1), and no residual a step that
# every axis takes between its own two faces: listed, not judged.
EXEMPT = ("offset step that parts every pair", "face out of square")


def make(name, seed):
    """The plan of a kind of mistake; the chip goes round with the seed."""
    mistake = dict(MISTAKES)[name]
    plan = Plan(seed, ("mpu6050", "gy85")[seed // 2 % 2])
    mistake(plan)
    return plan
