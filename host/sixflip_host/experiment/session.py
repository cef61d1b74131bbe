"""One capture as a value: its blocks (parts of the rests) with what was measured of each.

The unit of replication is the placement, never the sample. A placement is cut into a few blocks so
that what fades within it (creep) or wanders (flicker) shows between them. A part of a session, or
one without some of its rests, is another Session: nothing is changed in place.
"""
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sixflip.poses import faces

from ..capture import clock
from ..capture.capture_file import Capture
from . import block_measures, noise_arrays, thermometer, way_memory

# Share of bad samples up to which a rest is kept: two of a protocol's rest of 500. What they add
# to its mean is then at most that share of what is wrong with them.
MOST_BAD = 0.005
# Intervals taken together; stamps by which their scatter is known to a tenth; share of an interval
# that no turn shows: at 180 deg/s fifty of 10 ms are off by an eighth of a degree at most.
STEPS, FEWEST_STAMPS, EVEN = 16, 1600, 0.01
# By how much gravity changes along two axes or more between rests that nobody labelled, of which
# two are more than a right angle apart: a box that is turned over shows 1 g or 2. A robot on
# slopes of 30 degrees does not turn over: it tells no scale from a bias, and what its body does at
# rest not from what its sensors do.
TURNED_MG = 500.0
FAR_OFF_DEG = 25.0  # a label that gravity contradicts: a table does not lean by half of that
USUAL_C = 25.0  # temperature where no thermometer tells it: of the effects' own reference
OF_BLOCKS = ("placement", "code", "first", "end", "face", "t", "since", "seconds", "accel", "gyro",
             "temperature", "temperature_rate", "loudness", "vibration")


class ReadOnlyArrays:
    """Base of a frozen dataclass whose arrays are made read-only as it is made: what one of its
    readers wrote, all others would read."""

    def __post_init__(self):
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)


@dataclass(frozen=True, eq=False)
class Session(ReadOnlyArrays):
    """One capture as n blocks; arrays are read only.

    name; capture, labelled; rate (Hz); t_s (N,) s of every sample; timeless: the timestamps
    stand still; labelled: by whoever captured it; runs: tuple of rests.Run, the placements;
    thermometer or None; way: None without samples. Of the blocks (n,): placement (its run), code,
    face (-1: leaning), first, end (samples), t and since (s, since the capture's and the rest's
    begin), seconds; accel (n, 3) mg and gyro (n, 3) deg/s as the chip gave them, None of a sensor
    that there is not; temperature and temperature_rate or None; loudness mg rms from sample to
    sample. Of the sensor (3,):
    noise_accel, noise_gyro of a mean over one second, mg and deg/s; rounding_accel,
    rounding_gyro of the mean of a rest, by steps of the counts; None without a gyro.
    thermal, fastest (degC/s), vibration (n,) mg rms, shaken_mg: what sessions that are judged
    together agreed to look for, see terms; number, of: which it is of how many of them.
    """

    name: str
    capture: Capture
    rate: float
    t_s: np.ndarray
    timeless: bool
    labelled: bool
    runs: tuple
    thermometer: thermometer.Thermometer | None
    way: way_memory.Way | None
    placement: np.ndarray
    code: np.ndarray
    first: np.ndarray
    end: np.ndarray
    face: np.ndarray
    t: np.ndarray
    since: np.ndarray
    seconds: np.ndarray
    accel: np.ndarray
    gyro: np.ndarray | None
    temperature: np.ndarray | None
    temperature_rate: np.ndarray | None
    loudness: np.ndarray
    noise_accel: np.ndarray | None
    noise_gyro: np.ndarray | None
    rounding_accel: np.ndarray | None
    rounding_gyro: np.ndarray | None
    thermal: bool = False
    fastest: float = 0.0
    vibration: np.ndarray | None = None
    shaken_mg: float = 0.0
    number: int = 0
    of: int = 1

    @property
    def n(self):
        return len(self.placement)

    def placements(self):
        return len(self.runs)

    def part(self, placements):
        """The same session with the blocks of some of its placements only."""
        keep = np.isin(self.placement, list(placements))
        values = {name: getattr(self, name) for name in OF_BLOCKS}
        return replace(self, **{name: value if value is None else value[keep]
                                for name, value in values.items()})

    def rest_means(self, values):
        """(placements, k): values (n, k) of the blocks, averaged over each placement."""
        weight = np.bincount(self.placement, self.seconds, self.placements())
        sums = [np.bincount(self.placement, self.seconds * column, self.placements())
                for column in values.T]
        return np.stack(sums, axis=1) / weight[:, None]

    def without_poses(self, labels):
        """The same session without the placements with these labels."""
        codes = {faces.pose_code(label) for label in labels}
        return self.of_runs([run for run in self.runs if run.code not in codes])

    @property
    def turned_over(self):
        """Whether gravity is felt along two axes, now more and now less, and to both sides, as a
        box turned over feels it and a robot does not."""
        if self.accel is None or not len(self.accel):
            return False
        ends = self.accel[[*self.accel.argmin(axis=0), *self.accel.argmax(axis=0)]]
        spans = np.sort(ends[3:].max(axis=0) - ends[:3].min(axis=0))
        return bool(spans[1] >= TURNED_MG and (self.accel @ ends.T).min() < 0.0)

    @cached_property
    def at_rest(self):
        """(samples,) which samples are in one of the rests."""
        resting = np.zeros(len(self.capture), bool)
        for run in self.runs:
            resting[run.first:run.end] = True
        return resting

    @cached_property
    def period_s(self):
        """Seconds between two samples, by the clock where it runs."""
        measured = None if self.timeless else clock.sample_clock(self.capture)
        return 1.0 / (measured.rate_hz if measured else self.rate)

    @cached_property
    def uneven(self):
        """Whether the samples themselves came at uneven times: then the time that several take
        scatters as the root of their number, and by no more than that of one where only the stamps
        do [the variance ratio of Lo & MacKinlay, Review of Financial Studies 1 (1988) 41]. Its
        scatter is that of the middle of them, without pauses."""
        if self.timeless or len(self.t_s) < FEWEST_STAMPS:
            return False
        single, several = (float(np.subtract(*np.quantile(
            self.t_s[k:] - self.t_s[:-k], (0.84, 0.16)))) for k in (1, STEPS))
        return single > EVEN * self.period_s and several ** 2 > 0.5 * STEPS * single ** 2

    def without_samples(self, bad):
        """The same session without the placements with more than a few bad samples; bad (N,)."""
        return self.of_runs([r for r in self.runs if bad[r.first:r.end].mean() <= MOST_BAD])

    def of_runs(self, runs):
        """The same session with other rests."""
        return replace(self, runs=tuple(runs), **block_measures.of_runs(
            self.capture, tuple(runs), self.rate, self.t_s, self.labelled, self.thermometer))

    def of_capture(self, capture):
        """The same rests of another capture of the same samples, measured anew."""
        return self._reading(capture).of_runs(self.runs)

    def reading(self, capture):
        """The same blocks and noise with the means of another capture of the same samples."""
        accel, gyro = block_measures.readings(capture, self.first, self.end)
        return replace(self._reading(capture), accel=accel, gyro=gyro)

    def _reading(self, capture):
        return replace(self, capture=capture, way=way_memory.Way(capture, self.rate, self.t_s))

    def with_gyro_axes(self, read):
        """The same session with its gyro's means turned by a signed permutation (3, 3)."""
        return replace(self, gyro=self.gyro @ read, noise_gyro=self.noise_gyro @ np.abs(read),
                       rounding_gyro=self.rounding_gyro @ np.abs(read))

    def before(self, up):
        """(n, 3): up of the placement before each block's, its own at the first."""
        index = np.maximum(self.placement - 1, 0)
        return up[index]

    def remembered(self, up, tau_s):
        """(n, 3): where something that follows the attitude with a time constant stands when
        each block's placement begins; settled at the first."""
        starts = np.array([self.t_s[run[1]] for run in self.runs])
        return fading(starts, up, tau_s)[self.placement]

    @property
    def friction(self):
        """(n, len(FRICTION), 3): how far what rubs lags behind the specific force of each axis in
        the middle of each block."""
        return self._halfway(self.way.friction)

    @property
    def turned(self):
        """(n, len(way_memory.TURNED_S), 3): quarter turns about each axis that are not yet
        forgotten in the middle of each block, as the gyro tells them."""
        return self._halfway(self.way.turned)

    def _halfway(self, values):
        """(n, ...) of values (steps, ...) along the way in the middle of each block; read-only."""
        halfway = values[np.minimum((self.first + self.end) // 2 // self.way.step,
                                    len(values) - 1)]
        halfway.setflags(write=False)
        return halfway

    def moment(self, up, number=0):
        """moment.Moment of all blocks; up (placements, 3): unit vectors against gravity."""
        m = noise_arrays.moment()
        m.t, m.since_move, m.face = self.t, self.since, self.face
        m.temperature = np.full(self.n, USUAL_C) if self.temperature is None else self.temperature
        m.temperature_rate = np.zeros(self.n) if self.temperature is None \
            else self.temperature_rate
        m.f = m.up = tuple(up[self.placement].T)
        m.before = tuple(self.before(up).T)
        still = np.zeros(self.n)
        m.w = m.w_rate = (still, still, still)
        m.session = np.full(self.n, number)
        m.vibration_mg = still if self.vibration is None else self.vibration
        return m

    def contradicted(self):
        """Names of labels that gravity contradicts: [(label, degrees off), ...]."""
        degrees = {}
        for place, (code, _, _) in enumerate(self.runs):
            face, mine = faces.face_of_code(code), self.placement == place
            if face < 0 or not mine.any():
                continue
            mean = self.accel[mine].mean(axis=0)
            cosine = faces.SIGN[face] * mean[faces.AXIS[face]] / max(np.linalg.norm(mean), 1e-9)
            off = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
            if off > FAR_OFF_DEG:
                degrees[faces.pose_name(code)] = off
        return sorted(degrees.items())


def fading(starts, up, tau_s):
    """(placements, 3): where something that follows the attitude up (placements, 3) with a time
    constant stands when each placement begins, starts (placements,) s; settled at the first."""
    state = np.array(up[:len(starts)], float)
    for k in range(1, len(starts)):
        fade = np.exp(-(starts[k] - starts[k - 1]) / tau_s)
        state[k] = up[k - 1] + (state[k - 1] - up[k - 1]) * fade
    return state
