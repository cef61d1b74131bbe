"""The library's effects, and generic discrepancies, as columns over the blocks of a session.

Effects come from sixflip_sim's one definition: an effect's terms at the moments measured. Where
an effect has a shape (a time constant, a lag) or a bend (a square beside the slope) it has
several variants; they compete, and all go by the effect's one name.
"""
import copy

import numpy as np

from sixflip import faces
from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

from .thermometer import MOVES_C

LAGS_S = (0.0, 15.0, 30.0, 60.0, -30.0)
WARM_UP_S = (30.0, 60.0, 120.0, 240.0, 480.0)
CREEP_S = (5.0, 15.0, 30.0, 60.0, 120.0)
LONG_MEMORY_S = 30.0
LEAST_VIBRATION_MG = 5.0
DOMAIN = {  # where an effect shows itself
    "thermal_bias": "temperature", "thermal_scale": "temperature", "thermal_rate": "temperature",
    "warm_up": "time", "drift": "time", "supply": "time", "quadratic": "orientation",
    "cross_quadratic": "orientation", "cubic": "orientation", "asymmetry": "orientation",
    "g_sensitivity": "orientation", "earth_rate": "orientation", "hysteresis": "history",
    "creep": "time_since_move", "box_tilt": "across_gravity", "table_tilt": "across_gravity",
    "local_gravity": "along_gravity", "vibration": "frequency",
    "vibration_rectification": "amplitude", "quantisation": "amplitude",
    "dead_band": "amplitude", "saturation": "amplitude", "sample_rate": "timing",
    "dropped_samples": "timing", "filter_lag": "motion", "lever_arm": "motion",
    "torn_reads": "noise", "axis_swap": "orientation"}


class Design:
    """Columns (3n, k) of one variant of one effect in one session.

    keys (k,): the effect's own; those of a bend beside it end in "+". axes (k,): 0..2, the
    axis whose coefficient it is. prior (k,): a size ten times the typical one.
    """

    def __init__(self, effect, variant, keys, axes, columns, prior):
        self.effect, self.variant, self.keys = effect, variant, tuple(keys)
        self.axes, self.columns, self.prior = tuple(axes), columns, prior

    @property
    def generic(self):
        return self.effect.startswith("~")


def of_terms(name, sensor, moment, n, variant="", only=None, shape=None, chip="mpu6050"):
    """Design of an effect's terms; only: the keys wanted."""
    effect = EFFECTS[name](sensor, {}, shape)
    keys, axes, columns = [], [], []
    for key, axis, value in effect.terms(moment):
        if only is not None and key not in only:
            continue
        column = np.zeros((n, 3))
        column[:, axis] = value
        keys.append(key)
        axes.append(axis)
        columns.append(column.reshape(-1))
    size = typical.size(name, chip, sensor)[0]
    prior = 10.0 * (abs(size) if size else 1.0)
    return Design(name, variant, keys, axes, np.stack(columns, 1), np.full(len(keys), prior))


def bent(design, other, prior):
    """design with the columns of another function of the same thing beside it."""
    keys = design.keys + tuple(k + "+" for k in other.keys)
    return Design(design.effect, design.variant + "+", keys, design.axes + other.axes,
                  np.hstack([design.columns, other.columns]),
                  np.concatenate([design.prior, np.full(len(other.keys), prior)]))


def powered(design, columns, prior):
    """design with further columns, one for each of its own."""
    twin = Design(design.effect, design.variant, design.keys, design.axes, columns, design.prior)
    return bent(design, twin, prior)


def agree(sessions):
    """Settle for all sessions at once what is looked for, so that the columns of one are those
    of the others: thermal (every one has a thermometer, and one of them moved), shaken."""
    thermal = all(s.thermometer is not None for s in sessions) and max(
        s.thermometer.moved for s in sessions) >= MOVES_C
    shaken = max(s.vibration.max() for s in sessions) > LEAST_VIBRATION_MG
    for session in sessions:
        session.thermal, session.shaken = thermal, shaken


def library(session, up, sensor, reference_c, chip):
    """list of Design: every variant of every effect that the rests of the sessions agreed on
    can show; columns of zeros where this one shows nothing of it."""
    m, n = session.moment(up), session.n
    found = []

    def terms(name, variant="", moment=m, **options):
        found.append(of_terms(name, sensor, moment, n, variant, chip=chip, **options))
        return found[-1]

    if session.thermal:
        _thermal(session, m, terms, found, sensor, reference_c)
    for tau in WARM_UP_S:
        terms("warm_up", "tau %g s" % tau, shape={"tau_s": tau})
    history = terms("hysteresis")
    found.append(powered(history, history.columns ** 3, history.prior[0]))
    if sensor == "gyro":
        full = terms("g_sensitivity")
        found.append(powered(full, full.columns ** 3, full.prior[0]))
        return found
    for name in ("quadratic", "cubic"):
        plain = terms(name)
        felt = np.stack(m.f, 1)
        felt2 = np.stack([np.where(np.arange(3) == i, felt ** 2, 0.0) for i in range(3)], 2)
        found.append(powered(plain, plain.columns * _own(felt2, plain.axes), plain.prior[0]))
    cross = terms("cross_quadratic")
    terms("cross_quadratic", "squares", only=[k for k in cross.keys if k[1] == k[2]])
    terms("cross_quadratic", "products", only=[k for k in cross.keys if k[1] != k[2]])
    terms("asymmetry")
    for tau in CREEP_S:
        terms("creep", "tau %g s" % tau, shape={"tau_s": tau})
        if tau >= LONG_MEMORY_S:  # what came before the placement before is not forgotten yet
            felt = copy.copy(m)
            felt.before = tuple(session.remembered(up, tau).T)
            terms("creep", "tau %g s, all placements" % tau, felt, shape={"tau_s": tau})
    if session.shaken:
        terms("vibration_rectification", "vertical", shape={"vertical": 1})
        terms("vibration_rectification", "all round", shape={"vertical": 0})
    return found


def _own(table, axes):
    """(3n, k): column i of table (n, 3, 3), spread as its axis has it."""
    return np.stack([table[:, :, i].reshape(-1) for i in axes], 1)


def _thermal(session, m, terms, found, sensor, reference_c):
    """Slopes over the temperature with and without a lag, and with a square."""
    for lag in LAGS_S:
        felt = copy.copy(m)
        felt.temperature = session.thermometer.lagged(session.t, lag)
        felt.temperature_rate = session.thermometer.lagged_rate(session.t, lag)
        label = "lag %g s" % lag if lag else ""
        shape = {"reference_c": reference_c}
        bias = terms("thermal_bias", label, felt, only=("x", "y", "z"), shape=shape)
        dt = np.repeat(felt.temperature - reference_c, 3)[:, None]
        found.append(powered(bias, bias.columns * dt, 0.1 * bias.prior[0]))
        if sensor == "accel":
            scale = terms("thermal_scale", label, felt, shape=shape)
            if not lag:
                found.append(powered(scale, scale.columns * dt, 0.1 * scale.prior[0]))
        terms("thermal_rate", label, felt)


def generics(session, up, sensor):
    """list of Design whose effect is "~domain": smooth in one variable, named after none."""
    n, m = session.n, session.moment(up)
    f = np.stack(m.f, 1)
    scale = 5.0 if sensor == "accel" else 0.05
    found = [_generic("time", _hats(session.t, 6), n, scale)]
    if session.thermal:
        t = (session.temperature - session.temperature.mean()) / 5.0
        found.append(_generic("temperature", [t, t ** 2, t ** 3], n, scale))
    before = np.stack(m.before, 1)
    fade = np.exp(-session.since / 20.0)
    history = [before[:, i] for i in range(3)] + [before[:, i] * before[:, j] for i in range(3)
                                                  for j in range(i)]
    found.append(_generic("history", history, n, scale))
    since = [fade] + [(before[:, i] - f[:, i]) * fade for i in range(3)]
    found.append(_generic("time_since_move", since, n, scale))
    found.append(_generic("orientation", _harmonics(f, sensor), n, scale))
    return [*found, _flip(session, scale)]


def _flip(session, scale):
    """Along the axis of each face, what changes sign with the flip; zero where no flip was.
    Across it that is the table's tilt and the box's."""
    sign = np.where(session.code % 2 == 1, 1.0, -1.0)  # codes 1, 3, ... are a, the others b
    keys, axes, columns = [], [], []
    for face in range(len(faces.AXIS)):
        on = session.face == face
        column = np.zeros((session.n, 3))
        if len(np.unique(sign[on])) == 2:
            column[on, faces.AXIS[face]] = sign[on]
        keys.append("%s%d" % ("xyz"[faces.AXIS[face]], face))
        axes.append(faces.AXIS[face])
        columns.append(column.reshape(-1))
    return Design("~flip", "", keys, axes, np.stack(columns, 1), np.full(len(keys), scale))


def _generic(domain, functions, n, scale):
    keys, axes, columns = [], [], []
    for number, values in enumerate(functions):
        for axis in range(3):
            column = np.zeros((n, 3))
            column[:, axis] = values
            keys.append("%s%d" % ("xyz"[axis], number))
            axes.append(axis)
            columns.append(column.reshape(-1))
    return Design("~" + domain, "", keys, axes, np.stack(columns, 1),
                  np.full(len(keys), scale))


def _hats(x, number):
    """Piecewise straight functions between equally spaced corners."""
    u = (x - x.min()) / max(float(np.ptp(x)), 1e-9) * (number - 1)
    return [np.clip(1.0 - np.abs(u - k), 0.0, None) for k in range(number)]


def _harmonics(f, sensor):
    """Functions of the direction of gravity: degrees 2 and 3 (gyro: 1, too)."""
    x, y, z = f.T
    second = [x * x, y * y, x * y, x * z, y * z]
    third = [x ** 3, y ** 3, z ** 3, x * y * z, x * y * y, y * z * z, z * x * x]
    return ([x, y, z] if sensor == "gyro" else []) + second + third
