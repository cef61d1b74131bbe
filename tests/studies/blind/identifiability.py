"""What a session can tell apart, derived here from the physics: linear theory of pose means.

Observations: the accelerometer's and gyro's mean over each stretch of a placement (ten seconds
at most), and the rotation each move adds (gyro integral, known where gravity knows it). What
the nominal model, the table, the box and the hand absorb is projected out of everything, the
rest is weighed by white noise, flicker and placement scatter. The definition of the alias index
is GAP.md's: A(a|b) = |P_b S_a|^2 / |S_a|^2.
"""

import numpy as np
from scipy.linalg import solve_triangular

CHUNK_S = 10.0
FREE = 0.1                      # g^2, of the attitude nobody knows: ample against 1e-6
WARM_UP_TAUS = (60.0, 130.0, 300.0)


class Stretch:
    """A piece of a placement: where it is in the samples, and its means."""

    def __init__(self, session, number, label, where, first):
        self.session, self.number, self.label = session, number, label
        self.where, self.first = where, first


def stretches(signals):
    """The Stretches of a session's placements, in order."""
    out = []
    for number in range(signals.placements.max() + 1):
        inside = np.flatnonzero(signals.placements == number)
        if not len(inside):
            continue
        pieces = max(1, int(np.ceil(len(inside) / signals.rate / CHUNK_S)))
        for k, where in enumerate(np.array_split(inside, pieces)):
            out.append(Stretch(signals.session, number, str(signals.names[where[0]]), where,
                               k == 0))
    return out


def means(parts, series):
    """(k, 3) of a session's (n, 3) series over its stretches."""
    return np.array([series[p.where].mean(axis=0) for p in parts])


class Turns:
    """The moves of a session: rotation added at the end, in the body's axes there."""

    def __init__(self, signals, parts):
        self.moves = []
        dt = 1 / signals.rate
        for a, b in zip(parts[:-1], parts[1:]):
            if a.number == b.number:
                continue
            span = slice(a.where[-1], b.where[0] + 1)
            turned = (signals.at[int(b.where[0])].inv() * signals.at[span]).as_matrix() * dt
            flip = a.label[:2] == b.label[:2] and a.label[0] != "L"
            self.moves.append((span, turned, signals.at[int(b.where[0])], flip))

    def added(self, series):
        """(m, 3) degrees of an (n, 3) rate."""
        return np.array([np.einsum("nij,nj->i", turned, series[span])
                         for span, turned, _, _ in self.moves]).reshape(-1, 3)


class Design:
    """Whitening and projection of one sensor's observations of a case."""

    def __init__(self, covariance, nuisance):
        root = np.linalg.cholesky(covariance)
        self.white = lambda x: solve_triangular(root, x, lower=True)
        left, size, _ = np.linalg.svd(self.white(nuisance), full_matrices=False)
        self.basis = left[:, size > 1e-9 * size[0]]

    def seen(self, x):
        """Whitened, what the nuisance absorbs taken off. x (n,) or (n, k)."""
        w = self.white(x)
        return w - self.basis @ (self.basis.T @ w)

    def visible(self, x):
        """Share of a signature's square that is left."""
        return float(np.sum(self.seen(x) ** 2) / max(np.sum(self.white(x) ** 2), 1e-300))


def span_of(columns, floor=1e-6):
    """Orthonormal basis of what columns (n, k) span; (n, 0) when nothing."""
    left, size, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, size > floor * max(size.max(initial=0), 1e-12)]


def share_reproduced(signature, columns):
    """A(a|b) of one seen signature (n,) by seen columns (n, k)."""
    whole = float(signature @ signature)
    if whole < 1e-12:
        return 1.0
    basis = span_of(columns)
    return float(np.sum((basis.T @ signature) ** 2) / whole)


class Geometry:
    """A case without its effects: sessions' signals, stretches, turns, and both Designs."""

    def __init__(self, case):
        everything = set(range(len(case.effects)))
        self.chip = case.chip
        # Whoever looks for a crooked box must take all else for square.
        self.certified = case.spec.certified or any(e.name == "box_tilt" for e in case.effects)
        self.power_ups = case.spec.new_gyro_offset
        self.signals = [case.signals(k, everything) for k in range(len(case.sessions))]
        self.parts = [stretches(s) for s in self.signals]
        self.turns = [Turns(s, p) for s, p in zip(self.signals, self.parts)]
        self.up = [means(p, s.f) for p, s in zip(self.parts, self.signals)]
        self.accel, self.gyro = self._accel_design(), self._gyro_design()

    def accel_rows(self, series):
        """(3 k,) of one (n, 3) series a session."""
        return np.concatenate([means(p, x).ravel() for p, x in zip(self.parts, series)])

    def gyro_rows(self, series):
        return np.concatenate([np.concatenate([means(p, x).ravel(), t.added(x).ravel()])
                               for p, t, x in zip(self.parts, self.turns, series)])

    def rows(self, sensor, series):
        return self.accel_rows(series) if sensor == "accel" else self.gyro_rows(series)

    def design(self, sensor):
        return self.accel if sensor == "accel" else self.gyro

    def columns(self, sensor, shapes):
        """(n, k) from k shapes: each f(signals) -> (n, 3)."""
        return np.column_stack([self.rows(sensor, [shape(s) for s in self.signals])
                                for shape in shapes])

    def _flicker(self, parts, rms):
        t = np.array([s.t[p.where].mean() for s, p in parts])
        gap = np.abs(t[:, None] - t[None, :])
        kernel = (np.exp(-gap / 30) + np.exp(-gap / 300)) / 2
        return np.kron(rms ** 2 * kernel, np.eye(3))

    def _accel_design(self):
        scatter = np.radians(0.05)
        blocks, nuisance = [], []
        for number, (signals, parts, up) in enumerate(zip(self.signals, self.parts, self.up)):
            k = len(parts)
            white = np.concatenate([np.square(self.chip.white_g) / len(p.where) for p in parts])
            cover = np.diag(white) + self._flicker([(signals, p) for p in parts],
                                                   self.chip.flicker_g)
            for i, a in enumerate(parts):
                for j, b in enumerate(parts):
                    if a.number == b.number:
                        rest = [k for k, p in enumerate(parts) if p.number == a.number][0]
                        vertical = up[rest] / np.linalg.norm(up[rest])
                        across = np.eye(3) - np.outer(vertical, vertical)
                        loose = FREE if a.label[0] == "L" else scatter ** 2
                        cover[3 * i:3 * i + 3, 3 * j:3 * j + 3] += loose * across
            blocks.append(cover)
            rows = np.zeros((3 * k, 12 + 2 * len(self.signals) + 12))
            for i, p in enumerate(parts):
                here = slice(3 * i, 3 * i + 3)
                rows[here, :3] = np.eye(3)
                rows[here, 3:12] = np.kron(np.eye(3), up[i])
                at = signals.at[int(p.where[len(p.where) // 2])].as_matrix()
                if p.label[0] == "L":
                    continue
                rows[here, 12 + 2 * number:14 + 2 * number] = at.T[:, :2]
                if not self.certified:
                    face = "XYZ".index(p.label[0])
                    column = 12 + 2 * len(self.signals) + 4 * face + 2 * (p.label[1] == "-")
                    rows[here, column:column + 2] = np.delete(np.eye(3), face, axis=1)
            nuisance.append(rows)
        return Design(_block_diagonal(blocks), np.concatenate(nuisance))

    def _gyro_design(self):
        blocks, shapes = [], []
        for signals, parts, turns in zip(self.signals, self.parts, self.turns):
            white = np.repeat([self.chip.white_dps ** 2 / len(p.where) for p in parts], 3)
            rest = np.diag(white) + self._flicker([(signals, p) for p in parts],
                                                  self.chip.flicker_dps)
            move = []
            for span, _, end, flip in turns.moves:
                seconds = (span.stop - span.start) / signals.rate
                across = (self.chip.white_dps ** 2 * seconds / signals.rate
                          + (self.chip.flicker_dps * seconds) ** 2 + 2 * 0.05 ** 2)
                up = end.inv().apply([0, 0, 1.0])
                along = 1.0 if flip else 180.0
                move.append(across * np.eye(3) + along ** 2 * np.outer(up, up))
            blocks += [rest] + move
        # The offset is one for all sessions unless the power was off in between: with one of
        # its own for each, temperature and its rate are harder to tell apart.
        for session in range(len(self.signals) if self.power_ups else 1):
            for axis in range(3):
                shapes.append(lambda s, a=axis, k=session: np.eye(3)[a] * np.full(
                    (len(s.t), 1), float(s.session == k or not self.power_ups)))
        for i in range(3):
            for j in range(3):
                shapes.append(lambda s, i=i, j=j: s.w[:, j:j + 1] * np.eye(3)[i])
        for axis in range(3):
            shapes.append(lambda s, a=axis: s.at.inv().apply(np.eye(3)[a]))
        return Design(_block_diagonal(blocks), self.columns("gyro", shapes))


def _block_diagonal(blocks):
    out = np.zeros((sum(len(b) for b in blocks),) * 2)
    begin = 0
    for block in blocks:
        out[begin:begin + len(block), begin:begin + len(block)] = block
        begin += len(block)
    return out


def _past(signals):
    """(n, 3) of the mean force of the placement before, zero before the second."""
    out = np.zeros((len(signals.t), 3))
    previous = None
    for number in range(signals.placements.max() + 1):
        inside = np.flatnonzero(signals.placements == number)
        if previous is not None and len(inside):
            out[inside] = previous
        if len(inside):
            previous = signals.f[inside].mean(axis=0)
    return out


def _since(signals):
    """(n,) seconds since the placement began."""
    out = np.zeros(len(signals.t))
    for number in range(signals.placements.max() + 1):
        inside = np.flatnonzero(signals.placements == number)
        if len(inside):
            out[inside] = signals.t[inside] - signals.t[inside[0]]
    return out


def plain(sensor, case):
    """{effect: [(key, f(signals) -> (n, 3))]}: the obvious regressors, one a coefficient."""
    x = (lambda s: s.f) if sensor == "accel" else (lambda s: s.w)
    e = np.eye(3)

    def per_axis(shape):
        return [("xyz"[a], lambda s, a=a: shape(s)[:, a:a + 1] * e[a]) for a in range(3)]

    def scalar(shape):
        return per_axis(lambda s: shape(s)[:, None] * np.ones(3))

    out = {"thermal_bias": scalar(lambda s: s.temp - 25),
           "thermal_scale": per_axis(lambda s: x(s) * (s.temp - 25)[:, None]),
           "thermal_rate": scalar(lambda s: np.gradient(s.temp, s.t)),
           "warm_up": [p for tau in WARM_UP_TAUS
                       for p in scalar(lambda s, tau=tau: np.exp(-s.t / tau))],
           "asymmetry": per_axis(lambda s: np.abs(x(s)))}
    if sensor == "accel":
        out.update(
            quadratic=per_axis(lambda s: s.f ** 2), cubic=per_axis(lambda s: s.f ** 3),
            cross_quadratic=[("xyz"[i] + "xyz"[j] + "xyz"[k],
                              lambda s, i=i, j=j, k=k: (s.f[:, j] * s.f[:, k])[:, None] * e[i])
                             for i in range(3) for j, k in ((0, 1), (0, 2), (1, 2))],
            hysteresis=per_axis(_past),
            creep=per_axis(lambda s: (_past(s) - s.f) * np.exp(-_since(s) / 60)[:, None]))
        if any(e.name == "box_tilt" for e in case.effects):
            out["box_tilt"] = [
                ("%s%s" % (face, "xyz"[a]), lambda s, f=face, a=a: np.where(
                    (np.char.startswith(s.names, f))[:, None], np.radians(1) * e[a], 0))
                for face in ("Z+", "Z-", "X+", "X-", "Y+", "Y-") for a in range(3)
                if "xyz"[a] != face[0].lower()]
    else:
        out["quadratic"] = per_axis(lambda s: s.w ** 2)
        out["g_sensitivity"] = [("xyz"[i] + "xyz"[j], lambda s, i=i, j=j: s.f[:, j:j + 1] * e[i])
                                for i in range(3) for j in range(3)]
    return out
