"""How far streamed samples are from the simulated truth, rest by rest."""

import math

from sixflip import STANDARD_G as G

NEAR_M_S2 = 0.4  # farther from the mean of a rest than this: another rest, or a move
EDGE_S = 0.8  # left out at both ends of a rest: slow starts and ends of moves
SHORTEST_S = 3.6  # of a rest
STREAM_HZ = 50


class Rest:
    """One still stretch of the stream, vectors in m/s2."""

    def __init__(self, vector):
        self.vectors = [vector]
        self.mean = list(vector)

    def takes(self, vector):
        """Add a sample when it is near the mean; False when it is not."""
        if any(abs(v - m) > NEAR_M_S2 for v, m in zip(vector, self.mean)):
            return False
        self.vectors.append(vector)
        for axis in range(3):
            self.mean[axis] += (vector[axis] - self.mean[axis]) / len(self.vectors)
        return True

    def middle(self, hz):
        """Mean without the edges."""
        edge = round(EDGE_S * hz)
        inner = self.vectors[edge:-edge]
        return [sum(vector[axis] for vector in inner) / len(inner) for axis in range(3)]


def rests(vectors, hz=STREAM_HZ):
    """Mean vectors of the still stretches, in their order."""
    found = []
    for vector in vectors:
        if not found or not found[-1].takes(vector):
            found.append(Rest(vector))
    return [rest.middle(hz) for rest in found if len(rest.vectors) >= SHORTEST_S * hz]


def truth(world):
    """[(pose, specific force in m/s2)] of the world's placements, in their order."""
    return [(pose, world.scene.specific_force((begin + end) // 2))
            for pose, begin, end in world.truth.placements]


def error_mg(vector, true):
    """Length of the difference in thousandths of the standard g."""
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(vector, true))) / G * 1000


def compare(true, raw, corrected):
    """Rows (pose, truth, raw, corrected), vectors in m/s2; None when the rests do not pair up."""
    if not len(true) == len(raw) == len(corrected):
        return None
    return [(pose, list(vector), list(r), list(c))
            for (pose, vector), r, c in zip(true, raw, corrected)]


def table(rows):
    """Lines of text: the error of each rest before and after, in mg."""
    lines = ["pose   raw error   corrected error   (mg, length of the vector's error)"]
    for pose, true, raw, corrected in rows:
        lines.append("%-4s %10.2f %14.2f" % (pose, error_mg(raw, true), error_mg(corrected, true)))
    return lines


def worst(rows):
    """(largest raw error, largest corrected error) in mg."""
    return (max(error_mg(raw, true) for _, true, raw, _ in rows),
            max(error_mg(corrected, true) for _, true, _, corrected in rows))
