"""Confusion table, reliability and power curves as PNGs."""

from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from .reliability import bins, calibration_error  # noqa: E402
from .statsmath import wilson  # noqa: E402
from .target_tables import confusion  # noqa: E402


def draw(results, folder):
    """Write what there is to draw; returns the paths."""
    answered = [r for r in results if r["verdict"] is not None]
    out = []
    for name, picture in (("confusion", _confusion), ("reliability", _reliability),
                          ("power", _power)):
        figure = picture(answered)
        if figure is not None:
            out.append(folder / (name + ".png"))
            figure.savefig(out[-1], dpi=120, bbox_inches="tight")
            plt.close(figure)
    return out


def _confusion(results):
    counts = confusion(results)
    if not counts:
        return None
    rows = sorted({t for t, _ in counts})
    last = ["class with it", "class without it", "unexplained", "nothing"]
    columns = [r for r in rows if any(n == r for _, n in counts)]
    columns += sorted({n for _, n in counts} - set(rows) - set(last)) + last
    figure, axes = plt.subplots(figsize=(0.34 * len(columns) + 3, 0.26 * len(rows) + 2))
    totals = {t: sum(c for (x, _), c in counts.items() if x == t) for t in rows}
    grid = [[counts[t, n] / totals[t] for n in columns] for t in rows]
    axes.imshow(grid, cmap="Blues", vmin=0, vmax=1, aspect="auto")
    for i, t in enumerate(rows):
        for j, n in enumerate(columns):
            if counts[t, n]:
                axes.text(j, i, counts[t, n], ha="center", va="center", fontsize=7,
                          color="white" if grid[i][j] > 0.6 else "black")
    axes.set_xticks(range(len(columns)), columns, rotation=60, ha="right", fontsize=8)
    axes.set_yticks(range(len(rows)), ["%s (%d)" % (t, totals[t]) for t in rows], fontsize=8)
    axes.set_xlabel("named")
    axes.set_title("What was there against what was named (cases)")
    return figure


def _reliability(results):
    filled = [b for b in bins(results) if b[3]]
    if not filled:
        return None
    figure, axes = plt.subplots(figsize=(5, 4.5))
    stated, shares = [b[2] for b in filled], [right / n for *_, n, right in filled]
    bounds = [wilson(right, n) for *_, n, right in filled]
    axes.plot([0, 1], [0, 1], color="grey", lw=0.8, ls="--")
    axes.errorbar(stated, shares,
                  yerr=[[max(0, s - low) for s, (low, _) in zip(shares, bounds)],
                        [max(0, high - s) for s, (_, high) in zip(shares, bounds)]],
                  fmt="o", capsize=4)
    for x, y, (*_, n, _) in zip(stated, shares, filled):
        axes.annotate("n=%d" % n, (x, y), textcoords="offset points", xytext=(-8, -14),
                      ha="right", fontsize=8)
    axes.set_xlim(-0.03, 1.03)
    axes.set_ylim(0, 1.03)
    axes.set_xlabel("stated probability")
    axes.set_ylabel("share of causes that were there")
    axes.set_title("Reliability; expected calibration error %.3f" % calibration_error(results)[0])
    return figure


def _power(results):
    curves = defaultdict(lambda: defaultdict(list))
    for r in results:
        if r["suite"] == "power":
            e = r["effects"][0]
            curves[e["effect"] + " " + e["sensor"]][e["multiple"]].append(e["class_right"])
    if not curves:
        return None
    figure, axes = plt.subplots(figsize=(6, 4))
    for name, sizes in sorted(curves.items()):
        x = sorted(sizes)
        axes.plot(x, [sum(sizes[s]) / len(sizes[s]) for s in x], "o-", label=name)
    axes.set_xscale("log")
    axes.set_ylim(-0.03, 1.03)
    axes.set_xlabel("size, multiples of the typical one")
    axes.set_ylabel("right class")
    axes.axhline(0.95, color="grey", lw=0.8, ls="--")
    axes.legend(fontsize=8)
    axes.set_title("Power: right class over the size of the effect")
    return figure
