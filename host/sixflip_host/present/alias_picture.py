"""The alias matrix as a picture: row a, column b, how much of a could be b."""

from ..figures import save


def draw(matrices, path, title):
    """Write a PNG; matrices: {sensor: (names, index (n, n))}."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    sizes = [max(len(names), 2) for names, _ in matrices.values()]
    figure = Figure(figsize=(2.6 + 0.55 * sum(sizes) + 1.8 * len(sizes), 2.4 + 0.5 * max(sizes)),
                    layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(matrices), squeeze=False, width_ratios=sizes)[0]
    for ax, (sensor, (names, index)) in zip(axes, matrices.items()):
        image = ax.imshow(index, cmap="Blues", vmin=0.0, vmax=1.0)
        ax.set_xticks(range(len(names)), names, rotation=60, ha="right", rotation_mode="anchor")
        ax.set_yticks(range(len(names)), names)
        ax.set_title({"accel": "accelerometer", "gyro": "gyro"}[sensor])
        ax.set_xlabel("could be reproduced by")
        for i in range(len(names)):
            for j in range(len(names)):
                if index[i, j] >= 0.05:
                    ax.text(j, i, "%.2f" % index[i, j], ha="center", va="center", fontsize=7,
                            color="white" if index[i, j] > 0.6 else "black")
    axes[0].set_ylabel("share of this effect")
    figure.colorbar(image, ax=list(axes), shrink=0.7, label="alias index")
    figure.suptitle("Alias matrix, %s; silent effects are left out" % title)
    save(figure, path)
