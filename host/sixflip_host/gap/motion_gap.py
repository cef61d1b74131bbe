"""What shows in motion only: a sensor off the axis it is turned about, and one behind the other.

All moves of all sessions that go from rest to rest are fitted together, a move being the unit of
replication: its own information on the sizes, weighted by how well it agrees with the others
(Student's t), habits of the hand and bends of the sensor beside them. Scores are predictive,
each session by the others; thresholds come from the moves themselves with their signs drawn by
lot, which leaves the hand as it is and takes away what it has in common with the effect.
"""
import numpy as np

from sixflip_sim.effects.library import EFFECTS

from . import (
    gyro_turns,
    hands,
    moves,
    observations,
    plausible,
    rails,
    shrinkage,
    still_runs,
)
from .attitude_fit import NominalSensor
from .finding import Finding

FEWEST_MOVES = 12
FEWEST_FLAT = 6  # turns on a table, if there is one session only
SINGLE_FOLDS = 2
ROUNDS, FREEDOM = 4, 4.0  # of weighting; Student's t
BENT, WANDERED = (0.03, 0.1, 0.3, 1.0), (0.1, 0.3, 1.0)  # of the widest priors
LOTS, ALARMS = 2000, 0.002
LEAST_NATS = 9.0
Z_90 = 1.645
LEAST_LAG_MS = 0.5  # two sensors of one chip are not sampled at the same moment either
TIMES_SIGMA = 4.5  # 80 % power at the threshold
KNOWN_CM = 5.0  # standard deviation beyond which a direction of the arm is not known
UNTOLD = 0.1  # of an effect's power
RESAMPLED = 400


class MotionGap:
    """found (list of Finding), remarks, moves, shrinkage (or None); seen: there are moves
    enough; theta, covariance of (lever arm x, y, z in cm; the accelerometer's delay behind the
    gyro in ms); bare (n, 3) mg of each move, less hands' habits and bends; sizes of those
    found, by_others {fold: sizes} what the other folds say of them, held (moves,) which fold.
    """

    def __init__(self, sessions, models, chip, without=()):
        """sessions: list of observations.Session, the first len(models) with poses; models:
        their NominalSensor."""
        self.chip = chip
        self.moves = []
        for number, session in enumerate(sessions):
            model = models[number] if number < len(models) else None
            self.moves += _moves(session, number, model, models, self.moves)
        self.found, self.remarks, self.shrinkage = [], [], None
        self.names = [n for n in moves.EFFECT_NAMES if n not in without]
        self.seen = len(self.moves) >= FEWEST_MOVES
        if self.seen:
            self._prepare()
            self._fit()
            self._search()
            self._report()

    def force(self, name):
        """Put an effect among those found, whether it passes the threshold or not."""
        if self.seen and name in moves.EFFECT_NAMES and name not in self.chosen:
            self.chosen.append(name)
            self.scores[name] = self.gains.get(name, 0.0)
            self._report()

    def _prepare(self):
        prior = moves.priors(self.chip)
        self.sessions = sorted({m.session for m in self.moves})
        self.shared = len(prior)
        by_hand = {m.session: m.by_hand for m in self.moves}
        # What a hand in the air turns the box about may be its grip as well.
        self.one_hand = len(self.sessions) == 1 and by_hand[self.sessions[0]] and sum(
            m.flat for m in self.moves) < FEWEST_FLAT
        local = [moves.local_priors(by_hand[s]) for s in self.sessions]
        self.prior = self.wide = np.concatenate([prior, *local])
        self.bends = np.arange(self.shared - moves.BENDS, self.shared)
        course = np.arange(len(local[0])) >= 3
        self.courses = self.shared + np.flatnonzero(np.tile(course, len(local)))
        self.effects = {"lever_arm": np.arange(3), "filter_lag": np.array([3])}
        self.nuisance = np.arange(4, len(self.prior))
        self.folds = np.array([self.sessions.index(m.session) for m in self.moves])
        if len(self.sessions) == 1:
            self.folds = np.arange(len(self.moves)) % SINGLE_FOLDS

    def _settle(self, gram, inner):
        """How large bends of the sensor and the course of its bias are: the likeliest of a few
        levels, in place of priors that would let them be anything."""
        everything = np.arange(len(self.prior))
        best = None
        for level in np.ndindex(len(BENT), len(WANDERED)):
            prior = self.wide.copy()
            prior[self.bends] *= BENT[level[0]]
            prior[self.courses] *= WANDERED[level[1]]
            found = float(_evidence(gram, inner[:, None], everything, prior)[0])
            if best is None or found > best:
                best, self.prior = found, prior

    def _own(self, move):
        """Indices of a move's columns."""
        local = np.arange(move.local.shape[2])
        start = self.shared + len(local) * self.sessions.index(move.session)
        return np.concatenate([np.arange(self.shared), start + local])

    def _fit(self):
        """Information of every move, weights, and the sizes."""
        number, k = len(self.moves), len(self.prior)
        tables = [np.concatenate([m.columns, m.local], axis=2) for m in self.moves]
        left = [m.y for m in self.moves]
        weights = np.ones(number)
        for _ in range(ROUNDS):
            variances = hands.spectra(self.moves, left, weights)
            gram, inner = np.zeros((number, k, k)), np.zeros((number, k))
            for j, (move, table, variance) in enumerate(zip(self.moves, tables, variances)):
                own = self._own(move)
                scaled = (table / variance[:, :, None]).reshape(-1, len(own))
                gram[j][np.ix_(own, own)] = scaled.T @ table.reshape(-1, len(own))
                inner[j, own] = scaled.T @ move.y.ravel()
            self._settle(np.tensordot(weights, gram, axes=1), weights @ inner)
            theta, _ = _solved(gram, inner, weights, self.prior)
            weights, excess = _weighted(gram, inner, theta)
            left = [m.y - t @ theta[self._own(m)] for m, t in zip(self.moves, tables)]
        weights = weights / excess
        self.gram = gram * weights[:, None, None]
        self.inner = inner * weights[:, None]
        self.tables = tables
        self.precision = [w / v for w, v in zip(weights, variances)]

    def _search(self):
        """Take effects in as long as they pass the threshold."""
        self.chosen, self.scores, self.gains = [], {}, {}
        while len(self.chosen) < len(self.names):
            options = [n for n in self.names if n not in self.chosen]
            gains = {n: float(self._gain(n, self.inner.sum(axis=0)[:, None],
                                         self._held(self.inner))[0]) for n in options}
            limit = self._limit(options)
            self.gains.update(gains)
            best = max(gains, key=gains.get)
            if gains[best] < limit:
                return
            self.chosen.append(best)
            self.scores[best] = gains[best]

    def _columns(self, extra=()):
        names = [*self.chosen, *extra]
        return np.concatenate([self.nuisance] + [self.effects[n] for n in names])

    def _held(self, inner):
        """(folds, k, 1) sums over the moves outside of each fold."""
        return np.stack([inner[self.folds != f].sum(axis=0) for f in np.unique(self.folds)]
                        )[:, :, None]

    def _gain(self, name, whole, held):
        """(r,) nats that an effect gains in predicting each fold by the others. whole (k, r),
        held (folds, k, r)."""
        out = 0.0
        for sign, columns in ((1.0, self._columns([name])), (-1.0, self._columns())):
            total = _evidence(self.gram.sum(axis=0), whole, columns, self.prior)
            for f, inner in zip(np.unique(self.folds), held):
                out = out + sign * (total - _evidence(
                    self.gram[self.folds != f].sum(axis=0), inner, columns, self.prior))
        return out

    def _limit(self, options):
        """Gain that chance reaches in ALARMS of the lots: what all effects together leave of
        each move, by the sizes of the others, with its sign by lot [ter Braak, 1992]."""
        columns = self._columns(options)
        theta = _without_each(self.gram[:, columns][:, :, columns], self.inner[:, columns],
                              self.prior[columns])
        left = self.inner - np.einsum("jab,jb->ja", self.gram[:, :, columns], theta)
        signs = np.random.default_rng(1).choice([-1.0, 1.0], (len(left), LOTS))
        whole = left.T @ signs
        held = np.stack([left[self.folds != f].T @ signs[self.folds != f]
                         for f in np.unique(self.folds)])
        most = np.max([self._gain(n, whole, held) for n in options], axis=0)
        return max(LEAST_NATS, float(np.quantile(most, 1.0 - ALARMS)))

    def _report(self):
        self.found, self.remarks = [], []
        columns = self._columns([n for n in moves.EFFECT_NAMES if n not in self.chosen])
        self.theta, self.covariance = self._sizes(columns)
        if not self.chosen:
            return
        columns = self._columns()
        sizes, spread = self._sizes(columns)
        for name in self.chosen:
            one = _finding(name, sizes, np.sqrt(np.diag(spread)), self.scores[name])
            if not plausible.believable(name, self.chip, "accel", one.value):
                self.remarks.append("in motion %s would help, but at an impossible size: "
                                    "something else acts" % name.replace("_", " "))
            elif name == "filter_lag" and one.value["tau"] < LEAST_LAG_MS:
                continue
            elif name == "lever_arm" and self.one_hand:
                self.remarks.append("turned about a point %.1f cm from the accelerometer: the "
                                    "hand's grip or the box, flips on a table tell"
                                    % np.linalg.norm(list(one.value.values())))
            else:
                self.found.append(one)
        self.named = np.isin(np.arange(4), [i for f in self.found
                                            for i in self.effects[f.effect]])
        self.sizes, self.spread = sizes * self.named, spread * self.named * self.named[:, None]
        habits = np.zeros(len(self.prior))
        habits[columns] = _solved(self.gram[:, columns][:, :, columns], self.inner[:, columns],
                                  np.ones(len(self.moves)), self.prior[columns])[0]
        habits[:4][self.named] = 0.0
        self.bare = [m.y - t @ habits[self._own(m)] for m, t in zip(self.moves, self.tables)]
        if self.found:
            self.shrinkage = self._shrinkage()
            self.remarks.append("what was found in motion is judged on %d moves; what the hand "
                                "adds counts as noise there" % len(self.moves))

    def _sizes(self, columns, among=None):
        """(theta (4,), covariance (4, 4)) with the effects that columns name; zeros elsewhere.
        The larger of what the model and what the scatter of the moves (jackknife) say."""
        among = np.ones(len(self.moves), bool) if among is None else among
        prior = self.prior[columns]
        gram, inner = self.gram[among][:, columns][:, :, columns], self.inner[among][:, columns]
        theta, covariance = _solved(gram, inner, np.ones(len(gram)), prior)
        each = _without_each(gram, inner, prior) - theta
        grown = np.sqrt(np.maximum((each ** 2).sum(axis=0) / np.diag(covariance), 1.0))
        covariance = covariance * grown * grown[:, None]
        out, spread = np.zeros(4), np.zeros((4, 4))
        effects = np.flatnonzero(columns < 4)
        out[columns[effects]] = theta[effects]
        spread[np.ix_(columns[effects], columns[effects])] = covariance[np.ix_(effects, effects)]
        return out, spread

    def least(self, name):
        """Smallest size that would show, cm or ms."""
        sigma = np.sort(np.sqrt(np.diag(self.covariance)[self.effects[name]]))
        shown = TIMES_SIGMA * float(sigma[(len(sigma) - 1) // 2])
        return max(shown, LEAST_LAG_MS) if name == "filter_lag" else shown

    def rms(self, left):
        """mg of what is left of each move, (n, 3) mg: quiet moves, directions and frequencies
        count more, as they do for the sizes."""
        total = sum(float((p * x ** 2).sum()) for p, x in zip(self.precision, left))
        return float(np.sqrt(total / sum(float(p.sum()) for p in self.precision)))

    def floor(self):
        """mg: what is left with the sizes found."""
        return self.rms([y - m.columns[:, :, :4] @ self.sizes
                         for y, m in zip(self.bare, self.moves)])

    def _shrinkage(self):
        """Before, after, floor as rms has them; each fold by what the others say of the sizes.
        The interval is that of the sizes themselves."""
        columns = self._columns()
        folds = self.held = self.folds
        if not self._told(columns, folds):
            folds = self.held = np.arange(len(self.moves)) % SINGLE_FOLDS
            self.remarks.append("no session alone shows all that was found in motion: it was "
                                "held out by every other move")
        drawn = np.random.default_rng(2).multivariate_normal(
            self.sizes, self.spread, RESAMPLED, check_valid="ignore")
        before, after = np.zeros(RESAMPLED), np.zeros(RESAMPLED)
        own = other = 0.0
        self.by_others = {}
        for f in np.unique(folds):
            power = self.gram[folds == f].sum(axis=0)[:4, :4]
            theirs = self.by_others[f] = self._sizes(columns, folds != f)[0] * self.named
            before += np.einsum("ra,ab,rb->r", drawn, power, drawn)
            after += np.einsum("ra,ab,rb->r", drawn - theirs, power, drawn - theirs)
            noise = float((power * self.spread).sum())
            own += self.sizes @ power @ self.sizes - noise
            other += (self.sizes - theirs) @ power @ (self.sizes - theirs) + noise
        floor = self.floor()
        rms = [float(np.sqrt(floor ** 2 + max(v, 0.0) / sum(float(p.sum()) for p in
                                                            self.precision)))
               for v in (own, other)] + [floor]
        if own <= 0.0:
            return shrinkage.Shrinkage(*rms, None, None)
        low, high = np.quantile(1.0 - after / before, [0.05, 0.95])
        return shrinkage.Shrinkage(*rms, 1.0 - other / own, (float(low), float(high)))

    def _told(self, columns, folds):
        """True when all folds but one tell the sizes well enough for that one."""
        for f in np.unique(folds):
            power = self.gram[folds == f].sum(axis=0)[:4, :4]
            spread = self._sizes(columns, folds != f)[1] * self.named * self.named[:, None]
            if (power * spread).sum() > UNTOLD * (self.sizes @ power @ self.sizes):
                return False
        return True


def of(sessions, usable, nominal, turns, settings):
    """MotionGap, or None where the gyro cannot carry gravity from rest to rest."""
    if turns is None:
        return None
    others = [s for s in sessions if s not in usable and s.capture.gyro is not None]
    return MotionGap([*usable, *others], nominal, sessions[0].capture.meta["sensor"],
                     settings.without)


def _moves(session, number, model, models, known):
    """list of moves.Move of one session; the calibration of one without poses is that of the
    others."""
    if model is not None:
        chosen, sensor, runs = gyro_turns.turns(session, model), model, session.runs
    else:
        chosen, sensor, runs = _unlabelled(session, models, known)
    if not chosen:
        return []
    course = _course(session.t_s)
    white = _white(session.capture, runs)
    railed = rails.railed(session)
    found = []
    for turn in chosen:
        if railed[turn.first:turn.last].mean() > observations.MOST_BAD:
            continue
        move = moves.Move(turn, session, sensor, course)
        move.session, move.turn, move.white = number, turn, white
        move.by_hand = model is not None
        found.append(move)
    return found


class _Driven:
    """What gyro_turns.Turn asks of a session, for one whose rests were found here."""

    labelled, thermometer = False, None

    def __init__(self, session, runs, models):
        self.runs, self.capture, self.t_s, self.rate = (
            runs, session.capture, session.t_s, session.rate)
        scale = 1000.0 / session.capture.meta["accel_lsb_per_g"]
        matrix = np.mean([m.matrix for m in models], axis=0)
        offset = np.mean([m.offset for m in models], axis=0)
        self.sensor = NominalSensor(matrix, offset, None)
        felt = self.sensor.corrected(np.array(
            [session.capture.accel[a:b].mean(axis=0) * scale for _, a, b in runs]))
        self.sensor.up = felt / np.linalg.norm(felt, axis=1)[:, None]
        self.bias = np.array([session.capture.gyro[a:b].mean(axis=0) for _, a, b in runs]
                             ) / session.capture.meta["gyro_lsb_per_dps"]


def _unlabelled(session, models, known):
    """(turns, NominalSensor, rests) of a session without poses."""
    runs = still_runs.runs(session.capture, session.t_s)
    if len(runs) < 2 or not known:
        return [], None, []
    driven = _Driven(session, runs, models)
    matrix = np.mean([m.turn.matrix for m in known], axis=0)
    found = []
    for place in range(len(runs) - 1):
        bias = 0.5 * (driven.bias[place] + driven.bias[place + 1])
        turn = gyro_turns.Turn(driven, driven.sensor, bias, place)
        if not gyro_turns.fit(turn, session.rate):
            continue
        turn.matrix = matrix
        turn.middle = turn.middle @ matrix.T
        found.append(turn.integrate())
    return found, driven.sensor, runs


def _course(t):
    """(HATS, n) straight pieces over a session."""
    u = (t - t[0]) / max(t[-1] - t[0], 1e-9) * (moves.HATS - 1)
    return np.clip(1.0 - np.abs(u - np.arange(moves.HATS)[:, None]), 0.0, None)


def _white(capture, runs):
    """mg: standard deviation of the accelerometer's mean over one second, of all axes."""
    differences = np.concatenate([np.diff(capture.accel[a:b].astype(float), axis=0)
                                  for _, a, b in runs if b - a > 2])
    counts = np.sqrt(np.median(differences ** 2, axis=0) / 0.4549 / 2.0 + 1.0 / 12.0)
    return float(counts.mean()) * 1000.0 / capture.meta["accel_lsb_per_g"] / np.sqrt(
        capture.meta["rate_hz"])


def _solved(gram, inner, weights, prior):
    """(theta (k,), covariance (k, k)) of moves together."""
    total = np.tensordot(weights, gram, axes=1)
    scaled = total * prior * prior[:, None] + np.eye(len(prior))
    covariance = np.linalg.inv(scaled) * prior * prior[:, None]
    return covariance @ (weights @ inner), covariance


def _without_each(gram, inner, prior):
    """(moves, k): sizes from all moves but one."""
    total = gram.sum(axis=0) - gram
    scaled = total * prior * prior[:, None] + np.eye(len(prior))
    return np.linalg.solve(scaled, ((inner.sum(axis=0) - inner) * prior)[:, :, None]
                           )[:, :, 0] * prior


def _weighted(gram, inner, theta):
    """(weights (moves,), mean excess): how well each move's effects agree with all others'."""
    part = gram[:, :4, :4]
    left = inner[:, :4] - gram[:, :4] @ theta
    values, vectors = np.linalg.eigh(part)
    keep = values > 1e-9 * np.maximum(values[:, -1:], 1e-30)
    turned = np.einsum("jab,ja->jb", vectors, left)
    q = (np.where(keep, turned ** 2 / np.where(keep, values, 1.0), 0.0)).sum(axis=1)
    rank = keep.sum(axis=1)
    weights = (FREEDOM + rank) / (FREEDOM + q)
    excess = float((weights * q).sum() / rank.sum())
    return weights, max(excess, 1.0)


def _evidence(gram, inner, columns, prior):
    """(r,) log evidence of the columns against none of them; inner (k, r)."""
    d = prior[columns]
    scaled = gram[np.ix_(columns, columns)] * d * d[:, None] + np.eye(len(columns))
    lower = np.linalg.cholesky(scaled)
    half = np.linalg.solve(lower, inner[columns] * d[:, None])
    return 0.5 * (half ** 2).sum(axis=0) - np.log(np.diag(lower)).sum()


def _finding(name, sizes, sigma, score):
    """Finding of an effect in motion, sizes (4,) and sigma (4,)."""
    if name == "lever_arm":
        known = [i for i in range(3) if sigma[i] < KNOWN_CM]
        value = {"xyz"[i]: float(sizes[i]) for i in known}
        interval = {"xyz"[i]: (float(sizes[i] - Z_90 * sigma[i]),
                               float(sizes[i] + Z_90 * sigma[i])) for i in known}
        return Finding(name, "accel", [], value, EFFECTS[name].units["accel"], score, "motion",
                       "it sits %.1f cm off the point it is turned about"
                       % np.linalg.norm(list(value.values())), interval)
    sensor, tau = ("accel", sizes[3]) if sizes[3] > 0 else ("gyro", -sizes[3])
    return Finding(name, sensor, [], {"tau": float(tau)}, "ms", score, "motion",
                   "it is %.1f ms behind the other sensor; how late both are together shows "
                   "nowhere" % tau,
                   {"tau": (float(tau - Z_90 * sigma[3]), float(tau + Z_90 * sigma[3]))})
