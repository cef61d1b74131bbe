"""The maps of one gyro side by side: what the engine drew, over the real walls."""

import numpy as np

from ...figures import canvas, save
from . import drive, measures

WALL, DRAWN, WAY = "#2a6f97", "#202020", "#c0392b"
MARGIN_M = 6.0


def draw(path, result):
    """Write a PNG of three steps of the ladder (rows) and three readings (columns)."""
    engines = list(dict.fromkeys(key[0] for key in result.maps))
    figure, axes = canvas(len(engines), len(drive.READINGS), 12.0, 8.6)
    truth = result.made
    half = 0.5 * np.array([truth.corridor.length, truth.corridor.depth]) + MARGIN_M
    for row, engine in enumerate(engines):
        for column, reading in enumerate(drive.READINGS):
            here, found = axes[row][column], result.maps[engine, reading]
            quality = result.quality[engine, reading]
            for wall in truth.corridor.walls():
                here.plot(*wall.T, color=WALL, lw=0.6)
            here.plot(*measures.placed(truth, found.walls).T, ".", color=DRAWN, ms=0.8)
            here.plot(*measures.placed(truth, found.path)[:, :2].T, color=WAY, lw=0.7)
            here.set(xlim=(-half[0], half[0]), ylim=(-half[1], half[1]), aspect="equal",
                     xticks=[], yticks=[])
            here.set_title("%s, %s: corner %.1f°, closure %.2f m" % (
                engine, reading, quality.corner_deg, quality.closure_m), fontsize=9)
    figure.suptitle("The map of a looped corridor (black) over its walls (blue), and the way the "
                    "robot thinks it went (red)", fontsize=11)
    save(figure, path)
