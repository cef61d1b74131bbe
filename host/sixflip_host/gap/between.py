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
import numpy as np

from . import nominal_fit, regressors

SWITCH_ON = {"accel": (0.7, 2.0, 6.0, 20.0, 60.0, 200.0),  # mg
             "gyro": (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)}  # deg/s
ORDINARY = {"accel": (0.8, 0.075), "gyro": (0.003, 0.003)}  # placement, flicker
ORDINARY_CHANGE = {"accel": 2.0, "gyro": 0.1}  # standard deviation of a switch-on
UNUSUAL = {"accel": 6.0, "gyro": 0.3}  # standard deviation beyond which a change wants a reason
KNOWN = 1e-6  # of a bias that the poses leave undetermined, at most


class Bias:
    """A session's bias as it reads: value (3,), covariance (3, 3), columns (3, K) of all
    effects in it; None of it where the poses do not determine a bias."""

    def __init__(self, kind, rows, nominal, designs):
        scale = 1000.0 if kind == "accel" else 1.0
        covariance = rows.white + ORDINARY[kind][0] ** 2 * rows.lateral @ rows.lateral.T \
            + ORDINARY[kind][1] ** 2 * rows.kernel
        if rows.fixed is not None:
            covariance = covariance + rows.fixed
        factor = np.linalg.cholesky(covariance)
        whitened = np.linalg.solve(factor, rows.nuisance)
        back = np.linalg.pinv(whitened, rcond=1e-9)[list(rows.bias)]
        unit = np.zeros((3, rows.nuisance.shape[1]))
        unit[range(3), rows.bias] = 1.0
        self.determined = np.abs(back @ whitened - unit).max() < KNOWN
        take = back @ np.linalg.inv(factor)
        self.covariance = back @ back.T
        raw = np.hstack([np.zeros_like(d.columns) if d.generic else d.columns for d in designs])
        self.value, self.columns = take @ rows.y, take @ raw
        if kind == "accel":  # what the nominal fit took off already is in it, too
            reads = np.linalg.inv(nominal.matrix)
            self.value = reads @ (self.value - scale * nominal.offset)
            self.columns = reads @ self.columns
            self.covariance = reads @ self.covariance @ reads.T


def unit(kind, rows, models, designs):
    """Unit of the differences between sessions (one Rows, model and list of Design each), or
    None where there are none: 3 (S - 1) contrasts, each session against those before it."""
    biases = [Bias(kind, r, m, d) for r, m, d in zip(rows, models, designs)]
    if len(biases) < 2 or not all(b.determined for b in biases):
        return None
    number = len(biases)
    helmert = np.zeros((number - 1, number))
    for k in range(1, number):
        helmert[k - 1, :k], helmert[k - 1, k] = -1.0 / k, 1.0
        helmert[k - 1] /= np.linalg.norm(helmert[k - 1])
    spread = np.kron(helmert, np.eye(3))
    covariance = np.zeros((3 * number, 3 * number))
    for k, bias in enumerate(biases):
        covariance[3 * k:3 * k + 3, 3 * k:3 * k + 3] = bias.covariance
    y = spread @ np.concatenate([b.value for b in biases])
    columns = spread @ np.vstack([b.columns for b in biases])
    own, start = [], 0
    for d in designs[0]:
        k = len(d.keys)
        own.append(regressors.Design(d.effect, d.variant, d.keys, d.axes,
                                     columns[:, start:start + k], d.prior))
        start += k
    found = nominal_fit.Unit(y, np.zeros((len(y), 1)), spread @ covariance @ spread.T,
                             np.eye(len(y)), np.zeros((len(y), len(y))),
                             (SWITCH_ON[kind], (0.0,)), own)
    found.signature, found.between = ("between", number), True
    return found
