"""What a sensor reads at rest and how it is noisy: bias, N, B, K and the Allan deviation.

For recordings of rests without poses, a gyro's alone among them. N, B and K are those of
experiment/signal_measures.py; a drift with temperature that is found beside them is in B and K.
"""
from dataclasses import dataclass

import numpy as np

from .. import progress
from ..experiment import long_rest, signal_measures
from ..json_numbers import number, spelled
from . import odds

WALK_S = 60.0  # a rest this long shows the random walk
SHORTEST_S, FEWEST = 5.0, 64  # of a rest; samples in it
PARTS = 12  # of a rest, whose means give the error of the bias
A_DECADE = 4  # times of the Allan deviation
NAMES = ("density", "instability", "walk")


@dataclass(frozen=True)
class RestNoise:
    """unit: mg or deg/s; seconds at rest and of the longest rest; bias (3,), bias_90 (2, 3):
    mean reading with its interval, None of an accelerometer, which reads gravity as well;
    levels: {density (unit/sqrt(Hz)), instability (unit), walk (unit/s/sqrt(Hz)): three Level},
    walk only where a rest is long enough, none where an axis reads one value throughout; allan:
    ((seconds, (3,)), ...) of the longest rest."""

    unit: str
    seconds: float
    longest_s: float
    bias: object
    bias_90: object
    levels: dict
    allan: tuple


def noise_by_sensor(sessions):
    """{sensor: RestNoise} of blocks.Sessions, {} where nothing rests for SHORTEST_S."""
    noise = {}
    for sensor, unit in (("accel", "mg"), ("gyro", "deg/s")):
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        rate = sessions[0].rate
        rests = [long_rest.scaled(s, sensor)[a:b] for s in sessions for _, a, b in s.runs
                 if b - a >= max(SHORTEST_S * s.rate, FEWEST)]
        if not rests:
            continue
        progress.doing("the noise of the %s" % sensor)
        longest = max(rests, key=len)
        walks = len(longest) >= WALK_S * rate
        each = [signal_measures.noise_levels([x[:, axis] for x in rests], rate, walks)
                for axis in range(3)]
        levels = {name: tuple(of_axis[k] for of_axis in each) for k, name in enumerate(NAMES)
                  if all(of_axis[k] is not None for of_axis in each)}
        bias = _bias(rests) if sensor == "gyro" else (None, None)
        noise[sensor] = RestNoise(unit, sum(map(len, rests)) / rate, len(longest) / rate, *bias,
                                  levels, _allan(longest, rate))
    return noise


def _bias(rests):
    """((3,), (2, 3)): the mean of all rests, and its interval by the means of their parts; the
    correlation of neighbouring ones widens it [Bartlett, JRSS 98 (1935) 536]."""
    m = max(1, sum(map(len, rests)) // PARTS)
    parts = np.array([x[k:k + m].mean(axis=0) for x in rests
                      for k in range(0, max(len(x) - m, 0) + 1, m)])
    mean = np.concatenate(rests).mean(axis=0)
    if len(parts) < 3:
        return mean, None
    off = parts - parts.mean(axis=0)
    power = np.maximum((off ** 2).sum(axis=0), 1e-300)
    r = np.clip((off[1:] * off[:-1]).sum(axis=0) / power, 0.0, 0.9)
    half = odds.Z_90 * np.sqrt(power / (len(parts) - 1) / len(parts) * (1 + r) / (1 - r))
    values = np.concatenate(rests)
    constant = np.ptp(values, axis=0) == 0   # it lies anywhere within half a step of the others
    if constant.any():
        apart = np.abs(np.diff(values, axis=0))
        half = np.where(constant, 0.5 * apart[apart > 0].min(initial=np.inf), half)
        half = np.where(np.isfinite(half), half, 0.0)
    return mean, np.array([mean - half, mean + half])


def _allan(x, rate):
    most = len(x) // 9
    if most < 1:
        return ()
    times = np.unique(np.geomspace(1, most, max(2, int(
        A_DECADE * np.log10(most)) + 1)).round().astype(int))
    return tuple((m / rate, signal_measures.allan(x, int(m))) for m in times)


def answer(noise):
    """For --json."""
    def digits(value):
        return number(value, 5)
    entries = {}
    for sensor, own in noise.items():
        allan = [{"tau_s": digits(tau), "deviation": [digits(v) for v in values]}
                 for tau, values in own.allan]
        entries[sensor] = {"unit": spelled(own.unit), "seconds": digits(own.seconds),
                           "longest_s": digits(own.longest_s), "allan": allan}
        if own.bias is not None:
            entries[sensor]["bias"] = dict(zip("xyz", map(digits, own.bias)))
        if own.bias_90 is not None:
            entries[sensor]["bias_interval_90"] = {
                key: [digits(v) for v in pair] for key, pair in zip("xyz", own.bias_90.T)}
        for name, levels in own.levels.items():
            entries[sensor][name] = {key: digits(level.value) for key, level in zip("xyz", levels)}
            entries[sensor][name + "_interval_90"] = {
                key: [digits(level.low), digits(level.high)] for key, level in zip("xyz", levels)}
    return entries
