"""The gyro in motion: gravity before and after each move against the rotation integrated.

With R(t) the attitude since the start of a move, an error e(t) of the rate turns the end by
phi = int R(t) e(t) dt, and gravity carried back to the start is off by phi x up [Tedaldi et al.,
ICRA 2014, eq. 13-18, linearised]. Flips of one face also say that the turn was half a circle.
Everything is divided by the length of the move: deg/s, as the causes are.
"""
import itertools

import numpy as np
from scipy import linalg

from sixflip_sim.effects.moment import Moment

from ..simulating import noise_arrays
from ..solving.attitude import _rotation
from . import nominal_fit, regressors
from .evidence import Levels
from .finding import Finding
from .sensor_gap import SensorGap

EFFECTS = ("asymmetry", "quadratic", "cubic", "thermal_scale")
LEVELS_DEG = tuple(0.03 * 1.35 ** k for k in range(18))
ATTITUDE_DEG = 0.03  # of gravity's direction at rest
FLIP_DEG = 0.6  # of half a turn by hand; 0.4 is usual (METHOD section 2)
ROUNDS = 2  # of taking off scale and misalignment, so that what is left is small
SHORTEST_S, LONGEST_S, LEAST_DEG = 0.3, 60.0, 20.0
FEWEST_MOVES = 6
WRONG_DEG, RIGHT_DEG = 25.0, 12.0
RAIL = 32767
USUAL_DEG = 0.25  # of a move from rest to rest, beside white noise


class Turn:
    """One move: rate (n, 3) deg/s about the bias, dt (n,), attitude (n, 3, 3), up before and
    after, the code of a flip's face or -1; seconds; temperature (n,) or None; first, last: which
    samples; matrix, shift (deg/s): what was taken out of the rates, true = matrix rate - shift."""

    def __init__(self, session, nominal, bias, place):
        first, end = session.runs[place][2] - 1, session.runs[place + 1][1] + 1
        self.first, self.last = first, end
        self.matrix, self.shift = np.eye(3), np.zeros(3)
        capture = session.capture
        counts = capture.gyro[first:end]
        self.t = session.t_s[first:end]
        self.railed = bool((np.abs(counts.astype(int)) >= RAIL - 1).any())
        self.rate = counts / capture.meta["gyro_lsb_per_dps"] - bias
        self.dt = np.diff(self.t)
        self.middle = 0.5 * (self.rate[1:] + self.rate[:-1])
        self.seconds = float(self.t[-1] - self.t[0])
        self.before, self.after = nominal.up[place], nominal.up[place + 1]
        a, b = session.runs[place][0], session.runs[place + 1][0]
        self.flip = session.labelled and a != b and a <= 12 and b <= 12 and (a - 1) // 2 == (
            b - 1) // 2
        self.temperature = None if session.thermometer is None \
            else session.thermometer.at(self.t[1:])
        self.wander = np.zeros(3)

    def integrate(self, matrix=None):
        """Fill attitude: of each sample's middle since the start; and end."""
        rate = self.middle if matrix is None else self.middle @ matrix.T
        turns = _rotation(np.radians(rate) * self.dt[:, None])
        now, out = np.eye(3), np.empty((len(turns), 3, 3))
        for k, turn in enumerate(turns):
            out[k] = now
            now = now @ turn
        self.attitude, self.end = out, now
        return self

    @property
    def turned(self):
        """Degrees of path."""
        return float((np.linalg.norm(self.middle, axis=1) * self.dt).sum())

    def off(self):
        """Degrees between gravity before and gravity after, carried back."""
        cosine = np.clip(self.before @ self.end @ self.after, -1.0, 1.0)
        return float(np.degrees(np.arccos(cosine)))


def turns(session, nominal):
    """list of Turn that can be used; integrated, and kept with the session."""
    if not hasattr(session, "turns"):
        session.turns = _turns(session, nominal)
    return session.turns


def _turns(session, nominal):
    kept = np.unique(session.placement).tolist()
    rest = {p: session.gyro[session.placement == p].mean(axis=0) for p in kept}
    pairs = [p for p in kept if p + 1 in rest]
    if not pairs:
        return []
    # A bias that changes from rest to rest is known to about half of that in between.
    wander = np.sqrt(np.mean([(rest[p + 1] - rest[p]) ** 2 for p in pairs], axis=0)) / 2.0
    found = []
    for place in pairs:
        # What drifts, or feels gravity, is halfway between the rests before and after.
        turn = Turn(session, nominal, 0.5 * (rest[place] + rest[place + 1]), place)
        turn.wander = wander
        if fit(turn, session.rate):
            found.append(turn.integrate())
    return found


def fit(turn, rate):
    """True when a turn can be used: neither cut off nor with gaps, long and far enough."""
    gaps = turn.dt.max() if len(turn.dt) else 1.0
    return (not turn.railed and gaps <= 5.0 / rate and turn.turned >= LEAST_DEG
            and SHORTEST_S <= turn.seconds <= LONGEST_S)


def rows(turn, axis_vectors):
    """(2 or 3, 3): what a small rotation (start frame, deg) does to what is observed."""
    first, second = axis_vectors
    # phi x up along two directions across up; a flip's turn about up itself
    out = [np.cross(turn.before, first), np.cross(turn.before, second)]
    if turn.flip:
        out.append(turn.before)
    return np.array(out) / turn.seconds


def observed(turn, axis_vectors):
    """(2 or 3,) deg/s: gravity carried back less gravity before; the flip's turn less 180."""
    back = turn.end @ turn.after - turn.before
    out = [np.degrees(back @ v) for v in axis_vectors]
    if turn.flip:
        first, second = axis_vectors
        carried = turn.end @ first
        angle = np.degrees(np.arctan2(carried @ second, carried @ first))
        out.append((angle % 360.0) - 180.0)
    return np.array(out) / turn.seconds


def design(name, chosen, reference_c, chip):
    """Design of an effect of the gyro in motion over the rows of all turns."""
    parts = []
    for turn in chosen:
        m = Moment(np.exp, np.sin, np.floor, noise_arrays.gauss)
        m.w = tuple(turn.middle.T)
        m.temperature = turn.temperature if turn.temperature is not None else m.temperature
        shape = {"reference_c": reference_c} if name == "thermal_scale" else None
        one = regressors.of_terms(name, "gyro", m, len(turn.dt), chip=chip, shape=shape)
        added = one.columns.reshape(len(turn.dt), 3, -1)
        parts.append(projected(turn, added))
    return regressors.Design(name, "", one.keys, one.axes, np.vstack(parts), one.prior)


def projected(turn, added):
    """(2 or 3, k): rates added (n, 3, k), deg/s, as what is observed."""
    phi = np.einsum("nij,njk,n->ik", turn.attitude, added, turn.dt)
    return rows(turn, nominal_fit.lateral_basis(turn.before)) @ phi


def wandering(chosen):
    """(m, m) covariance of what is observed, by a bias that is not known between two rests."""
    parts = []
    for turn in chosen:
        constant = projected(turn, np.broadcast_to(np.eye(3), (len(turn.dt), 3, 3)))
        parts.append(constant @ np.diag(turn.wander ** 2) @ constant.T)
    return linalg.block_diag(*parts)


def nuisance(chosen):
    """Columns: scale and misalignment (9), bias (3)."""
    parts = []
    for turn in chosen:
        n = len(turn.dt)
        added = np.zeros((n, 3, 12))
        for i in range(3):
            added[:, i, 3 * i:3 * i + 3] = turn.middle
            added[:, i, 9 + i] = 1.0
        parts.append(projected(turn, added))
    return np.vstack(parts)


def calibrated(chosen):
    """Take the nominal scale, misalignment and bias out of the rates of all turns; returns
    what is observed then."""
    for _ in range(ROUNDS):
        y = np.concatenate([observed(t, nominal_fit.lateral_basis(t.before)) for t in chosen])
        found = np.linalg.lstsq(nuisance(chosen), y, rcond=1e-9)[0]
        matrix = np.eye(3) - found[:9].reshape(3, 3)
        for turn in chosen:
            turn.middle = turn.middle @ matrix.T - found[9:]
            turn.matrix, turn.shift = matrix @ turn.matrix, matrix @ turn.shift + found[9:]
            turn.integrate()
    return np.concatenate([observed(t, nominal_fit.lateral_basis(t.before)) for t in chosen])


class TurnsGap(SensorGap):
    """SensorGap of the gyro in motion: no flicker, and no bias between the sessions."""

    drifts = False

    def unit(self, part, model, certified):
        chosen = turns(part, model)
        y = calibrated(chosen)
        seconds = np.concatenate([[t.seconds] * (3 if t.flip else 2) for t in chosen])
        white = np.concatenate([[ATTITUDE_DEG] * 2 + [FLIP_DEG] * t.flip for t in chosen])
        names = [n for n in EFFECTS if n != "thermal_scale" or part.thermal]
        designs = [design(n, chosen, self.settings.reference_c, self.chip) for n in names]
        designs += [nameless(chosen, name, of_rate) for name, of_rate in STRANGERS.items()]
        unit = nominal_fit.Unit(
            y, nuisance(chosen), np.diag((white / seconds) ** 2), np.diag(1.0 / seconds),
            np.zeros((len(y), len(y))), (LEVELS_DEG, (0.0,)), designs, wandering(chosen))
        unit.signature = ("turns", tuple((t.flip, round(t.turned, -1)) for t in chosen))
        return unit

    def _levels(self):
        return Levels(USUAL_DEG, 1.0, 1.0)

    def _between(self):
        return []


def _bends(w, dt):
    """Of each axis' own rate: what no power names."""
    return [np.clip(w, -20.0, 20.0) / 20.0, np.clip(w, -60.0, 60.0) / 60.0,
            np.clip(np.abs(w), 0.0, 30.0) / 30.0]


def _of_motion(w, dt):
    """Of the rate of the others, and of how fast the rates change."""
    change = np.gradient(w, axis=0) / dt[:, None]
    size = np.linalg.norm(w, axis=1)[:, None] / 100.0
    product = np.stack([w[:, 1] * w[:, 2], w[:, 2] * w[:, 0], w[:, 0] * w[:, 1]], 1) / 1e4
    return [change / 100.0, np.broadcast_to(size, w.shape), size * w / 100.0, product]


STRANGERS = {"amplitude": _bends, "motion": _of_motion}


def nameless(chosen, name, of_rate):
    """Design of functions of the rate that no effect of the library has."""
    return _of_rates("~" + name, "", chosen, of_rate, 10.0)


def _of_rates(effect, variant, chosen, functions, prior):
    """Design of functions (n, 3) of rates (n, 3) and steps (n,), a coefficient an axis each."""
    parts, number = [], 0
    for turn in chosen:
        values = functions(turn.middle, turn.dt)
        number = len(values)
        added = np.zeros((len(turn.dt), 3, 3 * number))
        for k, value in enumerate(values):
            for axis in range(3):
                added[:, axis, 3 * k + axis] = value[:, axis]
        parts.append(projected(turn, added))
    keys = ["%s%s" % ("xyz"[a], "" if not k and effect[0] != "~" else k)
            for k in range(number) for a in range(3)]
    return regressors.Design(effect, variant, keys, [0, 1, 2] * number, np.vstack(parts),
                             np.full(3 * number, prior))


def usable(session, nominal):
    """True when there are enough turns to judge."""
    return session.gyro is not None and len(turns(session, nominal)) >= FEWEST_MOVES


def swapped(sessions, nominal):
    """Finding of gyro axes that are swapped or inverted, or None; its read (3, 3) takes what is
    true to what is read."""
    # A turn about the vertical looks the same to gravity whichever way the axes point.
    found = [t for s, m in zip(sessions, nominal) for t in turns(s, m)
             if t.before @ t.after < 0.8][:10]
    if len(found) < 3 or np.mean([t.off() for t in found]) < WRONG_DEG:
        return None
    best = None
    # Afterwards every turn is integrated as it was read again.
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            off = float(np.mean([t.integrate(matrix).off() for t in found]))
            if best is None or off < best[0]:
                best = off, matrix
    for turn in found:
        turn.integrate()
    if best[0] > RIGHT_DEG:
        return None
    read = best[1].T  # what register i carries: true = matrix · read
    value = {}
    for i in range(3):
        source = int(np.abs(read[i]).argmax())
        signed = int(read[i, source]) * (source + 1)
        if signed != i + 1:
            value["xyz"[i]] = signed
    found = Finding("axis_swap", "gyro", sorted(value), value, "axis", 99.0, "orientation",
                    "the gyro's axes are swapped or inverted against the accelerometer's",
                    {k: (v, v) for k, v in value.items()})
    found.read = read
    return found
