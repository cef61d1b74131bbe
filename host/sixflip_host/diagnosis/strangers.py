"""Nameless hypotheses, one a domain, that compete with the library's effects on equal terms.

Shared ones have the same coefficients in every session: what is smooth in temperature, what
gravity adds in proportion to it, what is even and odd in orientation, follows the pose before or
the time since the move, forgets how far the gyro was turned, changes sign with the flip, repeats
with the time since switching on, what is there while the sensor is shaken. Private ones have
coefficients of each session's own (session_strangers.py). The widths of their priors are tried
over a decade: of a stranger no size is known.
"""
from dataclasses import replace

import numpy as np
from numpy.polynomial import legendre

from sixflip.poses import faces

from ..experiment.projection import by_axis
from ..experiment.session_terms import LAGS_S, RECTIFIED
from ..experiment.terms import Design, harmonics
from ..experiment.way_memory import TURNED_S

SCALE = {"accel": 5.0, "gyro": 0.05}  # mg, deg/s: as large as the library's effects are
HATS = 6  # corners of what is smooth in time and repeats in every session
FADES_S = (5.0, 20.0, 80.0)  # of what follows a move
DEGREES = 6  # of a bend: a box in few poses shows no finer one
PRODUCT_DEGREES = (2, 3, 5)  # of a product's; of five degrees the fourth tells least from these
# Of the others: their own.
DOMAIN = {"jump": "time", "periodic": "frequency", "own_time": "time",
          "time_orientation": "time", "thermal_orientation": "temperature",
          "thermal_bend": "temperature",
          "bend": "orientation", "product_bend": "orientation", "shaking": "amplitude"}


def domain(effect):
    """GAP's domain of a nameless effect."""
    return DOMAIN.get(effect, effect)


def shared(session, up, sensor, reference_c):
    """Nameless functions whose coefficients are those of the sensor; reference_c: temperature
    that all sessions have in common, about which those of temperature are the same functions in
    each."""
    n, m = session.n, session.moment(up)
    f = np.stack(m.f, 1)
    scale = SCALE[sensor]
    designs = [smooth("time", hats(session.t, HATS), n, scale)]
    if session.thermal:
        # A part may lag behind its thermometer by itself, too: to first order that is a share of
        # the temperature's rate, which else would be named. Without a lag last: see hypotheses.
        for lag in sorted((lag for lag in LAGS_S if lag >= 0.0), reverse=True):
            t = (session.thermometer.lagged(session.t, lag) - reference_c) / 5.0
            designs.append(smooth("temperature", [t, t ** 2, t ** 3], n, scale,
                                   "lag %g s" % lag if lag else ""))
        t = (session.temperature - reference_c) / 5.0
        designs.append(smooth("thermal_orientation", [t * f[:, i] for i in range(3)], n, scale))
        columns = by_axis([t[:, None] ** 2 * f]).reshape(-1, 3)
        designs.append(Design("thermal_bend", "", "xyz", (0, 1, 2), columns, np.full(3, scale),
                              beside=True))
    before = np.stack(m.before, 1)
    history = [before[:, i] for i in range(3)] + [before[:, i] * before[:, j] for i in range(3)
                                                  for j in range(i)]
    designs.append(smooth("history", history, n, scale))
    if sensor == "gyro":
        for tau, turned in zip(TURNED_S, session.turned.transpose(1, 2, 0)):
            designs.append(smooth("time_since_move", turned, n, scale, "turned, tau %g s" % tau))
    for tau in FADES_S:
        fade = np.exp(-session.since / tau)
        # of how it lay before, and of how it lies now, as on what gives way
        since = [fade] + [of[:, i] * fade for of in (before - f, f) for i in range(3)]
        designs.append(smooth("time_since_move", since, n, scale, "tau %g s" % tau))
    designs.append(smooth("orientation", harmonics(f, sensor), n, scale))
    if sensor == "accel":
        designs += [bend(f, scale), product_bend(f, scale)]
    if session.shaken_mg:
        designs.append(_shaking(session.vibration / session.shaken_mg, scale))
    return [*designs, _flip(session, scale)]


def _shaking(rms, scale):
    """Design of what is there while a vibration of rms (n,) is, the strongest 1."""
    return smooth("shaking", [power(rms) for power in RECTIFIED.values()], len(rms), scale)


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
    return Design("flip", "", keys, axes, np.stack(columns, 1), np.full(len(keys), scale))


def smooth(name, functions, n, scale, variant="", choices=()):
    """Design of these functions (n,) on each axis; choices: of columns, one a session."""
    keys, axes, columns = [], [], []
    for number, values in enumerate(functions):
        for axis in range(3):
            column = np.zeros((n, 3))
            column[:, axis] = values
            keys.append("%s%d" % ("xyz"[axis], number))
            axes.append(axis)
            columns.append(column.reshape(-1))
    return Design(name, variant, keys, axes, np.stack(columns, 1),
                  np.full(len(keys), scale), choices)


def bend(f, scale):
    """Design of what any bend of an axis is made of: functions of what that axis feels, f (n, 3)
    g, beyond the straight line. By itself it is no hypothesis: another form of one."""
    felt = [legendre.Legendre.basis(degree)(f) for degree in range(2, DEGREES + 1)]
    felt.append(np.abs(f))
    columns = np.einsum("dni,ij->nidj", np.stack(felt), np.eye(3)).reshape(f.size, -1)
    keys = ["%s%d" % (axis, number) for number in range(len(felt)) for axis in "xyz"]
    return Design("bend", "", keys, [0, 1, 2] * len(felt), columns, np.full(len(keys), scale),
                  beside=True)


def product_bend(f, scale):
    """Design of what a product of two axes becomes where it is none but a function of one: of
    each product of f (n, 3) g, 1 at most, on each axis. By itself it is no hypothesis."""
    products = [2.0 * f[:, i] * f[:, j] for i in range(3) for j in range(i)]
    return replace(smooth("product_bend", [legendre.Legendre.basis(degree)(u) for u in products
                                            for degree in PRODUCT_DEGREES], len(f), scale),
                   beside=True)


def hats(x, number):
    """Piecewise straight functions between equally spaced corners."""
    u = (x - x.min()) / max(float(np.ptp(x)), 1e-9) * (number - 1)
    return [np.clip(1.0 - np.abs(u - k), 0.0, None) for k in range(number)]
