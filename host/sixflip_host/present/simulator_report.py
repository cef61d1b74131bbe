"""The part of a gap's page that compares with a simulator: its pictures, which take a Comparison
of one motion, and its sections."""
import numpy as np
from scipy.signal import welch

from ..capture.registers import SENSORS
from ..diagnosis.simulator import pairing
from ..figures import COLOURS, canvas, save
from . import simulator_words

SHOWN_S = 12.0  # of a log, in which a move can still be seen
UNIT = {"accel": "m/s²", "gyro": "rad/s"}
BEFORE, AFTER, REAL = COLOURS[0], COLOURS[2], "0.35"


def logs(fitted):
    """(simulated, real, simulated with what was found) (n, 3) of a conventions.SensorFit, each as
    it was read where both are known at the same times behind a low-pass that one of them has."""
    pair = fitted.as_read if np.array_equal(fitted.as_read.t, fitted.pair.t) else fitted.pair
    real, simulated = pair.real(fitted.kind), pair.simulated(fitted.kind)
    return simulated, real, real + fitted.fit.left @ fitted.fit.axes / fitted.fit.unit


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
    for column, (kind, fitted) in enumerate(comparison.fits.items()):
        simulated, real, mended = logs(fitted)
        part = liveliest(fitted.pair, real)
        t = fitted.pair.t[part]
        for i, axis in enumerate("xyz"):
            ax = axes[i, column]
            ax.plot(t, real[part, i], color=REAL, lw=2.2, label="real")
            ax.plot(t, simulated[part, i], color=BEFORE, lw=1.0, label="simulated")
            ax.plot(t, mended[part, i], "--", color=AFTER, lw=1.2,
                    label="simulated, put right")
            ax.set_ylabel("%s, %s" % (axis, UNIT[kind]))
        axes[0, column].set_title(SENSORS[kind])
        axes[0, column].legend(fontsize=8, loc="upper right")
        axes[2, column].set_xlabel("time of the simulator's log, s")
    save(figure, path)


def spectra(comparison, path):
    """Spectra of simulated less real, before and after, in the band that was compared."""
    figure, axes = canvas(1, max(1, len(comparison.fits)), 11.0, 3.6)
    for column, (kind, fitted) in enumerate(comparison.fits.items()):
        simulated, real, mended = logs(fitted)
        ax = axes[0, column]
        for values, colour, words in ((simulated, BEFORE, "simulated less real"),
                                      (mended, AFTER, "put right less real")):
            f, power = welch(values - real, pairing.GRID_HZ,
                             nperseg=min(512, len(values)), axis=0)
            inside = (f > 0) & (f <= fitted.pair.band_hz)
            ax.loglog(f[inside], np.sqrt(power[inside].sum(axis=1)), color=colour, label=words)
        ax.set_title(SENSORS[kind])
        ax.set_xlabel("frequency, Hz")
        ax.set_ylabel("%s/√Hz" % UNIT[kind])
        ax.legend(fontsize=8)
    save(figure, path)


def sections(page, simulator):
    """The layers of the comparison with a simulator, for its author."""
    for log in simulator["logs"]:
        for remark in log["remarks"]:
            page.paragraph(remark, note=True)
    page.heading("The simulator's conventions")
    if simulator["conventions"]:
        page.table(simulator_words.CONVENTIONS, simulator_words.convention_rows(simulator))
    else:
        page.paragraph("None is other than a sensor's, as far as these logs can show.")
    page.heading("Parameters side by side")
    page.table(simulator_words.PARAMETERS, simulator_words.parameter_rows(simulator, True))
    if simulator["effects"]:
        page.heading("Effects by the difference of both logs")
        page.table(simulator_words.EFFECTS, simulator_words.effect_rows(simulator))
    page.heading("What it does to a robot")
    for line in simulator_words.lines(simulator):
        page.paragraph(line)
    settings = simulator_words.settings(simulator)
    if settings:
        page.heading("Settings to paste")
        page.table(("setting", "value"), settings)
        page.paragraph("As code or in a simulator's own format: sixflip diagnose with --json into "
                       "a file, then sixflip export FILE --to numpy, gz, mujoco, genesis, "
                       "isaaclab, matlab or kalibr.", note=True)
