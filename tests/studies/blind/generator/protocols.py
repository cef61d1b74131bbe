"""What the operator was asked to do: sessions as lists of poses, and their thermal state."""

from dataclasses import dataclass

import numpy as np

from .hand import FACES, Move, Path, Rest


@dataclass
class Warmth:
    """A session's temperature: start, end and time constants drawn at random."""

    start_c: float
    end_c: float
    tau_s: float
    second_tau_s: float     # of the board around the chip
    second_share: float

    def at(self, t):
        fast = (1 - self.second_share) * np.exp(-t / self.tau_s)
        slow = self.second_share * np.exp(-t / self.second_tau_s)
        return self.end_c + (self.start_c - self.end_c) * (fast + slow)


def warming(rng):
    low = rng.uniform(20, 26)
    return Warmth(low, low + rng.uniform(8, 12), rng.uniform(150, 350), rng.uniform(30, 80),
                  rng.uniform(0, 0.3))


def cooling(rng):
    high = rng.uniform(33, 39)
    return Warmth(high, high - rng.uniform(8, 12), rng.uniform(150, 350), rng.uniform(30, 80),
                  rng.uniform(0, 0.3))


def steady(rng):
    level = rng.uniform(22, 30)
    return Warmth(level, level + rng.uniform(-0.3, 0.3), 300.0, 60.0, 0.0)


def twelve(rng):
    """The 12 poses, faces in random order, each with its flip after it."""
    out = []
    for face in rng.permutation(FACES):
        first = "ab"[rng.integers(2)]
        out += [face + first, face + ("b" if first == "a" else "a")]
    return out


def recommended(rng, scene):
    """[(Path, Warmth)] of two sessions: warming and cooling, leaning poses in the middle."""
    out = []
    for state in (warming, cooling):
        order = twelve(rng)
        leaning = ["L%d" % (k + 1) for k in range(rng.integers(12, 19))]
        scene.new_table()
        out.append((scene.path(order + leaning + order[::-1], 30.0), state(rng)))
    return out


def paper(rng, scene):
    """One session of 12 poses in the paper's fixed order, at room temperature."""
    order = [face + which for face in FACES for which in "ab"]
    return [(scene.path(order, 5.0), warming(rng) if rng.random() < 0.5 else steady(rng))]


def one_session(rng, scene):
    """The warming half of the recommended capture alone."""
    order = twelve(rng)
    leaning = ["L%d" % (k + 1) for k in range(rng.integers(12, 19))]
    return [(scene.path(order + leaning + order[::-1], 30.0), warming(rng))]


def rest(rng, scene):
    """A single rest of five to eight minutes."""
    label = FACES[rng.integers(6)] + "a"
    long = rng.uniform(300, 480)
    return [(Path([Rest(label, 0.0, long, scene.placed(label))], int(rng.integers(2 ** 31))),
             warming(rng) if rng.random() < 0.5 else steady(rng))]


def driving(rng, scene):
    """A robot turning on the spot left and right, with rests between; a session of the poses."""
    path, state = recommended(rng, scene)[0]
    label = "Z+a"
    attitude = scene.placed(label)
    parts, now = [Rest(label, 0.0, 8.0, attitude)], 8.0
    up = scene.tilt.apply([0, 0, 1.0])
    for number in range(14):
        angle = np.radians(rng.uniform(120, 175)) * (1 if number % 2 else -1)
        long = abs(np.degrees(angle)) / rng.uniform(50, 90)
        parts.append(Move(now, now + long, parts[-1].attitude, up * angle, np.zeros(3), 1.0,
                          np.zeros(3), True, np.zeros(3)))
        now += long
        after = parts[-1].attitude(np.array([now]))[0]
        parts.append(Rest("", now, now + 3.0, after))
        now += 3.0
    return [(path, state), (Path(parts, int(rng.integers(2 ** 31))), steady(rng))]


PROTOCOLS = {"recommended": recommended, "paper": paper, "one session": one_session,
             "rest": rest, "driving": driving}
