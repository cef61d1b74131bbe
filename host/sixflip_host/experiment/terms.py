"""The library's effects, and generic discrepancies, as columns over the blocks of a session.

Effects come from sixflip_sim's one definition: an effect's terms at the moments measured. Where
an effect has a shape (a time constant, a lag) or a bend (a square beside the slope) it has
several variants; they compete, and all go by the effect's one name.
"""

import copy
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

from .thermometer import MOVES_C

LAGS_S = (0.0, 15.0, 30.0, 60.0, -30.0)  # GAP: a neighbouring thermometer, 10-60 s
WARM_UP_S = (30.0, 60.0, 120.0, 240.0, 480.0)  # GAP: 60-300 s, and an octave to both sides
CREEP_S = (5.0, 15.0, 30.0, 60.0, 120.0)  # GAP: 60-70 s seen on Z; down to a rest's length
LONG_MEMORY_S = 30.0  # longer than two rests with the move between them
PLAY_G = (0.1, 0.2, 0.4)  # widths of a play operator: octaves below half of what a pose changes by
LEAST_VIBRATION_MG = 5.0  # above the quietest rest: more than the noise of a chip (typical.NOISE)
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
# Functions of what acts at a moment, the temperature and the time since power-up.
OF_THE_MOMENT = ("thermal_bias", "thermal_scale", "warm_up", "thermal_rate", "quadratic", "cubic",
                 "cross_quadratic", "asymmetry", "g_sensitivity")


def of_the_moment(sensor):
    """Names of OF_THE_MOMENT that a sensor ("accel", "gyro") can have."""
    return tuple(name for name in OF_THE_MOMENT if sensor in EFFECTS[name].units)


@dataclass(frozen=True, eq=False)
class Design:
    """Columns (3n, k) of one variant of one effect, or of a stranger, in one session.

    keys (k,): the effect's own; axes (k,): 0..2, the axis whose coefficient it is; prior (k,): a
    size ten times the typical one; choices: tuples of columns of which a session has one for its
    own; powers (k,): 1 for the effect's own columns, 2 and 3 for a square and a cube of them, as
    a bend beside a slope; record: it is there because a record of the board has that form;
    beside: it is no hypothesis, but what others may have as a discrepancy; positive: none of its
    coefficients is less than nothing, as a width is not.
    """

    effect: str
    variant: str
    keys: tuple
    axes: tuple
    columns: np.ndarray
    prior: np.ndarray
    choices: tuple = ()
    powers: tuple = ()
    record: bool = False
    beside: bool = False
    positive: bool = False

    def __post_init__(self):
        for name in ("keys", "axes", "choices"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "powers", tuple(self.powers) or (1,) * len(self.keys))

    @property
    def generic(self):
        return is_stranger(self.effect)


def is_stranger(name):
    """True of the name of a hypothesis that is no effect of the library."""
    return name not in EFFECTS


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


def corrected(designs, matrix):
    """The Designs as a nominal correction's matrix (3, 3) leaves them: what a sensor adds to one
    of its axes, as it measures, is in the others too once the correction has mixed them."""
    return [d if d.effect == "box_tilt" else replace(d, columns=np.einsum(
        "ij,njk->nik", matrix, d.columns.reshape(-1, 3, d.columns.shape[1])).reshape(
            d.columns.shape)) for d in designs]


def squared(design, columns, prior):
    """design with a further column for each of its own, a square beside a slope."""
    return replace(design, keys=design.keys * 2, axes=design.axes * 2,
                   columns=np.hstack([design.columns, columns]),
                   prior=np.concatenate([design.prior, np.full(len(design.keys), prior)]),
                   powers=(1,) * len(design.keys) + (2,) * len(design.keys), record=True)


def agreed(sessions):
    """The sessions with what is looked for settled for all of them at once, so that the columns
    of one are those of the others: thermal (every one has a thermometer, and one of them
    moved), shaken."""
    thermal = all(s.thermometer is not None for s in sessions) and max(
        s.thermometer.moved for s in sessions) >= MOVES_C
    shaken = max(s.vibration.max() for s in sessions) > LEAST_VIBRATION_MG
    return [replace(session, thermal=thermal, shaken=shaken) for session in sessions]


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
    terms("hysteresis")
    if sensor == "accel":
        found += remembered(session, m, found[-1])
    if sensor == "gyro":
        terms("g_sensitivity")
        return found
    terms("quadratic")
    terms("cubic")
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


def along_axes(session, nominal, chip):
    """Designs of the accelerometer's bends as functions of what an axis itself feels: it stands a
    degree askew in the box, so that a large bend mixes the box's axes."""
    reads = np.linalg.inv(nominal.matrix)
    reads /= np.linalg.norm(reads, axis=1)[:, None]
    m = copy.copy(session.moment(nominal.up))
    m.f = tuple(reads @ np.stack(m.f))
    return [of_terms(name, "accel", m, session.n, "along the axis", chip=chip)
            for name in ("quadratic", "cubic", "asymmetry")]


def remembered(session, m, plain):
    """Designs of hysteresis in other forms than a share of the pose before: only from which
    side the pose was reached, and a play operator along the whole way."""
    side = np.tanh(3.0 * (np.stack(m.before, 1) - np.stack(m.f, 1)))
    forms = [("side", side)] + [("play %g g" % width, behind) for width, behind in zip(
        PLAY_G, session.played(PLAY_G))]
    found = []
    for variant, values in forms:
        columns = np.einsum("ni,ij->nij", values, np.eye(3)).reshape(-1, 3)
        found.append(Design("hysteresis", variant, plain.keys, plain.axes, columns, plain.prior))
    return found


def _thermal(session, m, terms, found, sensor, reference_c):
    """Slopes over the temperature with and without a lag."""
    for lag in LAGS_S:
        felt = copy.copy(m)
        felt.temperature = session.thermometer.lagged(session.t, lag)
        felt.temperature_rate = session.thermometer.lagged_rate(session.t, lag)
        label = "lag %g s" % lag if lag else ""
        shape = {"reference_c": reference_c}
        bias = terms("thermal_bias", label, felt, only=("x", "y", "z"), shape=shape)
        if not lag:  # a record of the board holds a square, too
            dt = np.repeat(felt.temperature - reference_c, 3)[:, None]
            found.append(squared(bias, bias.columns * dt, 0.1 * bias.prior[0]))
        if sensor == "accel":
            terms("thermal_scale", label, felt, shape=shape)
        terms("thermal_rate", label, felt)


def harmonics(f, sensor):
    """Functions of the direction of gravity: degrees 2 and 3 (gyro: 1, too)."""
    x, y, z = f.T
    second = [x * x, y * y, x * y, x * z, y * z]
    third = [x ** 3, y ** 3, z ** 3, x * y * z, x * y * y, y * z * z, z * x * x]
    return ([x, y, z] if sensor == "gyro" else []) + second + third
