"""The lag of one log behind another of one motion in the course of time, by the path of least
cost through blocks of time and all lags at once [Viterbi, IEEE Trans. Inf. Theory 13 (1967) 260]:
it goes straight on where the times run alike, jumps, and wanders by small steps. Offset and pace,
jumps and a wander are then fitted together by least squares, the wander as a random walk.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.interpolate import CubicSpline

from .. import odds
from . import alignment

GRID_HZ = alignment.GRID_HZ
BLOCK_S, FINE_S = 1.0, 0.25  # of the path: the first by how fast both turn, then by all axes
INDEPENDENT_HZ = alignment.BAND_HZ  # a block's readings are as many as it has periods of the band
REACH_S = (2.0, 20.0)  # of the lag at least, and at most: some hundreds of lost rows a minute
STEP, LARGE = 3.0, 2  # nats of a step of one lag, 0.01 s, where it wanders; more is a jump
ROUNDS = 4  # of a line that takes the small steps' sum for its own pace, and of least squares
PACES = (1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3)  # of a random walk from knot to knot: by half-decades
LEVEL_S = 0.1  # of the wander, whose mean is the offset's
THINNED = 4  # of so many rows of the grid one for least squares: four a period of the band
PER_S2 = (2.0 * np.pi * alignment.BAND_HZ) ** 2  # of a bend at the end of the band
BLURRED_S = 0.2  # to either side of a jump: in a period of the band the low-pass forgets it
KNOT_S = 4.0  # of the wander: a clock that a temperature or a network leads takes longer
PRESENT = odds.COST + odds.PRESENT  # nats that a course earns over a line, to be looked at


@dataclass(frozen=True)
class Line:
    """Time of the real log = offset + (1 + drift) t + those of sizes (k,) whose times (k,) are
    past + wander (m,), a straight line between knots KNOT_S apart, of t of the simulator's."""

    offset: float
    drift: float
    times: np.ndarray
    sizes: np.ndarray
    wander: np.ndarray

    def of_simulator(self, t):
        """Times of the real log at times t (n,) of the simulator's."""
        return self.offset + (1.0 + self.drift) * t + self.course(t)

    def course(self, t):
        """What is no line of it."""
        jumped = np.concatenate([[0.0], np.cumsum(self.sizes)])
        knots = KNOT_S * np.arange(max(len(self.wander), 1))
        return jumped[np.searchsorted(self.times, t, "right")] + np.interp(
            t, knots, self.wander if len(self.wander) else [0.0])


@dataclass(frozen=True)
class Fitted:
    """A Line; sigma (k,): of its sizes; left (n, 3); turn (4, 3): the simulator's rates by the
    real ones and 1; cost: nats of what is free; found: largest share of a log's turns used."""

    line: Line
    sigma: np.ndarray
    left: np.ndarray
    turn: np.ndarray
    cost: float
    found: float

    @property
    def power(self):
        return float((self.left ** 2).mean())


class Turns:
    """real, sim (n, 3): turn rates of two Traces on a grid of GRID_HZ, smooth, less what they are
    at rest; real_read, sim_read: as they were read."""

    def __init__(self, real, sim):
        read = self.real_read, self.sim_read = _turns(real), _turns(sim)
        self.real, self.sim = (alignment.smooth(turns, GRID_HZ) for turns in read)
        self.end_s = (len(self.real) - 1) / GRID_HZ
        self.spline = CubicSpline(np.arange(len(self.real)) / GRID_HZ, self.real)


def _turns(trace):
    rate = trace.rate - (trace.rest_means(trace.rate).mean(axis=0) if trace.rests
                         else np.median(trace.rate, axis=0))
    t = np.arange(0.0, trace.seconds, 1.0 / GRID_HZ)
    return np.stack([np.interp(t, trace.t, r) for r in rate.T], 1)


def interpolated(values, at):
    """(n, 3) of values on the grid at times (n,) s, in straight lines."""
    return np.stack([np.interp(GRID_HZ * at, np.arange(len(values)), x) for x in values.T], 1)


def first_path(logs, aligned, reach_s):
    """(drift, lag in rows of each block, s of a block) by how fast both turn, or None where no
    jump and no wander earns what it costs."""
    x, y = (np.linalg.norm(z, axis=1) for z in (logs.real, logs.sim))
    if not min(x.std(), y.std()) > 0.0:
        return None
    x, reach = x * np.sqrt((y ** 2).mean() / (x ** 2).mean()), int(reach_s * GRID_HZ)
    best, straight = (np.inf,), np.inf
    for drift in dict.fromkeys((0.0, aligned.drift)):
        for _ in range(ROUNDS):
            own = at_pace(x[:, None], drift)[:, 0]
            middle = int(round(GRID_HZ * (aligned.offset_s if aligned.same else alignment.coarse(
                *((np.arange(len(z)) / GRID_HZ, z) for z in (own, y)), 0.0)[1])))
            nats = costs(own[:, None], y[:, None], int(BLOCK_S * GRID_HZ), middle, reach)
            straight = min(straight, float(nats.sum(axis=0).min()))
            cost, path = least_path(nats, np.log(nats.size), STEP)
            best = min(best, (cost, drift, path + middle - reach), key=lambda one: one[0])
            steps = np.diff(path)
            slow = steps[np.abs(steps) <= LARGE].sum()
            if abs(slow) <= LARGE:
                break
            drift += slow / len(y)
    return (*best[1:], BLOCK_S) if straight - best[0] > PRESENT else None


def costs(x, y, block, middle, reach):
    """(blocks, 2 reach + 1) nats of y (n, k) by x (m, k) at lags of middle - reach to middle +
    reach rows: of a noise that is another one in each block, and no less than what the best lags
    leave of half of them."""
    number = len(y) // block
    rows = np.arange(len(y) + 2 * reach) + middle - reach
    longer = x[np.clip(rows, 0, len(x) - 1)] * ((rows >= 0) & (rows < len(x)))[:, None]
    power = np.concatenate([[0.0], np.cumsum((longer ** 2).sum(axis=1))])
    left = np.empty((number, 2 * reach + 1), np.float32)
    for k, a in enumerate(range(0, number * block, block)):
        own = y[a:a + block]
        cross = sum(np.correlate(longer[a:a + block + 2 * reach, i], own[:, i], "valid")
                    for i in range(y.shape[1]))
        left[k] = power[a + block:a + block + 2 * reach + 1] - power[a:a + 2 * reach + 1] \
            - 2.0 * cross + (own ** 2).sum()
    left = np.maximum(left, 0.0) / block
    floor = np.median(left.min(axis=1)) + 1e-6 * (y ** 2).sum(axis=1).mean()
    return 0.5 * INDEPENDENT_HZ * block / GRID_HZ * np.log(left + floor)


def least_path(nats, jump, step):
    """(nats of it, (blocks,) lags) of the path of least cost through nats (blocks, lags), of which
    a jump to any lag costs so many, and a step to the next."""
    best, lags = nats[0].copy(), np.arange(nats.shape[1], dtype=np.int32)
    back = np.empty(nats.shape, np.int32)
    for k in range(1, len(nats)):
        back[k], own = lags, best.copy()
        for to, source in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
            nearer = best[source] + step < own[to]
            own[to] = np.where(nearer, best[source] + step, own[to])
            back[k, to] = np.where(nearer, lags[source], back[k, to])
        least = int(best.argmin())
        back[k, best[least] + jump < own] = least
        best = np.minimum(best[least] + jump, own) + nats[k]
    path = [int(best.argmin())]
    for each in back[:0:-1]:
        path.append(int(each[path[-1]]))
    return float(best.min()), np.array(path[::-1])


def at_pace(x, drift):
    """x (n, k) on the grid of a clock that is so much faster."""
    return interpolated(x, np.arange(0.0, len(x) - 1.0, 1.0 + drift) / GRID_HZ)


def fine_path(logs, drift, lags, block_s, wanders):
    """The Line of a path, by blocks of FINE_S and all axes; wanders: small steps are no jumps, and
    left to a wander. None where too little of both logs is there."""
    t, y = np.arange(len(logs.sim)) / GRID_HZ, logs.sim
    at = (1.0 + drift) * t + lags[np.minimum((t / block_s).astype(int), len(lags) - 1)] / GRID_HZ
    inside = (at > 0.0) & (at < logs.end_s)
    if inside.sum() < alignment.LEAST_S * GRID_HZ:
        return None
    turn = np.linalg.lstsq(np.column_stack([logs.spline(at[inside]), np.ones(inside.sum())]),
                           y[inside], rcond=None)[0]
    low, high = int(lags.min()), int(lags.max())
    middle, reach = (low + high) // 2, (high - low) // 2 + int(FINE_S * GRID_HZ)
    nats = costs(at_pace(logs.real, drift) @ turn[:3] + turn[3], y, int(FINE_S * GRID_HZ), middle,
                 reach)
    jump = np.log(nats.size)
    lags = least_path(nats, jump, STEP if wanders else jump)[1] + middle - reach
    steps = np.diff(lags)
    large = np.abs(steps) > (LARGE if wanders else 0)
    rest = (lags - np.concatenate([[0], np.cumsum(np.where(large, steps, 0))])) / GRID_HZ
    knots = KNOT_S * np.arange(int(t[-1] / KNOT_S) + 2 if wanders else 0)
    wander = np.interp(knots, FINE_S * (np.arange(len(rest)) + 0.5), rest) - rest.mean()
    return Line(float(rest.mean()), drift, FINE_S * (np.flatnonzero(large) + 1.0),
                steps[large] / GRID_HZ, wander)


def fitted(logs, line, wanders=False):
    """The Fitted of a Line by least squares from where it is, with the turn between both logs and
    how much smoother one is; None where too little of both is there."""
    t, y = np.arange(0, len(logs.sim), THINNED) / GRID_HZ, logs.sim[::THINNED]
    jumps, hats, sigma, of_walk = len(line.sizes), _hats(t, len(line.wander)), (), 0.0
    for left_to_do in range(ROUNDS, -1, -1):
        at = line.of_simulator(t)
        keep = (at > 0.0) & (at < logs.end_s)
        for time, size in zip(line.times, line.sizes):
            keep &= (t < time - BLURRED_S - max(-size, 0.0)) | (t > time + BLURRED_S)
        if keep.sum() < alignment.LEAST_S * GRID_HZ / THINNED:
            return None
        signal, slope, bend = (logs.spline(at[keep], k) for k in range(3))
        design = np.column_stack([signal, bend / PER_S2, np.ones(keep.sum())])
        turn = np.linalg.lstsq(design, y[keep], rcond=None)[0]
        left = y[keep] - design @ turn
        if not left_to_do:
            break
        pull = slope @ turn[:3]
        columns = sparse.hstack([np.column_stack([np.ones(keep.sum()), t[keep], (
            t[keep, None] >= line.times).astype(float)]), hats[keep]]).tocsr()
        noise = float((left ** 2).mean()) * alignment.independent(left)
        gram = (columns.T @ columns.multiply((pull ** 2).sum(axis=1)[:, None])).toarray() / noise
        size = np.concatenate([[line.offset, line.drift], line.sizes, line.wander])
        known, against = np.zeros_like(gram), columns.T @ (pull * left).sum(axis=1) / noise
        if wanders:
            known, of_walk = _walk(gram, against, size, 2 + jumps)
            against -= known @ size
        inverse = np.linalg.pinv(gram + known, hermitian=True)
        size, sigma = size + inverse @ against, np.sqrt(np.diag(inverse).clip(0.0))[2:2 + jumps]
        line = replace(line, offset=size[0], drift=size[1], sizes=size[2:2 + jumps],
                       wander=size[2 + jumps:])
    found = max(np.linalg.norm(y[keep]) ** 2 / np.linalg.norm(y) ** 2,
                THINNED * np.linalg.norm(signal) ** 2 / np.linalg.norm(logs.real) ** 2)
    return Fitted(line, sigma, left, turn[[0, 1, 2, -1]], of_walk + jumps * np.log(
        len(t) * REACH_S[0] * GRID_HZ), found)


def _hats(t, number):
    """(n, number) sparse: what each of so many knots says of times t (n,), in straight lines."""
    first, rows = (t / KNOT_S).astype(int), np.arange(len(t))
    share = t / KNOT_S - first
    return sparse.csr_matrix((np.concatenate([1.0 - share, share]), (np.tile(
        rows, 2), np.concatenate([first, first + 1]))), (len(t), number)) if number else \
        sparse.csr_matrix((len(t), 0))


def _walk(gram, against, size, first):
    """(prior precision of all sizes (k,), nats that it costs) of the random walk of most evidence
    for those from the first on; gram (k, k) and against (k,): of what is left beside them."""
    number, best, target = len(size) - first, None, against + gram @ size
    differences = np.diff(np.eye(number), axis=0)
    for pace in PACES:
        known = 1e-9 * np.eye(len(size)) * np.diag(gram).mean()
        known[first:, first:] += differences.T @ differences / (pace * KNOT_S) ** 2 + np.eye(
            number) / LEVEL_S ** 2
        whole, apart = (0.5 * (np.linalg.slogdet((gram + known)[:end, :end])[1]
                               - np.linalg.slogdet(known[:end, :end])[1]) for end in (None, first))
        guess = np.linalg.solve(gram + known, target)
        earns, walk = 0.5 * float(target @ guess) - whole, guess[first:]
        if best is None or earns > best[0]:
            best = earns, known, whole - apart + 0.5 * walk @ known[first:, first:] @ walk
    return best[1:]
