"""One long rest, or several in one attitude, as short means over time.

Where a capture has too few poses for the linear model, what it can still show is how its readings
change while nothing moves: with temperature, with time, by jumps. The means are short against what
wanders and long against the noise; their white noise is known from what differs within them.
"""
from dataclasses import dataclass

import numpy as np

from ..capture.registers import unit_of_count
from . import block_measures, noise_arrays

# Rests that lie apart by no more are in one attitude: a robot that stops leans by its suspension
# and the floor, while the next pose of what stands on another face is 90 degrees away.
SAME_DEG = 3.0
# Means of all rests together: the covariance of them all is one matrix that is factored at every
# level of noise tried, which takes the third power of their number.
MEANS = 96
# Of a mean: two submeans of block_measures.white, by whose difference its noise is known; in a log
# of few rows a second, two samples in each half.
SHORTEST_S, FEWEST_SAMPLES = 2.0 * block_measures.SUBMEAN_S, 4
SHORTEST_REST_S = 4.0 * SHORTEST_S  # fewer means have no course
# s that what drives takes to stop and to start: 0.02 g of braking and 0.2 deg/s of nodding are as
# still as a rest where an engine shakes it. A board or a person labels what has come to rest.
STOPS_S = 2.0


def longest(session):
    """(first, end) of the longest rest of a blocks.Session, or None."""
    if not session.runs:
        return None
    _, first, end = max(session.runs, key=lambda r: r[2] - r[1])
    return first, end


def scaled(session, sensor):
    """Samples (n, 3) in mg or deg/s."""
    meta = session.capture.meta
    counts = getattr(session.capture, sensor).astype(float)
    return counts * (1000.0 / meta["accel_lsb_per_g"]) if sensor == "accel" \
        else counts / meta["gyro_lsb_per_dps"]


@dataclass(frozen=True)
class LongRest:
    """Arrays over n means: t (s since the capture began), seconds (s that each lasts), rest and
    session (their numbers), temperature or None (degC). values, noise: {sensor: (n, 3) mg or
    deg/s}, {sensor: (n, 3) standard deviation of a mean}. up (3,): the attitude, 0 where no
    accelerometer tells; thermometers: one a session, or None."""

    t: np.ndarray
    seconds: np.ndarray
    rest: np.ndarray
    session: np.ndarray
    temperature: object
    values: dict
    noise: dict
    up: np.ndarray
    thermometers: tuple

    @property
    def n(self):
        return len(self.t)

    @property
    def span_s(self):
        """Seconds at rest of the longest session."""
        return max(float(self.seconds[self.session == k].sum()) for k in np.unique(self.session))

    @property
    def moved_c(self):
        """degC between the coldest and the warmest mean; 0 without a thermometer."""
        return 0.0 if self.temperature is None else float(np.ptp(self.temperature))

    def lagged(self, lag_s):
        """(temperature, its rate) (n,) that a part sees which follows the thermometer, or with a
        negative lag goes before it."""
        c, rate = np.empty(self.n), np.empty(self.n)
        for k, thermometer in enumerate(self.thermometers):
            mine = self.session == k
            c[mine] = thermometer.lagged(self.t[mine], lag_s)
            rate[mine] = thermometer.lagged_rate(self.t[mine], lag_s)
        return c, rate

    def moment(self, lag_s=0.0):
        """moment.Moment of all means, the thermometer lagging behind or not."""
        m = noise_arrays.moment()
        m.t = m.since_move = self.t
        if self.temperature is not None:
            m.temperature, m.temperature_rate = self.lagged(lag_s)
        m.f = m.up = m.before = tuple(np.full(self.n, v) for v in self.up)
        m.session = self.session
        return m


def in_one_attitude(sessions, lines=()):
    """LongRest of blocks.Sessions, or None where nothing rests; lines: (sensor, axis, Hz) of
    sines that are taken off first."""
    runs = _one_attitude([(k, first, end) for k, s in enumerate(sessions)
                          for first, end in _inner(s)], sessions)
    if not runs:
        return None
    sensors = [name for name in ("accel", "gyro")
               if all(getattr(s.capture, name) is not None for s in sessions)]
    total = sum((end - first) / sessions[k].rate for k, first, end in runs)
    length = max(total / MEANS, SHORTEST_S)
    table = _means(runs, sessions, length)
    if len(table) < 2:
        return None
    values, noise = {}, {}
    for sensor in sensors:
        values[sensor], noise[sensor] = _measured(sensor, sessions, runs, table, lines)
    t = np.array([sessions[k].t_s[(a + b) // 2] for k, _, a, b in table])
    number = np.array([k for k, _, _, _ in table])
    seconds = np.array([(b - a) / sessions[k].rate for k, _, a, b in table])
    thermometers = tuple(s.thermometer for s in sessions)
    temperature = None
    if all(thermometer is not None for thermometer in thermometers):
        temperature = np.empty(len(t))
        for k, thermometer in enumerate(thermometers):
            temperature[number == k] = thermometer.at(t[number == k])
    mean = values["accel"].mean(axis=0) if "accel" in values else np.zeros(3)
    return LongRest(t, seconds, np.array([r for _, r, _, _ in table]), number, temperature,
                    values, noise, mean / max(np.linalg.norm(mean), 1e-9), thermometers)


def _inner(session):
    """(first, end) of a session's rests without their edges, and without what may be the end or
    the beginning of a motion that nobody says has ended."""
    edge = int(block_measures.EDGE_S * session.rate)
    stops = edge if session.labelled else int(STOPS_S * session.rate)
    length, inner = len(session.capture), []
    for _, first, end in session.runs:
        # The finder leaves less than a window at the ends of a recording.
        first += edge if first < stops else stops
        end -= edge if end > length - stops else stops
        if end - first >= SHORTEST_REST_S * session.rate:
            inner.append((first, end))
    return inner


def _one_attitude(runs, sessions):
    """The (session, first, end) of runs that lie as the longest one does; all of them where
    nothing tells how they lie."""
    if not runs or any(s.capture.accel is None for s in sessions):
        return runs
    means = np.array([sessions[k].capture.accel[a:b].mean(axis=0) for k, a, b in runs])
    up = means / np.maximum(np.linalg.norm(means, axis=1), 1e-9)[:, None]
    top = max(range(len(runs)), key=lambda i: runs[i][2] - runs[i][1])
    near = np.degrees(np.arccos(np.clip(up @ up[top], -1.0, 1.0))) <= SAME_DEG
    return [run for run, keep in zip(runs, near) if keep]


def _means(runs, sessions, length_s):
    """[(session, rest, first, end)] of every mean."""
    table = []
    for number, (k, first, end) in enumerate(runs):
        m = max(FEWEST_SAMPLES, int(round(length_s * sessions[k].rate)))
        parts = max(1, (end - first) // m)
        edges = np.linspace(first, end, parts + 1).astype(int)
        table += [(k, number, int(a), int(b)) for a, b in zip(edges, edges[1:])]
    return table


def _measured(sensor, sessions, runs, table, lines):
    """((n, 3) means, (n, 3) standard deviations of their noise: white, and what rounding leaves
    in them), session by session."""
    values, noise = np.empty((len(table), 3)), np.empty((len(table), 3))
    for k in {k for k, _, _, _ in table}:
        session, where = sessions[k], [i for i, row in enumerate(table) if row[0] == k]
        first, end = (np.array([table[i][j] for i in where]) for j in (2, 3))
        counts = getattr(session.capture, sensor)
        scale = unit_of_count(session.capture.meta, sensor)
        read = counts.astype(float)
        for axis, hertz in [(axis, hz) for name, axis, hz in lines if name == sensor]:
            for a, b in [(a, b) for number, a, b in runs if number == k]:
                read[a:b, axis] = without_line(read[a:b, axis], session.t_s[a:b], hertz)
        values[where] = scale * np.array([read[a:b].mean(axis=0) for a, b in zip(first, end)])
        white = block_measures.white(read, first, end, session.rate)
        seconds = (end - first)[:, None] / session.rate
        noise[where] = scale * np.sqrt(white ** 2 / seconds
                                       + block_measures.rounding(counts, first, end) ** 2)
    return values, noise


def without_line(x, t, hertz):
    """x (n,) without the sine of a frequency that is known to a fraction of 1 / T: refined to
    the one that takes most off."""
    def left(f):
        angle = 2.0 * np.pi * f * t
        columns = np.stack([np.sin(angle), np.cos(angle), np.ones(len(t)), t], 1)
        size = np.linalg.lstsq(columns, x, rcond=None)[0]
        return x - columns[:, :2] @ size[:2]
    width = 0.5 / max(float(np.ptp(t)), 1e-9)
    tried = [left(hertz + share * width) for share in np.linspace(-1.0, 1.0, 9)]
    return min(tried, key=lambda rest: float(rest.var()))
