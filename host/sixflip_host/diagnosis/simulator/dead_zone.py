"""Where the real log lacks slow turns, which the simulator's of the same motion has: a dead band
of its gyro, hard or soft, about the rate that it reads or about no turn, or one of what turns it.
Asked is what the real log makes of the simulator's turns, axis by axis: of them as they are, with
a band of some width taken off, and of any bent line, which has no name.
"""
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import minimize_scalar

from sixflip_sim.effects.library import EFFECTS

from ...experiment import terms
from .. import odds
from ..detect.detection import Finding
from . import alignment as align_by
from . import (
    conventions,
    lacking_effects,
    own_effects,
    pairing,
    parameters,
    remaining_gap,
    single_log,
)
from .evidence_of_logs import shifted
from .pairing import GRID_HZ

# What is left of rates (rad/s) by a band: counts below it read 0 (the library's form), it is
# taken off what is beyond, or off everything the more the faster.
FORMS = {"hard": lambda rate, band: rate * (np.abs(rate) >= band),
         "soft": lambda rate, band: rate - np.clip(rate, -band, band),
         "rounded": lambda rate, band: rate - band * np.tanh(rate / band)}
# Of the largest rate, that a band may be: the axis does not answer to most of what it does. Bands
# that are tried are STEP apart; of itself, to which the likeliest is found, and by which those are
# apart that say how well it is known, by nats that are never quite none.
MOST, STEP, NEAR, BESIDE, SURE = 0.5, 1.4, 0.002, 0.05, 0.01
SHOWN = 0.5  # of the nats of the likeliest band, that one has at least that is a step from it
SPOILT = 10.0  # times what no band leaves, of one beside which the scale is none of a part's
# Times the noise of both from which on a band is none of their shaking at rest. Nor is one below a
# step of the real one's codes any other than those.
OF_NOISE = 5.0
GYRO = odds.PRESENT  # nats from which on it is the gyro: what turns a thing is as likely
GAIN = 0.1  # that its scale may be off beside the band: more than a part's is (ITG-3205 PS, 6 %)


@dataclass(frozen=True)
class Band:
    """axis 0 to 2; form (of FORMS); rate, rad/s, with its interval at 90 %; centre, rad/s: the
    simulator's reading about which it lies; nats against no band; probability; share of what is
    beyond the noise that it foretells, in so many blocks."""

    axis: int
    form: str
    rate: float
    interval: tuple
    centre: float
    nats: float
    probability: float
    share: float
    blocks: int

    def of(self, rates):
        """Rates (n,) of the simulator as the real axis reads them."""
        return self.centre + FORMS[self.form](rates - self.centre, self.rate)


def found(fits, real, sim):
    """(Band, ...) of the gyro by {sensor: conventions.SensorFit} of two Traces of one motion."""
    sensor_fit = fits.get("gyro")
    if sensor_fit is None or not sensor_fit.hypothesis.name or None in (
            real.noise["gyro"], sim.noise["gyro"]) or not (real.rests and sim.rests):
        return ()
    fit = sensor_fit.fit
    if fit.unit != 1.0 or not np.array_equal(fit.axes, np.eye(3)):
        return ()
    noise = in_band(real, sim, "gyro", sensor_fit.pair.band_hz)
    least = np.maximum(OF_NOISE * noise,
                       single_log.step(real.rate[~real.put_in], real.quantum[1]))
    still = sim.rest_means(sim.rate).mean(axis=0)
    # About no turn, or about what the simulator reads where the real one, of another bias, has 0.
    centres = np.unique([still, fit.bias], axis=0)
    bands = (_of_axis(axis, sensor_fit, sim, noise[axis], least[axis], centres[:, axis])
             for axis in np.flatnonzero(sensor_fit.live))
    return tuple(band for band in bands if band is not None)


def taken_off(sim, bands):
    """The simulator's Trace as a gyro with these Bands reads its turns."""
    rate = sim.rate.copy()
    for band in bands:
        rate[:, band.axis] = band.of(rate[:, band.axis])
    return replace(sim, rate=rate)


def added(diagnosis):
    """The Diagnosis with a Finding of the bands that its logs of one motion show, where neither
    the codes nor the turns between the rests have it already."""
    known = [c for sensor, c in diagnosis.causes if sensor == "gyro"] + [
        f for f in diagnosis.findings if f.sensor == "gyro"]
    if any("dead_band" in cause.probabilities for cause in known):
        return diagnosis
    best = {}
    for band in (band for comparison in diagnosis.comparisons
                 if comparison.of_gyro >= GYRO for band in comparison.bands):
        if band.axis not in best or band.nats > best[band.axis].nats:
            best[band.axis] = band
    if not best:
        return diagnosis
    counts = np.degrees(1.0) * diagnosis.sessions[0].capture.meta["gyro_lsb_per_dps"]
    bands = {"xyz"[axis]: band for axis, band in sorted(best.items())}
    likeliest = max(bands.values(), key=lambda band: band.nats)
    finding = Finding(
        "dead_band", "gyro", list(bands), {k: counts * b.rate for k, b in bands.items()},
        EFFECTS["dead_band"].units["gyro"], sum(b.nats for b in bands.values()),
        terms.DOMAIN["dead_band"],
        "does not answer to turns below %s deg/s, which the simulator of the same motion has"
        % ", ".join("%.3g" % np.degrees(b.rate) for b in bands.values()),
        interval={k: tuple(counts * end for end in b.interval) for k, b in bands.items()},
        share=likeliest.share, number=likeliest.blocks,
        place={"dead_band": likeliest.probability, "": 1.0 - likeliest.probability})
    return replace(diagnosis, findings=(*diagnosis.findings, finding))


def _of_axis(axis, sensor_fit, sim, noise, least, centres):
    """The Band of an axis or None; noise: of both logs in the frequencies compared, rad/s."""
    pair, delay = sensor_fit.pair, sensor_fit.fit.delay_s * GRID_HZ
    read = shifted(pair.rate, delay)[:, axis]

    def compared(rows):
        return pairing.at_times(sim, rows, pair.t, pair.band_hz)

    # As the simulator's log has them, with no band as with any: what the Pair has may be drawn
    # noise besides (single_log.rounding), and a band would earn what lacking that is worth.
    turns = compared(sim.rate)
    beside = np.column_stack([
        np.delete(turns, axis, axis=1), np.ones(len(turns)),
        own_effects.of_time("gyro", pair.t, pair.celsius)[0]])

    def left(own, rows=slice(None), more=()):
        """read less what own (n,) with its slopes says of it, by a fit to some rows; its gain."""
        slope = np.gradient(own)
        design = np.column_stack([own, slope, np.gradient(slope), beside, *more])
        beta = np.linalg.lstsq(design[rows], read[rows], rcond=None)[0]
        return read - design @ beta, beta[0]

    own = turns[:, axis]
    plain, _ = left(own)
    if plain.std() < parameters.TOGETHER * noise:
        return None
    top = MOST * np.abs(own - centres.mean()).max()
    if least >= top:
        return None
    widths = top * STEP ** -np.arange(int(np.log(top / least) / np.log(STEP)) + 1)

    def banded(form, centre, width):
        # Of every row, before what is fast is left out: that is what a sensor does.
        return centre + compared(FORMS[form](sim.rate[:, axis] - centre, width))

    def power(width, form, centre):
        rest, gain = left(banded(form, centre, width))
        return (rest ** 2).mean() if abs(gain - 1.0) < GAIN else SPOILT * (plain ** 2).mean()

    number = len(plain) / align_by.independent(plain)
    roughly = {}
    for way in product(FORMS, centres):
        near = min((power(width, *way), width) for width in widths)
        roughly[way] = 0.5 * number * np.log((plain ** 2).mean() / near[0]), near[1]
    gain = max(nats for nats, _ in roughly.values())
    if gain < SHOWN * (0.5 * np.log(number) + np.log(
            conventions.PRIOR_HEALTHY / conventions.PRIOR_EACH)):
        return None
    likeliest = []
    for (form, centre), near in [(way, near) for way, (nats, near) in roughly.items()
                                 if nats >= SHOWN * gain]:
        best = minimize_scalar(
            power, args=(form, centre), method="bounded",
            bounds=(max(least, near / STEP), near * STEP), options={"xatol": NEAR * near})
        likeliest.append((float(best.fun), form, float(centre), float(best.x)))
    least_power, form, centre, rate = min(likeliest)
    rest = left(banded(form, centre, rate))[0]
    number = len(rest) / align_by.independent(rest)
    knots = own_effects.bent(own[:, None])[0]
    bent = (left(own, more=(knots,))[0] ** 2).mean()
    # What is fitted besides costs half the logarithm of what fits it [Schwarz, Annals of
    # Statistics 6 (1978) 461].
    log = {"": -0.5 * number * np.log((plain ** 2).mean()) + np.log(conventions.PRIOR_HEALTHY),
           "bent": -0.5 * (number * np.log(bent) + knots.shape[1] * np.log(number))
           + np.log(conventions.PRIOR_NAMELESS),
           "band": -0.5 * (number * np.log(least_power) + np.log(number))
           + np.log(conventions.PRIOR_EACH)}
    probability = odds.shares(log).get("band", 0.0)
    if probability < odds.HOLDS:
        return None
    share, blocks = _earned(pair.t, noise, lambda rows: (
        left(own, rows)[0], left(banded(form, centre, rate), rows)[0]))
    if share < lacking_effects.MOST_OF_IT:
        return None
    # A parabola through what bands beside it leave.
    nats = 0.5 * number * np.log(np.mean([power(rate * (1.0 + side * BESIDE), form, centre)
                                          for side in (-1.0, 1.0)]) / least_power)
    half = odds.Z_90 * BESIDE * rate / np.sqrt(2.0 * max(nats, SURE))
    return Band(int(axis), form, rate, (rate - half, rate + half), centre,
                float(log["band"] - log[""]), probability, share, blocks)


def _earned(t, noise, fitted):
    """(share, blocks) by remaining_gap.earned(); fitted(rows): what is left without and with a
    band by fits to those rows."""
    seconds = max(remaining_gap.FOLD_S, 1.001 * np.ptp(t) / lacking_effects.BLOCKS)
    block = ((t - t[0]) / seconds).astype(int)
    left = np.empty((2, len(t)))
    for fold in (0, 1):
        hidden = block % 2 == fold
        if hidden.all() or not hidden.any():
            return 0.0, 0
        left[:, hidden] = np.stack(fitted(~hidden))[:, hidden]
    size = np.bincount(block)
    before, after = (np.bincount(block, each ** 2)[size > 0] for each in left)
    return remaining_gap.earned([(before, after, size[size > 0])], [noise])


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
