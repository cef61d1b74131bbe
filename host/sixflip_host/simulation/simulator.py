"""The simulated sensor in numpy: what sixflip_sim's chips would count, a million times a second.

Everything comes from sixflip_sim: the scene, the part, the noise, the effects and, by asking
the simulated chips themselves, their ranges and sample periods. Only the loop is gone. For the
same world and the same samples the counts are those of the chips, bit for bit, except where
noted in scene_arrays (the exponential of the temperature may differ in its last bit).
"""
import numpy as np

from sixflip import RAIL, STANDARD_G
from sixflip_sim.effects.moment import Moment as View
from sixflip_sim.sensor_model import _DEGREE

from ..experiment import noise_arrays
from .scene_arrays import moment

CHUNK = 65536  # samples at a time: the arrays stay in the cache


class Output:
    """What one chip does with the model: kind "accel", "gyro" or "temp"; period_ns of its
    samples; per_unit (LSB per g, dps or degC), rail or offset, louder (multiplier of noise)."""

    def __init__(self, kind, period_ns, per_unit, rail, louder=1.0):
        self.kind, self.period_ns = kind, period_ns
        self.per_unit, self.rail, self.louder = per_unit, rail, louder


class _Listener:
    """Stands in for the model of a chip, to hear what the chip asks it for."""

    def __init__(self, period_ns):
        self.period_ns, self.outputs = period_ns, []

    def accel_counts(self, k, t_us, lsb_per_g, rail, louder, counts):
        self.outputs.append(Output("accel", self.period_ns, lsb_per_g, rail, louder))

    def gyro_counts(self, k, t_us, lsb_per_dps, rail, louder, counts):
        self.outputs.append(Output("gyro", self.period_ns, lsb_per_dps, rail, louder))

    def temp_counts(self, k, t_us, lsb_per_c, offset_c, counts):
        self.outputs.append(Output("temp", self.period_ns, lsb_per_c, offset_c))


def outputs_of(chips):
    """Outputs of configured simulated chips, by asking each for a sample."""
    outputs = []
    for chip in chips:
        if not hasattr(chip, "model"):
            continue
        listener = _Listener(chip.period_ns())
        model, chip.model = chip.model, listener
        try:
            chip.measure(0, 0)
        finally:
            chip.model = model
        outputs += listener.outputs
    return outputs


def vectorise(model):
    """Let the effects of a model work on arrays: hand them numpy's functions."""
    for effect in model.effects:
        if hasattr(effect, "view"):
            effect.view = View(np.exp, np.sin, np.floor, noise_arrays.gauss)


def counts(model, output, k):
    """Counts of samples k (n,) int64 of one output: (3, n) int64, or (1, n) for temp."""
    k = np.asarray(k, dtype=np.int64)
    parts = [_counts(model, output, k[i:i + CHUNK]) for i in range(0, len(k), CHUNK)]
    return np.concatenate(parts, axis=1) if parts else np.zeros((3, 0), dtype=np.int64)


def _counts(model, output, k):
    t_us = k * output.period_ns // 1000
    t = t_us * 1e-6
    look = t
    timed = [e.time for e in model.effects if hasattr(e, "time")]
    for shift in timed:
        look = shift(look)
    m = moment(model.scene, k, t, look * 1e6 if timed else t_us)
    for effect in model.effects:
        if hasattr(effect, "world"):
            effect.world(m)
    if output.kind == "temp":
        return _temperature(model, output, m, k)
    m.a = model.accel.answer(m.f)
    m.r = model.gyro.answer(m.w)
    for effect in model.effects:
        if hasattr(effect, "analog"):
            effect.only = output.kind
            effect.analog(m)
    first = 0 if output.kind == "accel" else 3
    m.counts = [0] * 7
    m.counts[first:first + 3] = _rounded(model, output, m, k)
    for effect in model.effects:
        if hasattr(effect, "counts"):
            effect.counts(m, first)
    return np.stack(m.counts[first:first + 3])


def _rounded(model, output, m, k):
    """sensor_model.Triad.round for arrays."""
    triad, felt, unit = ((model.accel, m.a, STANDARD_G) if output.kind == "accel"
                         else (model.gyro, m.r, _DEGREE))
    gain = output.per_unit / unit / triad.step
    columns = []
    for i in range(3):
        noise = noise_arrays.gauss(triad.keys[i], k)
        x = felt[i] + triad.sigma[i] * output.louder * noise
        count = np.floor(x * gain + 0.5).astype(np.int64) * triad.step
        columns.append(np.clip(count, -output.rail - 1, output.rail))
    return columns


def _temperature(model, output, m, k):
    noise = noise_arrays.gauss(model._temp_key, k)
    x = m.temp + model.temp_sigma * noise
    count = np.floor((x - output.rail) * output.per_unit + 0.5).astype(np.int64)
    return np.clip(count, -RAIL - 1, RAIL)[None]


def polled(output, polls_us):
    """Number of the sample that a poll at polls_us (n,) sees: sample and hold."""
    return np.asarray(polls_us, dtype=np.int64) * 1000 // output.period_ns
