"""Known effects of conversion, bus and clock: they act on counts, rows and times."""

import numpy as np

from .effect import Effect, names_of, some_axes


def _counts(signals, sensor):
    return signals.counts[:, :3] if sensor == "accel" else signals.counts[:, 3:]


def quantisation(rng, chip, sensor, times):
    """Only every n-th count appears, the nearest one or the next one below; the grid need not
    hold zero."""
    step = max(2, int(round(chip.typical["quantisation", sensor] * times)))
    offset = int(rng.integers(0, step)) if rng.random() < 0.3 else 0
    nearest = float(rng.choice([0.5, 0.0]))

    def act(signals, _):
        counts = _counts(signals, sensor)
        counts[:] = np.floor((counts - offset) / step + nearest).astype(int) * step + offset

    return Effect("quantisation", sensor, ["x", "y", "z"], "counts", act,
                  {"step": step, "offset": offset, "rounds": nearest > 0.0})


def dead_band(rng, chip, sensor, times):
    """Readings within the band about zero read as zero: a digital high-pass of cheap chips. What
    is beyond reads as it is, or less by the band (gyro, every other part)."""
    lsb = chip.accel_lsb_per_g if sensor == "accel" else chip.gyro_lsb_per_dps
    width = max(2, int(round(chip.typical["dead_band", sensor] * times * lsb)))
    axes = some_axes(rng)
    less = width if sensor == "gyro" and rng.random() < 0.5 else 0

    def act(signals, _):
        counts = _counts(signals, sensor)
        for axis in axes:
            # the chip takes its own offset out before the band, or the band would never be seen
            x = counts[:, axis]
            counts[:, axis] = np.where(np.abs(x) < width, 0, x - less * np.sign(x))

    return Effect("dead_band", sensor, names_of(axes), "counts", act,
                  {"counts": width, "less": less})


def saturation(rng, chip, sensor, times):
    """A rail at an odd level: just under one g, or within the rates of the moves; on both sides,
    or on one of them."""
    axes = some_axes(rng)
    if sensor == "accel":
        level = (1 - chip.typical["saturation", "accel"] * times) * chip.accel_lsb_per_g
    else:
        level = rng.uniform(60, 90) / (1 + times) * chip.gyro_lsb_per_dps
    level = int(level)
    lowest = -level - 1 if rng.random() < 0.6 else -(1 << 15)

    def act(signals, _):
        counts = _counts(signals, sensor)
        counts[:, axes] = np.clip(counts[:, axes], lowest, level)

    return Effect("saturation", sensor, names_of(axes), "counts", act, {"level": level})


def torn_reads(rng, chip, sensor, times):
    """Now and then the high byte is still that of the sample before, or already that of the
    sample after."""
    share = chip.typical["torn_reads", sensor] * times
    beside = int(rng.choice([1, -1]))

    def act(signals, own):
        counts = _counts(signals, sensor)
        torn = own.random(counts.shape) < share
        torn[[0, -1]] = False
        old = np.roll(counts, beside, axis=0)
        mixed = (old & ~0xFF) | (counts & 0xFF)
        counts[torn] = mixed[torn]

    return Effect("torn_reads", sensor, ["x", "y", "z"], "counts", act,
                  {"share": share, "beside": beside})


def stuck_bit(rng, chip, sensor, times):
    """One low bit that always reads the same."""
    bit = int(np.clip(round(2 + np.log2(max(times, 0.3))), 0, 4))
    if chip.accel_lsb_per_g < 1000:
        bit = min(bit, 1)
    axes, value = some_axes(rng), int(rng.integers(2))

    def act(signals, _):
        counts = _counts(signals, sensor)
        counts[:, axes] = (counts[:, axes] & ~(1 << bit)) | (value << bit)

    return Effect("stuck_bit", sensor, names_of(axes), "counts", act, {"bit": bit, "value": value})


def sample_rate(rng, chip, sensor, times):
    """The chip's oscillator is off and wanders a little; the times written down are true, or
    (one in four) those the driver believes in, which hides it."""
    wrong = rng.choice([-1, 1]) * chip.typical["sample_rate", "device"] * times
    wander, hidden = 0.1 * wrong, bool(rng.random() < 0.25)

    def clock(n, rate=100.0):
        u = np.arange(int(n * 1.2))
        interval = 1 / (rate * (1 + wrong + wander * np.sin(2 * np.pi * u / (rate * 700))))
        return np.concatenate([[0.0], np.cumsum(interval)])

    return Effect("sample_rate", "device", [], "rows", lambda signals, _: None,
                  {"relative": wrong, "hidden": hidden}, clock=clock, hides_clock=hidden)


def dropped_samples(rng, chip, sensor, times):
    """Rows that never came, alone and in bursts over the whole session, or in long runs only."""
    share = chip.typical["dropped_samples", "device"] * times
    lengths = [[1, 1, 1, 2, 5, 10], [15, 30, 45]][int(rng.random() < 0.3)]

    def act(signals, own):
        n = len(signals.t)
        lost, budget = np.zeros(n, bool), share * n
        while lost.sum() < budget:
            start, length = own.integers(1, n - 50), int(own.choice(lengths))
            lost[start:start + length] = True
        signals.kept &= ~lost

    return Effect("dropped_samples", "device", [], "rows", act,
                  {"share": share, "lengths": lengths})
