"""What all pictures have in common: a canvas that needs no display, the colours of the axes."""

import io

from . import atomic_write

COLOURS = ("#c0392b", "#27864a", "#2455a4")  # of x, y, z
DPI = 110


def canvas(rows, columns, width, height):
    """(figure, axes (rows, columns)) that need no display; width and height in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, squeeze=False)


def save(figure, path):
    """Write a figure as PNG, whole or not at all."""
    atomic_write.write_bytes(path, png(figure))


def png(figure):
    """The bytes of a figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    return buffer.getvalue()
