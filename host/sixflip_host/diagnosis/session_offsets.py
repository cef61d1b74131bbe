"""What lies between the sessions: the difference of their biases, beyond switching on.

Within one session a bias is a nuisance, so an effect and its rate of change over one exponential
look alike, however many sessions are laid side by side. Between a warming and a cooling session
they do not: the temperatures that the two stand at differ by degrees. A chip's bias does change
from one switch-on to the next, so the differences count with a standard deviation of their own,
by restricted maximum likelihood as the levels of placement and flicker.

The bias of each session by generalised least squares at an ordinary point of the grid: its error
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


@dataclass(frozen=True, eq=False)
class Bias:
    """A session's bias as it reads: value (3,), covariance (3, 3), columns (3, K) of all
    effects in it; determined: False where the poses do not determine a bias."""

    value: np.ndarray
    covariance: np.ndarray
    columns: np.ndarray
    determined: bool


def bias(kind, rows, nominal, designs):
    """Bias of one session by generalised least squares; rows as nominal_rows has them."""
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
    wanted = list(rows.bias)
    back = np.linalg.pinv(observed, rcond=1e-9)[wanted]
    determined = np.abs(back @ observed - np.eye(fitted)[wanted]).max() < KNOWN
    spread, back = back @ back.T, back[:, :len(white)]
    value, columns = back @ white[:, -1], back @ white[:, fitted:-1]
    if kind == "accel":  # what the nominal fit took off already is in it, too
        reads = np.linalg.inv(nominal.matrix)
        value = reads @ (value - 1000.0 * nominal.offset)
        columns, spread = reads @ columns, reads @ spread @ reads.T
    return Bias(value, spread, columns, bool(determined))


def unit(kind, rows, models, designs):
    """Unit of the differences between sessions (one Rows, model and list of Design each), or
    None where there are none: 3 (S - 1) contrasts, each session against those before it."""
    biases = [bias(kind, r, m, d) for r, m, d in zip(rows, models, designs)]
    if len(biases) < 2 or not all(b.determined for b in biases):
        return None
    number = len(biases)
    helmert = np.zeros((number - 1, number))
    for k in range(1, number):
        helmert[k - 1, :k], helmert[k - 1, k] = -1.0 / k, 1.0
        helmert[k - 1] /= np.linalg.norm(helmert[k - 1])
    spread = np.kron(helmert, np.eye(3))
    errors = linalg.block_diag(*(b.covariance for b in biases))
    y = spread @ np.concatenate([b.value for b in biases])
    columns = spread @ np.vstack([b.columns for b in biases])
    own, start = [], 0
    for d in designs[0]:
        k = len(d.keys)
        own.append(replace(d, columns=columns[:, start:start + k], choices=()))
        start += k
    rows = nominal_rows.Rows(y, covariance.alone(spread @ errors @ spread.T, np.eye(len(y)),
                                                 np.zeros((len(y), len(y)))),
                             np.zeros((len(y), 1)), (SWITCH_ON[kind], (0.0,)))
    return linear_model.unit(rows, own, signature=("between", number), between=True)
