"""How the parameters of a board moved: over time and over temperature."""

from datetime import datetime, timezone

import numpy as np

from ..figures import COLOURS, canvas
from ..history.parameters import AXES

ROWS = (("accel_bias_%s_mg", "accelerometer bias, mg", 1.0),
        ("accel_scale_%s", "accelerometer scale, 1e-3", 1e3),
        ("gyro_bias_%s_dps", "gyro bias, deg/s", 1.0))


def draw(calibrations):
    """A figure of [(Happened, parameters)]: change since the first one; None with nothing to draw.

    Error bars are two standard errors; refused calibrations are left out.
    """
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
    usable = [(one, found) for one, found in calibrations if one.verdict != "refused" and found]
    rows = [row for row in ROWS if any(row[0] % "x" in found for _, found in usable)]
    if not usable or not rows:
        return None
    figure, axes = canvas(len(rows), 2, 10.0, 0.6 + 2.3 * len(rows))
    for number, (pattern, label, factor) in enumerate(rows):
        for k, axis in enumerate(AXES):
            points = [(one, *found[pattern % axis]) for one, found in usable
                      if pattern % axis in found]
            _curve(axes[number], points, factor, COLOURS[k], axis)
        axes[number, 0].set_ylabel(label, fontsize=9)
        for ax in axes[number]:
            ax.axhline(0.0, color="0.7", lw=0.8, zorder=0)
            ax.margins(x=0.08)
    axes[0, 0].legend(fontsize=8, ncols=3)
    axes[0, 0].set_title("change since the first calibration, over time", fontsize=10)
    axes[0, 1].set_title("over the sensor's temperature", fontsize=10)
    axes[-1, 0].set_xlabel("UTC")
    for ax in axes[:, 0]:
        locator = AutoDateLocator(tz=timezone.utc)
        ax.xaxis.set_major_locator(locator)
        ax.xaxis.set_major_formatter(ConciseDateFormatter(locator, tz=timezone.utc))
    axes[-1, 1].set_xlabel("°C")
    return figure


def _curve(axes, points, factor, colour, label):
    """One parameter, against time on the left and against temperature on the right."""
    if not points:
        return
    change = factor * np.array([value - points[0][1] for _, value, _ in points])
    error = 2 * factor * np.array([np.nan if sigma is None else sigma for _, _, sigma in points])
    look = {"color": colour, "ms": 4, "capsize": 2, "lw": 1}
    axes[0].errorbar([datetime.fromtimestamp(one.at, timezone.utc) for one, _, _ in points],
                     change, error, fmt="o-", label=label, **look)
    celsius = np.array([np.nan if one.temp_c is None else one.temp_c for one, _, _ in points])
    axes[1].errorbar(celsius, change, error, fmt="o", **look)
