"""A person who calibrates and makes one mistake, or a chip that does.

A mistake is a function that changes the plan of a session (planned_sessions.Plan) before it is
sampled, or its counts afterwards (`after`). What it draws is from plan.rng, and what was done the
plan then says.
"""

import math

import numpy as np

from sixflip.poses.faces import AXIS, FACES

from .planned_sessions import HAND_DEG, Plan, about


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
