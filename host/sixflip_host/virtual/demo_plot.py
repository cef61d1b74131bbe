"""The demo's picture: errors of the vectors before and after the correction, face by face."""

from sixflip import STANDARD_G

from ..figures import canvas, save
from .demo_truth import error_mg


def draw(path, rows):
    """Write a PNG. rows: (pose, truth, raw, corrected), vectors in m/s2."""
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
            errors = [1000 / STANDARD_G * (row[2 + index][axis] - row[1][axis]) for row in rows]
            axes.plot([p + 0.15 * (axis - 1) for p in places], errors, marker, color=colour,
                      label=which if axis == 0 else None, alpha=0.5 + 0.25 * axis)
    axes.axhline(0, color="0.6", lw=0.8)
    axes.set_xticks(list(places), poses)
    axes.set_ylabel("error of x, y, z, mg (left to right)")
    axes.margins(y=0.2)
    axes.legend(loc="upper left", ncols=2)
    save(figure, path)
