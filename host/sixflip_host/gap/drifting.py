"""Drift: more flicker than is allowed, all over the session and within the rests.

What jumps or sways does not drift, nor does one axis alone: a random walk's innovations, the
residuals with all correlation taken out in the order of time, are normal and of about one size
on all axes; those of jumps have heavy tails, those of a sine light ones. Neither does a random
walk do what one jump a session, or one slow sine, does about as well.
"""
import numpy as np
from scipy.linalg import solve_triangular
from scipy.stats import kurtosis

from . import adequacy, regressors, which

DRIFT_NATS, ALONE_NATS = 6.0, 20.0  # with other sessions to hold it against, and without
JUMP_NATS = 10.0  # what a jump at an unknown time costs in each session
SWAY_NATS = 20.0  # what a sine of unknown period and phase costs in each session
SHORTEST_SWAY_S, A_PERIOD = 16.0, 8  # shortest sine tried; frequencies tried a period
STILL_FITS = 2.0  # chi2 a degree of freedom that freer flicker must bring it down to
WITHIN = 0.2  # of what a random walk moves within the rests, that must be seen there
WALKS = 14  # rates of a random walk that are tried
SLOW = ("time", "temperature")
DRAWS = 40
FORM = 0.1  # of the gain, that something else may add: no part has the library's spectrum
ONE_AXIS = 2.3  # largest ratio of two axes' innovations
TAILS = (-0.7, 1.2)  # mean excess kurtosis of all axes and sessions, if normal
TAIL = 3.5  # and the largest
TOGETHER = 0.5  # correlation of two axes' innovations: one thing moves both
ABSORBED = 0.6  # leverage above which a residual is mostly fitted away
FEWEST = 20  # innovations an axis


def level(gap):
    """(flicker level, nats gained by it) of a SensorGap that drifts, or None: more flicker than
    is allowed, the rests themselves wander so, and all that is left looks like it."""
    columns = np.concatenate([c.columns for c in gap.chosen] + [np.zeros(0, dtype=int)])
    prior = np.concatenate([c.prior for c in gap.chosen] + [np.zeros(0)])
    free = which.fits(gap.data, columns, prior)
    highest = max(u.grid[f.index[0]][1] for u, f in zip(gap.units, free))
    if highest <= gap.allowed * 1.001:
        return None
    gain = sum(float(f.loglik[0]) - _at_level(u, s, columns, prior, gap.allowed)
               for u, f, s in zip(gap.units, free, gap.data.statistics))
    seen = expected = 0.0
    least = 1.0
    for (part, _), unit, fit in zip(gap.parts, gap.units, free):
        values = part.accel if gap.kind == "accel" else part.gyro
        noise = part.noise_accel if gap.kind == "accel" else part.noise_gyro
        found = adequacy.wandering(part, values, noise, unit.grid[fit.index[0]][1],
                                   adequacy.usual(gap.chip, gap.kind))
        if found:
            seen, expected = seen + found[0], expected + found[2]
            least = min(least, found[3])
    ratio = sum(float(f.quadratic[0]) for f in free) / max(
        1, sum(u.freedom for u in gap.units) - len(columns))
    if gain <= (ALONE_NATS if gap.same_session else DRIFT_NATS) or ratio >= STILL_FITS:
        return None
    if seen <= WITHIN * expected or least >= 1e-3:
        return None
    if max(gap.added.values(), default=0.0) > FORM * gain:
        return None
    if max(_simpler(gap, free)) >= gain - DRIFT_NATS / 2.0:
        return None
    theta = which.coefficients(free, prior)[0][0]
    return (highest, gain) if _walks(gap, free, columns, theta) else None


def _walks(gap, fits, columns, theta):
    """Whether the innovations are those of a random walk, as far as there are enough: of flicker
    or of a walk in each session, whichever is likelier."""
    each, together = [[], [], []], 0.0
    for (part, _), unit, fit in zip(gap.parts, gap.units, fits):
        left = unit.z - unit.columns[:, columns] @ theta
        found = innovations(unit, _likelier(unit, part, *unit.grid[fit.index[0]], gap.allowed,
                                            left))
        together = max(together, _correlation(found))
        for axis in range(3):
            seen = found[np.isfinite(found[:, axis]), axis]
            if len(seen) >= FEWEST:
                each[axis].append(seen)
    if not any(each):
        return True
    tails = [kurtosis(one) for seen in each for one in seen]
    sizes = [np.sqrt(np.mean(np.concatenate(seen) ** 2)) for seen in each if seen]
    return bool(TAILS[0] < np.mean(tails) < TAILS[1] and max(tails) < TAIL
                and max(sizes) < ONE_AXIS * min(sizes) and together < TOGETHER)


def _correlation(found):
    """Largest correlation of two axes of innovations (n, 3)."""
    largest = 0.0
    for a, b in ((0, 1), (0, 2), (1, 2)):
        both = found[np.isfinite(found[:, [a, b]]).all(axis=1)][:, [a, b]]
        if len(both) >= FEWEST:
            largest = max(largest, abs(float(np.corrcoef(both.T)[0, 1])))
    return largest


def by_chance(gap):
    """Names that do no better than a drift like this one gains them by chance: list of Cause.

    What drifts follows for a while whatever changes slowly, in both sessions now and then; the
    thresholds were simulated without drift. Here every effect of time and temperature is put to
    DRAWS sets of contrasts that drift as the sessions do, without any effect.
    """
    slow = [c for c in gap.causes if regressors.DOMAIN[c.effect] in SLOW]
    if not slow:
        return []
    options = [o for o in gap.options if regressors.DOMAIN.get(o.effect) in SLOW]
    generator, draws = np.random.default_rng(20190919), []
    free = which.fits(gap.data, np.zeros(0, dtype=int), np.zeros(0))
    for number, (unit, fit) in enumerate(zip(gap.units, free)):
        if unit.between:
            draws.append(unit.draw(fit.index[0], generator, DRAWS))
            continue
        covariance = _likelier(unit, gap.parts[number][0], *unit.grid[fit.index[0]], gap.allowed,
                               unit.z)
        factor = np.linalg.cholesky(unit.contrasts.T @ covariance @ unit.contrasts)
        draws.append(factor @ generator.standard_normal((unit.freedom, DRAWS)))
    gains = which.gains(which.Data(gap.units, draws), options)
    chance = max(float(v.max()) for v in gains.values())
    return [c for c in slow if c.score <= chance]


def _likelier(unit, part, placement, level, allowed, z):
    """(3n, 3n) covariance of a session's rows: with the flicker found, or with no more than is
    allowed and a random walk, as makes the contrasts z likelier."""
    rows = unit.rows
    still = rows.white + placement ** 2 * rows.lateral @ rows.lateral.T
    if rows.fixed is not None:
        still = still + rows.fixed
    walk = np.kron(random_walk(part), np.eye(3))
    calm = still + min(level, allowed) ** 2 * rows.kernel
    # From a walk as far as the flicker allowed goes in a second up to what the flicker found
    # goes in a rest and a move.
    rates = np.geomspace(0.1 * allowed ** 2, 10.0 * level ** 2, WALKS)
    models = [still + level ** 2 * rows.kernel] + [calm + rate * walk for rate in rates]
    return max(models, key=lambda covariance: _likelihood(unit, covariance, z))


def _likelihood(unit, covariance, z):
    """Log density of contrasts z under a covariance of the rows."""
    factor = np.linalg.cholesky(unit.contrasts.T @ covariance @ unit.contrasts)
    half = solve_triangular(factor, z, lower=True)
    return -0.5 * float(half @ half) - float(np.log(np.diag(factor)).sum())


def random_walk(part):
    """(n, n) covariance of the means over a session's blocks of a random walk that begins with
    the first and goes 1 in a second."""
    begin = part.t - 0.5 * part.seconds
    t = begin - begin.min()
    found = np.minimum(t[:, None] + 0.5 * part.seconds[:, None], t[None] + 0.5 * part.seconds)
    np.fill_diagonal(found, t + part.seconds / 3.0)
    return found


def innovations(unit, covariance):
    """(n, 3) residuals of a session's nuisance fit, whitened in the order of time to a standard
    deviation of 1 under a covariance (3n, 3n) of its rows; NaN where the fit takes them up."""
    rows = unit.rows
    factor = np.linalg.cholesky(covariance)
    columns, y = (solve_triangular(factor, v, lower=True) for v in (rows.nuisance, rows.y))
    basis, s, _ = np.linalg.svd(columns, full_matrices=False)
    basis = basis[:, s > 1e-9 * s[0]]
    left, leverage = y - basis @ (basis.T @ y), (basis ** 2).sum(axis=1)
    left = left / np.sqrt(np.maximum(1.0 - leverage, 1e-9))
    left[leverage > ABSORBED] = np.nan
    return left.reshape(-1, 3)


def _simpler(gap, fits):
    """Nats that one jump in each session gains, and one sine, with no more flicker than is
    allowed."""
    jump = sway = 0.0
    for (part, _), unit, fit in zip(gap.parts, gap.units, fits):
        placement = unit.grid[fit.index[0]][0]
        factor = np.linalg.cholesky(unit.covariance(placement, gap.allowed))
        z = np.linalg.solve(factor, unit.z)
        take = np.linalg.solve(factor, unit.contrasts.T)
        steps = ((part.placement >= start)[:, None] for start in np.unique(part.placement)[1:])
        jump += max(_gain(take, z, steps) - JUMP_NATS, 0.0)
        sway += max(_gain(take, z, _sines(part.t)) - SWAY_NATS, 0.0)
    return jump, sway


def _sines(t):
    """(n, 2) sine and cosine of every period from SHORTEST_SWAY_S to the session's length."""
    longest = max(float(np.ptp(t)), 2.0 * SHORTEST_SWAY_S)
    count = int(A_PERIOD * longest / SHORTEST_SWAY_S)
    for frequency in np.linspace(0.5 / longest, 1.0 / SHORTEST_SWAY_S, count):
        phase = 2.0 * np.pi * frequency * t
        yield np.stack([np.sin(phase), np.cos(phase)], 1)


def _gain(take, z, courses):
    """Largest gain in nats of any course (n, k) on all three axes."""
    best = 0.0
    for course in courses:
        columns = take @ np.kron(course, np.eye(3))
        size = np.linalg.lstsq(columns, z, rcond=1e-9)[0]
        best = max(best, 0.5 * float(z @ columns @ size))
    return best


def _at_level(unit, statistics, columns, prior, allowed):
    """Largest log-likelihood with no more flicker than allowed."""
    quadratic, projections = statistics
    keep = [i for i, (_, level) in enumerate(unit.grid) if level <= allowed * 1.001]
    return max(float(which.Fit(_Point(unit, i), (quadratic[i:i + 1], projections[i:i + 1]),
                               columns, prior).loglik[0]) for i in keep)


class _Point:
    """One point of a unit's grid, for which.Fit."""

    def __init__(self, unit, index):
        self.grid = unit.grid[index:index + 1]
        self.gram, self.logdet = unit.gram[index:index + 1], unit.logdet[index:index + 1]
