"""Stage 5: is what is left no more than noise?

Absolute: the contrasts after the likeliest set, against white noise, placement and flicker at
their likeliest levels, of which the prior says what is usual: as much flicker as a reference
capture shows, or as the chip's data sheet and published plots have.
"""
from dataclasses import dataclass

import numpy as np
from scipy import special

from sixflip_sim.effects import typical
from sixflip_sim.effects.drift import FLOOR_OF_KERNEL

from . import between_sessions, evidence, gap_figures, odds
from .evidence import Levels

PLACEMENT = {"accel": 0.87, "gyro": 0.003}  # 0.05 deg across gravity, mg; the Earth's rate
TIMES_TYPICAL = 4.0  # of flicker, that one rest may have: data sheets give no largest value
ABSORBED = 0.6  # leverage above which a residual is mostly fitted away
FEWEST = 20  # innovations of each axis of a session, and of two axes at the same time
FROZEN = 1e-6  # of a standard deviation: rounding of a reading that never changes leaves less
# Standard deviations of a kurtosis that chance reaches once in 30,000; how much one axis' noise
# may be above another's in a chip as it is [ADXL345 rev. E, table 1: Z 1.1 LSB, X and Y 0.75].
KURTOSIS_SIGMAS, UNLIKE = 4.0, 1.5
# Both sensors, turns, tails and axes share odds.CHANCE; covariances are true to some 15 %.
DOUBTFUL_P, DOUBTFUL_RATIO = 1e-3, 1.3


def usual(sensor, kind):
    """Flicker level of a chip that is still usual, mg or deg/s: by the Allan floor of published
    plots. The recorded units that typical.FLICKER goes by are quieter."""
    return typical.FLOOR[typical.chip_of(sensor, kind)] / FLOOR_OF_KERNEL


def levels(sensor, kind, reference=None):
    """evidence.Levels of a chip; reference: flicker level of a capture of noise."""
    changes = (between_sessions.UNUSUAL[quantity][kind] for quantity in ("bias", "scale"))
    if reference is not None:
        return Levels(PLACEMENT[kind], max(reference, usual(sensor, kind) / 4.0),
                      *changes, known=True)
    return Levels(PLACEMENT[kind], usual(sensor, kind), *changes)


@dataclass(frozen=True)
class Adequacy:
    """ok; p: the least of the tests failed, or of chi2; index: of each unit's grid; excess,
    excess_before: chi2 beyond the degrees of freedom, with and without the set; odd: how what is
    left differs from noise, or ""."""

    ok: bool
    p: float
    index: tuple
    excess: float
    excess_before: float
    odd: str = ""


def goodness_of_fit(units, statistics, scored, usual_noise, shaken=(), by_hand=False):
    """Adequacy of a scored_sets.Scored; usual_noise: evidence.Levels; shaken: axes (0..2) that a
    line of the spectrum is on; by_hand: what a placement adds is the hand's doing, which has any
    distribution."""
    shared = scored.shared
    theta = evidence.coefficients(scored.fits, shared)[0][0]
    index, parts, before, within = [], [], 0.0, sum(not unit.between for unit in units)
    for unit, sums, fit, private in zip(units, statistics, scored.fits, scored.private):
        index.append(int(fit.index[0]))
        if unit.between:  # a change of more than is usual is no noise
            fit = _usual_change(unit, sums, shared, private, usual_noise)
        point = int(fit.index[0])
        chi2 = _between_levels(unit, sums, shared, private, theta, fit)
        freedom = unit.freedom - gap_figures.freedom_taken(unit, point, private)
        if not unit.between:
            freedom -= len(shared) / within
        parts.append((chi2, max(freedom, 1.0)))
        before += float(sums[0][point, 0]) - unit.freedom
    chi2, freedom = (sum(part[k] for part in parts) for k in (0, 1))
    known = [unit.rows.known for unit in units]
    p = _by_chance(chi2, freedom, sum(k for k, u in zip(known, units) if not u.between))
    worst = min(_by_chance(*part, k) for part, k in zip(parts, known))
    largest = max([chi2 / freedom] + [c / f for c, f in parts])
    looks = len(parts) + 1  # at each of them, and at all together [Bonferroni]
    ok = not (looks * min(p, worst) < DOUBTFUL_P and largest > DOUBTFUL_RATIO)
    # Noise of the usual size may have any shape: that of parts is not the same on all axes, and
    # a table sways along several.
    wanders = wandering_nats(units, statistics, scored, usual_noise) > odds.COST
    odd, chance = _odd(units, scored, theta, shaken, by_hand) if wanders else ("", 1.0)
    p = min(p, looks * worst if not ok else 1.0, chance if odd else 1.0)
    return Adequacy(ok and not odd, p, tuple(index), chi2 - freedom, before, odd)


def _usual_change(unit, statistics, shared, private, levels):
    """Fit of what is between the sessions where no more than is usual changes at a switch-on."""
    prior = levels.prior(unit, ())
    return evidence.fit(unit, statistics, shared, private, prior,
                        np.flatnonzero(prior == prior.max()))


def _chi2(fit, theta):
    """Of a unit's contrasts with these coefficients of the shared columns."""
    return float(fit.quadratic[0] - 2.0 * theta @ fit.inner[0] + theta @ fit.gram[0] @ theta)


def _between_levels(unit, statistics, shared, private, theta, fit):
    """chi2 at the likeliest flicker, which lies between the levels that are tried: where these are
    a factor of two apart, chi2 beside the nearest is off by as much as doubts begin at."""
    placement, flicker = divmod(int(fit.index[0]), unit.shape[1])
    if unit.between or unit.turns or not 0 < flicker < unit.shape[1] - 1:
        return _chi2(fit, theta)
    points = placement * unit.shape[1] + flicker + np.array([-1, 0, 1])
    flat = np.zeros(len(unit.grid))
    fits = [evidence.fit(unit, statistics, shared, private, flat, points[k:k + 1])
            for k in range(3)]
    x = np.log([unit.grid[k][1] for k in points])
    bend, slope, _ = np.polyfit(x - x[1], [f.evidence[0] - fits[1].evidence[0] for f in fits], 2)
    if bend >= 0.0:
        return _chi2(fit, theta)
    likeliest = np.clip(x[1] - 0.5 * slope / bend, x[0], x[2])
    return float(np.exp(np.interp(likeliest, x, np.log([
        max(_chi2(f, theta), 1e-9) for f in fits]))))


def wandering_nats(units, statistics, scored, usual_noise):
    """Nats by which the readings are likelier with more flicker than evidence.Levels say than
    with no more than that, beside a scored_sets.Scored."""
    return _beyond([(unit, *rest) for unit, *rest in zip(units, statistics, scored.private)
                    if not (unit.between or unit.turns)], scored.shared, 1, usual_noise.flicker)


def placement_nats(units, statistics, scored, usual):
    """The same of placement beyond a level: of turns, degrees that their ends are off."""
    return _beyond([(unit, *rest) for unit, *rest in zip(units, statistics, scored.private)
                    if not unit.between], scored.shared, 0, usual)


def _beyond(sessions, shared, column, usual):
    """Nats of levels beyond a usual one over those within it, sum over [(Unit, statistics, private
    Columns)]; column: of the grid."""
    nats = 0.0
    for unit, sums, private in sessions:
        level = np.array(unit.grid)[:, column]
        within = np.flatnonzero(level <= max(usual, level.min()))
        flat = np.zeros(len(unit.grid))
        every, few = (evidence.fit(unit, sums, shared, private, flat, points)
                      for points in (None, within))
        nats += float(every.evidence[0] - few.evidence[0])
    return nats


def _by_chance(chi2, freedom, known):
    """Probability of a larger chi2, the noise itself known with so many degrees of freedom."""
    if not np.isfinite(known):
        return float(special.chdtrc(freedom, chi2))
    return float(special.fdtrc(freedom, known, chi2 / freedom))


def _odd(units, scored, theta, shaken, by_hand):
    """oddity() of what is left in all sessions: what jumps has heavy tails, what is shared or on
    one axis alone has another cause than noise has; a drift may be that of one axis."""
    left = [innovations(u, u.grid[int(f.index[0])], private,
                        u.raw(scored.shared.index) @ theta, by_hand)
            for u, f, private in zip(units, scored.fits, scored.private)
            if not (u.between or u.turns or u.apart)]
    left = [x for x in left if np.isfinite(x).sum(axis=0).min() >= FEWEST]
    return oddity(np.concatenate(left), shaken, "drift" not in scored.names) if left else ("", 1.0)


def oddity(x, shaken=(), alike=True):
    """("" or how, p): how innovations x (n, 3), NaN where the fit takes them up, differ from noise
    that is normal, independent between the axes and, where they are alike, of one size on all;
    shaken: axes that a line of the spectrum is on."""
    each = [column[np.isfinite(column)] for column in x.T]
    if min(noise.std() for noise in each) < FROZEN:  # what always reads the same has no noise
        return "", 1.0
    # Of one axis that is louder than the others all together have tails.
    p = tails(np.concatenate(each if alike else [
        (noise - noise.mean()) / noise.std() for noise in each]))
    if p < 1.0:
        return "heavy tails", p
    # A line is noise with a name.
    quiet = [noise for axis, noise in enumerate(each) if axis not in shaken] or each[:1]
    small, large = (pick(quiet, key=lambda noise: (noise ** 2).mean()) for pick in (min, max))
    p = louder(large, small)
    if alike and p < DOUBTFUL_P:
        return "one axis more than the others", p
    for a, b in ((0, 1), (0, 2), (1, 2)):
        both = np.isfinite(x[:, a]) & np.isfinite(x[:, b])
        number = np.count_nonzero(both)
        if number < FEWEST:
            continue
        together = abs(np.corrcoef(x[both, a], x[both, b])[0, 1])
        if together > 4.0 / np.sqrt(number) + 0.1:
            return "axes move together", 6.0 * float(special.ndtr(
                -np.arctanh(together - 0.1) * np.sqrt(number)))
    return "", 1.0


def tails(x):
    """Probability of such heavy tails of a normal x (n,); 1.0 where they are not beyond what
    chance and noise of not quite the kernel's colour have."""
    # As scipy.stats.kurtosis has it, which takes a second to import.
    moments = ((x - x.mean()) ** np.array([[2], [4]])).mean(axis=1)
    beyond, error = moments[1] / moments[0] ** 2 - 3.0, np.sqrt(24.0 / len(x))
    if beyond <= KURTOSIS_SIGMAS * error + 0.5:
        return 1.0
    return float(special.ndtr(-(beyond - 0.5) / error))


def louder(x, than):
    """Probability of noise x (n,) being so much more than that of another axis (m,) by chance
    and by what chips have, one of three axes."""
    ratio = (x ** 2).mean() / (than ** 2).mean()
    return min(3.0 * float(special.fdtrc(len(x), len(than), ratio / UNLIKE ** 2)), 1.0)


def innovations(unit, point, private, explained, loose=False):
    """(n, 3) residuals of a session's nuisance fit, whitened in the order of time to a standard
    deviation of 1 at a point (placement, flicker) of its grid; NaN where the fit takes them up.
    explained (3n,): what the shared columns add; private columns are fitted as the nuisance;
    loose: see linear_model.Unit."""
    left, leverage = unit.innovations(point, private.index, explained, loose)
    left = left / np.sqrt(np.maximum(1.0 - leverage, 1e-9))
    left[leverage > ABSORBED] = np.nan
    return left
