"""What one log shows of itself without the other's motion: channels that never change, steps and
range."""
import numpy as np

from . import convention_findings

# Share of the liveliest channel's standard deviation: a channel that says nothing varies by less
# than DEAD, where the real one varies by more than ALIVE, five times as much.
DEAD, ALIVE = 0.03, 0.15
# Times its power at rest: on its way a channel that says nothing has that (SAME: the power of a
# hundred independent samples errs by 14 %), and what moves a robot moves its other channels by
# MORE.
SAME, MORE = 1.3, 10.0
CROOKED = 0.08  # of another axis, in a channel: twice a cross axis (hypotheses.SHAPE)
FULL = 32767.0 / 32768.0  # of a limit: 32767 counts are as far as -32768
# Times as often as any value next to a limit a channel reads the limit: a sine, which slows down
# at its peaks, reads them 2.4 times as often (the roots of 1 and of 2 less 1).
OFTEN = 10
STILL = 0.9  # of a log: what rests for longer, and does not turn besides, was not moved
DROWNED = 0.3  # of a count: noise below it hardly ever crosses one


def live(trace):
    """{sensor: (3,) bool}: channels that change at all."""
    channels = {"accel": np.ptp(trace.force, axis=0) > 0}
    channels["gyro"] = np.zeros(3, bool) if trace.rate is None else np.ptp(trace.rate, axis=0) > 0
    return channels


def dead(real, sim):
    """{sensor: (3,) bool}: channels of the simulator that hardly change where the real ones do,
    and no other does in their place: of what turns about one axis another one may answer."""
    channels = {"accel": np.zeros(3, bool), "gyro": np.zeros(3, bool)}
    for kind, name in (("accel", "force"), ("gyro", "rate")):
        if getattr(real, name) is None or getattr(sim, name) is None:
            continue
        still = [at_rest(x, getattr(x, name), x.quantum[kind == "gyro"]) for x in (real, sim)]
        ours, theirs = (getattr(x, name).var(axis=0) for x in (real, sim))
        # What the real one has at rest, too, is noise, which a simulator may lack; of what never
        # rests it is no more than what changes from row to row.
        quiet = still[0]
        if quiet is None:
            quiet = 0.5 * (np.diff(getattr(real, name), axis=0) ** 2).mean(axis=0)
        moved, moves = np.maximum(ours - quiet, 0.0), ours > SAME * quiet
        shares = [np.sqrt(x / max(x.max(), 1e-24)) for x in (moved, theirs)]
        alive = moves & (shares[0] > ALIVE), shares[1] > ALIVE
        if alive[0].sum() > alive[1].sum():
            channels[kind] |= alive[0] & (shares[1] < DEAD)
        if still[0] is not None and still[1] is not None:
            own = beyond_cross_axes(getattr(real, name)).var(axis=0)
            alive = own > MORE * np.maximum(*still), theirs > MORE * still[1]
            if alive[0].sum() > alive[1].sum():
                channels[kind] |= alive[0] & (theirs < SAME * still[1]) & alive[1].any()
    return channels


def beyond_cross_axes(values):
    """values (n, 3) without what each has of the others by how askew a sensor may be."""
    x = values - values.mean(axis=0)
    others = (np.delete(x, i, axis=1) for i in range(3))
    return np.stack([own - other @ np.clip(np.linalg.lstsq(other, own, rcond=None)[0], -CROOKED,
                                           CROOKED) for own, other in zip(x.T, others)], 1)


def constant_channels(real, sim):
    """({sensor: (3,) bool} of the simulator's channels that change and answer, [Convention] of
    those that do not)."""
    answer, findings = live(sim), []
    for kind, still in dead(real, sim).items():
        if still.any():
            axes = [a for a, x in zip("xyz", still) if x]
            findings.append(convention_findings.finding(
                "constant_channel", kind, 1.0, 100.0, "its %s says nothing of the motion" %
                " and ".join(axes), value=dict.fromkeys(axes, 0.0), unit="1"))
            answer[kind] = answer[kind] & ~still
    return answer, findings


def at_rest(trace, values, quantum):
    """(3,): power of values (n, 3) within the rests, a count's at least; None without a rest."""
    rests = [values[a:b] for a, b in trace.rests]
    if not rests:
        return None
    still = np.concatenate([x - x.mean(axis=0) for x in rests]).var(axis=0)
    return np.maximum(still, quantum ** 2 / 12.0)


def turns(trace):
    """Whether the gyro of a Trace reads more than it does at rest: what only drives does not turn.
    Where there is no rest nobody knows."""
    if trace.rate is None:
        return False
    still = at_rest(trace, trace.rate, trace.quantum[1])
    return still is None or bool((trace.rate.var(axis=0) > SAME * still).any())


def lies_still(trace):
    """Whether a Trace rests nearly all the time, and turns no more than its noise."""
    resting = sum(end - first for first, end in trace.rests)
    return resting > STILL * len(trace.t) and not turns(trace)


def step(values, quantum):
    """(3,): the step of what was read, in the unit of values: the common divisor of its counts."""
    counts = np.round(values / quantum).astype(np.int64)
    counts = counts - counts[0]
    return np.gcd.reduce(np.abs(counts), axis=0) * quantum


def limit(x):
    """The value that a channel (n,) stops at, or None: the largest size, read so often that a
    peak of a smooth motion cannot be it."""
    size = np.abs(x)
    top = size.max()
    at = size >= FULL * top
    if at.all():
        return None  # what never changes does not stop there
    runs = at[1:] & at[:-1] & (np.sign(x[1:]) == np.sign(x[:-1]))
    if runs.sum() < 5 or top <= 0:
        return None
    # A log at rest repeats its largest reading by chance; then those next to it are as frequent.
    below = top - size[~at & (size > 0.99 * top)]
    next_to_it = np.bincount((below / ((1.0 - FULL) * top)).astype(int), minlength=1).max()
    stops = at.sum() > 3 * max(len(below), 1) or at.sum() > OFTEN * max(next_to_it, 1)
    return float(size[at].min()) if stops else None


def at_limit(values):
    """(n,): rows of values (n, 3) in which a channel stands at its limit."""
    return np.any([np.abs(x) >= (np.inf if end is None else end)
                   for x, end in zip(values.T, map(limit, values.T))], axis=0)


def gyro_cut_off(trace):
    """(n,): rows in which the gyro of a Trace stands at its limit, and turned faster than it says.
    One without noise may turn as fast as ever again and again."""
    return np.zeros(len(trace.t), bool) if silent(trace, "gyro") else at_limit(trace.rate)


def rounding(kind, logs, number, band_hz):
    """(number, 3) of as much noise as the rounding of both logs leaves in the band: two that were
    made of the same samples, and one that has no noise, which rounds what is slow the same way
    again and again, do not say that they agree any better."""
    power = sum((log.quantum[kind == "gyro"] or 0.0) ** 2 / 12.0 * (
        1.0 if silent(log, kind) else min(1.0, 2.0 * band_hz / log.rate_hz)) for log in logs)
    return np.sqrt(power) * np.random.default_rng(20200517).standard_normal((number, 3))


def silent(log, kind):
    """Whether a sensor's noise in a log hardly ever crosses a count."""
    noise, count = log.noise.get(kind), log.quantum[kind == "gyro"]
    return noise is not None and bool((noise.per_sample < DROWNED * count).all())
