"""What is left of the gap where conventions and parameters are put right: of the readings of one
motion, each block by a fit that has not seen it; and, layer four, of what a robot makes of them.
One attitude filter (imufusion, Madgwick's revised complementary filter) is run on the real log, on
the simulator's and on the simulator's put right.
"""
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from .. import odds
from . import pairing
from .parameters import MG
from .sensor_axes import DEG

# s of a block that is held out as a whole: longer than what neighbouring samples have in common, a
# move of a robot for instance, and short enough that half of a log of a minute has several.
FOLD_S = 5.0
UNSEEN = 1e6  # noise of a sample that a fit must not see, in units of the average
# Times slow() of noise, of what is left of two logs of one motion and is no shaking: bumps that
# shake a rover otherwise in each leave 1.1 to 1.8 (`make zoo`).
SLOW = 3.0
# s by which what is left may be late, or early, of what is read: a quarter of a second is half a
# period of the narrowest band, and a second a time constant that shows in a block; and the rows
# beside (pairing.GRID_HZ). Share of the largest course of such readings from which on one is used.
LAGS_S, LEAST_COURSE = (-1.0, -0.75, -0.5, -0.25, -0.08, 0.0, 0.08, 0.25, 0.5, 0.75, 1.0), 1e-4
# Chance of blocks of noise alone to be foretold as well as those that an effect is believed by
# [Student's t, one side].
CHANCE = 0.001
SETTLE_S = 3.0  # the filter's own start-up ramp


def not_foretold(sensor_fit):
    """(n, 3) of the simulator's log that conventions and parameters fitted on the other half's
    blocks do not foretell, of a SensorFit."""
    pair = sensor_fit.pair
    fold = ((pair.t - pair.t[0]) / FOLD_S).astype(int) % 2
    left = np.empty((len(pair.t), 3))
    for k in (0, 1):
        fit = sensor_fit.refitted(np.where(fold == k, UNSEEN, 1.0))
        left[fold == k] = fit.left[fold == k] / fit.unit
    return left


def explains(named, nameless):
    """Whether a SensorFit with a name explains the gap as well as the nameless one, which is free
    enough to follow what it has seen: it closes the gap but for a tenth, and foretells what it has
    not seen better. What is left then has no name, and is none of the conventions."""
    live = named.live
    gap = (named.pair.simulated(named.kind) - named.pair.real(named.kind))[:, live]
    left = [not_foretold(fit)[:, live].std() for fit in (named, nameless)]
    inside = (named.fit.left / named.fit.unit)[:, live]
    return inside.std() < (1.0 - odds.CLOSED) * gap.std() and left[0] < left[1]


def closes(sensor_fit, noise2):
    """Whether a SensorFit closes half of the gap that is above noise of a power noise2 (3,): of
    conventions none of which fits one is the likeliest all the same, whatever it says."""
    live = sensor_fit.live
    gap = (sensor_fit.pair.simulated(sensor_fit.kind) - sensor_fit.pair.real(sensor_fit.kind))
    gap2, left2 = (float(x[:, live].var(axis=0).sum()) for x in (gap, sensor_fit.fit.left))
    return gap2 - left2 >= pairing.FORETOLD * (gap2 - np.broadcast_to(noise2, 3)[live].sum())


def slow(left, band_hz):
    """How large the means of what is left (n, 3) over a second are, root mean square, beside those
    of noise in a band that is as large within the seconds: 1 of noise."""
    second = int(pairing.GRID_HZ)
    parts = left[:len(left) // second * second].reshape(-1, second, 3)
    means = parts.mean(axis=1)
    within = float(((parts - means[:, None]) ** 2).mean()) / max(2.0 * band_hz - 1.0, 0.2)
    return float(np.sqrt((means ** 2).mean() / max(within, 1e-300)))


def held_out(fits, not_explained, real, sim):
    """{sensor: (before, after, noise alone)}: root mean square of simulator less real, mg and
    deg/s, in the band compared; not_explained {sensor: not_foretold()}. Noise is 0 where a log
    without a rest does not tell it."""
    gaps = {}
    for kind, sensor_fit in fits.items():
        pair = sensor_fit.pair
        levels = [trace.noise[kind] for trace in (real, sim)]
        noise = 0.0 if None in levels else sum(
            (level.density ** 2).mean() * 2.0 * min(pair.band_hz, trace.rate_hz / 2)
            for level, trace in zip(levels, (real, sim)))
        as_read = sensor_fit.as_read
        before = size(kind, as_read.simulated(kind) - as_read.real(kind))
        # Nothing has to be done that makes it larger: a number that blocks are too short for.
        gaps[kind] = (before, min(before, size(kind, not_explained[kind])),
                      size(kind, np.sqrt(noise)))
    return gaps


def size(kind, values):
    """Root mean square of values (m/s2, rad/s) of a sensor, mg or deg/s."""
    return float(np.sqrt((values ** 2).mean()) * (MG if kind == "accel" else DEG))


def wandering(fits, not_explained):
    """frozenset of the sensors of which what is left is no noise, and no shaking that each log has
    of its own: it goes on for seconds, or follows from what both logs read."""
    return frozenset(kind for kind, sensor_fit in fits.items()
                     if slow(not_explained[kind], sensor_fit.pair.band_hz) > SLOW
                     or follows(sensor_fit, not_explained[kind]) > 1.0 - odds.CLOSED)


def follows(sensor_fit, left):
    """Share of the power of what is left (n, 3) that each of the two logs foretells by what its
    sensor reads now, before and after, of blocks that the regression has not seen, and that both
    foretell alike. What one log alone has, as noise or bumps, follows from its own readings; from
    the other's it does not, or with the other sign."""
    pair, said = sensor_fit.pair, []
    left = left[:, sensor_fit.live]
    fold = ((pair.t - pair.t[0]) / FOLD_S).astype(int) % 2
    for readings in (pair.real(sensor_fit.kind), pair.simulated(sensor_fit.kind)):
        columns = np.stack([np.interp(pair.t - lag, pair.t, own) for own in readings.T
                            for lag in LAGS_S] + [np.ones(len(pair.t))], 1)
        columns /= np.maximum(np.sqrt((columns ** 2).mean(axis=0)), 1e-12)
        foretold = np.zeros_like(left)
        for k in (0, 1):
            seen = fold != k
            foretold[~seen] = columns[~seen] @ np.linalg.lstsq(
                columns[seen], left[seen], rcond=LEAST_COURSE)[0]
        said.append(foretold)
    power = max(float((left ** 2).sum()), 1e-30)
    return min(float((said[0] * said[1]).sum()), *(
        power - float(((left - x) ** 2).sum()) for x in said)) / power


def earned(blocks, noises):
    """(share, blocks): the share of what nothing leaves beyond the noise that the best
    hypothesis foretells in blocks that its fit has not seen (lacking_effects.blocks_of() of each
    log), and how many of them; (0, 0) where they do not bear it out."""
    before, after, size = (np.concatenate(each) for each in zip(*blocks))
    nats = np.log(np.maximum(before, 1e-30) / np.maximum(after, 1e-30))
    if len(nats) < 2 or nats.mean() * np.sqrt(len(nats)) < nats.std(ddof=1) * special.stdtrit(
            len(nats) - 1, 1.0 - CHANCE):
        return 0.0, 0
    floor = min(sum(noise ** 2 * s.sum() for noise, (_, _, s) in zip(noises, blocks)), after.sum())
    gain = float((before - after).sum())
    return float(np.clip(gain / max(before.sum() - floor, 1e-30), 0.0, 1.0)), len(nats)


@dataclass(frozen=True)
class Task:
    """estimator; what the errors are against; attitude and heading, degrees: {"before": x,
    "after": y}; attitude: root mean square of roll and pitch; heading: by the end of the log."""

    estimator: str
    against: str
    attitude: dict
    heading: dict


def available():
    """Whether imufusion is there."""
    try:
        import imufusion  # noqa: F401
    except ImportError:
        return False
    return True


def estimated(t, force, rate, g):
    """(n, 3, 3) attitudes of the filter, body to world."""
    import imufusion
    period = float(np.median(np.diff(t)))
    ahrs = imufusion.Ahrs()
    settings = imufusion.AhrsSettings()
    settings.sample_rate = 1.0 / period
    ahrs.set_settings(settings)
    attitudes = np.empty((len(t), 3, 3))
    for i in range(len(t)):
        ahrs.update_no_magnetometer(np.degrees(rate[i]), force[i] / g)
        attitudes[i] = imufusion.quaternion_to_matrix(ahrs.get_quaternion()).reshape(3, 3)
    return attitudes


def attitude_errors(a, b, t):
    """(root mean square of roll and pitch, heading at the end), degrees, of two courses of
    attitudes (n, 3, 3), the heading equal after the filter's start."""
    keep = t - t[0] > SETTLE_S
    a, b = a[keep], b[keep]
    up = np.degrees(np.arccos(np.clip((a[:, 2] * b[:, 2]).sum(axis=1), -1.0, 1.0)))
    turn = np.einsum("nij,nkj->nik", a, b)
    heading = np.arctan2(turn[:, 1, 0] - turn[:, 0, 1], turn[:, 0, 0] + turn[:, 1, 1])
    return float(np.sqrt(np.mean(up ** 2))), float(np.degrees(heading[-1] - heading[0]))


def task_of_one_motion(accel, gyro, g):
    """Task of one motion, of two conventions.SensorFit; put right: what the simulator would say
    with the conventions and parameters found, which is the real reading and what is left."""
    t = np.intersect1d(accel.pair.t, gyro.pair.t)
    at = [np.isin(x.pair.t, t) for x in (accel, gyro)]
    real = accel.pair.force[at[0]], gyro.pair.rate[at[1]]
    put_right = tuple(r + x.fit.left[k] @ x.fit.axes / x.fit.unit
                      for r, x, k in zip(real, (accel, gyro), at))
    simulated = accel.pair.sim_force[at[0]], gyro.pair.sim_rate[at[1]]
    wanted = estimated(t, *real, g)
    return task_from_errors("the same filter on the real log", [
        attitude_errors(estimated(t, *values, g), wanted, t) for values in (simulated, put_right)])


def task_of_two_motions(real, sim, own_real, own_sim):
    """Task of two motions: each log's error against its own calibrated log, and by how much the
    simulator's is other than the real one's; after: the simulator with the real one's sensor."""
    def error(trace, sensor):
        true = sensor.applied(trace)
        return np.array(attitude_errors(
            estimated(trace.t, trace.force, trace.rate, trace.g),
            estimated(true.t, true.force, true.rate, trace.g), trace.t))

    wanted = error(real, own_real)
    true = own_sim.applied(sim)
    as_real = replace(sim, force=true.force @ np.linalg.inv(own_real.accel).T + own_real.bias,
                      rate=true.rate @ np.linalg.inv(own_real.gyro).T + own_real.gyro_bias)
    before, after = (error(x, y) - wanted for x, y in ((sim, own_sim), (as_real, own_real)))
    return task_from_errors("the error of the same filter on the real log, each against its "
                            "calibrated log", [before, after])


def task_from_errors(against, results):
    """Task of ((tilt, heading) before, after), degrees. A heading is no further off than half a
    turn: of a log upside down it is any at any time, and would add up turns that nothing made."""
    (tilt, heading), (tilt_after, heading_after) = (
        (tilt, (heading + 180.0) % 360.0 - 180.0) for tilt, heading in results)
    return Task("imufusion", against,
                {"before": abs(float(tilt)), "after": abs(float(tilt_after))},
                {"before": abs(float(heading)), "after": abs(float(heading_after))})


def tried(real, sim, own_real, own_sim, fits):
    """(Task of the logs, or None where it cannot be tried; [sentence on why])."""
    if own_real is None or own_sim is None:
        return None, ["the task was not tried: it needs a gyro and a rest in both logs"]
    if min(real.seconds, sim.seconds) < 2.0 * SETTLE_S:
        return None, ["the task was not tried: it needs %g s of both logs" % (2.0 * SETTLE_S)]
    if not available():
        return None, ["the task was not tried: imufusion is not installed (pip install imufusion)"]
    if len(fits) == 2:
        return task_of_one_motion(fits["accel"], fits["gyro"], real.g), []
    return task_of_two_motions(real, sim, own_real, own_sim), []
