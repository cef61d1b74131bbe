"""A hand moves a box on a table: where it is at any time, and what was asked of it.

A path is a chain of rests and moves. Attitudes turn body axes into the world's (z up).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

FACES = ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
SETTLING_S = 0.5        # after the box is down, before anybody would call it still


def unit_of(face):
    """The body axis that points up on a face."""
    axis = np.zeros(3)
    axis["XYZ".index(face[0])] = 1.0 if face[1] == "+" else -1.0
    return axis


def standing_on(face):
    """A rotation that brings the face's axis up; which heading it has does not matter."""
    axis = unit_of(face)
    if axis[2] == -1.0:
        return Rotation.from_rotvec([np.pi, 0, 0])
    if axis[2] == 1.0:
        return Rotation.identity()
    return Rotation.from_rotvec(np.cross(axis, [0, 0, 1.0]) * np.pi / 2)


@dataclass
class Habits:
    """How carefully the operator works; the defaults are those of GAP.md."""

    scatter_deg: float = 0.05       # of each placement, about two level axes
    flip_error_deg: float = 0.7     # of a half turn
    free_heading: bool = False      # no table edge to go by: every placement lies anyhow
    rest_s: tuple = (4.5, 6.5)
    move_s: tuple = (3.0, 7.0)
    touches: float = 0.0            # share of rests in which somebody bumps the table
    table_tilt_deg: float = 1.0
    box_tilt_deg: float = 0.1


@dataclass
class Rest:
    label: str
    start: float
    end: float
    attitude: Rotation
    touched: float = -1.0       # when, seconds into the rest


@dataclass
class Move:
    start: float
    end: float
    first: Rotation
    turn: np.ndarray            # rotation vector in the world
    wobble: np.ndarray          # rotation vector in the body at the height of the move
    warp: float                 # the quicker half of the move is early (< 1) or late (> 1)
    lift: np.ndarray            # metres, world: up and sideways
    flat: bool                  # a flip on the table
    centre: np.ndarray          # metres from the centre of the turn to the box's middle

    def progress(self, t):
        u = np.clip((t - self.start) / (self.end - self.start), 0, 1) ** self.warp
        return u ** 3 * (10 - 15 * u + 6 * u * u)

    def attitude(self, t):
        s = self.progress(t)
        bump = np.sin(np.pi * s) ** 2
        return (Rotation.from_rotvec(s[:, None] * self.turn) * self.first
                * Rotation.from_rotvec(bump[:, None] * self.wobble))

    def place(self, t):
        """Metres in the world, from where the move began."""
        s = self.progress(t)
        out = np.sin(np.pi * s)[:, None] ** 2 * self.lift
        if self.flat:
            out = out + Rotation.from_rotvec(s[:, None] * self.turn).apply(self.centre)
        return out


class Path:
    """Rests and moves in order; attitude, acceleration and labels at any times."""

    def __init__(self, parts, tremor_seed):
        self.parts = parts
        self.starts = np.array([p.start for p in parts])
        self.duration = parts[-1].end
        self.tremor_seed = tremor_seed

    def pieces(self, t):
        """(part, slice of t) for increasing times."""
        edges = np.append(np.searchsorted(t, self.starts[1:]), len(t))
        begin = 0
        for part, end in zip(self.parts, edges):
            if end > begin:
                yield part, slice(begin, end)
            begin = end

    def attitude(self, t):
        quaternions = np.empty((len(t), 4))
        for part, piece in self.pieces(t):
            if isinstance(part, Rest):
                quaternions[piece] = part.attitude.as_quat()
            else:
                quaternions[piece] = part.attitude(t[piece]).as_quat()
        return Rotation.from_quat(quaternions)

    def acceleration(self, t, g):
        """(n, 3) of the box's middle in the world, in g: lifting, trembling, setting down."""
        out = np.zeros((len(t), 3))
        rng = np.random.default_rng(self.tremor_seed)
        step = 0.01
        for part, piece in self.pieces(t):
            here = t[piece]
            if isinstance(part, Move):
                out[piece] = (part.place(here + step) - 2 * part.place(here)
                              + part.place(here - step)) / step ** 2 / g
                quiver = rng.normal(0, 1, (4, 3)) * (0.006 if part.flat else 0.015)
                tones = rng.uniform(2, 9, 4)
                span = np.sin(np.pi * part.progress(here)) ** 2
                for tone, size in zip(tones, quiver):
                    out[piece] += (span * np.sin(2 * np.pi * tone * here))[:, None] * size
            else:
                ring = rng.normal(0, 0.02, 3)
                since = here - part.start
                fading = np.exp(-since / 0.06) * np.sin(2 * np.pi * 21 * since)
                out[piece] = fading[:, None] * ring
                if part.touched >= 0:
                    after = here - part.start - part.touched
                    out[piece] += (np.where(after > 0, np.exp(-np.abs(after) / 0.05), 0)
                                   * np.sin(2 * np.pi * 17 * after))[:, None] * ring
        return out

    def labels(self, t):
        """(names (n,), number of the placement (n,), -1 while it moves)."""
        names = np.full(len(t), "", dtype="<U5")
        numbers = np.full(len(t), -1)
        count = 0
        for part, piece in self.pieces(t):
            if isinstance(part, Rest) and part.label:
                still = np.arange(piece.start, piece.stop)[
                    (t[piece] - part.start > SETTLING_S) & (part.end - t[piece] > 0.15)]
                names[still] = part.label
                numbers[still] = count
                count += 1
        return names, numbers


class Scene:
    """Table, box and hand of one case: the table may differ between sessions, the box not."""

    def __init__(self, rng, habits):
        self.rng, self.habits = rng, habits
        angles = rng.normal(0, 1, (6, 3)) * np.radians(habits.box_tilt_deg)
        self.crooked = {face: Rotation.from_rotvec(a - unit_of(face) * (a @ unit_of(face)))
                        for face, a in zip(FACES, angles)}
        self.new_table()

    def new_table(self):
        direction = self.rng.uniform(0, 2 * np.pi)
        self.tilt = Rotation.from_rotvec(np.radians(self.habits.table_tilt_deg)
                                         * np.array([np.cos(direction), np.sin(direction), 0]))
        self.headings = {face: self.rng.integers(4) * 90.0 for face in FACES}

    def placed(self, label):
        """The attitude of one placement on a face."""
        heading = self.headings[label[:2]] + 180.0 * (label[2] == "b")
        if self.habits.free_heading:
            heading = self.rng.uniform(0, 360)
        return self._put_down(label, heading + self.rng.normal(0, self.habits.flip_error_deg))

    def _put_down(self, label, heading):
        self.heading = heading
        level = self.rng.normal(0, np.radians(self.habits.scatter_deg), 2)
        return (self.tilt * Rotation.from_rotvec([level[0], level[1], 0])
                * Rotation.from_euler("z", heading, degrees=True)
                * standing_on(label[:2]) * self.crooked[label[:2]])

    def flipped(self, label):
        """The same face after a half turn on the table, by hand."""
        return self._put_down(
            label, self.heading + 180 + self.rng.normal(0, self.habits.flip_error_deg))

    def leaning(self):
        """A free attitude at least 15 degrees off every face."""
        while True:
            attitude = Rotation.random(random_state=int(self.rng.integers(2 ** 31)))
            up = np.abs(attitude.inv().apply([0, 0, 1.0]))
            if up.max() < np.cos(np.radians(15)):
                return attitude

    def path(self, poses, end_rest_s):
        """A Path through poses ("Z+a", "L1", ...), end_rest_s at rest at both ends."""
        rng, habits = self.rng, self.habits
        parts, now, left = [], 0.0, bool(rng.integers(2))
        for number, label in enumerate(poses):
            before = poses[number - 1] if number else None
            flip = before is not None and label[0] != "L" and before[:2] == label[:2]
            if flip:
                attitude = self.flipped(label)
            else:
                attitude = self.leaning() if label[0] == "L" else self.placed(label)
            if before is not None:
                long = rng.uniform(*habits.move_s)
                parts.append(self._move(parts[-1].attitude, attitude, now, long, flip, left))
                left = left != flip
                now += long
            long = rng.uniform(*habits.rest_s)
            if number in (0, len(poses) - 1):
                long = max(long, end_rest_s)
            touched = rng.uniform(1, long - 1) if rng.random() < habits.touches else -1.0
            parts.append(Rest(label, now, now + long, attitude, touched))
            now += long
        return Path(parts, int(rng.integers(2 ** 31)))

    def _move(self, first, last, now, long, flip, left):
        rng = self.rng
        turn = (last * first.inv()).as_rotvec()
        if flip and (turn[2] > 0) != left:      # the long way round is the way asked for
            turn = turn * (1 - 2 * np.pi / np.linalg.norm(turn))
        wobble = rng.normal(0, np.radians(0.3 if flip else 12), 3)
        lift = rng.normal(0, 0.01, 3) if flip else rng.normal(0, 0.03, 3) + [0, 0, 0.1]
        if flip:
            lift[2] = 0.0
        return Move(now, now + long, first, turn, wobble, rng.uniform(0.8, 1.25), lift, flip,
                    rng.normal(0, 0.004, 3) if flip else np.zeros(3))
