"""The pictures of a board's calibration: raw and corrected vectors, residuals, the session itself,
and how its parameters drift from one calibration to the next."""

from datetime import datetime, timezone

import numpy as np

from sixflip.poses.faces import FACES, pose_name

from ..capture import rests
from ..figures import COLOURS, canvas

RAW, CORRECTED = "#b5651d", "#2a6f97"
MOST_POINTS = 3000      # of a curve
AXES = "xyz"
# Of a drift's rows: the parameter of each axis (history/parameters.py), its label, times what.
DRIFT_ROWS = (("accel_bias_%s_mg", "accelerometer bias, mg", 1.0),
              ("accel_scale_%s", "accelerometer scale, 1e-3", 1e3),
              ("gyro_bias_%s_dps", "gyro bias, deg/s", 1.0))


def vectors(solution, P):
    """(poses, raw, corrected, true): names and (n, 3) in g, one row a placement that was used.

    raw by the data sheet's numbers, corrected by P (m/s²), true with the table's tilt in it.
    """
    r = solution.accel
    raw, own, given = np.array(r.means), np.array(r.P), np.array(P)
    in_g = np.array([1.0, 1.0, 1.0, 1.0 / r.g])
    left = np.array([r.residual[pose] for pose in r.poses])
    rows = np.hstack([raw, np.ones((len(raw), 1))])
    # of two placements of one pose the residual is their mean's, so is the truth
    fitted = rows @ (own[:, :3] * in_g[:, None])
    means = {pose: fitted[[p == pose for p in r.poses]].mean(axis=0) for pose in set(r.poses)}
    true = np.array([means[pose] for pose in r.poses]) - left
    return [pose_name(p) for p in r.poses], raw, rows @ (given[:, :3] * in_g[:, None]), true


def errors(names, raw, corrected, true):
    """Length of the error of every vector, raw and corrected."""
    figure, axes = canvas(1, 2, 10.0, 3.6)
    places = np.arange(len(names))
    for values, shift, colour, label in ((raw, -0.2, RAW, "raw"),
                                         (corrected, 0.2, CORRECTED, "corrected")):
        axes[0, 0].bar(places + shift, 1e3 * np.linalg.norm(values - true, axis=1), 0.4,
                       color=colour, label=label)
        axes[0, 1].bar(places + shift, 1e3 * (np.linalg.norm(values, axis=1) - 1), 0.4,
                       color=colour, label=label)
    axes[0, 0].set_yscale("log")
    axes[0, 0].set_ylabel("error of the vector, mg")
    axes[0, 1].set_ylabel("|a| - g, mg")
    axes[0, 1].axhline(0.0, color="0.6", lw=0.8)
    axes[0, 1].set_yscale("symlog", linthresh=1.0)
    axes[0, 0].set_ylim(top=10 * axes[0, 0].get_ylim()[1])      # room for the legend
    low, high = axes[0, 1].get_ylim()
    axes[0, 1].set_ylim(min(2 * low, -1.0), max(2 * high, 1.0))
    for ax in axes[0]:
        ax.set_xticks(places, names, rotation=90, fontsize=8)
    axes[0, 0].legend(fontsize=8, ncols=2)
    return figure


def flip_pairs(names, raw, corrected, true):
    """Where gravity's part along the table points, face by face, before and after the flip."""
    figure, axes = canvas(2, 3, 10.0, 7.0)
    for panel, face in zip(axes.T.ravel(), (2, 3, 4, 5, 0, 1)):
        i, j = [k for k in range(3) if k != AXES.index(FACES[face][0].lower())]
        here = [k for k, name in enumerate(names) if name[:2] == FACES[face]]
        for values, colour, label in ((raw, RAW, "raw"), (corrected, CORRECTED, "corrected")):
            panel.plot(1e3 * values[here, i], 1e3 * values[here, j], "-", color=colour, lw=0.8)
            for flip, marker in (("a", "o"), ("b", "s")):
                placed = [k for k in here if names[k].endswith(flip)]
                panel.plot(1e3 * values[placed, i], 1e3 * values[placed, j], marker, color=colour,
                           ms=6, label="%s %s" % (label, flip))
        panel.plot(1e3 * true[here, i], 1e3 * true[here, j], "k+", ms=11, label="true")
        panel.axhline(0.0, color="0.8", lw=0.8, zorder=0)
        panel.axvline(0.0, color="0.8", lw=0.8, zorder=0)
        panel.set_title("%s up" % FACES[face], fontsize=10)
        panel.set_xlabel("%s, mg" % AXES[i], fontsize=8)
        panel.set_ylabel("%s, mg" % AXES[j], fontsize=8)
        panel.set_aspect("equal", adjustable="datalim")
        panel.margins(0.15)
    axes[0, 0].legend(fontsize=7)
    return figure


def residuals(solution):
    """What the solve leaves over, with two standard errors of a pose's mean."""
    r = solution.accel
    codes = sorted(r.residual)
    figure, axes = canvas(1, 1, 10.0, 3.0)
    ax = axes[0, 0]
    places = np.arange(len(codes))
    for k in range(3):
        noise = [np.sqrt(np.mean([v[k] for p, v in zip(r.poses, r.variance) if p == code]))
                 for code in codes]
        ax.bar(places + 0.25 * (k - 1), [1e3 * r.residual[code][k] for code in codes], 0.23,
               color=COLOURS[k], yerr=2e3 * np.array(noise), capsize=2,
               error_kw={"lw": 0.8}, label=AXES[k])
    ax.set_xticks(places, [pose_name(code) for code in codes])
    ax.axhline(0.0, color="0.4", lw=0.8)
    ax.set_ylabel("residual, mg")
    ax.legend(fontsize=8, ncols=3)
    return figure


def tilts(solution):
    """The table's tilt as every face saw it; they all must agree."""
    r = solution.accel
    figure, axes = canvas(1, 1, 10.0, 2.4)
    ax = axes[0, 0]
    faces = sorted(r.tilts)
    ax.plot(range(len(faces)), [r.tilts[face] for face in faces], "o", color=CORRECTED)
    ax.axhline(r.tilt_deg, color="0.6", lw=0.8)
    ax.set_xticks(range(len(faces)), [FACES[face] for face in faces])
    ax.set_ylabel("tilt, deg")
    spread = max(0.02, 1.5 * r.tilt_spread_deg)
    ax.set_ylim(r.tilt_deg - spread, r.tilt_deg + spread)
    return figure


def session(capture):
    """The whole capture over time, the poses shaded."""
    parts = [(capture.accel / capture.meta["accel_lsb_per_g"], "acceleration, g")]
    if capture.gyro is not None:
        parts.append((capture.gyro / capture.meta["gyro_lsb_per_dps"], "rate, deg/s"))
    if capture.temp is not None:
        parts.append(((capture.temp / capture.meta["temp_lsb_per_c"]
                       + capture.meta["temp_offset_c"])[:, None], "°C"))
    figure, axes = canvas(len(parts), 1, 10.0, 0.6 + 1.6 * len(parts))
    every = max(1, len(capture) // MOST_POINTS)
    seconds = (capture.t_us - capture.t_us[0]) * 1e-6
    for ax, (values, label) in zip(axes[:, 0], parts):
        for k in range(values.shape[1]):
            ax.plot(seconds[::every], values[::every, k], lw=0.7,
                    color=COLOURS[k] if values.shape[1] == 3 else "0.3",
                    label=AXES[k] if values.shape[1] == 3 else None)
        ax.set_ylabel(label, fontsize=9)
        ax.margins(x=0.005)
        if label == "°C" and np.ptp(values) < 1.0:      # noise must not look like warming
            ax.set_ylim(values.mean() - 0.5, values.mean() + 0.5)
        if capture.pose is not None:
            _shade(ax, capture, seconds, label == parts[0][1])
    axes[0, 0].legend(fontsize=7, ncols=3, loc="lower right")
    axes[-1, 0].set_xlabel("s")
    return figure


def _shade(ax, capture, seconds, named):
    for code, first, after in rests.labelled(capture.pose):
        start, end = seconds[first], seconds[after - 1]
        ax.axvspan(start, end, color="0.92", zorder=0)
        if named:
            ax.annotate(pose_name(code), (0.5 * (start + end), 1.01),
                        xycoords=("data", "axes fraction"), ha="center", va="bottom",
                        fontsize=7, rotation=60)


def drift(calibrations):
    """How the parameters of a board moved since the first of its calibrations, over time and over
    temperature: a figure, or None with nothing to draw. calibrations: [(Happened, parameters)].

    Error bars are two standard errors; refused calibrations are left out.
    """
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
    usable = [(one, found) for one, found in calibrations if one.verdict != "refused" and found]
    rows = [row for row in DRIFT_ROWS if any(row[0] % "x" in found for _, found in usable)]
    if not usable or not rows:
        return None
    figure, axes = canvas(len(rows), 2, 10.0, 0.6 + 2.3 * len(rows))
    for number, (pattern, label, factor) in enumerate(rows):
        for k, axis in enumerate(AXES):
            points = [(one, *found[pattern % axis]) for one, found in usable
                      if pattern % axis in found]
            _drift_curve(axes[number], points, factor, COLOURS[k], axis)
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


def _drift_curve(axes, points, factor, colour, label):
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
