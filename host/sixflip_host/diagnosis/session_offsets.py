"""What lies between the sessions: the differences of their biases, and of an accelerometer's
scales, beyond switching on.

Within one session a bias is a nuisance, so an effect and its rate of change over one exponential
look alike, however many sessions are laid side by side. Between a warming and a cooling session
they do not: the temperatures that the two stand at differ by degrees. A chip's bias does change
from one switch-on to the next, so the differences count with a standard deviation of their own,
by restricted maximum likelihood as the levels of placement and flicker. A scale, which each
session's poses tell as well as the bias, hardly changes: it takes up what depends on the order of
the poses, which is another one in the next session.

Both of each session by generalised least squares at an ordinary point of the grid: its error
is then independent of the contrasts that are left in that session (Gauss-Markov), so this unit
stands beside the others as one more session would.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from ..experiment import covariance, linear_model, nominal_rows

SWITCH_ON = {"accel": (0.7, 2.0, 6.0, 20.0, 60.0, 200.0),  # mg
             "gyro": (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)}  # deg/s
ORDINARY = {"accel": (0.8, 0.075), "gyro": (0.003, 0.003)}  # placement, flicker
ORDINARY_CHANGE = {"accel": 2.0, "gyro": 0.1}  # standard deviation of a switch-on
UNUSUAL = {"accel": 6.0, "gyro": 0.3}  # standard deviation beyond which a change wants a reason
KNOWN = 1e-6  # of a bias that the poses leave undetermined, at most


SCALES = {"accel": (0.07, 0.2, 0.6, 2.0, 6.0, 20.0), "gyro": (0.0,)}  # mg at 1 g
ORDINARY_SCALE = {"accel": 0.06, "gyro": 0.0}


@dataclass(frozen=True, eq=False)
class Standing:
    """What a session stands at, as it reads: value (k,) of its biases and, of an accelerometer,
    its scales, mg or deg/s; covariance (k, k); columns (k, K) of all effects in them; determined
    (k,): False where the poses do not determine one."""

    value: np.ndarray
    covariance: np.ndarray
    columns: np.ndarray
    determined: np.ndarray


def standing(kind, rows, nominal, designs):
    """Standing of one session by generalised least squares; rows as nominal_rows has them."""
    factor = covariance.Factor(covariance.reduced(rows.groups), ORDINARY[kind][:1],
                               ORDINARY[kind][1])
    # Strangers belong to one session: in the difference of two they have no coefficient.
    raw = np.hstack([np.zeros_like(d.columns) if d.generic else d.columns for d in designs])
    common = rows.common if rows.common is not None else np.zeros((len(rows.y), 0))
    number, extra = rows.nuisance.shape[1], common.shape[1]
    fitted = number + extra
    white = factor.whitened(covariance.turned(rows.groups, np.column_stack(
        [rows.nuisance, common, raw, rows.y])))[0]
    # Coefficients known to a standard deviation of 1 are observed as 0 with that error.
    observed = np.vstack([white[:, :fitted], np.eye(fitted)[number:]])
    wanted = [*rows.bias, *rows.scale]
    back = np.linalg.pinv(observed, rcond=1e-9)[wanted]
    determined = np.abs(back @ observed - np.eye(fitted)[wanted]).max(axis=1) < KNOWN
    spread, back = back @ back.T, back[:, :len(white)]
    value, columns = back @ white[:, -1], back @ white[:, fitted:-1]
    if kind == "accel":  # what the nominal fit took off already is in it, too
        reads = np.linalg.inv(nominal.matrix)
        turned = linalg.block_diag(reads, np.diag(np.diag(reads)))
        # A scale is what an axis reads of gravity along it, whichever way the axes are turned.
        value = turned @ (value - 1000.0 * np.concatenate([nominal.offset, np.zeros(3)]))
        value[3:] += 1000.0 * np.linalg.norm(reads, axis=1)
        columns, spread = turned @ columns, turned @ spread @ turned.T
    return Standing(value, spread, columns, determined)


def unit(kind, rows, models, designs):
    """Unit of the differences between sessions (one Rows, model and list of Design each), or
    None where there are none: k (S - 1) contrasts, each session against those before it."""
    found = [standing(kind, r, m, d) for r, m, d in zip(rows, models, designs)]
    determined = np.all([one.determined for one in found], axis=0)
    if len(found) < 2 or not determined[:3].all():
        return None
    kept = np.arange(len(determined) if determined.all() else 3)
    number = len(found)
    scales = np.diag(np.tile(1.0 * (kept >= 3), number - 1))
    helmert = np.zeros((number - 1, number))
    for k in range(1, number):
        helmert[k - 1, :k], helmert[k - 1, k] = -1.0 / k, 1.0
        helmert[k - 1] /= np.linalg.norm(helmert[k - 1])
    spread = np.kron(helmert, np.eye(len(kept)))
    errors = linalg.block_diag(*(one.covariance[np.ix_(kept, kept)] for one in found))
    y = spread @ np.concatenate([one.value[kept] for one in found])
    columns = spread @ np.vstack([one.columns[kept] for one in found])
    own, start = [], 0
    for d in designs[0]:
        k = len(d.keys)
        own.append(replace(d, columns=columns[:, start:start + k], choices=()))
        start += k
    rows = nominal_rows.Rows(
        y, covariance.alone(spread @ errors @ spread.T, np.eye(len(y)) - scales, scales),
        np.zeros((len(y), 1)), (SWITCH_ON[kind], SCALES[kind] if scales.any() else (0.0,)))
    return linear_model.unit(rows, own, signature=("between", number), between=True)
