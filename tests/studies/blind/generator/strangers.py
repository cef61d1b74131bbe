"""Families that GAP.md's library does not hold.

Each returns an Effect whose name starts with "?" and whose parameters say in which domains of
GAP.md it may rightly be found.
"""

import numpy as np

from .effect import Effect, names_of, sized, some_axes

SIZE = {"accel": 5e-3, "gyro": 0.25}        # g, deg/s at 1x


def stranger(name, domains, shape, rng, sensor, times, axes=None, size=None):
    axes = some_axes(rng) if axes is None else axes
    size = sized(rng, (SIZE[sensor] if size is None else size) * times, axes)

    def act(signals, own):
        added = shape(signals, own, axes)
        if added.ndim == 1:
            added = added[:, None] * np.ones(3)
        signals.out(sensor)[:] += added * size

    return Effect("?" + name, sensor, names_of(axes), "response", act,
                  {"size": size.tolist(), "domains": domains})


def bias_step(rng, chip, sensor, times):
    """The offset jumps once, at a random time of a random session."""
    when, where = rng.uniform(0.25, 0.75), int(rng.integers(2))

    def shape(signals, own, axes):
        if signals.session != where and signals.sessions > 1:
            return np.zeros(len(signals.t))
        return (signals.t > when * signals.t[-1]).astype(float)

    return stranger("bias step", ["time", "session"], shape, rng, sensor, times)


def sinusoidal_nonlinearity(rng, chip, sensor, times):
    """sin(5 pi f / 2 + phase): bends five times between -1 g and +1 g."""
    phase = rng.uniform(0, 2 * np.pi)

    def shape(signals, own, axes):
        return np.sin(2.5 * np.pi * signals.f + phase)

    return stranger("sinusoidal nonlinearity", ["orientation", "along_gravity", "across_gravity"],
                    shape, rng, "accel", times)


def two_pose_memory(rng, chip, sensor, times):
    """Remembers the sign of the product of the last two different faces' forces, and relaxes."""
    tau = rng.uniform(3, 8)

    def shape(signals, own, axes):
        f = signals.f
        out = np.zeros_like(f)
        rests = [np.flatnonzero(signals.placements == k)
                 for k in range(signals.placements.max() + 1)]
        means = [f[r].mean(axis=0) for r in rests if len(r)]
        for k in range(2, len(means)):
            inside = slice(rests[k][0], rests[k][-1] + 1)
            since = signals.t[inside] - signals.t[rests[k][0]]
            out[inside] = (means[k - 1] - means[k - 2])[[1, 2, 0]] * np.exp(-since / tau)[:, None]
        return out

    return stranger("memory of two poses", ["history", "time_since_move"], shape, rng, "accel",
                    times, size=1.5 * SIZE["accel"])


def telegraph(rng, chip, sensor, times):
    """Popcorn noise: two levels, dwelling tens of seconds on each."""
    mean = rng.uniform(10, 40)

    def shape(signals, own, axes):
        jumps = np.cumsum(own.exponential(mean, int(signals.t[-1] / mean * 3) + 20))
        return (np.searchsorted(jumps, signals.t) % 2) - 0.5

    return stranger("telegraph noise", ["time", "noise", "frequency"], shape, rng, sensor, times)


def slow_oscillation(rng, chip, sensor, times):
    """An air conditioner: the bias swings with a period of one to two minutes, the chip's
    thermometer does not."""
    period, phase = rng.uniform(60, 120), rng.uniform(0, 2 * np.pi)

    def shape(signals, own, axes):
        return np.sin(2 * np.pi * signals.t / period + phase)

    return stranger("slow oscillation", ["time", "frequency", "noise"], shape, rng, sensor, times)


def humidity(rng, chip, sensor, times):
    """A sigmoid in time, once, in the middle of one session."""
    middle, width, where = rng.uniform(0.35, 0.65), rng.uniform(10, 30), int(rng.integers(2))

    def shape(signals, own, axes):
        if signals.session != where and signals.sessions > 1:
            return np.zeros(len(signals.t))
        return 1 / (1 + np.exp(-(signals.t - middle * signals.t[-1]) / width))

    return stranger("humidity", ["time", "session"], shape, rng, sensor, times)


def spike_bursts(rng, chip, sensor, times):
    """A loose contact: bursts of heavy-tailed spikes in every third rest or so."""
    def shape(signals, own, axes):
        out = np.zeros(len(signals.t))
        for start in own.uniform(0, signals.t[-1], int(signals.t[-1] / 25)):
            inside = (signals.t > start) & (signals.t < start + own.uniform(0.5, 3))
            out[inside] = own.standard_t(1.5, inside.sum()) * 4
        return np.clip(out, -60, 60)

    return stranger("spike bursts", ["noise", "time", "amplitude"], shape, rng, sensor, times)


def speed_reading(rng, chip, sensor, times):
    """Reads something of how fast it is turned, whichever way: a cable that is flung outward."""
    per_dps = {"accel": 0.2e-3, "gyro": 0.004}[sensor]

    def shape(signals, own, axes):
        return np.linalg.norm(signals.w, axis=1)

    return stranger("speed reading", ["motion"], shape, rng, sensor, times, size=per_dps)


def cross_rate(rng, chip, sensor, times):
    """The gyro's axes rectify one another: the product of two rates on the third."""
    def shape(signals, own, axes):
        return signals.w[:, [1, 2, 0]] * signals.w[:, [2, 0, 1]] / 50.0

    return stranger("cross rate", ["motion", "amplitude"], shape, rng, "gyro", times, size=0.5)


def page_spikes(rng, chip, sensor, times):
    """The eighth bit is hit on the bus now and then, whatever the byte above it."""
    share, axes = 0.003 * times, some_axes(rng)

    def act(signals, own):
        counts = signals.counts[:, :3] if sensor == "accel" else signals.counts[:, 3:]
        for axis in axes:
            hit = own.random(len(counts)) < share
            counts[hit, axis] += 256 * own.choice([-1, 1], hit.sum())

    return Effect("?page spikes", sensor, names_of(axes), "counts", act,
                  {"share": share, "domains": ["noise", "amplitude"]})


def lost_runs(rng, chip, sensor, times):
    """Runs of samples are lost while the times go on as if none were: a buffer that overflows."""
    def act(signals, own):
        n, lost = len(signals.t), 0
        while lost < 0.003 * times * n:
            start, length = int(own.integers(1, n - 40)), int(own.integers(5, 30))
            signals.counts[start:-length] = signals.counts[start + length:]
            lost += length

    return Effect("?lost runs", sensor, [], "counts", act,
                  {"domains": ["timing", "motion", "noise", "amplitude", "time"]})


STRANGERS = {"bias step": (bias_step, ("accel", "gyro")),
             "sinusoidal nonlinearity": (sinusoidal_nonlinearity, ("accel",)),
             "memory of two poses": (two_pose_memory, ("accel",)),
             "telegraph noise": (telegraph, ("accel", "gyro")),
             "slow oscillation": (slow_oscillation, ("accel", "gyro")),
             "humidity": (humidity, ("accel", "gyro")),
             "spike bursts": (spike_bursts, ("accel", "gyro")),
             "speed reading": (speed_reading, ("accel", "gyro")),
             "cross rate": (cross_rate, ("gyro",)),
             "page spikes": (page_spikes, ("accel", "gyro")),
             "lost runs": (lost_runs, ("gyro",))}
