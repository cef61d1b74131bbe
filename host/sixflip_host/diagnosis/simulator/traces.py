"""A capture as a log in SI units, and what the sensor went through by its own account.

Simulator and sensor are compared as two such logs. Gravity and the motion come from the gyro,
levelled at every rest by the accelerometer, so that nothing but the log itself is needed.
"""
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sixflip import RAIL

from ...capture import clock
from ...capture.attitude import carried, levelled, rotation_between, rotations
from ...errors import BadFile
from .. import adequacy
from . import log_noise, log_rests, row_times, single_log

DPS = np.pi / 180.0


@dataclass(frozen=True)
class Trace:
    """One log. t (n,) s from its first row; force (n, 3) m/s2; rate (n, 3) rad/s or None;
    celsius (n,) or None; rate_hz by count over time; rests ((first, end), ...) in samples;
    faces: the axis of each rest that a label says is up, (3,) or None; quantum: m/s2 and rad/s
    of one count; flicker: {sensor: mg or deg/s}, the level of such a chip (adequacy.usual), by
    which its bias is another one the next time; railed (n,): a channel stands at the end of what
    it can say; put_in (n,): nobody read it, or what is beside it; calm: as rests, with
    stretches in which it hardly moves, of a log that rests somewhere; clock_sigma: the relative
    standard error of the pace of t."""

    name: str
    t: np.ndarray
    force: np.ndarray
    rate: np.ndarray
    celsius: np.ndarray
    rate_hz: float
    g: float
    rests: tuple
    faces: tuple
    quantum: tuple
    flicker: dict
    railed: np.ndarray
    put_in: np.ndarray
    calm: tuple = ()
    clock_sigma: float = 0.0

    @property
    def seconds(self):
        return float(self.t[-1]) if len(self.t) else 0.0

    @cached_property
    def noise(self):
        """{sensor: log_noise.Noise, or None} of the sensors that there are."""
        return {kind: log_noise.noise(self, values) for kind, values in (
            ("accel", self.force), ("gyro", self.rate)) if values is not None}

    def noise_of_rests(self, kind):
        """(3,) by how much a sensor's noise makes the mean over all that rests err, 0 where it is
        not known."""
        seconds = sum(b - a for a, b in self.rests) / self.rate_hz
        noise = self.noise[kind]
        return np.zeros(3) if noise is None else noise.density / np.sqrt(seconds)

    def rest_means(self, values):
        """(rests, 3): the mean of values (n, 3) over each rest."""
        return np.array([values[a:b].mean(axis=0) for a, b in self.rests]).reshape(-1, 3)


def check_rows(name, capture):
    """BadFile for a log of fewer rows than the shortest rest has: of a row or two each channel
    keeps its value, and steps by what its noise is."""
    if len(capture) < log_rests.FEWEST:
        raise BadFile("%s: it has %d row%s, expected %d and more to compare a simulator with" % (
            name, len(capture), "s" * (len(capture) > 1), log_rests.FEWEST))


def trace_from_capture(name, capture):
    """The Trace of a Capture; a chip without a gyro has no rate."""
    meta = capture.meta
    t = (capture.t_us - capture.t_us[0]) * 1e-6
    if len(t) > 1 and t[-1] <= 0.0:
        t = np.arange(len(t)) / float(meta["rate_hz"])
    measured = clock.sample_clock(capture)
    rate_hz = float(meta["rate_hz"]) if len(t) < 2 else (len(t) - 1) / t[-1]
    if measured is not None and (measured.pauses or not measured.losses):
        rate_hz = measured.rate_hz  # a pause is none of its time, nor are rows that came late
    quantum = (capture.g / meta["accel_lsb_per_g"],
               DPS / meta["gyro_lsb_per_dps"] if capture.gyro is not None else None)
    celsius = None
    if capture.temp is not None:
        celsius = capture.temp / meta["temp_lsb_per_c"] + meta["temp_offset_c"]
    rests, ups, calm = log_rests.of_capture(capture, rate_hz)
    railed = _railed(capture.accel)
    if capture.gyro is not None:
        railed = railed | _railed(capture.gyro)
    flicker = {kind: adequacy.usual(meta["sensor"], kind) for kind in ("accel", "gyro")}
    trace = Trace(name, t, capture.accel * quantum[0],
                  None if capture.gyro is None else capture.gyro * quantum[1], celsius,
                  float(rate_hz), capture.g, rests, ups, quantum, flicker, railed,
                  np.zeros(len(t), bool), calm, row_times.pace_sigma(measured))
    return row_times.evened(row_times.as_read(trace, measured), measured)


def _railed(counts):
    """(n,): samples at which a channel stands at the end of what it can say. By its readings
    alone: a simulator may stop elsewhere than at the range that its header states, by which
    detect.saturation goes."""
    at_end = (np.abs(counts.astype(int)) >= RAIL).any(axis=1)  # however short the peak
    return at_end | single_log.at_limit(counts.astype(float))


@dataclass(frozen=True)
class Motion:
    """What a Trace says its sensor went through, arrays over its samples: turn (n, 3, 3) body to
    world (heading 0 at the start); up (n, 3) unit vector against gravity in the body; rate
    (n, 3) rad/s less its bias at rest; rate_dot (n, 3); moved (n, 3) m/s2: specific force less
    gravity; speed (n, 3) m/s in the body, zero at each rest (without one: on average); spin
    (n, 3, 3): what multiplies r in w x (w x r), None for that of the rate."""

    turn: np.ndarray
    up: np.ndarray
    rate: np.ndarray
    rate_dot: np.ndarray
    moved: np.ndarray
    speed: np.ndarray
    spin: np.ndarray = None


def spinning(rate):
    """(n, 3, 3): what multiplies r in w x (w x r)."""
    return rate[:, :, None] * rate[:, None, :] - (rate ** 2).sum(axis=1)[:, None, None] * np.eye(3)


def motion(trace):
    """The Motion of a Trace with a gyro, else None; of one that never rests as far as it shows
    the vertical."""
    if trace.rate is None:
        return None
    if not trace.rests:
        return _restless_motion(trace)
    rate = trace.rate - rest_line(trace, trace.rate)
    ups = [_unit(v) for v in trace.rest_means(trace.force)]
    n = len(trace.t)
    middle = 0.5 * (rate[1:] + rate[:-1]) * np.diff(trace.t)[:, None]
    steps = rotations(middle)
    turn = np.empty((n, 3, 3))
    first, end = trace.rests[0]
    # The first rest says where the world's vertical is; before it time runs backwards.
    start = rotation_between(ups[0], log_rests.UP)
    turn[first:end] = start
    if first:
        turn[:first + 1] = (start @ carried(np.swapaxes(steps[:first], 1, 2)[::-1]))[::-1]
    for k in range(len(trace.rests)):
        first, end = trace.rests[k]
        last = trace.rests[k + 1][0] if k + 1 < len(trace.rests) else n - 1
        turn[first:end] = turn[first]
        way = turn[end - 1] @ carried(steps[end - 1:last])
        if k + 1 < len(trace.rests):
            way = levelled(way, ups[k + 1], log_rests.UP, _share_turned(middle[end - 1:last]))
        turn[end - 1:last + 1] = way
    up = turn[:, 2, :]
    moved = trace.force - trace.g * up
    speed = _speed(trace, turn, moved)
    return Motion(turn, up, rate, _slope(trace.t, rate), moved, speed)


def _restless_motion(trace):
    """The Motion of a Trace without a rest, or None where nothing in it shows the vertical."""
    levelled = log_rests.levelled(trace.t, trace.force, trace.rate, trace.rate_hz, trace.g)
    if levelled is None:
        return None
    turn, bias, speed = levelled
    up, rate = turn[:, 2, :], trace.rate - bias
    return Motion(turn, up, rate, _slope(trace.t, rate), trace.force - trace.g * up, speed)


def _slope(t, values):
    """(n, 3) change of values (n, 3) with time; where a stamp repeats, as around it."""
    at, own = row_times.increasing(t, values)
    if len(at) < 3:
        return np.zeros_like(values)
    return np.stack([np.interp(t, at, slope) for slope in np.gradient(own, at, axis=0).T], 1)


def _share_turned(steps):
    """(n + 1,) share of the angle turned so far, by rotation vectors (n, 3)."""
    path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    return path / path[-1] if path[-1] > 0 else np.linspace(0, 1, len(path))


def rest_line(trace, values):
    """(n, 3): values at rest, in a straight line from rest to rest."""
    if not trace.rests:
        return np.zeros((len(trace.t), 3))
    at = np.array([0.5 * (trace.t[a] + trace.t[b - 1]) for a, b in trace.rests])
    means = trace.rest_means(values)
    return np.stack([np.interp(trace.t, at, means[:, i]) for i in range(3)], 1)


def _speed(trace, turn, moved):
    """(n, 3): the integral of what moves it, zero at each rest."""
    world = np.einsum("nij,nj->ni", turn, moved)
    dt = np.diff(trace.t)[:, None]
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * (world[1:] + world[:-1]) * dt, 0)])
    at = np.concatenate([[a, b - 1] for a, b in trace.rests])
    drift = np.stack([np.interp(trace.t, trace.t[at], total[at, i]) for i in range(3)], 1)
    return np.einsum("nji,nj->ni", turn, total - drift)


def _unit(v):
    return v / max(np.linalg.norm(v), 1e-12)
