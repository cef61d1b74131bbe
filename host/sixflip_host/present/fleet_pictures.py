"""The pictures of a fleet: how its boards are distributed, and control charts in their order."""
import numpy as np

from ..figures import COLOURS, canvas, png

BINS = 24  # of a histogram: as many as a picture of this width shows
AXES = "xyz"
LIMIT = 3.0  # sigmas of a control chart's limits [Shewhart 1931]
MOST = 12  # blocks of three axes that are drawn


def drawn(members):
    """Names of the blocks with one parameter an axis, in the order of the answer."""
    return [block.name for block in members.blocks if len(block.names) == 3][:MOST]


def distributions(members, batches):
    """PNG: a histogram of the boards' estimates of every parameter, a line for each batch's
    population, dashed what is nominal."""
    names = drawn(members)
    figure, axes = canvas(len(names), 3, 10.0, 0.4 + 1.6 * len(names))
    for row, name in enumerate(names):
        for j in range(3):
            ax = axes[row, j]
            values = [b.populations[name][0].y[:][:, j] for b in batches if name in b.populations]
            values = [v[np.isfinite(v)] for v in values]
            every = np.concatenate([*values, np.zeros(0)])
            if not len(every):
                ax.set_axis_off()
                continue
            edges = _edges(every)
            for k, (batch, own) in enumerate(zip(batches, values)):
                colour = "C%d" % k if len(batches) > 1 else COLOURS[j]
                ax.hist(np.clip(own, edges[0], edges[-1]), edges, color=colour, alpha=0.45,
                        label=batch.name or None)
                _curve(ax, batch.populations[name], j, edges, len(own), colour)
            _nominal(ax, batches, name, j, edges)
            ax.set_yticks([])
            ax.locator_params(axis="x", nbins=5)
            ax.tick_params(labelsize=7)
            ax.set_title(_title(batches, name, j), fontsize=8)
    if len(batches) > 1:
        axes[0, 0].legend(fontsize=7)
    return png(figure)


def _edges(values):
    """Bins over all but the farthest; those stand at the ends."""
    middle = np.median(values)
    width = 1.4826 * np.median(np.abs(values - middle)) or np.ptp(values) or abs(middle) or 1.0
    low = max(values.min(), middle - 6.0 * width)
    high = min(values.max(), middle + 6.0 * width)
    return np.linspace(low - 0.02 * width, high + 0.02 * width, BINS + 1)


def _curve(ax, pair, j, edges, number, colour):
    """The population with the usual error of an estimate, as a line."""
    block, fitted = pair
    sigma = np.median(fitted.sigma(block.variance())[:, j])
    x = np.linspace(edges[0], edges[-1], 200)
    y = np.exp(-0.5 * ((x - fitted.mean[j]) / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi))
    ax.plot(x, number * (edges[1] - edges[0]) * y, color=colour, lw=1.2)


def _parameter(batches, name, j):
    for batch in batches:
        if name in batch.populations:
            wanted = batch.populations[name][0].names[j]
            return next(p for p in batch.parameters if p.name == wanted)
    return None


def _nominal(ax, batches, name, j, edges):
    parameter = _parameter(batches, name, j)
    if parameter and parameter.nominal is not None and edges[0] <= parameter.nominal <= edges[-1]:
        ax.axvline(parameter.nominal, color="0.3", lw=0.8, ls="--")


def _title(batches, name, j):
    parameter = _parameter(batches, name, j)
    if not parameter:
        return ""
    return "%s%s" % (parameter.name, ", " + parameter.unit if parameter.unit else "")


def control_charts(members, batches):
    """PNG: every board's estimate in the order of the boards, the batch's mean and the limits
    within which boards of it lie; what lies beyond is a ring."""
    names = drawn(members)
    figure, axes = canvas(len(names), 3, 10.0, 0.4 + 1.5 * len(names))
    for row, name in enumerate(names):
        for j in range(3):
            _chart(axes[row, j], batches, name, j)
            axes[row, j].tick_params(labelsize=7)
            axes[row, j].set_title(_title(batches, name, j), fontsize=8)
    for ax in axes[-1]:
        ax.set_xlabel("board", fontsize=8)
    return png(figure)


def _chart(ax, batches, name, j):
    start = 0
    for batch in batches:
        if name not in batch.populations:
            continue
        block, fitted = batch.populations[name]
        x = start + np.arange(len(batch.boards))
        y, sigma = block.y[:][:, j], fitted.sigma(block.variance())[:, j]
        middle = fitted.mean[j]
        ax.plot(x, y, ".", color=COLOURS[j], ms=2.5)
        ax.plot(x, np.full(len(x), middle), color="0.4", lw=0.8)
        for sign in (-1.0, 1.0):
            ax.plot(x, middle + sign * LIMIT * sigma, color="0.6", lw=0.7)
        named = {(o.board, o.parameter) for o in batch.outliers if o.why == "differs"}
        outlying = [k for k, board in enumerate(batch.boards) if (board, block.names[j]) in named]
        ax.plot(x[outlying], y[outlying], "o", mfc="none", mec="k", ms=6)
        start += len(batch.boards)
        if batch is not batches[-1]:
            ax.axvline(start - 0.5, color="0.85", lw=0.8, zorder=0)
