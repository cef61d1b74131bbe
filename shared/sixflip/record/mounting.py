"""Roll and pitch of an installed sensor from gravity at rest on a level vehicle (Promrit).

Promrit's R takes the vehicle's axes into the sensor's: G = R (0, 0, 1). Yaw turns about
gravity, is not observable and is taken as 0. The paper chains measured = R (I+S+M) a + b; the
sensor's errors act after the rotation, so ours is (I+S+M) R a + b (they differ by 10.6 mg at
30/15 degrees): correct the sample first, then turn it back with R transposed.
"""

import math

FRAMES = ("rep103", "ned")


def angles(gx, gy, gz, order):
    """(roll, pitch) in rad for order "xyz" (Promrit A, B) or "yxz" (C, D); all quadrants."""
    if order == "xyz":
        return math.atan2(gy, gz), math.atan2(-gx, math.sqrt(gy * gy + gz * gz))
    if order == "yxz":
        return math.atan2(gy, math.sqrt(gx * gx + gz * gz)), math.atan2(-gx, gz)
    raise ValueError("rotation order %s: expected xyz or yxz" % order)


def choose(gx, gy, gz):
    """Promrit Eq. 6, G in units of g: (order, left side, right side)."""
    left = abs(math.sqrt(gy * gy + gz * gz) - 1.0)
    right = abs(math.sqrt(gx * gx + gz * gz) - 1.0)
    return ("xyz" if left < right else "yxz"), left, right


def rotation(roll, pitch, order):
    """R, 3 x 3, vehicle to sensor: R_xyz = Rx(roll) Ry(pitch) or R_yxz = Ry Rx (Promrit IV)."""
    a, b = math.sin(roll), math.cos(roll)
    c, d = math.sin(pitch), math.cos(pitch)
    if order == "xyz":
        return [[d, 0.0, -c], [a * c, b, a * d], [b * c, -a, b * d]]
    if order == "yxz":
        return [[d, c * a, -c * b], [0.0, b, a], [c, -d * a, d * b]]
    raise ValueError("rotation order %s: expected xyz or yxz" % order)


def parse_axes(text):
    """Signed permutation B, 3 x 3, from "x y z" or "-y x z": robot x is the sensor's -y ...

    ValueError unless every axis is named once and the result is right-handed.
    """
    B = [[0] * 3 for _ in range(3)]
    words = text.lower().replace(",", " ").split()
    permuted = []
    for row, word in zip(B, words):
        axis = "xyz".find(word[-1])
        if word[:-1] not in ("", "+", "-") or axis < 0:
            break
        row[axis] = -1 if word[0] == "-" else 1
        permuted.append(axis)
    if len(words) != 3 or sorted(permuted) != [0, 1, 2]:
        raise ValueError("axes %s: expected x, y and z once each, such as -y x z" % text)
    turned = 1 if (permuted[1] - permuted[0]) % 3 == 1 else -1
    if turned * sum(B[0]) * sum(B[1]) * sum(B[2]) < 0:
        raise ValueError("axes %s: left-handed, no way of mounting gives that" % text)
    return B


def estimate(gx, gy, gz, order=None, axes="x y z", frame="rep103"):
    """The record's mounting section from corrected, averaged gravity in g, sensor axes.

    axes   which sensor axis points along the robot's forward, left and up
    frame  axes the robot's samples are wanted in: rep103 (forward, left, up) or ned
           (forward, right, down)
    order  None chooses by Promrit's rule. ValueError when |G| is more than 5 % off 1 g: the
           vehicle moved, or the sensor is not calibrated.
    """
    if frame not in FRAMES:
        raise ValueError("frame %s: expected rep103 or ned" % frame)
    size = math.sqrt(gx * gx + gy * gy + gz * gz)
    if not abs(size - 1.0) <= 0.05:
        raise ValueError("gravity reads %.3f g: expected 0.95 to 1.05 at rest" % size)
    B = parse_axes(axes)
    x, y, z = [r[0] * gx + r[1] * gy + r[2] * gz for r in B]
    order = order or choose(x, y, z)[0]
    roll, pitch = angles(x, y, z, order)
    return {"roll_deg": math.degrees(roll), "pitch_deg": math.degrees(pitch), "order": order,
            "axes": axes, "frame": frame}


def compensation(mounting):
    """3 x 3 that takes corrected sensor axes to the robot's: frame, R transposed, axes."""
    R = rotation(math.radians(mounting["roll_deg"]), math.radians(mounting["pitch_deg"]),
                 mounting["order"])
    B = parse_axes(mounting["axes"])
    turn = [[sum([R[k][i] * B[k][j] for k in range(3)]) for j in range(3)] for i in range(3)]
    if mounting["frame"] == "ned":
        turn = [turn[0], [-x for x in turn[1]], [-x for x in turn[2]]]
    return turn
