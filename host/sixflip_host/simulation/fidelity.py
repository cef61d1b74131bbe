"""How much the simulator is like real recordings: `make fidelity`.

Every parameter is fitted to the first half of a recording and judged on the second half, so
that a ratio near 1 is a prediction and no tautology.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

from ..capture import recordings
from ..errors import SixflipError
from ..experiment import signal_measures as measures
from ..figures import save
from ..terminal import console, table
from . import fidelity_effects, replica

TAUS_S = (0.1, 0.5, 1.0, 3.0)


def rests(place):
    """{(name, kind): (counts (n, 3) at rest, LSB, rate)} of the recordings."""
    recorded = {}
    still = recordings.suarez(place)
    recorded["suarez", "accel"] = still[:, :3], 16384.0, 100.0
    recorded["suarez", "gyro"] = still[:, 3:], 131.0, 100.0
    counts, _, rate = recordings.tree(place, "non_event_far_new_sd_v10")
    recorded["tree", "accel"] = counts, 16384.0, rate
    accel, gyro = recordings.xsens(place)
    recorded["xsens", "accel"] = accel[100:5000], 415.0 * replica.STANDARD_G, 100.0
    recorded["xsens", "gyro"] = gyro[100:5000], 4778.0 * np.pi / 180.0, 100.0
    return recorded


def simulated(kind, counts, lsb, rate):
    """The replica of the first half, as long as the second."""
    half = len(counts) // 2
    make = replica.accel_at_rest if kind == "accel" else replica.gyro_at_rest
    return make(counts[:half], lsb, rate, len(counts) - half)


def rest_rows(name, kind, counts, lsb, rate):
    """Rows (what, unit, real, simulated) of one rest, the middle one of the three axes."""
    real, twin = counts[len(counts) // 2:], simulated(kind, counts, lsb, rate)
    unit, per = ("mg", lsb / 1000.0) if kind == "accel" else ("deg/s", lsb)
    label = "%s %s" % (name, kind)
    rows = [(label + " noise", unit, *pair(measures.white, real, twin, per))]
    for tau in TAUS_S:
        m = int(round(tau * rate))
        if 3 * m > len(real):
            continue
        rows.append((label + " Allan at %g s" % tau, unit,
                     *pair(lambda x, m=m: measures.allan(x, m), real, twin, per)))
    edges = [rate * share for share in (0.005, 0.05, 0.2, 0.5)]
    for low, high in zip(edges, edges[1:]):
        rows.append((label + " spectrum %.2g-%.3g Hz" % (low, high), unit + "/rtHz",
                     *pair(lambda x, a=low, b=high: measures.band(x, rate, a, b), real, twin,
                           per)))
    rows.append((label + " step", "counts", *pair(measures.step, real.astype(int), twin, 1.0)))
    return rows


def pair(measure, real, twin, per):
    """Mean over the axes of a measure, real and simulated, in the unit that `per` makes."""
    return (float(np.mean(measure(real))) / per, float(np.mean(measure(twin))) / per)


def all_rows(place):
    """Every row of the table."""
    rows = []
    for (name, kind), (counts, lsb, rate) in rests(place).items():
        rows += rest_rows(name, kind, counts, lsb, rate)
    return rows + fidelity_effects.rows(place)


def draw(place, path):
    """Allan deviation and spectrum of every rest, real against simulated: one PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    recorded = rests(place)
    figure = Figure(figsize=(3.4 * len(recorded), 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, len(recorded))
    for column, ((name, kind), (counts, lsb, rate)) in enumerate(recorded.items()):
        unit, per = ("mg", lsb / 1000.0) if kind == "accel" else ("deg/s", lsb)
        for words, data, style in (("real", counts[len(counts) // 2:], "C0-"),
                                   ("simulated", simulated(kind, counts, lsb, rate), "C1--")):
            m = np.unique(np.geomspace(1, len(data) // 4, 25).astype(int))
            deviation = [np.mean(measures.allan(data, k)) / per for k in m]
            axes[0, column].loglog(m / rate, deviation, style, label=words)
            frequencies, density = measures.spectrum(data, rate)
            axes[1, column].loglog(frequencies[1:], density[1:].mean(axis=1) / per, style,
                                   label=words)
        axes[0, column].set_title("%s %s" % (name, kind))
        axes[0, column].set_xlabel("averaging time, s")
        axes[0, column].set_ylabel("Allan deviation, " + unit)
        axes[1, column].set_xlabel("frequency, Hz")
        axes[1, column].set_ylabel(unit + "/√Hz")
        axes[0, column].legend()
    save(figure, path)


def main(argv=None):
    parser = argparse.ArgumentParser(prog="fidelity", description=__doc__.split("\n")[0])
    parser.add_argument("--out", default="fidelity-output", metavar="FOLDER",
                        help="where the plot goes (default: fidelity-output)")
    args = parser.parse_args(argv)
    try:
        place = recordings.folder()
        rows = all_rows(place)
        Path(args.out).mkdir(parents=True, exist_ok=True)
        draw(place, str(Path(args.out) / "fidelity.png"))
    except SixflipError as error:
        print("fidelity: %s" % error, file=sys.stderr)
        return error.exit_code
    screen = console()
    screen.print(table("Simulator against real recordings, judged on the half it was not fitted "
                       "to",
                       ("quantity", "unit", "real", "simulated", "ratio"),
                       [(what, unit, "%.4g" % real, "%.4g" % twin, ratio(real, twin))
                        for what, unit, real, twin in rows]))
    print("A chainsaw does not saw evenly: its rms differs from half to half of the recording.")
    print("plots: %s" % (Path(args.out) / "fidelity.png"))
    return 0


def ratio(real, twin):
    return "%.2f" % (twin / real) if real else ("1.00" if twin == real else "-")


if __name__ == "__main__":
    sys.exit(main())
