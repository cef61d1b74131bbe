"""The library's effects as columns over the blocks of a session: one column a coefficient, what
the reading changes by for a coefficient of 1.

The columns are an effect's terms at the moments measured, by the one definition that the simulator
has of it too (sixflip_sim/effects). Their variants are those of session_terms.py.
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS

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
    a bend beside a slope, 0 for what a session has beside it; record: it is there because a record
    of the board has that form;
    beside: it is no hypothesis, but what others may have as a discrepancy; positive: none of its
    coefficients is less than nothing, as a width is not; shape: ((parameter, value), ...) of the
    effect that the session gives, and the variant does not name.
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
    shape: tuple = ()

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
    keys, axes, columns = columns_of(EFFECTS[name](sensor, {}, shape), moment, n, only)
    size = typical.size(name, chip, sensor)[0]
    prior = 10.0 * (abs(size) if size else 1.0)
    return Design(name, variant, keys, axes, columns, np.full(len(keys), prior))


def columns_of(effect, moment, n, only=None):
    """(keys (k,), axes (k,), columns (3n, k)) of an effect at n moments, rows in the order x y z
    of each; axes: the first that a coefficient acts on; only: the keys wanted."""
    by_key = {}
    for key, axis, value in effect.terms(moment):
        if only is None or key in only:
            by_key.setdefault(key, (axis, np.zeros((n, 3))))[1][:, axis] += value
    axes, columns = zip(*by_key.values())
    return list(by_key), axes, np.stack([column.reshape(-1) for column in columns], 1)


def corrected(designs, matrix):
    """The Designs as a nominal correction's matrix (3, 3) leaves them: what a sensor adds to one
    of its axes, as it measures, is in the others too once the correction has mixed them."""
    return [d if d.effect == "box_tilt" else replace(d, columns=np.einsum(
        "ij,njk->nik", matrix, d.columns.reshape(-1, 3, d.columns.shape[1])).reshape(
            d.columns.shape)) for d in designs]


def harmonics(f, sensor):
    """[(n,)]: harmonics of degree 2 and 3 (of the gyro 1, too) of gravity's direction f (n, 3)."""
    x, y, z = f.T
    second = [x * x, y * y, x * y, x * z, y * z]
    third = [x ** 3, y ** 3, z ** 3, x * y * z, x * y * y, y * z * z, z * x * x]
    return ([x, y, z] if sensor == "gyro" else []) + second + third
