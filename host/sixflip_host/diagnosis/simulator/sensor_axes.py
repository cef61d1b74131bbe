"""Which axes of the real sensor those of the simulator's are: a signed permutation, as a driver or
a frame has them otherwise, or any turn, as the one of two sensors is mounted that lies crooked.
"""
import numpy as np
from scipy.spatial.transform import Rotation

from sixflip import STANDARD_G

from ..detect import axis_order

# Prior standard deviation of scale and misalignment: MPU-6050 PS rev 3.4, tables 6.1 and 6.2 (3 %
# scale, 2 % cross-axis) and ITG-3205 PS (6 % scale).
SHAPE = 0.04
DEAD = 0.1  # of the other channels' gain: below it a channel does not answer
DEG = 180.0 / np.pi
HEARD = 2.0  # times what is left of a channel, above which its own motion would show in it
UNHEARD = 1e-6  # of E, where it does not: none, but for a prior that has a width
GRAVITY_TELLS = 0.8  # m/s2 along an axis, from which on it is no bias (MPU-6050, 80 mg)
NOTHING = 0.5  # of a channel's power, from which on it says nothing of the motion
# rad about each axis by which a sensor is mounted otherwise than along an axis of the other one
# (standard deviation): a board on a wrist, a phone on a head; and the least turn that is looked
# for, twice what the axes of a part are off by (SHAPE).
MOUNTED, LEAST_TURN = 0.3, 2.0 * SHAPE


def candidates(hypothesis, measured, kind, live, swapped=None, real_own=None):
    """[(S (3, 3), unit)]; real_own (columns (n, q), sizes (q,)): what the real sensor adds of
    itself, or None."""
    y = hypothesis.signal
    design = np.column_stack([y, np.ones(len(y))])
    free = np.linalg.lstsq(design, measured, rcond=None)[0][:3].T
    if hypothesis.heading:
        psi = np.arctan2(free[1, 0] - free[0, 1], free[0, 0] + free[1, 1])
        c, s = np.cos(psi), np.sin(psi)
        return [(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]), 1.0)]
    units = (1.0, DEG, 1.0 / DEG) if kind == "gyro" else (1.0, STANDARD_G, 1.0 / STANDARD_G)
    if hypothesis.scaled and kind == "gyro":
        units = units[:1]  # any factor on all that turns it is one of time
    free[~live] = 0.0
    tried = [(np.eye(3), unit) for unit in (units if hypothesis.name else units[:1])]
    if hypothesis.name:
        # Of a robot on a floor z is what x and y make of it by how crooked it stands, and noise,
        # and of an arm's joint what forces make of it: what it answers to does not show.
        added = design if real_own is None else np.column_stack([design, real_own[0]])
        own = np.stack([left_of(y[:, i], np.delete(added, i, axis=1)) for i in range(3)], 1)
        # By their power: the gain of a channel that reads noise alone may be anything.
        gain = np.sqrt(measured[:, live].var(axis=0).sum() / max(y[:, live].var(axis=0).sum(),
                                                                 1e-30))
        left = left_of(measured, design)
        heard = gain * own.std(axis=0) > HEARD * left.std(axis=0)
        # What follows from next to nothing does so by any factor.
        power = gain ** 2 * own.var(axis=0)
        free = free * power / np.maximum(power + left.var(axis=0)[:, None], 1e-30)
        size = np.linalg.norm(free, axis=1)
        # Of a channel that does not follow no axis can be told; a dead one follows from nothing.
        strays = left.var(axis=0) > NOTHING * measured.var(axis=0)
        near = np.where(strays[:, None], 0.0, axis_order.nearest(
            np.where(strays, 0.0, 1.0 / np.maximum(size, 1e-9))[:, None] * free))
        # What is made of several readings has the noise of all, and none to be missed.
        dead = live & heard & strays & (size < DEAD * gain) & ~near.any(axis=0) & (
            hypothesis.name == "healthy")
        signs = kind == "accel" and np.abs(y.mean(axis=0)) > GRAVITY_TELLS
        for own in with_strays(near, strays & ~dead, np.broadcast_to(signs, 3)):
            once = np.abs(own[live]).sum(axis=0).max() < 2
            if once and not np.array_equal(own[live], np.eye(3)[live]):
                tried += [(own, unit) for unit in units]
        for other in (swapped, None if strays.any() else turned(free)):
            if other is not None and not any(alike(other, s) for s, _ in tried):
                tried.append((other, 1.0))
    return tried


def turning(values, force, noise):
    """(3, 3) prior widths of E of a gyro that reads values (n, 3) beside the force (n, 3), with
    noise (3,): what an axis reads that is no more than other axes and forces make of it, and
    noise, as an arm's joint does across, says nothing of what is made of it."""
    beside = np.column_stack([force, np.ones(len(values))])
    own = np.stack([left_of(values[:, i], np.column_stack([np.delete(values, i, axis=1), beside]))
                    for i in range(3)], 1)
    heard = own.std(axis=0) > HEARD * noise
    return np.where(heard if heard.any() else True, SHAPE, UNHEARD) * np.ones((3, 3))


def turned(free):
    """The (3, 3) turn that is nearest to how a sensor's channels follow from the real one's axes
    [Higham, SIAM J. Sci. Stat. Comput. 7 (1986), 1160], or None where that is a signed permutation
    within what axes of a part are off by, or the channels follow too differently to tell one."""
    sizes, turn = np.linalg.svd(free)[1], nearest_turn(free)
    if sizes[-1] < NOTHING * sizes[0] or np.linalg.det(turn) < 0.0:
        return None
    return turn if crooked(turn) > LEAST_TURN else None


def nearest_turn(matrix):
    """The orthogonal (3, 3) that is nearest to a matrix."""
    left, _, right = np.linalg.svd(matrix)
    return left @ right


def alike(one, other):
    """Whether two S (3, 3) are the same within what the axes of two parts are off by."""
    return bool(np.linalg.norm(one - other) < np.sqrt(2.0) * LEAST_TURN)


def crooked(axes):
    """rad between S (3, 3) and the nearest signed permutation: 0 for one that is one."""
    near = axis_order.nearest(axes)
    return 0.0 if np.array_equal(axes, near) else float(np.linalg.norm(
        Rotation.from_matrix(axes @ near.T).as_rotvec()))


def is_mounted(axes):
    """Whether S (3, 3) is a turn, and no signed permutation."""
    return bool((np.abs(axes) % 1.0 != 0.0).any())


def name_of(axes, kind, live):
    """The name of what a simulator does whose sensor reads along S (3, 3)."""
    if kind == "accel" and live.all() and np.array_equal(axes, -np.eye(3)):
        return "force_sign"
    return kind + ("_mounting" if is_mounted(axes) else "_axes")


def of_mounting(axes):
    """Nats by which a turn S (3, 3), that may be any of MOUNTED, is less likely before looking
    than none: beside it the axes of a part are off by as much as beside a signed permutation, so
    that it is worth the share of all turns which those cover."""
    return -3.0 * np.log(np.sqrt(2.0) * MOUNTED / SHAPE) - 0.5 * (crooked(axes) / MOUNTED) ** 2


def with_strays(near, strays, signs):
    """[S (3, 3)]: near (3, 3) with the rows of strays (3,), which follow nothing, answering to
    axes that no other row does: each to its own where that is free. signs (3,): axes whose sign
    gravity tells, as it does an accelerometer's; of others a turn is likelier than a mirror."""
    near, rows = near.copy(), np.flatnonzero(strays)
    free = [int(j) for j in np.flatnonzero(~near.any(axis=0))]
    for i in [*(i for i in rows if i in free), *(i for i in rows if i not in free)]:
        if free:
            near[i, free.pop(free.index(i) if i in free else 0)] = 1.0
    told = [i for i in rows if signs[near[i] != 0.0].any()]
    moved = [i for i in rows if i in told or near[i].any() and not near[i, i]]
    signed = [near]
    for i in moved:
        signed += [np.where(np.arange(3)[:, None] == i, -s, s) for s in signed]
    signed.sort(key=np.linalg.det, reverse=True)
    return signed if told else signed[:1]


def left_of(values, design):
    """values (n, ...) less what the columns of a design (n, k) say of them."""
    return values - design @ np.linalg.lstsq(design, values, rcond=None)[0]


def signed(row):
    """"-y" for (0, -1, 0), "0" for nothing."""
    if not row.any():
        return "0"
    i = int(np.abs(row).argmax())
    return ("-" if row[i] < 0 else "") + "xyz"[i]


def matrix_of(value):
    """(3, 3) of {"x": "-y", ...}"""
    matrix = np.zeros((3, 3))
    for i, axis in enumerate("xyz"):
        if value[axis] != "0":
            matrix[i, "xyz".index(value[axis][-1])] = -1.0 if value[axis][0] == "-" else 1.0
    return matrix


def turn_of(axes):
    """({"angle": deg that the turned axes S (3, 3) are off the nearest ones, "x", "y", "z": the
    turn vector, deg, by which readings along them become the real sensor's}, words)."""
    vector, near = np.degrees(Rotation.from_matrix(axes.T).as_rotvec()), axis_order.nearest(axes)
    angle, whole = float(np.degrees(crooked(axes))), float(np.linalg.norm(vector))
    words = "turn its readings by %.1f° about (%.2f, %.2f, %.2f)" % (whole, *(vector / whole))
    if not np.array_equal(near, np.eye(3)):
        words += ": it is %.1f° off %s" % (angle, ", ".join(
            "%s = %s" % (a, signed(row)) for a, row in zip("xyz", near)))
    return {"angle": angle, **dict(zip("xyz", vector.tolist()))}, words


def mounted(turn):
    """The (3, 3) S of the value of a turn_of()."""
    return Rotation.from_rotvec(np.radians([turn[a] for a in "xyz"])).as_matrix().T
