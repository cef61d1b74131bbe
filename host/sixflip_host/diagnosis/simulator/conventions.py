"""Layer one: what the simulator's numbers mean. Both logs of one motion, hypothesis against
hypothesis on the same samples; a nameless one stands beside those that have a name."""
from dataclasses import dataclass, replace

import numpy as np

from . import alignment as align_by
from . import (
    convention_findings,
    evidence_of_logs,
    gravity_directions,
    hypotheses,
    motion_match,
    numbers_told,
    own_effects,
    pairing,
    remaining_gap,
    sensor_axes,
    single_log,
)

# Before looking: nine in ten are right about each sensor, one in fifty has each thing reported.
PRIOR_HEALTHY, PRIOR_EACH, PRIOR_NAMELESS = 0.9, 0.02, 0.005
# Of a gyro whose axes are swapped, or its time step wrong, as its accelerometer's are: the two are
# one part more often than not.
PRIOR_SAME = 0.5
SHARED_AXES = "accel_axes", "accel_mounting"  # which both sensors of one part have
# Of a factor from 1 that is a wrong time step: rates that are mistaken for each other, 50, 60, 100
# and 120 Hz, are 1.2 apart and more; by less a scale is wrong, or gravity.
LEAST_STEP = 0.1
HELD_BAND = 12.0  # readings in a period, below which a straight line between them is no curve
OWN_SHARES = (1.0, 0.3, 0.1, 0.03, 0.01)  # tried, of what datasheets allow: half-decades
DELAY_ROUNDS = 4  # of two rows, to a hundredth of one
# Share of the noise expected in the difference of two logs below which they share some of it: logs
# of their own have all of it, a log that was made of the other's samples next to none.
SHARED = 0.5
# Rows by which hypotheses are weighed before it is known which samples are independent, of about
# a minute or two; and nats of such by which none is made up for by what any number of rests says.
ROUGHLY, FAR = 1000, 100.0
POSSIBLE = 0.02  # probability of a fit from which on its names are some that it may be
# Of a log that is as smooth as the other, s2: a time constant of 0.04 ms; and standard errors from
# which on it is smoother, by chance in 1 of 16,000 (normal).
ALIKE_S2, SMOOTHER = 1e-9, 4.0


@dataclass(frozen=True)
class SensorFit:
    """One sensor of the simulator as the best hypothesis has it: conventions, fit
    (evidence_of_logs.Fit), inflation, the Pair it was made on, the Hypothesis, the real sensor's
    own effects, the channels that change, how fast the noise is (evidence_of_logs.bends) and the
    LowPass that the other log of the Pair is behind, or None; as_read: the Pair without that."""

    kind: str
    conventions: tuple
    fit: object
    inflation: float
    pair: object
    hypothesis: object
    own: tuple
    live: np.ndarray
    noise_bends: tuple
    low_pass: object
    as_read: object

    def refitted(self, rows, left=True):
        """The Fit of the same hypothesis with other noise of each sample, rows (n,); left: with
        what it leaves of every sample."""
        return evidence_of_logs.fit_one(
            self.hypothesis, self.pair.simulated(self.kind), self.fit.axes, self.fit.unit,
            pairing.GRID_HZ, self.kind, self.inflation, self.own, self.live, rows, left,
            self.noise_bends)

    @property
    def smoothing_earns(self):
        """Chi squared that a smoother fit earns by the noise alone that it takes away."""
        weaker = evidence_of_logs.smoothed(self.fit.smooth_s2, self.noise_bends)
        return float(len(self.pair.t) / self.inflation * self.live.sum() * -np.log(weaker))


def same_motion(real, sim, alignment, motion, live, fresh_hz, behind, own_real):
    """{sensor: SensorFit} of two aligned Traces; own_real: the real one's OwnSensor; live
    {sensor: (3,)}: channels that change; behind {sensor: LowPass} (transfer.between)."""
    sensor_fits, swapped, said = {}, None, ()
    for kind in ("accel", "gyro"):
        if live[kind].any():
            rest = (motion, live[kind], fresh_hz[kind], behind.get(kind), own_real, swapped, said)
            sensor_fits[kind] = motion_match.in_step(
                lambda aligned, kind=kind, rest=rest: one_sensor(kind, real, sim, aligned, *rest),
                kind, real, sim, alignment)
            said = [c.name for c in sensor_fits[kind].conventions]
            if set(said).intersection(SHARED_AXES):
                swapped = sensor_fits[kind].fit.axes
    return sensor_fits


def one_sensor(kind, real, sim, alignment, motion, live, fresh_hz, behind, own_real, *other):
    """SensorFit of one sensor; other: what is known of the other one, see prior()."""
    swapped = other[0] if other else None
    noise, theirs = (log.noise[kind] for log in (real, sim))
    full_scale = own_real.full_scale[kind]

    def asked(pair):
        values, measured = pair.real(kind), pair.simulated(kind)
        share = own_noise(values, measured, noise, theirs, pair.band_hz)
        if (share < 1.0).any() or single_log.silent(sim, kind):
            measured = measured + single_log.rounding(kind, (real, sim), len(pair.t), pair.band_hz)
            pair = replace(pair, **{"sim_force" if kind == "accel" else "sim_rate": measured})
        made = hypotheses.made(kind, alignment.turning)
        heard = measured[:, live]
        left = pairing.not_foretold(made(values, pair.motion, real.g)[-1], heard)
        # Where no log tells it what is not foretold is all that says how noisy they are.
        density = 0.0 if noise is None else noise.density
        sigma = np.sqrt(2.0 * pair.band_hz * share) * density
        more = {"behind": behind, **({} if kind == "accel" else {
            "shape_sd": sensor_axes.turning(values, pair.force, sigma)})}
        values = pairing.reliable(values, np.maximum(sigma, pairing.shaken(left, heard, values)))
        tried = [replace(h, full_scale=full_scale, **more)
                 for h in made(values / full_scale, pair.motion, real.g)]
        if full_scale != 1.0:  # it may be that of the simulator's log as well
            tried.insert(0, hypotheses.Hypothesis(
                "healthy", values, *hypotheses.none(len(values)), shared=True, **more))
        return pair, measured, tried, evidence_of_logs.bends(left, pairing.GRID_HZ)

    logs = real, sim, alignment, motion
    pair, measured, tried, noise_bends = asked(pairing.paired(*logs, low_pass=behind))
    band = min(fresh_hz / HELD_BAND, pairing.coherent_band(
        measured, np.concatenate([tried[-1].signal, tried[-1].free], 1)))
    if band < pair.band_hz:
        pair, measured, tried, noise_bends = asked(pairing.paired(*logs, band, behind))

    as_read = pair if behind is None else pairing.paired(*logs, pair.band_hz)
    own = effects = own_effects.of_everything(
        kind, pair.t, pair.celsius, pair.force, pair.motion.rate, real.g)

    def judged(tried, inflation, rows=None, **most):
        return [f for h in tried for f in evidence_of_logs.fits(
            h, measured, kind, pairing.GRID_HZ, inflation, own, live, rows, noise_bends, swapped,
            **most)]

    def whole(fit, inflation, rows=None, sizes=None, left=True):
        return evidence_of_logs.fit_one(
            fit.hypothesis, measured, fit.axes, fit.unit, pairing.GRID_HZ, kind, inflation,
            own if sizes is None else (own[0], sizes), live, rows, left, noise_bends)

    every = sorted(judged(tried, 1.0, most=ROUGHLY), key=lambda f: -f.log)
    first = whole(every[0], 1.0)
    rows = pairing.local_noise(first.left[:, live])
    inflation = align_by.independent(first.left[:, live] / rows[:, None])
    # The best with a name is as good as any other that the rests may yet speak for.
    least = next(f.log for f in every if f.name) - FAR * inflation
    hopeful = [h for h in tried if h.name in ("", "healthy") or any(
        f.log > least for f in every if f.hypothesis is h)]

    def in_full(fit):
        return whole(fit, inflation, rows)

    def kept(named, fit):
        return without_smoothing(SensorFit(kind, named, fit, inflation, pair, fit.hypothesis, own,
                                           live, noise_bends, behind, as_read), rows)

    def best_of(fits):
        return kept(*posterior(kind, fits, live, in_full, *other))

    known = 0.0 if None in (noise, theirs) else 2.0 * pair.band_hz * (
        noise.density ** 2 + theirs.density ** 2)
    # What has no name has what the sensor does of itself among its own columns: the sizes that
    # suit it leave the others none, so they are asked by their own before it is believed.
    for likely in every[:1] if first.name else [first, next(f for f in every if f.name)]:
        own = sized(effects, lambda s, f=likely: whole(f, inflation, rows, s, left=False).log)
        fits = [gravity_directions.beside(kind, fit, real, sim, own_real.turns)
                for fit in judged(hopeful, inflation, rows)]
        best = best_of(fits)
        if doubt := best.fit.name and numbers_told.doubted(best, known):
            return kept((convention_findings.one_of(kind, (), *doubt),),
                        in_full(max((f for f in fits if not f.name), key=lambda f: f.log)))
        if best.fit.name:
            return best
    other = best_of([f for f in fits if f.name])
    sound = not numbers_told.doubted(other, known)
    return other if sound and remaining_gap.explains(other, best) else best


def without_smoothing(sensor_fit, rows):
    """The SensorFit as smooth as the real log, where it is not shown to be smoother: of a motion
    of one frequency, as a pendulum's, what that takes off by chance a scale puts back."""
    free, sigma = sensor_fit.fit.smooth_s2, sensor_fit.fit.smooth_sigma_s2
    if sensor_fit.low_pass is not None or (
            free / sigma) ** 2 - sensor_fit.smoothing_earns > SMOOTHER ** 2:
        return sensor_fit
    fixed = replace(sensor_fit, hypothesis=replace(sensor_fit.hypothesis, smooth_sd=ALIKE_S2))
    return replace(fixed, fit=replace(fixed.refitted(rows), smooth_s2=free, smooth_sigma_s2=sigma))


def own_noise(values, measured, noise, theirs, band_hz):
    """Share (3,) of the real log's noise that the simulator's log has not as well: all of it, but
    for a simulator that was made out of the real log's samples. What they differ by has the noise
    of both, or the simulator's says what the real noise was; noise, theirs: log_noise.Noise."""
    if noise is None or theirs is None:
        return np.ones(3)
    delay = 0.0  # in rows
    for _ in range(DELAY_ROUNDS):
        moved = evidence_of_logs.shifted(values, delay)
        slope = -np.gradient(moved, axis=0)
        design = np.column_stack([moved, slope, np.ones(len(values))])
        fit = np.linalg.lstsq(design, measured, rcond=None)[0]
        # A late simulator has the slope of what it has, in the same proportions.
        delay += float((fit[:3] * fit[3:6]).sum() / max((fit[:3] ** 2).sum(), 1e-12))
    left = (measured - design @ fit) ** 2
    wide = max(1, int(pairing.GRID_HZ))
    calm = np.median(left[:len(left) // wide * wide].reshape(-1, wide, 3).mean(axis=1), axis=0) \
        if len(left) >= wide else left.mean(axis=0)
    expected = 2.0 * band_hz * ((fit[:3].T ** 2) @ noise.density ** 2 + theirs.density ** 2)
    share = calm / np.maximum(expected, 1e-30)
    return np.where(share > SHARED, 1.0, share)


def sized(own, log):
    """own (columns, sizes) with the sizes that make the logs likeliest: most real sensors do far
    less of themselves than datasheets allow, and room that is not needed is room for noise."""
    return own[0], max((own[1] * share for share in OWN_SHARES), key=log)


def posterior(kind, fits, live, in_full, swapped=None, said=()):
    """(Conventions, the best Fit in full); in_full(fit): a Fit with its errors and with what it
    leaves; swapped, said: of the other sensor, see prior()."""
    # A factor that is no wrong time step would part what moves it from gravity: no scale does.
    fits = [f for f in fits if f.name != "time_step" or abs(f.extra[0]) >= LEAST_STEP]
    named = [evidence_of_logs.names(f, kind, live) for f in fits]
    logs = np.array([f.log + sum(np.log(prior(n, f, swapped, said)) for n in each) + (
        np.log(PRIOR_HEALTHY) if not each else 0.0) for f, each in zip(fits, named)])
    top = int(logs.argmax())
    best = in_full(fits[top])
    findings = convention_findings.told(
        named, logs, POSSIBLE, lambda _: kind, lambda name, probability, nats:
        convention_findings.described(name, kind, best, probability, nats, live))
    if named[top] and not findings:
        best = in_full(max((f for f, each in zip(fits, named) if not each), key=lambda f: f.log))
    return tuple(findings), best


def prior(name, fit=None, swapped=None, said=()):
    """Probability of a thing, before looking; of the other sensor swapped (3, 3): its axes, where
    they are, None for its own, and said: its names."""
    same = name.startswith("gyro_") and swapped is not None and sensor_axes.alike(
        fit.axes, swapped)
    if same or name == "time_step" and name in said:
        return PRIOR_SAME
    if name.endswith("_mounting"):
        return PRIOR_EACH * np.exp(sensor_axes.of_mounting(fit.axes))
    return PRIOR_NAMELESS if name == "unknown" else PRIOR_EACH
