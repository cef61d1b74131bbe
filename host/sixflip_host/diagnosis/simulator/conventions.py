"""Layer one: what the simulator's numbers mean. Both logs of one motion, hypothesis against
hypothesis on the same samples; a nameless one stands beside those that have a name."""
from dataclasses import dataclass, field

import numpy as np

from . import alignment as align_by
from . import evidence_of_logs, hypotheses, pairing, single_log

# Before looking: nine simulators in ten are right about each sensor, and every single thing that
# public reports name is one in some fifty of them.
PRIOR_HEALTHY, PRIOR_EACH, PRIOR_NAMELESS = 0.9, 0.02, 0.005
CERTAIN = 0.99  # probability from which on a convention is named
HELD_BAND = 12.0  # readings in a period, below which a straight line between them is no curve
OWN_SHARES = (1.0, 0.3, 0.1, 0.03, 0.01)  # of what datasheets allow
LATE_SIGMA = 4.0  # of a delay's standard error, from which on it is one
WHO = {"accel": "accelerometer", "gyro": "gyro"}
WORDS = {
    "no_gravity": "outputs acceleration without gravity",
    "gravity_sign": "adds gravity with its sign turned",
    "force_sign": "outputs specific force with its sign turned",
    "gravity_after_rotation": "adds gravity after the rotation into the body: always along the "
                              "same axis of the sensor",
    "world_frame_forces": "outputs forces along the world's axes",
    "world_frame_rates": "outputs turn rates along the world's axes",
    "time_step": "divides by the wrong time step: what moves it is too large or too small, and "
                 "gravity is right",
    "no_centripetal_term": "leaves out the centripetal term",
    "lever_arm_missing": "is at the body's centre, the real sensor is not",
    "accel_axes": "has its axes swapped or mirrored",
    "gyro_axes": "has its axes swapped or mirrored",
    "both_axes": "has the axes of both sensors swapped or mirrored in the same way",
    "accel_unit": "uses another unit",
    "gyro_unit": "uses another unit",
    "accel_delay": "is late against the gyro",
    "gyro_delay": "is late against the accelerometer",
    "accel_rate_held": "repeats readings: it is slower than its rows",
    "gyro_rate_held": "repeats readings: it is slower than its rows",
    "noise_per_sample": "takes a noise density for the noise of a sample",
    "constant_channel": "never changes",
    "bias_sign": "has the bias with the wrong sign",
    "unknown": "does something that no convention here explains",
}
SET = {
    "no_gravity": "subtract the world's gravity vector before the rotation into the body: f = "
                  "Rᵀ(a - g)",
    "gravity_sign": "f = Rᵀ(a - g), with g pointing down",
    "force_sign": "change the sign of all three axes",
    "gravity_after_rotation": "f = Rᵀ(a - g): rotate after adding gravity",
    "world_frame_forces": "rotate into the body: f = Rᵀ f_world",
    "world_frame_rates": "rotate into the body: ω = Rᵀ ω_world",
    "no_centripetal_term": "differentiate the velocity in the world's frame, then rotate",
    "lever_arm_missing": "add dω/dt × r + ω × (ω × r)",
    "noise_per_sample": "standard deviation of a sample = density · √rate",
}


@dataclass(frozen=True)
class Convention:
    """One finding: name; sensor accel, gyro or device; probability; nats over the healthy one;
    value {key: number} with unit and interval_90 where it has a size; words; set_to; one_of: the
    names it may be where the logs cannot tell (name is "unknown" then)."""

    name: str
    sensor: str
    probability: float
    nats: float
    words: str
    set_to: str = ""
    value: dict = field(default_factory=dict)
    unit: str = ""
    interval_90: dict = field(default_factory=dict)
    one_of: tuple = ()


@dataclass(frozen=True)
class SensorFit:
    """One sensor of the simulator as the best hypothesis has it: found (Conventions), fit
    (evidence_of_logs.Fit), inflation, the Pair it was made on, the Hypothesis, the real sensor's
    own effects and the channels that change."""

    kind: str
    found: tuple
    fit: object
    inflation: float
    pair: object
    hypothesis: object
    own: tuple
    live: np.ndarray

    def again(self, rows):
        """The Fit of the same hypothesis with other noise of each sample, rows (n,)."""
        measured = self.pair.sim_force if self.kind == "accel" else self.pair.sim_rate
        return evidence_of_logs.fit_one(self.hypothesis, measured, self.fit.axes, self.fit.unit,
                                        pairing.GRID_HZ, self.kind, self.inflation, self.own,
                                        self.live, rows)


def one_of(sensor, candidates, probability, nats):
    """A finding whose name the logs cannot tell."""
    known = [c for c in candidates if c != "unknown"]
    who = "the simulator" if sensor == "device" else "the simulator's " + WHO[sensor]
    words = "%s shows one of: %s; these logs cannot tell which" % (who, ", ".join(
        n.replace("_", " ") for n in known)) if known else "%s %s" % (who, WORDS["unknown"])
    return Convention("unknown", sensor, probability, nats, words, one_of=tuple(known))


def finding(name, sensor, probability, nats, set_to="", **more):
    who = "the simulator" if sensor == "device" else "the simulator's " + WHO[sensor]
    return Convention(name, sensor, probability, nats, "%s %s" % (who, WORDS[name]),
                      set_to or SET.get(name, ""), **more)


def same_motion(real, sim, alignment, motion, live, fresh_hz):
    """{sensor: SensorFit} of two aligned Traces; live {sensor: (3,)}: channels that change."""
    out = {}
    for kind in ("accel", "gyro"):
        if live[kind].any():
            out[kind] = one_sensor(kind, real, sim, alignment, motion, live[kind],
                                   fresh_hz[kind])
    return out


def one_sensor(kind, real, sim, alignment, motion, live, fresh_hz):
    """SensorFit of one sensor."""
    noise = single_log.noise(real, real.force if kind == "accel" else real.rate)

    def asked(pair):
        if kind == "accel":
            return pair.sim_force, hypotheses.accelerometer(
                reliable(pair.force, noise, pair.band_hz), pair.motion, real.g)
        return pair.sim_rate, hypotheses.gyro(reliable(pair.rate, noise, pair.band_hz),
                                              pair.motion, pair.force, real.g)

    pair = pairing.paired(real, sim, alignment, motion)
    measured, tried = asked(pair)
    nameless = tried[-1]
    band = min(fresh_hz / HELD_BAND, pairing.coherent_band(
        measured, np.concatenate([nameless.signal, nameless.free], 1)))
    if band < pair.band_hz:
        pair = pairing.paired(real, sim, alignment, motion, band)
        measured, tried = asked(pair)

    own = hypotheses.own_effects(kind, pair.t, pair.celsius, pair.force, pair.motion.rate, real.g)

    def judged(inflation, rows=None):
        return [f for h in tried for f in evidence_of_logs.fits(
            h, measured, kind, pairing.GRID_HZ, inflation, own, live, rows)]

    first = max(judged(1.0), key=lambda f: f.log)
    rows = local_noise(first.left[:, live])
    inflation = align_by.independent(first.left[:, live] / rows[:, None])
    own = sized(own, lambda sizes: evidence_of_logs.fit_one(
        first.hypothesis, measured, first.axes, first.unit, pairing.GRID_HZ, kind, inflation,
        (own[0], sizes), live, rows).log)
    found, fit = posterior(kind, judged(inflation, rows), live)
    return SensorFit(kind, found, fit, inflation, pair, fit.hypothesis, own, live)


def reliable(values, noise, band_hz):
    """values (n, 3) of the real log, each channel drawn to its mean by the share of its variance
    that its noise makes up in the band: what is expected of the motion, given the reading. What
    follows from the motion alone is then fitted without being made too small, and a channel that
    reads nothing but noise says nothing of the simulator's [Fuller, Measurement Error Models
    (1987), section 1.1; Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 4].
    noise: single_log.Noise, None where it is not known."""
    if noise is None:
        return values
    mean, variance = values.mean(axis=0), values.var(axis=0)
    share = 1.0 - 2.0 * band_hz * noise.density ** 2 / np.maximum(variance, 1e-30)
    return mean + np.clip(share, 0.0, 1.0) * (values - mean)


def sized(own, log):
    """own (columns, sizes) with the sizes that make the logs likeliest: most real sensors do far
    less of themselves than datasheets allow, and room that is not needed is room for noise."""
    return own[0], max((own[1] * share for share in OWN_SHARES), key=log)


def local_noise(left):
    """(n,): how noisy the log is around each sample, in units of the average: a robot on its way
    shakes, at rest it does not; never less than the quieter half."""
    wide = int(pairing.GRID_HZ)
    power = (left ** 2 / np.maximum(left.var(axis=0), 1e-18)).mean(axis=1)
    level = np.sqrt(np.convolve(power, np.ones(wide), "same") / np.convolve(
        np.ones(len(power)), np.ones(wide), "same"))
    level = np.maximum(level, 0.5 * np.median(level) + 1e-9)
    return level / np.sqrt((level ** 2).mean())


def posterior(kind, fits, live):
    """(Conventions, the best Fit)"""
    logs = np.array([f.log + sum(np.log(prior(n)) for n in names(f, kind, live)) + (
        np.log(PRIOR_HEALTHY) if not names(f, kind, live) else 0.0) for f in fits])
    healthy = max(v for f, v in zip(fits, logs) if not names(f, kind, live))
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    best = fits[int(logs.argmax())]
    out = []
    for name in names(best, kind, live):
        probability = float(sum(w for f, w in zip(fits, weights)
                                if name in names(f, kind, live)))
        if probability >= CERTAIN:
            out.append(described(name, kind, best, probability,
                                 float(logs.max() - healthy), live))
    if names(best, kind, live) and not out:
        candidates = sorted({n for f, w in zip(fits, weights) if w > 0.02
                             for n in names(f, kind, live)})
        quiet = float(sum(w for f, w in zip(fits, weights) if not names(f, kind, live)))
        if quiet < 1.0 - CERTAIN:
            out.append(one_of(kind, candidates, 1.0 - quiet, float(logs.max() - healthy)))
        else:
            best = max((f for f in fits if not names(f, kind, live)), key=lambda f: f.log)
    return tuple(out), best


def prior(name):
    return PRIOR_NAMELESS if name == "unknown" else PRIOR_EACH


def names(fit, kind, live):
    """What a Fit says the simulator does other than a sensor: () is healthy."""
    out = []
    if fit.name == "":
        out.append("unknown")
    elif fit.name != "healthy":
        out.append(fit.name)
    dead = live & ~fit.axes.any(axis=1)
    if dead.any():
        out.append("constant_channel")
    answers = live & ~dead
    turned = not np.array_equal(fit.axes[answers], np.eye(3)[answers])
    if turned and fit.name not in ("world_frame_rates", "world_frame_forces"):
        minus = kind == "accel" and live.all() and np.array_equal(fit.axes, -np.eye(3))
        out.append("force_sign" if minus else kind + "_axes")
    if fit.unit != 1.0:
        out.append(kind + "_unit")
    return tuple(out)


def described(name, kind, fit, probability, nats, live):
    """The Convention with its size and what to set."""
    spread = 1.645 * fit.extra_sigma
    if name == "time_step":
        k = 1.0 + fit.extra[0]
        return finding(name, kind, probability, nats, "divide what moves it by %.3g: its velocity "
                       "difference spans another time than it is divided by" % k,
                       value={"factor": float(k)}, unit="1",
                       interval_90={"factor": (float(k - spread[0]), float(k + spread[0]))})
    if name == "lever_arm_missing":
        value = {a: float(100.0 * v) for a, v in zip("xyz", fit.extra)}
        return finding(name, kind, probability, nats, "%s, r = (%.1f, %.1f, %.1f) cm" % (
            SET[name], *value.values()), value=value, unit="cm", interval_90={
                a: (float(100 * (v - s)), float(100 * (v + s)))
                for a, v, s in zip("xyz", fit.extra, spread)})
    if name == "constant_channel":
        dead = [a for a, row, is_live in zip("xyz", fit.axes, live) if is_live and not row.any()]
        return finding(name, kind, probability, nats, "its %s says nothing of the motion" %
                       " and ".join(dead), value=dict.fromkeys(dead, 0.0), unit="1")
    if name.endswith("_axes"):
        rows = ", ".join("%s = %s" % (a, signed(row)) for a, row in zip("xyz", fit.axes))
        return finding(name, kind, probability, nats, "its axes are the sensor's so: " + rows,
                       value={a: signed(row) for a, row in zip("xyz", fit.axes)}, unit="axis")
    if name.endswith("_unit"):
        return finding(name, kind, probability, nats, "multiply by %.5g: %s" % (
            1.0 / fit.unit, unit_words(kind, fit.unit)),
            value={"factor": float(fit.unit)}, unit="1")
    return finding(name, kind, probability, nats)


def signed(row):
    """"-y" for (0, -1, 0), "0" for nothing."""
    if not row.any():
        return "0"
    i = int(np.abs(row).argmax())
    return ("-" if row[i] < 0 else "") + "xyz"[i]


def unit_words(kind, unit):
    if kind == "gyro":
        return "it gives degrees where radians are expected" if unit > 1.0 else \
            "it gives radians where degrees are expected"
    return "it gives m/s² where g is expected" if unit > 1.0 else \
        "it gives g where m/s² is expected"


def merged(found):
    """Both sensors' axes turned in the same way are one finding, of the whole device."""
    axes = {c.sensor: c for c in found if c.name in ("accel_axes", "gyro_axes")}
    if len(axes) == 2 and axes["accel"].value == axes["gyro"].value:
        one = axes["accel"]
        found = [c for c in found if c not in axes.values()]
        found.append(Convention("both_axes", "device", min(c.probability for c in axes.values()),
                                sum(c.nats for c in axes.values()),
                                "the simulator " + WORDS["both_axes"], one.set_to, one.value,
                                one.unit))
    return list(found)


def delay(sensor_fits, row_s):
    """(seconds by which the gyro is later than the accelerometer, more than the real sensor's;
    standard error), and the Convention where it is a row or more."""
    if len(sensor_fits) < 2:
        return None, None, []
    a, g = sensor_fits["accel"].fit, sensor_fits["gyro"].fit
    late = g.delay_s - a.delay_s
    sigma = float(np.hypot(a.delay_sigma_s, g.delay_sigma_s))
    known = not any(c.name == "unknown" for f in sensor_fits.values() for c in f.found)
    out = [late_one(late, sigma)] if known and abs(late) > LATE_SIGMA * sigma and (
        abs(late) >= row_s) else []
    return late, sigma, out


def late_one(late, sigma):
    """The Convention of a gyro that is late by so many seconds, or an accelerometer (negative)."""
    kind = "gyro" if late > 0 else "accel"
    ms = 1e3 * abs(late)
    return finding(kind + "_delay", kind, 1.0 - 2.0 * _tail(abs(late) / sigma),
                   0.5 * (late / sigma) ** 2, "take %.1f ms of delay out of it" % ms,
                   value={"delay": ms}, unit="ms", interval_90={
                       "delay": (ms - 1645.0 * sigma, ms + 1645.0 * sigma)})


def _tail(z):
    from math import erfc
    return 0.5 * erfc(z / 2.0 ** 0.5)
