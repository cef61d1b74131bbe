"""How far streamed samples are from the simulated truth, rest by rest."""

import math

from sixflip import STANDARD_G as G

from ..figures import canvas, save

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
    stretches = []
    for vector in vectors:
        if not stretches or not stretches[-1].takes(vector):
            stretches.append(Rest(vector))
    return [rest.middle(hz) for rest in stretches if len(rest.vectors) >= SHORTEST_S * hz]


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


def draw(path, rows):
    """Write a PNG: the errors of the vectors before and after, face by face; rows of compare()."""
    poses = [row[0] for row in rows]
    raw = [error_mg(row[2], row[1]) for row in rows]
    corrected = [error_mg(row[3], row[1]) for row in rows]
    figure, ((bars, axes),) = canvas(1, 2, 10.0, 4.2)
    places = range(len(rows))
    bars.bar([p - 0.2 for p in places], raw, 0.4, label="raw", color="#b5651d")
    bars.bar([p + 0.2 for p in places], corrected, 0.4, label="corrected", color="#2a6f97")
    bars.set_yscale("log")
    bars.set_xticks(list(places), poses)
    bars.set_ylabel("error of the vector, mg")
    bars.set_title("raw and corrected against the simulated truth")
    bars.set_ylim(0.1, 3 * max(raw))
    bars.legend(loc="upper left", ncols=2)
    for index, (which, colour, marker) in enumerate(
            (("raw", "#b5651d", "o"), ("corrected", "#2a6f97", "x"))):
        for axis in range(3):
            errors = [1000 / G * (row[2 + index][axis] - row[1][axis]) for row in rows]
            axes.plot([p + 0.15 * (axis - 1) for p in places], errors, marker, color=colour,
                      label=which if axis == 0 else None, alpha=0.5 + 0.25 * axis)
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set_xticks(list(places), poses)
    axes.set_ylabel("error of x, y, z, mg (left to right)")
    axes.margins(y=0.2)
    axes.legend(loc="upper left", ncols=2)
    save(figure, path)
