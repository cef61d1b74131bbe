"""The person who calibrates: lays the box on its faces on a table, flips it, makes mistakes.

An Operator builds a Scene. The first placement on a face turns the box over about a
horizontal axis; the second one of a pair, whenever it comes, is turned by half a turn about
the table's normal from the first, give or take the hand's error. Poses are the names "Z+a"
(the face that is up, first placement), "Z+b" (turned), "L1" (leaning, attitude free).
"""

import math

from sixflip_sim import noise, rotation
from sixflip_sim.scene import Scene

FACES = ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
PAPER_ORDER = ("Z+a", "Z+b", "Z-a", "Z-b", "X+a", "X+b",
               "X-a", "X-b", "Y+a", "Y+b", "Y-a", "Y-b")
_DEGREE = math.pi / 180.0
LOOKS_S, REACTS_S = 1.5, 0.5    # a box at rest is seen as such after 0.75 s
_FLIP, _SCATTER, _LEAN, _TOUCH = 0x100, 0x101, 0x102, 0x103     # streams of the hand


def face_axis(face):
    """Unit vector in the body of the axis that points up on "Z+", "X-", …"""
    sign = 1.0 if face[1] == "+" else -1.0
    return tuple([sign if letter == face[0] else 0.0 for letter in "XYZ"])


class Operator:
    """tilt_deg, tilt_dir_deg: the table's tilt and the direction it leans to (from world x).
    flip_error_deg, placement_scatter_deg: standard deviations of the hand.
    turn: which way flips go, "alternate", "left" (right-handed about up) or "right".
    first_pose: where the box lies in the beginning.
    crooked: {face: (deg, direction_deg)} of box faces that are not square.
    scene_args go to Scene (g, lever_arm, temperature_c, warm_c, warm_tau_s).
    """

    def __init__(self, tilt_deg=0.0, tilt_dir_deg=30.0, flip_error_deg=0.0,
                 placement_scatter_deg=0.0, seed=1, turn="alternate", move_s=2.5,
                 lift_m=0.05, first_pose="Z+a", crooked=None, scene_args=None):
        if turn not in ("alternate", "left", "right"):
            raise ValueError("turn is %r, expected alternate, left or right" % turn)
        self.flip_error_deg = flip_error_deg
        self.placement_scatter_deg = placement_scatter_deg
        self.turn = turn
        self.move_s = move_s
        self.lift_m = lift_m
        self.crooked = crooked or {}
        self._keys = [noise.key(seed, c) for c in (_FLIP, _SCATTER, _LEAN, _TOUCH)]
        self._drawn = [0, 0, 0, 0]
        d = tilt_dir_deg * _DEGREE
        lean = rotation.about((-math.sin(d), math.cos(d), 0.0), tilt_deg * _DEGREE)
        self.normal = rotation.apply(lean, (0.0, 0.0, 1.0))
        self.pose = first_pose
        self.log = []                   # [pose, t0_us, t1_us] of every unbroken rest
        self.flips_deg = {}             # face -> turn from a to b, right-handed about the face
        self._flips = 0
        first_face = first_pose[:2]
        up = rotation.times(lean, _to_top(first_face))
        self._square = {self.pose: up}  # pose -> attitude before scatter
        self._now = up                  # the attitude meant at present
        self.scene = Scene(self._scattered(first_face, up), **(scene_args or {}))

    def _draw(self, stream):
        self._drawn[stream] += 1
        return noise.gauss(self._keys[stream], self._drawn[stream])

    def rest(self, seconds):
        """Leave the box alone."""
        t0 = self.scene.end_us()
        self.scene.rest(int(round(seconds * 1e6)))
        if not (self.log and self.log[-1][0] == self.pose and self.log[-1][2] == t0):
            self.log.append([self.pose, t0, t0])
        self.log[-1][2] = self.scene.end_us()

    def rest_until(self, t_us):
        """Leave the box alone at least up to a time: for an operator who reacts."""
        if t_us > self.scene.end_us():
            self.rest((t_us - self.scene.end_us()) * 1e-6)

    def asked(self, now_us, pose, up=None, anew=True):
        """Somebody asks for a pose, over and over until it is taken. Nothing while the last move
        goes on and the box has not lain for LOOKS_S; else it is brought there after REACTS_S,
        one that lies so already only if it is to be placed anew."""
        if now_us < self.scene.end_us() + LOOKS_S * 1e6 or (pose == self.pose and not anew):
            return
        self.rest_until(now_us + REACTS_S * 1e6)
        self.place(pose, up=up)

    def place(self, pose, move_s=None, turned_deg=180.0, turn=None, up=None):
        """Bring the box into a pose. turned_deg: what the hand takes for half a turn; turn:
        "left" or "right", None: as always; up: the axis of the box that a leaning pose raises.
        """
        if pose[0] == "L":
            self._lean(pose, move_s, up)
            return
        face, letter = pose[:2], pose[2:]
        if face not in FACES or letter not in ("a", "b"):
            raise ValueError("pose is %r, expected one of %s or L1, L2, …"
                             % (pose, " ".join(PAPER_ORDER)))
        other = face + ("b" if letter == "a" else "a")
        hint = None
        if other in self._square:
            target, angle = self._flipped(self._square[other], turned_deg, turn or self.turn)
            if self.pose == other:
                hint = angle
            self.flips_deg[face] = angle if letter == "b" else -angle
        elif pose in self._square:
            error = self.flip_error_deg * self._draw(0) * _DEGREE
            target = rotation.times(rotation.about(self.normal, error), self._square[pose])
        else:
            target = self._turned_over(face_axis(face))
        self._square[pose] = self._now = target
        self._move(self._scattered(face, target), move_s, hint)
        self.pose = pose

    def flip(self, move_s=None):
        """Half a turn about the table's normal on the face it lies on."""
        self.place(self.pose[:2] + ("b" if self.pose[2:] == "a" else "a"), move_s)

    def touch(self, deg=0.5, seconds=0.3):
        """Bump the box: it comes back to where it was."""
        self.scene.bump(int(seconds * 1e6), self._horizontal(), deg * _DEGREE)

    def knock(self, deg=1.0, seconds=0.3):
        """Push the box: it stays where it was pushed to (turned about a horizontal axis)."""
        self.scene.turn(int(seconds * 1e6), self._horizontal(), deg * _DEGREE)

    def _flipped(self, start, turned_deg, turn):
        """(attitude, angle in degrees) after half a turn to the left or right."""
        left = turn == "left" or (turn == "alternate" and self._flips % 2 == 0)
        self._flips += 1
        angle = turned_deg + self.flip_error_deg * self._draw(0)
        angle = angle if left else -angle
        return rotation.times(rotation.about(self.normal, angle * _DEGREE), start), angle

    def _turned_over(self, up):
        """Attitude after turning over about a horizontal axis until body axis up is up."""
        was = rotation.apply(self._now, up)
        axis = rotation.cross(was, self.normal)
        sine = rotation.norm(axis)
        cosine = rotation.dot(was, self.normal)
        if sine > 0.05:
            turn = rotation.about(_unit(axis), math.atan2(sine, cosine))
            return rotation.times(turn, self._now)
        # The opposite face: half a turn about an edge of the box which lies flat.
        edge = rotation.apply(self._now, (up[2], up[0], up[1]))
        turned = rotation.times(rotation.about(_unit(edge), math.pi), self._now)
        return _upright(turned, up, self.normal)

    def _lean(self, pose, move_s, up=None):
        """A free attitude, the same for the same name and seed; or the axis up raised."""
        number = int(pose[1:])
        if up is not None:
            self._now = self._turned_over(_unit(up))
        else:
            v = [noise.gauss(self._keys[2], 4 * number + i) for i in range(3)]
            angle = (35.0 + 20.0 * noise.uniform(self._keys[2], 4 * number + 3)) * _DEGREE
            self._now = rotation.times(self._now, rotation.about(_unit(v), angle))
        self._move(self._now, move_s, None)
        self.pose = pose

    def _scattered(self, face, attitude):
        """What the box really lies at: a crooked face, and not quite flush to the table."""
        up = face_axis(face)
        side, across = (up[1], up[2], up[0]), (up[2], up[0], up[1])
        if face in self.crooked:
            deg, direction = self.crooked[face]
            c, s = math.cos(direction * _DEGREE), math.sin(direction * _DEGREE)
            axis = [c * side[i] + s * across[i] for i in range(3)]
            attitude = rotation.times(attitude, rotation.about(axis, deg * _DEGREE))
        if self.placement_scatter_deg:
            size = self.placement_scatter_deg * _DEGREE
            for axis in (side, across):
                attitude = rotation.times(
                    attitude, rotation.about(axis, size * self._draw(1)))
        return attitude

    def _move(self, target, move_s, flip_deg):
        """One smooth turn from the present attitude; a flip goes its own way round."""
        start = self.scene.end_attitude()
        axis, angle = rotation.axis_angle(
            rotation.times(rotation.transposed(start), target))
        if flip_deg is not None:
            up = rotation.apply(rotation.transposed(start), self.normal)
            if rotation.dot(axis, up) * flip_deg < 0.0:
                axis = (-axis[0], -axis[1], -axis[2])
                angle = 2.0 * math.pi - angle if abs(flip_deg) > 120.0 else -angle
        self.scene.turn(int(round((move_s or self.move_s) * 1e6)), axis, angle, self.lift_m)

    def _horizontal(self):
        """A horizontal direction in the body, another one each time."""
        angle = math.pi * noise.uniform(self._keys[3], self._drawn[3])
        self._drawn[3] += 1
        world = (math.cos(angle), math.sin(angle), 0.0)
        return rotation.apply(rotation.transposed(self.scene.end_attitude()), world)


def _unit(v):
    n = rotation.norm(v)
    return (v[0] / n, v[1] / n, v[2] / n)


def _upright(attitude, up, normal):
    """Remove what is left between body axis up and the table's normal."""
    was = rotation.apply(attitude, up)
    axis = rotation.cross(was, normal)
    sine = rotation.norm(axis)
    if sine < 1e-12:
        return attitude
    return rotation.times(
        rotation.about(_unit(axis), math.atan2(sine, rotation.dot(was, normal))), attitude)


def _to_top(face):
    """Rotation that brings the face's axis to the world's z."""
    axis = face_axis(face)
    if face == "Z-":
        return rotation.about((1.0, 0.0, 0.0), math.pi)
    return _upright(rotation.IDENTITY, axis, (0.0, 0.0, 1.0))
