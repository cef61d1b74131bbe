"""The pictures of a diagnosis, one function each: where the gap lies, what is left of the
readings, their noise, and which effects look alike. All write a PNG."""
import numpy as np

from ..capture.registers import SENSORS
from ..diagnosis import aliases
from ..experiment import long_rest, signal_measures
from ..figures import COLOURS, canvas, save

UNIT = {"accel": "mg", "gyro": "°/s"}
DOMAINS = ("along_gravity", "across_gravity", "orientation", "flip", "time", "time_since_move",
           "temperature", "history", "frequency", "noise", "amplitude", "timing", "motion",
           "session")
AXES = "xyz"


def heat_map(diagnosis, path):
    """Share of the excess by domain and channel; nothing found is an empty map."""
    channels = [(k, a) for k in ("accel", "gyro") for a in AXES] + [("device", None)]
    table = np.zeros((len(DOMAINS), len(channels)))
    for place in diagnosis.where:
        row = DOMAINS.index(place.domain)
        for column, (sensor, axis) in enumerate(channels):
            if sensor == place.sensor and place.axis in (axis, None):
                table[row, column] = max(table[row, column], place.share)
    figure, axes = canvas(1, 1, 6.5, 5.4)
    ax = axes[0, 0]
    ax.imshow(table, cmap="Reds", vmin=0.0, vmax=1.0, aspect="auto")
    ax.set_xticks(range(len(channels)), ["%s%s" % (s, " " + a if a else "") for s, a in channels],
                  rotation=35, ha="right", rotation_mode="anchor")
    ax.set_yticks(range(len(DOMAINS)), [d.replace("_", " ") for d in DOMAINS])
    for i, j in np.argwhere(table >= 0.005):
        ax.text(j, i, "%.0f" % (100 * table[i, j]), ha="center", va="center", fontsize=8,
                color="white" if table[i, j] > 0.6 else "black")
    ax.set_title("Where the gap lies: share of the excess, %")
    save(figure, path)


VARIABLE = {"temperature": "temperature, °C", "time": "time since start, s",
            "time_since_move": "time since the move, s",
            "orientation": "gravity along the axis, g",
            "history": "gravity along the axis in the pose before, g"}


def residuals(gap, path):
    """Residual of every block against the variable named, before and after the causes.
    Before: the nominal model fitted with the causes beside it, so that it takes up none."""
    domain = gap.causes[0].domain if gap.causes and gap.causes[0].domain in VARIABLE else "time"
    figure, axes = canvas(2, 3, 11.0, 5.6)
    for number, (session, nominal) in enumerate(gap.parts):
        before, after = both(gap, number)
        x = variable(session, nominal, domain)
        for i in range(3):
            for row, values in enumerate((before, after)):
                axes[row, i].plot(x[:, i], values[:, i], "os^D"[number % 4], ms=3.5,
                                  color=COLOURS[i], alpha=1.0 if number % 2 == 0 else 0.45,
                                  mfc=None if number % 2 == 0 else "none",
                                  label="session %d" % (number + 1) if row == 0 else None)
    for i in range(3):
        low = min(ax.get_ylim()[0] for ax in axes[:, i])
        high = max(ax.get_ylim()[1] for ax in axes[:, i])
        for row, words in enumerate(("before", "after")):
            axes[row, i].set_ylim(low, high)
            axes[row, i].axhline(0.0, color="0.6", lw=0.8)
            axes[row, i].set_title("%s %s, %s" % (SENSORS[gap.kind], AXES[i], words), fontsize=10)
        axes[1, i].set_xlabel(VARIABLE[domain])
    axes[0, 0].legend(fontsize=8)
    for row in range(2):
        axes[row, 0].set_ylabel("residual, " + UNIT[gap.kind])
    save(figure, path)


def both(gap, number):
    """(before, after): residuals (n, 3) of one session; the nuisance is that of the fit with
    the causes, the noise's metric left aside (least squares)."""
    unit = gap.units[number]
    columns = gap.shared.index
    left = unit.z
    added = np.zeros(len(unit.rows.y))
    if len(columns):
        theta = gap.coefficients()
        left = unit.z - unit.columns[:, columns] @ theta
        raw = np.hstack([d.columns for d in unit.designs])[:, columns]
        added = raw @ theta
    after = unit.in_rows(left).reshape(-1, 3)
    added = added.reshape(-1, 3)
    return after + added - added.mean(axis=0), after


def variable(session, nominal, domain):
    """(n, 3): what to draw against, per axis."""
    up = nominal.up[session.placement]
    if domain == "temperature" and session.temperature is not None:
        return np.repeat(session.temperature[:, None], 3, axis=1)
    if domain == "time_since_move":
        return np.repeat(session.since[:, None], 3, axis=1)
    if domain == "orientation":
        return up
    if domain == "history":
        return session.before(nominal.up)
    return np.repeat(session.t[:, None], 3, axis=1)


def noise(diagnosis, loops, path):
    """Spectrum and Allan deviation of the longest rest, real against simulated."""
    kinds = [k for k in ("accel", "gyro")
             if getattr(diagnosis.sessions[0].capture, k) is not None]
    figure, axes = canvas(2, len(kinds), 5.2 * len(kinds), 6.4)
    for column, kind in enumerate(kinds):
        pairs = [("real", diagnosis.sessions[-1], "-")]
        if kind in loops:
            pairs.append(("simulated", loops[kind].after_twin, "--"))
        for words, session, style in pairs:
            rest = long_rest.longest(session) or (0, len(session.capture))
            x = long_rest.scaled(session, kind)[rest[0]:rest[1]]
            _noise_curves(axes[:, column], x, session.rate, words, style)
        axes[0, column].set_title("%s, longest rest" % SENSORS[kind])
        axes[0, column].set_ylabel(UNIT[kind] + "/√Hz")
        axes[0, column].set_xlabel("frequency, Hz")
        axes[1, column].set_ylabel("Allan deviation, " + UNIT[kind])
        axes[1, column].set_xlabel("averaging time, s")
        axes[0, column].legend(fontsize=7, ncols=2)
    save(figure, path)


def _noise_curves(axes, x, rate, words, style):
    frequencies, density = signal_measures.spectrum(x, rate, 512)
    m = np.unique(np.geomspace(1, max(2, len(x) // 4), 20).astype(int))
    deviation = np.array([signal_measures.allan(x, k) for k in m])
    for i in range(3):
        axes[0].loglog(frequencies[1:], density[1:, i], style, color=COLOURS[i], lw=1.0,
                       label="%s %s" % (words, AXES[i]))
        axes[1].loglog(m / rate, deviation[:, i], style, color=COLOURS[i], lw=1.2)


def alias_matrix(diagnosis, path):
    """How much of each effect another could be, for the captures at hand."""
    tables = {}
    for kind, gap in diagnosis.gaps.items():
        gram = sum(u.gram.at(i) for u, i in zip(gap.units, gap.levels()))
        names, table = aliases.alias_table(gram, gap.options)
        if names:
            tables[kind] = names, np.nan_to_num(table)
    if tables:
        draw_alias(tables, path, "captures at hand")
    return bool(tables)


def draw_alias(matrices, path, title):
    """The alias index as a picture: row a, column b, how much of a could be b. matrices: {sensor:
    (names, index (n, n))}."""
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
        ax.set_title(SENSORS[sensor])
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


def poses(gap, path):
    """Residual of each placement in the order of the capture, one panel a session."""
    from sixflip.poses.faces import pose_name
    figure, axes = canvas(len(gap.parts), 1, 11.0, 1.2 + 2.2 * len(gap.parts))
    for number, (session, _) in enumerate(gap.parts):
        before, after = both(gap, number)
        ax = axes[number, 0]
        places = np.unique(session.placement)
        for i in range(3):
            shift = 0.22 * (i - 1)
            for values, look in ((before, {"color": COLOURS[i], "alpha": 0.35}),
                                 (after, {"color": COLOURS[i]})):
                mean = [values[session.placement == p, i].mean() for p in places]
                ax.bar(np.arange(len(places)) + shift, mean, 0.2, **look)
        ax.set_xticks(range(len(places)), [pose_name(int(session.code[session.placement == p][0]))
                                           for p in places], rotation=90, fontsize=7)
        ax.axhline(0.0, color="0.3", lw=0.7)
        ax.set_ylabel(UNIT[gap.kind])
        ax.set_title("%s, session %d: residual of each placement (pale: before; x red, y green, "
                     "z blue)" % (SENSORS[gap.kind], number + 1), fontsize=9)
    save(figure, path)
