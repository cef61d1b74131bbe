"""Whether it is the gyro that does not answer slow turns, or what turns the thing: by its forces,
and in words."""
from dataclasses import replace

import numpy as np

from .. import odds
from . import alignment as align_by
from . import pairing, parameters, single_log, traces
from .evidence_of_logs import left_of

GYRO = odds.PRESENT  # nats from which on it is the gyro: what turns a thing is as likely


def nats_of_gyro(real, sim, alignment, fits):
    """How much likelier the forces are where the thing turned as the simulator's did, and the gyro
    did not answer, than where it turned as the gyro says: what turns it may not answer either.
    Gravity goes another way in the two, by a known course: of what the accelerometer's fit leaves
    of the simulator's forces that is all or nothing. 0 at most where the forces are not alike but
    for noise: then it moved otherwise, wherever it turned. fits: with the bands taken off."""
    accel, gyro = fits.get("accel"), fits["gyro"].fit
    if accel is None or accel.fit.unit != 1.0 or None in (real.noise["accel"], sim.noise["accel"]):
        return 0.0
    at = (real.t - alignment.offset_s) / (1.0 + alignment.drift)
    inside = ((at > 0.0) & (at < sim.seconds))[:, None]
    own = (real.rate - traces.rest_line(real, real.rate)) @ (np.eye(3) + gyro.shape).T
    turns = np.stack([np.interp(at, sim.t, x) for x in (
        sim.rate - traces.rest_line(sim, sim.rate)).T], 1)
    ups = [traces.motion(replace(real, rate=rate)).up for rate in (
        np.where(inside, turns, own), own)]
    pair = accel.pair
    course = real.g * pairing.at_times(real, ups[0] - ups[1], alignment.of_simulator(pair.t),
                                       pair.band_hz)
    design = np.column_stack([pair.force, np.ones(len(pair.t))])  # which the fit has, too
    left, course = (left_of(x, design) for x in (accel.fit.left, course))
    noise = in_band(real, sim, "accel", pair.band_hz)
    most = 0.0 if left.std() > parameters.TOGETHER * np.sqrt((noise ** 2).mean()) else np.inf
    power = max(float((course ** 2).sum()), 1e-30)
    share = float((left * course).sum()) / power
    rest = left - share * course
    variance = float((rest ** 2).mean()) * align_by.independent(rest) / power
    return min(most, (1.0 - 2.0 * share) / (2.0 * variance))


def in_band(real, sim, kind, band_hz):
    """(3,): the noise of two Traces together, in the frequencies compared, m/s2 or rad/s; of one
    that has none, what rounding leaves while it moves, which it does not show at rest."""
    power = sum(2.0 * band_hz * log.noise[kind].density ** 2 + (
        (log.quantum[kind == "gyro"] or 0.0) ** 2 / 12.0 if single_log.silent(log, kind) else 0.0)
        for log in (real, sim))
    return np.sqrt(power)


def said_of(bands, of_gyro):
    """[sentence] on Bands that the gyro need not be the cause of."""
    if not bands or of_gyro >= GYRO:
        return []
    who = "what turns it does not answer, as its forces say" if of_gyro <= -GYRO else \
        "its gyro does not answer, or what turns it does not: its forces do not tell which"
    return ["the real log lacks turns slower than %s deg/s, which the simulator's has: %s" % (
        ", ".join("%.3g about %s" % (np.degrees(band.rate), "xyz"[band.axis]) for band in bands),
        who)]
