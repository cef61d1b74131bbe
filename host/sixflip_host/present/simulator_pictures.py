"""The pictures of a comparison with a simulator; both take a Comparison of one motion and write a
PNG."""
import numpy as np
from scipy.signal import welch

from ..diagnosis.simulator import pairing
from ..figures import COLOURS, canvas, save

SHOWN_S = 12.0  # of a log, in which a move can still be seen
UNIT = {"accel": "m/s²", "gyro": "rad/s"}
NAME = {"accel": "accelerometer", "gyro": "gyro"}
BEFORE, AFTER, REAL = COLOURS[0], COLOURS[2], "0.35"


def logs(found):
    """(simulated, real, simulated with what was found) (n, 3) of a conventions.SensorFit."""
    pair = found.pair
    real = pair.force if found.kind == "accel" else pair.rate
    simulated = pair.sim_force if found.kind == "accel" else pair.sim_rate
    return simulated, real, real + found.fit.left @ found.fit.axes / found.fit.unit


def liveliest(pair, values):
    """Rows of the stretch in which values (n, 3) change most."""
    wide = int(SHOWN_S * pairing.GRID_HZ)
    if len(values) <= wide:
        return slice(0, len(values))
    change = np.concatenate([[0.0], np.cumsum((np.diff(values, axis=0) ** 2).sum(axis=1))])
    first = int((change[wide - 1:] - change[:len(change) - wide + 1]).argmax())
    return slice(first, first + wide)


def traces(comparison, path):
    """Real, simulated, and simulated with what was found, all axes, where most happens."""
    figure, axes = canvas(3, max(1, len(comparison.fits)), 11.0, 6.6)
    for column, (kind, found) in enumerate(comparison.fits.items()):
        simulated, real, mended = logs(found)
        part = liveliest(found.pair, real)
        t = found.pair.t[part]
        for i, axis in enumerate("xyz"):
            ax = axes[i, column]
            ax.plot(t, real[part, i], color=REAL, lw=2.2, label="real")
            ax.plot(t, simulated[part, i], color=BEFORE, lw=1.0, label="simulated")
            ax.plot(t, mended[part, i], "--", color=AFTER, lw=1.2,
                    label="simulated, put right")
            ax.set_ylabel("%s, %s" % (axis, UNIT[kind]))
        axes[0, column].set_title(NAME[kind])
        axes[0, column].legend(fontsize=8, loc="upper right")
        axes[2, column].set_xlabel("time of the simulator's log, s")
    save(figure, path)


def spectra(comparison, path):
    """Spectra of simulated less real, before and after, in the band that was compared."""
    figure, axes = canvas(1, max(1, len(comparison.fits)), 11.0, 3.6)
    for column, (kind, found) in enumerate(comparison.fits.items()):
        simulated, real, mended = logs(found)
        ax = axes[0, column]
        for values, colour, words in ((simulated, BEFORE, "simulated less real"),
                                      (mended, AFTER, "put right less real")):
            f, power = welch(values - real, pairing.GRID_HZ,
                             nperseg=min(512, len(values)), axis=0)
            inside = (f > 0) & (f <= found.pair.band_hz)
            ax.loglog(f[inside], np.sqrt(power[inside].sum(axis=1)), color=colour, label=words)
        ax.set_title(NAME[kind])
        ax.set_xlabel("frequency, Hz")
        ax.set_ylabel("%s/√Hz" % UNIT[kind])
        ax.legend(fontsize=8)
    save(figure, path)
