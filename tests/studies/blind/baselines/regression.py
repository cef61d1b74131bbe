"""Residuals of one sensor at rest and candidate variables, as sums over samples.

Of every session the nominal model is taken out first (accelerometer: twelve parameters and where
the box lies on each pose; gyro: bias). What the methods need then are only sums: S'S, S'y, y'y.
"""

import numpy as np

from . import rests as at_rest

WARM_UP_S, CREEP_S, ABOUT_C = 120.0, 30.0, 25.0
UNITS = {"accel": "mg", "gyro": "°/s"}
SILENT = 1e-6  # share of a variable that must be left beside the nominal model


class Sums:
    """Over rows that samples (or means over blocks) make: gram (K, K), inner (K,), square,
    freedom (rows less parameters of the nominal model)."""

    def __init__(self, gram, inner, square, freedom):
        self.gram, self.inner, self.square, self.freedom = gram, inner, square, freedom

    def __add__(self, other):
        return Sums(self.gram + other.gram, self.inner + other.inner, self.square + other.square,
                    self.freedom + other.freedom)

    def left(self, theta):
        """Sum of squares that coefficients theta (K,) leave."""
        return float(self.square - 2.0 * theta @ self.inner + theta @ self.gram @ theta)


class Problem:
    """One sensor over all sessions: names [(effect, axis letter)] (K,), samples and blocks:
    list of Sums, one a session. `seen` (K,): variables that are not silent."""

    def __init__(self, sensor, sessions):
        self.sensor = sensor
        thermometer = all(r.temperature is not None for s in sessions for r in s.rests)
        fields = [[variables(sensor, r, thermometer) for r in s.rests] for s in sessions]
        self.names = [(effect, "xyz"[axis]) for effect, axis, _ in fields[0][0]]
        self.samples = [_sums(sensor, s, f, 0.0) for s, f in zip(sessions, fields)]
        self.blocks = [_sums(sensor, s, f, at_rest.BLOCK_S) for s, f in zip(sessions, fields)]
        energy = sum(_energy(sensor, s, f) for s, f in zip(sessions, fields))
        left = sum(np.diag(s.gram) for s in self.samples)
        self.seen = left > SILENT * np.maximum(energy, 1e-300)

    @property
    def pooled(self):
        """Sums over the samples of all sessions."""
        return sum(self.samples[1:], self.samples[0])

    def held_out(self, fit):
        """{"unit", "before", "after"}: RMS of the block means of each session, before and after
        what fit(sums of the samples of the others) -> theta (K,) predicts; None with one."""
        if len(self.samples) < 2:
            return None
        before = after = freedom = 0.0
        for held, block in enumerate(self.blocks):
            others = self.samples[:held] + self.samples[held + 1:]
            theta = fit(sum(others[1:], others[0]))
            before, after = before + block.square, after + max(block.left(theta), 0.0)
            freedom += block.freedom
        return gap(self.sensor, before, after, freedom)


def gap(sensor, before, after, freedom):
    """The figures of one sensor from two sums of squares."""
    if freedom < 1 or before <= 0.0:
        return None
    return {"unit": UNITS[sensor], "before": float(np.sqrt(before / freedom)),
            "after": float(np.sqrt(after / freedom)),
            "explained_share": float(1.0 - after / before)}


def problems(captures):
    """list of Problem of what the captures can show; empty where they have too few poses."""
    try:
        found = at_rest.sessions(captures)
    except ValueError:
        return []
    gyro = all(r.gyro is not None for s in found for r in s.rests)
    return [Problem(sensor, found) for sensor in (("accel", "gyro") if gyro else ("accel",))]


def variables(sensor, rest, thermometer):
    """[(effect, axis, value (n,) or scalar)]: the candidates during a rest."""
    f, before = rest.up, rest.before
    slow = {"warm_up": np.exp(-rest.t / WARM_UP_S), "drift": rest.t / 100.0}
    found = []
    for axis in range(3):
        if thermometer:
            warm = rest.temperature - ABOUT_C
            found += [("thermal_bias", axis, warm), ("thermal_bias", axis, warm ** 2 / 10.0),
                      ("thermal_rate", axis, rest.rate)]
        found += [(name, axis, value) for name, value in slow.items()]
        if sensor == "gyro":
            found += [("g_sensitivity", axis, f[k]) for k in range(3)]
            continue
        if thermometer:
            found.append(("thermal_scale", axis, warm * f[axis]))
        j, k = [a for a in range(3) if a != axis]
        found += [("quadratic", axis, f[axis] ** 2), ("cubic", axis, f[axis] ** 3),
                  ("asymmetry", axis, abs(f[axis])), ("hysteresis", axis, before[axis]),
                  ("creep", axis, (before - f)[axis] * np.exp(-rest.since / CREEP_S)),
                  ("vibration_rectification", axis, rest.shaken ** 2)]
        found += [("cross_quadratic", axis, f[a] * f[b])
                  for a, b in ((j, k), (axis, j), (axis, k), (j, j))]
    return found


def residual(sensor, rest):
    """(n, 3) mg or deg/s: what the rest reads beyond the calibration's gravity, or the rate."""
    return rest.true - 1000.0 * rest.up if sensor == "accel" else rest.gyro


def nuisance(sensor, session):
    """list over the rests of (3, p) columns that are constant during a rest."""
    if sensor == "gyro":
        return [np.eye(3) for _ in session.rests]
    codes = sorted({r.code for r in session.rests if r.code <= at_rest.FACES})
    found = []
    for rest in session.rests:
        twelve = np.kron(np.eye(3), np.append(rest.up, 1.0)[None])
        lies = np.zeros((3, 3 * len(codes)))
        if rest.code in codes:
            place = 3 * codes.index(rest.code)
            lies[:, place:place + 3] = np.eye(3) - np.outer(rest.up, rest.up)
        found.append(np.hstack([twelve, lies]))
    return found


def seen(sensor, rest):
    """(rows, 3): what of a vector can be compared. Of a leaning rest only its length."""
    leaning = sensor == "accel" and rest.code > at_rest.FACES
    return rest.up[None] if leaning else np.eye(3)


def _sums(sensor, session, fields, block_s):
    """Sums of a session less its nominal model; over samples, or means over block_s."""
    fixed = nuisance(sensor, session)
    p, size = fixed[0].shape[1], len(fields[0])
    total, rows = np.zeros((p + size + 1,) * 2), 0
    for rest, columns, constant in zip(session.rests, fields, fixed):
        number = max(1, int((rest.t[-1] - rest.t[0]) / block_s)) if block_s else 0
        averaged = _averages(len(rest.t), number)
        y = averaged(residual(sensor, rest))
        values = np.stack([averaged(np.broadcast_to(v, rest.t.shape)) for _, _, v in columns], 1)
        for row in seen(sensor, rest):
            weights = np.array([row[axis] for _, axis, _ in columns])
            x = np.hstack([np.broadcast_to(row @ constant, (len(y), p)), values * weights,
                           (y @ row)[:, None]])
            total += x.T @ x
            rows += len(x)
    return _without(total, p, rows)


def _averages(n, number):
    """Function from samples (n, ...) to means over `number` blocks; as they are for 0."""
    if not number:
        return lambda x: x
    edges = np.linspace(0, n, number + 1).astype(int)
    return lambda x: np.add.reduceat(x, edges[:-1], axis=0) / np.diff(edges).reshape(
        (-1,) + (1,) * (x.ndim - 1))


def _without(total, p, rows):
    """Sums after the first p columns have been projected out."""
    block = total[:p, :p]
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))
    values, vectors = np.linalg.eigh(block / scale / scale[:, None])
    keep = values > 1e-10 * values.max()
    turned = (vectors[:, keep].T / scale) @ total[:p, p:] / np.sqrt(values[keep])[:, None]
    left = total[p:, p:] - turned.T @ turned
    return Sums(left[:-1, :-1], left[:-1, -1], max(float(left[-1, -1]), 0.0),
                rows - int(keep.sum()))


def _energy(sensor, session, fields):
    """(K,) sum of squares of the candidates as they are."""
    total = np.zeros(len(fields[0]))
    for rest, columns in zip(session.rests, fields):
        square = [(np.broadcast_to(v, rest.t.shape) ** 2).sum() for _, _, v in columns]
        weights = (seen(sensor, rest) ** 2).sum(axis=0)
        total += np.array([s * weights[axis] for s, (_, axis, _) in zip(square, columns)])
    return total
