"""Families kept out of development: only `make blind` runs them.

The manifest names them by hash alone; nobody tunes a diagnosis on a family listed here.
"""

import numpy as np

from .signals import lagged
from .strangers import SIZE, stranger


def dust_lump(rng, chip, sensor, times):
    """A loose lump lies on whichever side was down last: an offset with the sign of the last
    force beyond 0.8 g on one axis, felt on another."""
    feels = int(rng.integers(3))

    def shape(signals, own, axes):
        x = signals.f[:, feels]
        mark = np.where(np.abs(x) > 0.8, np.sign(x), 0)
        last = np.maximum.accumulate(np.where(mark != 0, np.arange(len(mark)), 0))
        side = mark[last]
        # seen only while that axis lies level: else it is an even nonlinearity
        return side * (np.abs(x) < 0.5)

    other = [a for a in range(3) if a != feels][int(rng.integers(2))]
    return stranger("dust lump", ["history", "orientation", "time"], shape, rng, "accel", times,
                    axes=[other])


def shared_rail(rng, chip, sensor, times):
    """The gyro's drive pulls the accelerometer's supply: after motion its offset sags for some
    seconds, by how much it was turned."""
    tau = rng.uniform(4, 10)

    def shape(signals, own, axes):
        speed = np.linalg.norm(signals.w, axis=1) / 60
        return lagged(speed, signals.t, tau)

    return stranger("shared rail", ["time_since_move", "history", "motion", "flip"], shape, rng,
                    "accel", times, size=2 * SIZE["accel"])


def table_moved(rng, chip, sensor, times):
    """Somebody leans on the table in the middle of a session and it stays crooked."""
    when, where = rng.uniform(0.3, 0.7), int(rng.integers(2))
    direction = rng.uniform(0, 2 * np.pi)

    def shape(signals, own, axes):
        late = (signals.t > when * signals.t[-1]).astype(float)
        if signals.session != where and signals.sessions > 1:
            late *= 0
        lean = signals.at.inv().apply([np.cos(direction), np.sin(direction), 0])
        return late[:, None] * lean

    return stranger("table moved", ["time", "session", "across_gravity", "flip"], shape, rng,
                    "accel", times, axes=[0, 1, 2])


def wear(rng, chip, sensor, times):
    """Every set-down shifts the offset a little, by a random amount of one sign."""
    def shape(signals, own, axes):
        steps = own.gamma(0.5, 1.0, signals.placements.max() + 2)
        level = np.cumsum(steps) / steps.sum()
        now = np.maximum.accumulate(np.maximum(signals.placements, 0))
        return level[now]

    return stranger("wear", ["time", "session", "history"], shape, rng, sensor, times,
                    size=2 * SIZE[sensor])


def scale_step(rng, chip, sensor, times):
    """The reference voltage jumps: a scale that is another one from some moment on."""
    when, where = rng.uniform(0.3, 0.7), int(rng.integers(2))

    def shape(signals, own, axes):
        late = (signals.t > when * signals.t[-1]).astype(float)
        if signals.session != where and signals.sessions > 1:
            late *= 0
        return late[:, None] * signals.f

    return stranger("scale step", ["time", "session", "orientation", "along_gravity"], shape,
                    rng, "accel", times)


def cable_pull(rng, chip, sensor, times):
    """A cable twists the box on its mount by its heading on the table: an offset of both signs
    with the angle turned so far, two turns of memory."""
    def shape(signals, own, axes):
        turned = np.cumsum(signals.w * np.gradient(signals.t)[:, None], axis=0).sum(axis=1)
        return np.sin(np.radians(turned) / 2)

    return stranger("cable pull", ["history", "flip", "time", "orientation"], shape, rng, sensor,
                    times)


HELD_OUT = {"dust lump": (dust_lump, ("accel",)),
            "shared rail": (shared_rail, ("accel",)),
            "table moved": (table_moved, ("accel",)),
            "wear": (wear, ("accel", "gyro")),
            "scale step": (scale_step, ("accel",)),
            "cable pull": (cable_pull, ("accel", "gyro"))}
