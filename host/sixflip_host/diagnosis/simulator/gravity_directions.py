"""How likely one log's directions of gravity are: at its rests, as labels or the real robot's own
rests have them, and from each rest to the next, as the gyro carries them."""
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from ...capture.attitude import carried, rotation_between, rotations
from .. import odds
from ..detect.wrong_scale import RANGES
from . import single_log, traces
from .convention_findings import CERTAIN
from .sensor_axes import DEAD

SIGMA = np.radians(4.0)  # of a direction: bias of 60 mg at both ends of a way
# Of scale and misalignment, as data sheets have them (MPU-6050 PS, section 6.1: 3 % and 2 %).
GYRO = 0.03
# Share of moves and rests that follow nothing at all: a log of fifty moves may have one in which
# the gyro was cut off or the robot slid, which then costs a hypothesis no more than ln 50 nats.
ASTRAY = 0.02
ANYWHERE = np.radians(20.0)  # of a direction, from which on a gyro says nothing of it
AGAIN = 0.5  # of those after which it lies as it did before
POSE = np.radians(15.0)  # how alike the rests of two runs of one robot are: ramps and slopes
POSES_COUNT = 4  # runs of one robot stand alike: that many of its rests say something new
STEPS_HZ = 25.0  # a robot turns below 5 Hz: five steps a period
HEADINGS = 48  # each 7.5 degrees: within SIGMA of the true one


def moves(trace):
    """[(rest before, rest after, increments (k, 3) rad)] of the gyro, in short steps, of moves in
    which it was not cut off: it turned farther than it says then."""
    if trace.rate is None:
        return []
    rate = trace.rate - traces.rest_line(trace, trace.rate)
    ways, cut = [], single_log.gyro_cut_off(trace)
    for k in range(len(trace.rests) - 1):
        first, last = trace.rests[k][1] - 1, trace.rests[k + 1][0]
        if cut[first:last].any():
            continue
        dt = np.diff(trace.t[first:last + 1])[:, None]
        steps = 0.5 * (rate[first:last] + rate[first + 1:last + 1]) * dt
        group = max(1, int(trace.rate_hz / STEPS_HZ))
        edges = np.arange(0, len(steps), group)
        ways.append((k, k + 1, np.add.reduceat(steps, edges, axis=0)))
    return ways


def near(a, b, sigma):
    """Density of direction a about b, each (…, 3), that is known to sigma rad [Fisher, Proc. R.
    Soc. A 217 (1953), 295]."""
    return np.exp(((a * b).sum(axis=-1) - 1.0) / sigma ** 2) / (2.0 * np.pi * sigma ** 2)


def closeness(a, b, sigma=SIGMA):
    """log density of direction a given b; nothing at all is always possible."""
    return np.log((1.0 - ASTRAY) * near(a, b, sigma) + ASTRAY / (4.0 * np.pi))


def habit(a, before, far, sigma=0.0):
    """Density of direction a at a rest after the direction before, by how a thing is moved in a
    log, as far as far rad; of a that is itself known to sigma only."""
    return near(a, before, np.hypot(np.maximum(far, SIGMA), sigma))


def lands(a, b, sigma, before, far):
    """log density of the direction a at a rest, to which the gyro takes the one before as b, known
    to sigma: by that and the habit of the log. Where a thing is laid down as it lay each
    time, a gyro that says so less sharply than the habit takes nothing from it; one by which it
    turned so often that it may lie anywhere has no habit of lying as it lay."""
    both = near(a, b, sigma) * np.where(sigma < ANYWHERE, habit(a, before, far) / np.maximum(
        habit(b, before, far, sigma), 1e-300), 1.0)
    return np.log((1.0 - ASTRAY) * both + ASTRAY * (
        (1.0 - AGAIN) / (4.0 * np.pi) + AGAIN * near(a, before, SIGMA)))


@dataclass(frozen=True)
class Carried:
    """How a gyro's readings carry directions over m moves: the rests before and after (m,), turn
    (m, 3, 3) of each move, and its spread (m, 3, 3), see carries()."""

    before: np.ndarray
    after: np.ndarray
    turn: np.ndarray
    spread: np.ndarray

    def log(self, body):
        """Sum over the moves of how likely gravity after each is; body (rests, 3): directions."""
        up = body[self.before]
        predicted = np.einsum("mji,mj->mi", self.turn, up)
        return float(np.sum(lands(body[self.after], predicted, carries(self.spread, up), up,
                                  goes(up, body[self.after]))))


def carried_by(ways, gyro):
    """Carried of ways as moves() has them, by a gyro that reads gyro (3, 3) · true rate."""
    matrix, turns, spreads = np.linalg.inv(gyro), [], []
    for _, _, steps in ways:
        steps = steps @ matrix.T
        chain = carried(rotations(steps))
        turns.append(chain[-1])
        spreads.append(spread(steps, chain))
    before, after = np.array([way[:2] for way in ways], int).reshape(-1, 2).T
    return Carried(before, after, np.reshape(turns, (-1, 3, 3)), np.reshape(spreads, (-1, 3, 3)))


def carried_log(body, ways, gyro):
    """Sum over moves: gravity after, carried by the gyro's readings (read = gyro · true rate)."""
    return carried_by(ways, gyro).log(body)


def spread(steps, turns):
    """(3, 3) rad2: covariance of the end of steps (k, 3) rad, whose turns (k + 1, 3, 3) they make.
    Each entry of the gyro's matrix, GYRO off, turns it by the sum of the steps that it is off by,
    as they lie where the way begins: of a way there and back that is next to nothing, of a flight
    of many turns so much that where it ends says nothing of the gyro."""
    off = np.einsum("kai,kj->aij", turns[:-1], steps)
    return GYRO ** 2 * np.einsum("aij,bij->ab", off, off)


def carries(spreads, up):
    """rad (m,): how well moves of such spreads (m, 3, 3) carry directions up (m, 3)."""
    along = np.einsum("mi,mij,mj->m", up, spreads, up)
    return np.sqrt(SIGMA ** 2 + np.maximum(np.trace(spreads, axis1=1, axis2=2) - along, 0.0) / 2.0)


def full_scale(trace, ups):
    """How many times too large the gyro reads by the directions of gravity ups (k, 3) at the rests
    of a Trace, where its full scale is not the one that its log states; 1 where they do not show
    another, or where there is none."""
    ways = moves(trace)
    chances = odds.shares({times: carried_log(ups, ways, times * np.eye(3)) + np.log(
        CERTAIN if times == 1.0 else 1.0 - CERTAIN) for times in (1.0, *RANGES)})
    likeliest = max(chances, key=chances.get)
    return likeliest if chances[likeliest] > CERTAIN else 1.0


def beside(kind, fit, real, sim, real_turns):
    """The Fit of a gyro with what the rests of each Trace by itself say of it: one that turns as
    far as its gravity does has no wrong time step, or reads no part of what it went through.
    real_turns: how many times as far as gravity the real one turns; what the simulator's shares
    with it is wrong in both, and no gap."""
    if kind != "gyro" or fit.name not in ("healthy", "time_step"):
        return fit
    ratio = max(1.0 + float(np.diag(fit.shape).mean()), DEAD)
    if fit.hypothesis.shared:
        times = real_turns, real_turns * ratio
    else:
        times = 1.0 / ratio, 1.0 + fit.extra[0] if fit.name == "time_step" else 1.0
    return replace(fit, log=fit.log + sum(turns_nats(*x) for x in zip((real, sim), times)))


def turns_nats(trace, times):
    """Nats by which a Trace's directions of gravity are likelier where its gyro turns so many
    times too far than where it is right; 0 where it has no two rests."""
    ups = trace.rest_means(trace.force)
    if len(ups) < 2 or times == 1.0:
        return 0.0
    ups = ups / np.maximum(np.linalg.norm(ups, axis=1), 1e-9)[:, None]
    ways = moves(trace)
    return carried_log(ups, ways, times * np.eye(3)) - carried_log(ups, ways, np.eye(3))


def world_log(body, ways):
    """The same with rates along the world's axes, the heading at the start unknown."""
    if not ways:
        return -1e9
    z = np.array([0.0, 0.0, 1.0])
    wholes = [(before, after, reduce(lambda whole, turn: turn @ whole, rotations(steps)))
              for before, after, steps in ways]
    best, far = [], goes(*(body[[way[k] for way in ways]] for k in (0, 1)))
    for psi in np.linspace(0.0, 2.0 * np.pi, HEADINGS, endpoint=False):
        c, s = np.cos(psi), np.sin(psi)
        attitude = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) @ rotation_between(body[0], z)
        total = 0.0
        for before, after, whole in wholes:
            attitude = whole @ attitude
            total += lands(body[after], attitude[2], SIGMA, body[before], far)
            attitude = rotation_between(attitude @ body[after], z) @ attitude
        best.append(total)
    top = max(best)
    return float(top + np.log(np.mean(np.exp(np.array(best) - top))))


def nameless_log(ups, ways):
    """Gravity goes as far as it does in this log, into any direction: the gyro says nothing."""
    before, after = (ups[[way[k] for way in ways]].reshape(-1, 3) for k in (0, 1))
    return float(np.log((1.0 - ASTRAY) * habit(after, before, goes(before, after))
                        + ASTRAY / (4.0 * np.pi)).sum())


def constant_log(ups, ways, sim):
    """Gravity along one axis of the sensor, whichever way it was turned."""
    axis = ups.mean(axis=0)
    near = np.zeros(3)
    near[np.abs(axis).argmax()] = np.sign(axis[np.abs(axis).argmax()])
    total = sum(closeness(ups[b], near) for _, b, _ in ways)
    for up, face in zip(ups, sim.faces):
        if face is not None:
            total += closeness(up, near)
    return float(total) - np.log(6.0)


def direction_log(body, real, sim):
    """How well the directions at rest fit the labels, or the rests of the real robot."""
    if any(f is not None for f in sim.faces):
        return float(sum(closeness(b, f) for b, f in zip(body, sim.faces) if f is not None))
    theirs = real.rest_means(real.force)
    if not len(theirs):
        return 0.0
    theirs = theirs / np.maximum(np.linalg.norm(theirs, axis=1), 1e-12)[:, None]
    kappa = 1.0 / POSE ** 2
    near = kappa / (2 * np.pi) * np.exp(kappa * (body @ theirs.T - 1.0))
    density = np.log(0.9 * near.mean(axis=1) + 0.1 / (4 * np.pi))
    return float(density.mean() * min(len(body), POSES_COUNT))


def should_turn(ups, ways):
    """rad: how far the gyro says that gravity moves in the sensor in a move, at most."""
    angles = [0.0]
    for before, _, steps in ways:
        turn = carried(rotations(steps))[-1]
        angles.append(float(np.arccos(np.clip(ups[before] @ (turn.T @ ups[before]), -1.0, 1.0))))
    return max(angles)


def goes(before, after):
    """rad about either axis, root mean square, by which directions before (m, 3) go to after."""
    return float(np.sqrt(np.mean(np.arccos(np.clip(
        (before * after).sum(axis=1), -1.0, 1.0)) ** 2) / 2.0)) if len(before) else 0.0


def turned(ups, ways):
    """Angles by which gravity moved in the sensor."""
    return [float(np.arccos(np.clip(ups[a] @ ups[b], -1, 1))) for a, b, _ in ways] or [0.0]
