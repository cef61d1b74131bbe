"""A capture reduced to what the gap is looked for in: means over parts of each rest.

The unit of replication is the placement, never the sample. A placement is cut into a few
blocks so that what fades within it (creep) or wanders (flicker) shows between them.
"""
import numpy as np

from sixflip import faces, pose_codes
from sixflip_sim.effects.moment import Moment

from ..simulating import noise_arrays, pose_runs
from ..solving.find_poses import HELD_BY_HAND
from . import thermometer
from .counts import steps

EDGE_S = 0.1  # left out at both ends of a rest: a label is never exact
BLOCK_S, MOST_BLOCKS = 2.5, 6
SHORT_REST_BLOCKS = 2
LONG_REST_S = 12.0
SUBMEAN_S = 0.25  # white noise is judged on means this long, so that a filter's colour is in it
SHORTEST_S = 0.8
PLAY_S = 0.1  # step at which hysteresis follows the way
MOST_BAD = 0.005  # share of a rest's samples
FAR_OFF_DEG = 25.0  # a label that gravity contradicts


class Session:
    """One capture as blocks, arrays over n blocks.

    name; rate (Hz); accel (n, 3) mg and gyro (n, 3) deg/s or None as the chip gave them; t,
    seconds, since (s since the move); temperature, temperature_rate or None;
    placement (number), code, face (-1: leaning); vibration (n,) mg rms above the quietest;
    noise_accel, noise_gyro (3,): of a mean over one second, mg and deg/s;
    rounding_accel, rounding_gyro (3,): of the mean of a rest, by steps of the counts.
    """

    def __init__(self, name, capture):
        self.name, self.capture = name, capture
        self.rate = float(capture.meta["rate_hz"])
        self.t_s = (capture.t_us - capture.t_us[0]) * 1e-6
        self.timeless = len(capture) > 1 and self.t_s[-1] <= 0.0
        if self.timeless:
            self.t_s = np.arange(len(capture)) / self.rate
        self.labelled = capture.pose is not None and bool((capture.pose > 0).any())
        if not self.labelled:
            _label(capture)
        unsteady = {pose_codes.pose_code(name) for name in capture.meta.get(HELD_BY_HAND, ())}
        self.runs = [r for r in pose_runs.runs(capture.pose)
                     if r[2] - r[1] >= max(8, SHORTEST_S * self.rate) and r[0] not in unsteady]
        self.thermometer = thermometer.of(capture, self.t_s)
        self._blocks()

    def _blocks(self):
        columns = []
        for placement, (code, first, end) in enumerate(self.runs):
            edge = int(EDGE_S * self.rate)
            columns += [(placement, code, a, b) for a, b in blocks(first + edge, end - edge,
                                                                   self.rate)]
        self.n = len(columns)
        table = np.array(columns, dtype=np.int64).reshape(self.n, 4)
        self.placement, self.code, self.first, self.end = table.T
        # Where nobody labelled, a face is a guess, and only the length of gravity is used.
        self.face = np.array([faces.face_of_code(int(c)) if self.labelled else -1
                              for c in self.code], dtype=int)
        meta = self.capture.meta
        self.accel = self._means(self.capture.accel) * (1000.0 / meta["accel_lsb_per_g"])
        self.gyro = None
        if self.capture.gyro is not None:
            self.gyro = self._means(self.capture.gyro) / meta["gyro_lsb_per_dps"]
        if not self.n:
            return
        middle = (self.first + self.end) // 2
        self.t = self.t_s[middle]
        starts = np.array([self.t_s[run[1]] for run in self.runs])
        self.since = self.t - starts[self.placement]
        self.seconds = (self.end - self.first) / self.rate
        self.temperature = self.temperature_rate = None
        if self.thermometer is not None:
            self.temperature = self.thermometer.at(self.t)
            self.temperature_rate = self.thermometer.rate_at(self.t)
        self.noise_accel = self._white(self.capture.accel) * (1000.0 / meta["accel_lsb_per_g"])
        if self.gyro is not None:
            self.noise_gyro = self._white(self.capture.gyro) / meta["gyro_lsb_per_dps"]
        self.rounding_accel = self._rounding(self.capture.accel) * (
            1000.0 / meta["accel_lsb_per_g"])
        if self.gyro is not None:
            self.rounding_gyro = self._rounding(self.capture.gyro) / meta["gyro_lsb_per_dps"]
        self.vibration = self._vibration()

    def _rounding(self, counts):
        """Counts (3,): standard deviation of what rounding to steps leaves in the mean of a
        rest. Noise much wider than a step averages it out: the k-th harmonic of the rounding
        error, step / (pi k), is damped by exp(-2 pi^2 k^2 (noise / step)^2) [Widrow & Kollar,
        Quantization Noise (2008), chapter 5]."""
        step = steps(counts)
        rests = np.concatenate([np.diff(counts[a:b].astype(float), axis=0)
                                for a, b in zip(self.first, self.end)])
        noise = np.sqrt(np.maximum(rests.var(axis=0) / 2.0 - step ** 2 / 12.0, 0.0))
        k = np.arange(1, 9)[:, None]
        harmonics = step / (np.pi * k) * np.exp(-2.0 * (np.pi * k * noise / step) ** 2)
        return np.sqrt((harmonics ** 2).sum(axis=0) / 2.0)

    def leave_out(self, bad):
        """Leave out the placements with more than a few bad samples; bad (N,) of samples."""
        self.runs = [run for run in self.runs if bad[run[1]:run[2]].mean() <= MOST_BAD]
        self._blocks()

    def _means(self, counts):
        return np.array([counts[a:b].mean(axis=0) for a, b in zip(self.first, self.end)]
                        ).reshape(self.n, 3)

    def _white(self, counts):
        """Counts (3,): standard deviation of a mean over one second, from the differences of
        neighbouring short means (slow changes are not in it)."""
        m = max(1, int(SUBMEAN_S * self.rate))
        squares, number = np.zeros(3), 0
        for a, b in zip(self.first, self.end):
            k = (b - a) // m
            if k < 2:
                continue
            short = counts[a:a + k * m].astype(float).reshape(k, m, 3).mean(axis=1)
            squares += (np.diff(short, axis=0) ** 2).sum(axis=0)
            number += k - 1
        if not number:
            return counts[self.first[0]:self.end[0]].std(axis=0) / np.sqrt(self.rate)
        floor = 1.0 / np.sqrt(12.0 * self.rate)  # of counting: rounding is noise, too
        return np.maximum(np.sqrt(squares / number / 2.0 * m / self.rate), floor)

    def _vibration(self):
        """mg rms above the quietest tenth of the blocks; zero where nothing stands out."""
        scale = 1000.0 / self.capture.meta["accel_lsb_per_g"]
        power = np.array([np.diff(self.capture.accel[a:b].astype(float), axis=0).var(axis=0).sum()
                          / 2.0 for a, b in zip(self.first, self.end)])
        quiet = np.quantile(power, 0.1)
        excess = np.where(power > 2.0 * quiet, power - quiet, 0.0)
        return np.sqrt(excess) * scale

    def refuse(self, labels):
        """Leave out the placements with these labels."""
        codes = {pose_codes.pose_code(label) for label in labels}
        self.runs = [run for run in self.runs if run[0] not in codes]
        self._blocks()

    @property
    def leaning(self):
        return self.face < 0

    def placements(self):
        return len(self.runs)

    def before(self, up):
        """(n, 3): up of the placement before each block's, its own at the first."""
        index = np.maximum(self.placement - 1, 0)
        return up[index]

    def remembered(self, up, tau_s):
        """(n, 3): where something that follows the attitude with a time constant stands when
        each block's placement begins; settled at the first."""
        starts = np.array([self.t_s[run[1]] for run in self.runs])
        state = np.array(up[:len(starts)], float)
        for k in range(1, len(starts)):
            fade = np.exp(-(starts[k] - starts[k - 1]) / tau_s)
            state[k] = up[k - 1] + (state[k - 1] - up[k - 1]) * fade
        return state[self.placement]

    def played(self, widths_g):
        """[(n, 3)] a width: how far a play operator of that width (g) lags behind the specific
        force of each axis, over the whole way that the box was taken, -1 to 1 [Krejci,
        Hysteresis, Convexity and Dissipation in Hyperbolic Equations (1996), chapter II]."""
        step = max(1, int(PLAY_S * self.rate))
        counts = self.capture.accel[:len(self.capture.accel) // step * step]
        f = counts.reshape(-1, step, 3).mean(axis=1) / self.capture.meta["accel_lsb_per_g"]
        width = np.array(widths_g)[:, None]
        state, behind = np.repeat(f[:1], len(widths_g), axis=0), np.empty(
            (len(f), len(widths_g), 3))
        for k, now in enumerate(f):
            state = np.minimum(np.maximum(state, now - width), now + width)
            behind[k] = (state - now) / width
        middle = np.minimum((self.first + self.end) // 2 // step, len(f) - 1)
        return [behind[middle, k] for k in range(len(widths_g))]

    def moment(self, up, number=0):
        """moment.Moment of all blocks; up (placements, 3): unit vectors against gravity."""
        m = Moment(np.exp, np.sin, np.floor, noise_arrays.gauss)
        m.t, m.since_move, m.face = self.t, self.since, self.face
        m.temperature = np.full(self.n, 25.0) if self.temperature is None else self.temperature
        m.temperature_rate = np.zeros(self.n) if self.temperature is None \
            else self.temperature_rate
        m.f = m.up = tuple(up[self.placement].T)
        m.before = tuple(self.before(up).T)
        still = np.zeros(self.n)
        m.w = m.w_rate = (still, still, still)
        m.session = np.full(self.n, number)
        m.vibration_mg = self.vibration
        return m

    def contradicted(self):
        """Names of labels that gravity contradicts: [(label, degrees off), ...]."""
        found = {}
        for code, first, end in self.runs:
            face = faces.face_of_code(code)
            if face < 0:
                continue
            mean = self.capture.accel[first:end].mean(axis=0)
            cosine = faces.SIGN[face] * mean[faces.AXIS[face]] / max(np.linalg.norm(mean), 1e-9)
            off = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
            if off > FAR_OFF_DEG:
                found[faces.pose_name(code)] = off
        return sorted(found.items())

    def part(self, placements):
        """The same session with some of its placements only."""
        other = object.__new__(Session)
        other.__dict__.update(self.__dict__)
        other.__dict__.pop("turns", None)  # a part turns between its own placements only
        keep = np.isin(self.placement, list(placements))
        for name, value in self.__dict__.items():
            if isinstance(value, np.ndarray) and len(value) == self.n and name not in (
                    "t_s", "noise_accel", "noise_gyro", "rounding_accel", "rounding_gyro"):
                setattr(other, name, value[keep])
        other.n = int(keep.sum())
        return other


def blocks(first, end, rate):
    """[(first, end)] of the blocks of a rest."""
    seconds = (end - first) / rate
    if seconds < 1.6:
        number = 1
    elif seconds <= LONG_REST_S:
        number = SHORT_REST_BLOCKS
    else:
        number = int(min(MOST_BLOCKS, max(SHORT_REST_BLOCKS, seconds // BLOCK_S)))
    edges = np.linspace(first, end, number + 1).astype(int)
    return list(zip(edges[:-1].tolist(), edges[1:].tolist()))


def _label(capture):
    """Poses found where nobody labelled any."""
    from ..solving.find_poses import find_poses
    try:
        find_poses(capture).label(capture)
    except (ValueError, IndexError, ZeroDivisionError):
        capture.pose = np.zeros(len(capture), np.int16)


def distinct(sessions):
    """(sessions without those that repeat one before them, the repeated ones)."""
    kept, again = [], []
    for session in sessions:
        same = any(len(session.capture) == len(other.capture)
                   and np.array_equal(session.capture.accel, other.capture.accel)
                   and np.array_equal(session.capture.t_us, other.capture.t_us)
                   for other in kept)
        (again if same else kept).append(session)
    return kept, again


def same_chip(sessions):
    """(those of the first one's sensor, the others): different chips have different causes.
    Different ranges of one chip do not matter: everything is in mg and deg/s."""
    chip = sessions[0].capture.meta["sensor"]
    return ([s for s in sessions if s.capture.meta["sensor"] == chip],
            [s for s in sessions if s.capture.meta["sensor"] != chip])
