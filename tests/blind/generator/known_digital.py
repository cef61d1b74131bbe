"""Known effects of conversion, bus and clock: they act on counts, rows and times."""

import numpy as np

from .effect import Effect, names_of, some_axes


def _counts(signals, sensor):
    return signals.counts[:, :3] if sensor == "accel" else signals.counts[:, 3:]


def quantisation(rng, chip, sensor, times):
    """Only every n-th count appears; the grid need not hold zero."""
    step = max(2, int(round(chip.typical["quantisation", sensor] * times)))
    offset = int(rng.integers(0, step)) if rng.random() < 0.3 else 0

    def act(signals, _):
        counts = _counts(signals, sensor)
        counts[:] = np.floor((counts - offset) / step + 0.5).astype(int) * step + offset

    return Effect("quantisation", sensor, ["x", "y", "z"], "counts", act,
                  {"step": step, "offset": offset})


def dead_band(rng, chip, sensor, times):
    """Readings within the band about zero read as zero: a digital high-pass of cheap chips."""
    lsb = chip.accel_lsb_per_g if sensor == "accel" else chip.gyro_lsb_per_dps
    width = max(2, int(round(chip.typical["dead_band", sensor] * times * lsb)))
    axes = some_axes(rng)

    def act(signals, _):
        counts = _counts(signals, sensor)
        for axis in axes:
            # the chip takes its own offset out before the band, or the band would never be seen
            small = np.abs(counts[:, axis]) < width
            counts[small, axis] = 0

    return Effect("dead_band", sensor, names_of(axes), "counts", act, {"counts": width})


def saturation(rng, chip, sensor, times):
    """A rail at an odd level: just under one g, or within the rates of the moves."""
    axes = some_axes(rng)
    if sensor == "accel":
        level = (1 - chip.typical["saturation", "accel"] * times) * chip.accel_lsb_per_g
    else:
        level = rng.uniform(60, 90) / (1 + times) * chip.gyro_lsb_per_dps
    level = int(level)

    def act(signals, _):
        counts = _counts(signals, sensor)
        counts[:, axes] = np.clip(counts[:, axes], -level - 1, level)

    return Effect("saturation", sensor, names_of(axes), "counts", act, {"level": level})


def torn_reads(rng, chip, sensor, times):
    """Now and then the high byte is still that of the sample before."""
    share = chip.typical["torn_reads", sensor] * times

    def act(signals, own):
        counts = _counts(signals, sensor)
        torn = own.random(counts.shape) < share
        torn[0] = False
        old = np.roll(counts, 1, axis=0)
        mixed = (old & ~0xFF) | (counts & 0xFF)
        counts[torn] = mixed[torn]

    return Effect("torn_reads", sensor, ["x", "y", "z"], "counts", act, {"share": share})


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
    """Rows that never came, alone and in bursts, over the whole session."""
    share = chip.typical["dropped_samples", "device"] * times

    def act(signals, own):
        n = len(signals.t)
        lost, budget = np.zeros(n, bool), share * n
        while lost.sum() < budget:
            start, length = own.integers(1, n - 12), int(own.choice([1, 1, 1, 2, 5, 10]))
            lost[start:start + length] = True
        signals.kept &= ~lost

    return Effect("dropped_samples", "device", [], "rows", act, {"share": share})
