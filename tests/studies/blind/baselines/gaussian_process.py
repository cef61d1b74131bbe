"""Baseline: a Gaussian process over temperature, time and orientation for the residual.

It shrinks the gap on the session held out and names nothing. Squared exponentials, one for each
of the three, added; their sizes axis by axis, and how far the temperature reaches, by marginal
likelihood of what the nominal model leaves [Rasmussen & Williams 2006, section 5.4]. On means
over blocks: of samples there are too many.
"""

import numpy as np
from scipy import linalg, optimize

from . import rests as at_rest
from .answers import answer
from .regression import gap, nuisance, residual, seen

LENGTHS_C, LENGTH_S, LENGTH_UP = (4.0, 36.0), 200.0, 0.8
WORTH_A_WORD = 0.1  # share of the squared gap from which on the verdict is "unexplained"


class Blocks:
    """Means over blocks of one session and sensor, a row each component: y (r,), axes (r, 3)
    its direction, inputs (r, 5): temperature, time, up; contrasts (r, m) free of the nominal
    model."""

    def __init__(self, sensor, session):
        rows, fixed = [], []
        for rest, constant in zip(session.rests, nuisance(sensor, session)):
            y = residual(sensor, rest)
            number = max(1, int((rest.t[-1] - rest.t[0]) / at_rest.BLOCK_S))
            for part in np.array_split(np.arange(len(y)), number):
                warm = 0.0 if rest.temperature is None else rest.temperature[part].mean()
                for row in seen(sensor, rest):
                    rows.append([row @ y[part].mean(axis=0), *row, warm, rest.t[part].mean(),
                                 *rest.up])
                    fixed.append(row @ constant)
        table = np.array(rows)
        self.y, self.axes, self.inputs = table[:, 0], table[:, 1:4], table[:, 4:]
        u, s, _ = np.linalg.svd(np.array(fixed))
        self.contrasts = u[:, int((s > 1e-9 * s[0]).sum()):]


def kernels(one, two, length_c):
    """list of (r, s): temperature, time and orientation on each axis, between two Blocks."""
    a, b = one.inputs, two.inputs
    apart = ((a[:, None, 0] - b[None, :, 0]) / length_c,
             (a[:, None, 1] - b[None, :, 1]) / LENGTH_S,
             np.linalg.norm(a[:, None, 2:] - b[None, :, 2:], axis=2) / LENGTH_UP)
    return [np.outer(one.axes[:, axis], two.axes[:, axis]) * np.exp(-0.5 * d ** 2)
            for d in apart for axis in range(3)]


class Process:
    """What is learnt from one session."""

    def __init__(self, blocks):
        self.blocks = blocks
        q = blocks.contrasts
        z = q.T @ blocks.y
        self.scale = max(float(z.std()), 1e-12)
        best = None
        for length_c in LENGTHS_C:
            parts = [q.T @ k @ q for k in kernels(blocks, blocks, length_c)] + [np.eye(len(z))]
            found = likeliest(parts, z / self.scale)
            if best is None or found.fun < best[0]:
                best = found.fun, length_c, np.exp(found.x), parts
        _, self.length_c, self.sizes, parts = best
        self.weights = q @ np.linalg.solve(total(self.sizes, parts), z / self.scale)

    def at(self, other):
        """(r,) the mean for the rows of another session."""
        parts = kernels(other, self.blocks, self.length_c)
        return self.scale * total(self.sizes, parts) @ self.weights


def total(sizes, parts):
    """Sum of the parts by their sizes."""
    return sum(a * k for a, k in zip(sizes, parts))


def likeliest(parts, z):
    """The minimum over the logarithms of the sizes."""
    def misfit(logs):
        sizes = np.exp(logs)
        factor = linalg.cho_factor(total(sizes, parts), lower=True)
        solved = linalg.cho_solve(factor, z)
        inverse = linalg.cho_solve(factor, np.eye(len(z)))
        slopes = [0.5 * a * ((inverse * k).sum() - solved @ k @ solved)
                  for a, k in zip(sizes, parts)]
        return 0.5 * z @ solved + np.log(np.diag(factor[0])).sum(), np.array(slopes)

    return optimize.minimize(misfit, np.full(len(parts), np.log(0.1)), jac=True,
                             method="L-BFGS-B", options={"maxiter": 30},
                             bounds=[(-12.0, 6.0)] * (len(parts) - 1) + [(-8.0, 2.0)])


def gaussian_process(captures):
    """The answer: no effect by name, the gap of each sensor on the session held out."""
    try:
        sessions = at_rest.sessions(captures)
    except ValueError:
        return answer({}, {})
    gyro = all(r.gyro is not None for s in sessions for r in s.rests)
    found = answer({}, {sensor: held_out(sensor, [Blocks(sensor, s) for s in sessions])
                        for sensor in (("accel", "gyro") if gyro else ("accel",))})
    if any(g["explained_share"] > WORTH_A_WORD for g in found["gap"].values()):
        found["verdict"] = "unexplained"  # there is a gap, and no word for it
    return found


def held_out(sensor, blocks):
    """The figures of the gap, each session predicted from the mean of the others' processes;
    None with one."""
    if len(blocks) < 2:
        return None
    before = after = freedom = 0.0
    processes = [Process(b) for b in blocks]
    for held, mine in enumerate(blocks):
        others = processes[:held] + processes[held + 1:]
        predicted = np.mean([p.at(mine) for p in others], axis=0)
        z = mine.contrasts.T @ np.stack([mine.y, mine.y - predicted], 1)
        before, after = before + z[:, 0] @ z[:, 0], after + z[:, 1] @ z[:, 1]
        freedom += len(z)
    return gap(sensor, before, after, freedom)
