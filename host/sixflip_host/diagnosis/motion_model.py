"""What shows in motion only: a sensor off the axis it is turned about, and one behind the other.

All moves of all sessions that go from rest to rest are fitted together, a move being the unit of
replication: its own information on the sizes, weighted by how well it agrees with the others
(Student's t), habits of the hand and bends of the sensor beside them. The effects and the
strangers of motion (what follows the rate, its size, its products, its change) compete in the
posterior that rests and turns have, too, each session by the others; what a member costs comes
from the moves themselves with their signs drawn by lot (moves_unit).
"""
import copy
from dataclasses import replace

import numpy as np

from sixflip_sim.effects.library import EFFECTS

from ..experiment import blocks, inertial_fit, turns
from ..experiment.attitude_fit import NominalSensor
from . import (
    cutoffs,
    handling_noise,
    holdout_gain,
    hypotheses,
    localisation,
    moves_unit,
    odds,
    plausible,
    posterior,
)
from .detect import saturation
from .detect.detection import Finding

FEWEST_MOVES = 12
FEWEST_FLAT = 6  # turns on a table, if there is one session only
SINGLE_FOLDS = 2
ROUNDS, FREEDOM = 4, 4.0  # of weighting; Student's t
BENT, WANDERED = (0.03, 0.1, 0.3, 1.0), (0.1, 0.3, 1.0)  # of the widest priors
LEAST_NATS = 9.0
STRANGE_SHARE = 0.06  # of what a stranger gains, that a name must gain beside it: a quarter of
# the stranger's size, squared, is of another form than the strangers of motion have
FOLLOWS = {"speed": "size of the rate", "rates": "rate", "squares": "products of the rates",
           "changes": "change of the rate", "scale": "size of the rate and gravity"}
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

    def __init__(self, sessions, models, turned, chip, without=()):
        """sessions: list of blocks.Session, the first len(models) with poses; models: their
        NominalSensor; turned: their calibrated turns."""
        self.chip = chip
        self.moves = []
        for number, session in enumerate(sessions):
            model = models[number] if number < len(models) else None
            own = turned[number] if number < len(models) else None
            self.moves += _moves(session, number, model, own, models, self.moves)
        self.found, self.remarks, self.nameless, self.shrinkage = [], [], [], None
        self.without = set(without)
        self.seen = len(self.moves) >= FEWEST_MOVES
        if self.seen:
            self._prepare()
            self._fit()
            self._search()
            self._report()

    def with_effect(self, name):
        """The same with an effect among those found, whether it passes the threshold or not."""
        if not self.seen or name not in inertial_fit.EFFECT_NAMES or name in self.chosen:
            return self
        other = copy.copy(self)
        other.chosen = [*self.chosen, name]
        score = self.gains.get(name, 0.0)
        other.scores = dict(self.scores, **{name: score})
        other.posterior = replace(self.posterior, places={
            name: {name: odds.probability(score)}, **self.posterior.places})
        other._report()
        return other

    def _prepare(self):
        prior = inertial_fit.priors(self.chip)
        self.sessions = sorted({m.session for m in self.moves})
        self.shared = len(prior)
        by_hand = {m.session: m.by_hand for m in self.moves}
        # What a hand in the air turns the box about may be its grip as well.
        self.one_hand = len(self.sessions) == 1 and by_hand[self.sessions[0]] and sum(
            m.flat for m in self.moves) < FEWEST_FLAT
        local = [inertial_fit.local_priors(by_hand[s]) for s in self.sessions]
        self.prior = self.wide = np.concatenate([prior, *local])
        self.bends = np.arange(self.shared - inertial_fit.BENDS, self.shared)
        course = np.arange(len(local[0])) >= 3
        self.courses = self.shared + np.flatnonzero(np.tile(course, len(local)))
        self.effects = {"lever_arm": np.arange(3), "filter_lag": np.array([3])}
        self.nuisance = np.arange(inertial_fit.COMPETING_NUMBER, len(self.prior))
        self.folds = np.array([self.sessions.index(m.session) for m in self.moves])
        if len(self.sessions) == 1:
            self.folds = np.arange(len(self.moves)) % SINGLE_FOLDS

    def _settle(self, gram, inner):
        """How large bends of the sensor and the course of its bias are: the likeliest of a few
        levels, in place of priors that would let them be anything."""
        best = None
        for level in np.ndindex(len(BENT), len(WANDERED)):
            prior = self.wide.copy()
            prior[self.bends] *= BENT[level[0]]
            prior[self.courses] *= WANDERED[level[1]]
            found = _evidence(gram, inner, prior)
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
            variances = handling_noise.spectra(self.moves, left, weights)
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
        """The likeliest set of effects and of strangers of motion."""
        everything = np.arange(len(self.prior))
        left = self.inner - np.einsum("jab,jb->ja", self.gram, _without_each(
            self.gram, self.inner, self.prior))
        columns = np.arange(inertial_fit.COMPETING_NUMBER)
        designs = moves_unit.designs(self.prior)
        energy = 3.0 * np.concatenate([t.reshape(-1, t.shape[2])[:, columns]
                                       for t in self.tables]) ** 2
        units = [moves_unit.MovesUnit(
            self.gram[self.folds == f], self.inner[self.folds == f], left[self.folds == f],
            columns, everything[len(columns):], self.prior, energy.mean(axis=0), designs)
            for f in np.unique(self.folds)]
        self.forms = [f for f in hypotheses.of(units, self.without, drift=False)
                      if not f.generic or f.axis is None or f.variant == "speed"]
        model = posterior.Model(units, [u.statistics() for u in units], moves_unit.NO_LEVELS)
        cost = cutoffs.simulated(units, self.forms, moves_unit.NO_LEVELS, [0] * len(units))
        self.posterior = posterior.search(model, self.forms, cutoffs.Cutoffs(
            max(cost, LEAST_NATS), STRANGE_SHARE))
        self.chosen = [f.effect for f in self.posterior.best.forms if not f.generic]
        self.scores = dict(self.posterior.gains)
        alone = model.scored(())
        self.gains = {f.effect: model.scored((f,)).score - alone.score for f in self.forms}

    def _columns(self, extra=()):
        names = [*self.chosen, *extra]
        strange = [f.columns for f in self.posterior.best.forms if f.generic]
        return np.concatenate([self.nuisance, *strange] + [self.effects[n] for n in names])

    def _report(self):
        self.found, self.remarks, self.nameless = [], [], self._strange()
        columns = self._columns([n for n in inertial_fit.EFFECT_NAMES if n not in self.chosen])
        self.theta, self.covariance = self._sizes(columns)
        if not self.chosen:
            return
        columns = self._columns()
        sizes, spread = self._sizes(columns)
        for name in self.chosen:
            one = _finding(name, sizes, np.sqrt(np.diag(spread)), self.scores[name])
            one.place = self.posterior.places[name]
            if not plausible.believable(name, self.chip, "accel", one.value):
                self.remarks.append("in motion %s would help, but at an impossible size: "
                                    "something else acts" % name.replace("_", " "))
                self.nameless.append(localisation.Place(
                    "accel", None, "motion", 1.0, odds.chance(one.score)))
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
            for one in self.found:
                one.share = self._share(one.effect)
            self.remarks.append("what was found in motion is judged on %d moves; what the hand "
                                "adds counts as noise there" % len(self.moves))

    def _strange(self):
        """[Place] of what has no name in the likeliest set, axis by axis where it is on one."""
        gains, found = self.posterior.gains, []
        for form in self.posterior.best.forms:
            if form.generic:
                share = gains[form.effect] / max(sum(map(abs, gains.values())), 1e-9)
                axis = None if form.axis is None else "xyz"[form.axis]
                found.append(localisation.Place("accel", axis, "motion", share,
                                                odds.chance(gains[form.effect])))
                self.remarks.append("what the accelerometer reads in motion follows the %s in a "
                                    "way that no effect of the library does" % FOLLOWS[
                                        form.variant])
        return found

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
            return holdout_gain.Shrinkage(*rms, None, None)
        low, high = np.quantile(1.0 - after / before, [0.05, 0.95])
        return holdout_gain.Shrinkage(*rms, 1.0 - other / own, (float(low), float(high)))

    def _share(self, name):
        """Share of the explainable gap that one of the effects found closes on what is held out,
        or None where that is too small to measure."""
        if self.shrinkage.share is None:
            return None
        power = self.gram.sum(axis=0)[:4, :4]
        without = self.sizes * ~np.isin(np.arange(4), self.effects[name])
        whole, rest = (float(v @ power @ v) for v in (self.sizes, without))
        return float(np.clip(self.shrinkage.share * (1.0 - rest / whole), 0.0, 1.0))

    def _told(self, columns, folds):
        """True when all folds but one tell the sizes well enough for that one."""
        for f in np.unique(folds):
            power = self.gram[folds == f].sum(axis=0)[:4, :4]
            spread = self._sizes(columns, folds != f)[1] * self.named * self.named[:, None]
            if (power * spread).sum() > UNTOLD * (self.sizes @ power @ self.sizes):
                return False
        return True


def of(sessions, usable, nominal, gyro, settings):
    """MotionGap, or None where the gyro cannot carry gravity from rest to rest (gyro: SensorGap
    or None)."""
    if gyro is None:
        return None
    others = [s for s in sessions if s not in usable and s.capture.gyro is not None]
    turned = [unit.turns for unit in gyro.units]
    return MotionGap([*usable, *others], nominal, turned, sessions[0].capture.meta["sensor"],
                     settings.without)


def _moves(session, number, model, turned, models, known):
    """list of inertial_fit.Move of one session with its calibrated turns; one without poses is
    calibrated by the others."""
    if model is not None:
        chosen, sensor, runs = turned, model, session.runs
    else:
        chosen, sensor, runs = _driven(session, models, known)
    if not chosen:
        return []
    course = _course(session.t_s)
    white = _white(session.capture, runs)
    railed = saturation.railed(session)
    found = []
    for turn in chosen:
        if railed[turn.first:turn.last].mean() > blocks.MOST_BAD:
            continue
        move = inertial_fit.Move(turn, session, sensor, course)
        move.session, move.turn, move.white = number, turn, white
        move.by_hand = model is not None
        found.append(move)
    return found


def _driven(session, models, known):
    """(turns, NominalSensor, runs) of a session without poses: calibrated by the others."""
    runs = session.runs
    if len(runs) < 2 or not known:
        return [], None, []
    scale = 1000.0 / session.capture.meta["accel_lsb_per_g"]
    sensor = NominalSensor(np.mean([m.matrix for m in models], axis=0),
                           np.mean([m.offset for m in models], axis=0), None)
    felt = sensor.corrected(np.array([session.capture.accel[a:b].mean(axis=0) * scale
                                      for _, a, b in runs]))
    up = felt / np.linalg.norm(felt, axis=1)[:, None]
    bias = np.array([session.capture.gyro[a:b].mean(axis=0) for _, a, b in runs]
                    ) / session.capture.meta["gyro_lsb_per_dps"]
    matrix = np.mean([m.turn.matrix for m in known], axis=0)
    found = [turns.between(session, up, 0.5 * (bias[place] + bias[place + 1]), place)
             for place in range(len(runs) - 1)]
    found = [turn.corrected(matrix, np.zeros(3)) for turn in found if turn.usable(session.rate)]
    return found, sensor, runs


def _course(t):
    """(HATS, n) straight pieces over a session."""
    u = (t - t[0]) / max(t[-1] - t[0], 1e-9) * (inertial_fit.HATS - 1)
    return np.clip(1.0 - np.abs(u - np.arange(inertial_fit.HATS)[:, None]), 0.0, None)


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


def _evidence(gram, inner, prior):
    """Log evidence of all columns against none of them; inner (k,)."""
    scaled = gram * prior * prior[:, None] + np.eye(len(prior))
    lower = np.linalg.cholesky(scaled)
    half = np.linalg.solve(lower, inner * prior)
    return float(0.5 * (half ** 2).sum() - np.log(np.diag(lower)).sum())


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
