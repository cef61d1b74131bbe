"""Does a parameter move with time, with temperature? Weighted least squares over calibrations.

p = p0 + a (T - mean T) + b (t - mean t), weights 1/s² from the calibrations' own standard
errors; when they scatter more than those say, the errors of a and b are widened by the root of
chi² per degree of freedom. Where time and temperature went up together neither is named.
"""

import math
from dataclasses import dataclass

import numpy as np

DAY_S = 86400.0
PER_DAYS = 30.0
LEAST_C = 2.0               # of range, below it a thermometer's noise decides
LEAST_DAYS = 0.5
TOGETHER = 0.95             # correlation of time and temperature
SURE = 0.975                # two-sided 95 %


@dataclass
class Drift:
    """Of one parameter, in its own unit.

    change     last minus first
    per_c, per_30_days   (slope, standard error, beyond doubt?) or None
    note       why a slope is missing, "" when none is
    """

    name: str
    change: float
    per_c: tuple = None
    per_30_days: tuple = None
    note: str = ""


def drifts(calibrations):
    """[Drift] of every parameter that two calibrations or more hold.

    calibrations  [(Happened, {name: (value, standard error)})] in the order of their time;
                  refused ones do not count
    """
    usable = [(row, parameters) for row, parameters in calibrations if row.verdict != "refused"]
    names = list(dict.fromkeys(name for _, parameters in usable for name in parameters))
    all_drifts = []
    for name in names:
        with_it = [(row, *parameters[name]) for row, parameters in usable if name in parameters]
        if len(with_it) > 1:
            all_drifts.append(_drift(name, with_it))
    return all_drifts


def _drift(name, points):
    values = np.array([value for _, value, _ in points])
    drift = Drift(name, float(values[-1] - values[0]))
    days = np.array([row.at / DAY_S for row, _, _ in points])
    celsius = np.array([np.nan if row.temp_c is None else row.temp_c for row, _, _ in points])
    columns = {}
    if np.isfinite(celsius).all() and np.ptp(celsius) >= LEAST_C:
        columns["per_c"] = celsius - celsius.mean()
    if np.ptp(days) >= LEAST_DAYS:
        columns["per_30_days"] = (days - days.mean()) / PER_DAYS
    if not columns:
        drift.note = "less than %g °C and %g days between them" % (LEAST_C, LEAST_DAYS)
    elif len(points) < len(columns) + 2:
        drift.note = "%d calibrations, %d are needed" % (len(points), len(columns) + 2)
    elif len(columns) == 2 and abs(np.corrcoef(*columns.values())[0, 1]) > TOGETHER:
        drift.note = "time and temperature went together: cannot be told apart"
    else:
        sigma = np.array([np.nan if s is None else s for _, _, s in points])
        for key, slope in zip(columns, _slopes(values, sigma, list(columns.values()))):
            setattr(drift, key, slope)
    return drift


def _slopes(values, sigma, columns):
    """[(slope, standard error, beyond doubt)] of each column."""
    from scipy.stats import t as student
    known = np.isfinite(sigma).all() and (sigma > 0).all()
    weight = 1.0 / sigma if known else np.ones(len(values))
    X = np.column_stack([np.ones(len(values)), *columns]) * weight[:, None]
    inverse = np.linalg.inv(X.T @ X)
    best = inverse @ X.T @ (values * weight)
    freedom = len(values) - X.shape[1]
    chi2 = float(((values * weight - X @ best) ** 2).sum()) / freedom
    widened = max(chi2, 1.0) if known else chi2
    errors = np.sqrt(np.diag(inverse) * widened)
    limit = student.ppf(SURE, freedom)
    return [(float(best[k]), float(errors[k]), bool(abs(best[k]) > limit * errors[k]))
            for k in range(1, len(best)) if math.isfinite(best[k])]
