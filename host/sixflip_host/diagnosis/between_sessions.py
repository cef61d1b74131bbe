"""What lies between the sessions: the differences of their biases and scales, beyond switching
on.

Within one session a bias is a nuisance, so an effect and its rate of change over one exponential
look alike, however many sessions are laid side by side. Between a warming and a cooling session
they do not: the temperatures that the two stand at differ by degrees. So it is with a scale, of
which a session at one temperature says nothing at all. A chip's bias and scale do change from one
switch-on to the next, so the differences count with a standard deviation of their own, by
restricted maximum likelihood as the levels of placement and flicker.

The bias of each session by generalised least squares at an ordinary point of the grid: its error
is then independent of the contrasts that are left in that session (Gauss-Markov), so this unit
stands beside the others as one more session would. The scale at the point that is likeliest by
noise alone: whatever else a session has passes for noise there, and moves the scale by no more
than that noise would. Six faces tell a bias and a scale independently of each other, and other
poses nearly so: these two count as if it were so.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from ..experiment import covariance, linear_model, nominal_rows
from . import evidence
from .elimination import NONE

SWITCH_ON = {"bias": {"accel": (0.7, 2.0, 6.0, 20.0, 60.0, 200.0),  # mg
                      "gyro": (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)},  # deg/s
             "scale": dict.fromkeys(("accel", "gyro"), (0.03, 0.1, 0.3, 1.0, 3.0, 10.0))}
ORDINARY = {"accel": (0.8, 0.075), "gyro": (0.003, 0.003)}  # placement, flicker
# Standard deviation of a switch-on, and beyond which a change wants a reason. How well a scale
# repeats no data sheet of the chips here says: as a temperature known to half a degree, and to one
# and a half, would make it [MPU-6000 PS rev 3.4, table 6.2: 0.02 %/degC].
ORDINARY_CHANGE = {"bias": {"accel": 2.0, "gyro": 0.1}, "scale": {"accel": 0.1, "gyro": 0.1}}
UNUSUAL = {"bias": {"accel": 6.0, "gyro": 0.3}, "scale": {"accel": 0.3, "gyro": 0.3}}  # 1/1000
KNOWN = 1e-6  # of a bias or a scale that the poses leave undetermined, at most


@dataclass(frozen=True, eq=False)
class Constants:
    """A session's biases or scales as it reads: value (3,), covariance (3, 3), columns (3, K) of
    all effects in it; determined: False where the poses do not determine them."""

    value: np.ndarray
    covariance: np.ndarray
    columns: np.ndarray
    determined: bool


def biases(kind, rows, nominal, designs):
    """Constants of one session by generalised least squares; rows as nominal_rows has them."""
    value, spread, columns, determined = _fitted(rows, rows.bias, designs, ORDINARY[kind])
    if kind == "accel":  # what the nominal fit took off already is in it, too
        reads = np.linalg.inv(nominal.matrix)
        value = reads @ (value - 1000.0 * nominal.offset)
        columns, spread = reads @ columns, reads @ spread @ reads.T
    return Constants(value, spread, columns, determined)


def likeliest(unit, levels):
    """(placement, flicker) of a Unit's grid that are likeliest by noise alone; levels:
    evidence.Levels."""
    fit = evidence.fit(unit, unit.statistics(), NONE, NONE, levels.prior(unit, ()))
    return unit.grid[int(fit.index[0])]


def scales(rows, designs, point, matrix, one=1.0):
    """Constants of one session, thousandths: how long a row of what it reads by is, however the
    sensor lies in its box, of its rows at a point of their levels and the matrix (3, 3) that
    calibrates it; one: what the columns of the scales are in, of thousandths."""
    value, spread, columns, determined = _fitted(rows, rows.scale, designs, point)
    reads = np.linalg.norm(np.linalg.inv(matrix), axis=1)
    by = reads * one
    return Constants(1000.0 * reads + by * value, by[:, None] * spread * by,
                     by[:, None] * columns, determined)


def _fitted(rows, wanted, designs, point):
    """(value (k,), covariance (k, k), what each effect adds to it (k, K), whether it is
    determined) of the wanted columns of the nuisance, at a point (placement, flicker)."""
    factor = covariance.Factor(covariance.reduced(rows.groups), point[:1], point[1])
    # Strangers belong to one session: in the difference of two they have no coefficient.
    raw = np.hstack([np.zeros_like(d.columns) if d.generic else d.columns for d in designs])
    common = rows.common if rows.common is not None else np.zeros((len(rows.y), 0))
    number, extra = rows.nuisance.shape[1], common.shape[1]
    fitted = number + extra
    white = factor.whitened(covariance.turned(rows.groups, np.column_stack(
        [rows.nuisance, common, raw, rows.y])))[0]
    # Coefficients known to a standard deviation of 1 are observed as 0 with that error.
    observed = np.vstack([white[:, :fitted], np.eye(fitted)[number:]])
    wanted = list(wanted)
    back = np.linalg.pinv(observed, rcond=1e-9)[wanted]
    determined = np.abs(back @ observed - np.eye(fitted)[wanted]).max() < KNOWN
    spread, back = back @ back.T, back[:, :len(white)]
    return back @ white[:, -1], spread, back @ white[:, fitted:-1], bool(determined)


def of_rests(kind, units, parts, levels):
    """[Unit of what lies between the sessions] at rest: units of those, parts [(Session,
    NominalSensor)], evidence.Levels. Without a thermometer another scale may be that of another
    temperature, and says nothing."""
    designs, models = units[0].designs, [model for _, model in parts]
    found = unit("bias", kind, [biases(kind, u.rows, model, u.designs)
                                for u, model in zip(units, models)], designs)
    if kind == "accel" and all(session.thermometer for session, _ in parts):
        found += unit("scale", kind, [
            scales(u.rows, u.designs, likeliest(u, levels), model.matrix)
            for u, model in zip(units, models)], designs)
    return found


def unit(quantity, kind, constants, designs):
    """[Unit of the differences of S Constants], none where there is nothing between or where the
    poses leave one open: 3 (S - 1) contrasts, each session against those before it."""
    if len(constants) < 2 or not all(c.determined for c in constants):
        return []
    number = len(constants)
    spread = np.kron(_each_against_those_before(number), np.eye(3))
    errors = linalg.block_diag(*(c.covariance for c in constants))
    return [_unit(quantity, number, spread @ np.concatenate([c.value for c in constants]),
                  spread @ errors @ spread.T, spread @ np.vstack([c.columns for c in constants]),
                  designs, SWITCH_ON[quantity][kind])]


def _each_against_those_before(number):
    """(number - 1, number) orthonormal contrasts of so many sessions [Helmert]."""
    contrasts = np.tril(np.full((number, number), -1.0), -1)
    contrasts[np.diag_indices(number)] = np.arange(number)
    return contrasts[1:] / np.linalg.norm(contrasts[1:], axis=1)[:, None]


def _unit(quantity, number, y, errors, columns, designs, levels):
    """Unit of contrasts y (n,) between so many sessions with covariance errors (n, n)."""
    own, start = [], 0
    for d in designs:
        k = len(d.keys)
        own.append(replace(d, columns=columns[:, start:start + k], choices=()))
        start += k
    size = len(y)
    rows = nominal_rows.Rows(y, covariance.alone(errors, np.eye(size), np.zeros((size, size))),
                             np.zeros((size, 1)), (levels, (0.0,)))
    return linear_model.unit(rows, own, signature=("between", quantity, number),
                             between=quantity)


def held_out(unit, session):
    """(Unit of a session against the mean of the others, Unit of the others among themselves)
    of a Unit between three sessions and more."""
    quantity, number = unit.signature[1:]
    own = _each_against_those_before(number)[:, session]
    basis = np.linalg.svd(own[None])[2]  # the first against the mean of the others, in size
    errors, columns = covariance.dense(unit.groups, 0.0, 0.0), unit.raw(slice(None))
    return tuple(_unit(quantity, number, part @ unit.rows.y, part @ errors @ part.T,
                       part @ columns, unit.designs, unit.rows.levels[0])
                 for part in (np.kron(basis[:1], np.eye(3)), np.kron(basis[1:], np.eye(3))))
