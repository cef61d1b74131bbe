"""The rests of a log: as its labels have them, or where it is calm and its gyro follows no course;
and what a log that never rests says its sensor went through, and its noise.

Of that the gyro carries the attitude, and the vertical is where the specific force lies over some
twenty seconds, or as many as a shorter log has, in the frame that it carries: what moves a thing
averages out, since it does not go ever faster [Mahony et al., IEEE Trans. Autom. Control 53
(2008), 1203, whose filter this is without its delay: past and future alike]. The noise is that of
the quick end of the spectrum.
"""
import numpy as np

from sixflip.poses import faces

from ...capture import find_poses, rests_by_variance
from ...capture import rests as rest_finder
from ...capture.attitude import carried, rotations
from ...experiment.block_measures import EDGE_S
from .. import adequacy
from . import rest_or_course
from .alignment import smooth

SHORTEST_REST_S = 0.5  # of a robot that stops between two moves
WINDOW_S = 0.3  # over which a log is calm: shorter than such a stop with its edges
FEWEST_STILL = 3  # samples of that window: of fewer rows a second it is longer
LEVEL_S, FEWEST = 1.0, 8  # over which the noise is told: s, and samples, of a rest as well
# Times the noise of the quietest tenth up to which a log is calm; deg/s of a turn that is slower
# than any robot's, and more than a gyro's bias changes by within a log (20 deg/s over 60 degC).
LOUDER, SLOW_DPS = 2.5, 1.5
# deg/s of a gyro's bias, standard deviation of what is known before (20 is the limit of an
# MPU-6050, 40 that of an ITG-3200 in their data sheets), and times as much that none is.
BIAS_DPS, NO_BIAS = 10.0, 5.0
# Times the power of the gyro's noise: more shows a turn. Where nothing turns the accelerometer's
# courses tell what rests, a deg/s of a gyro's standing for so many mg: from 1 mg to 300.
TURNS, MG_FOR_DPS = 1.3, 10.0
MOST_SPANS = 1000  # of which the gyro's level is told: each is held against each
COUNT_VARIANCE = 0.25  # counts: a channel that toggles between two of them
UP = np.array([0.0, 0.0, 1.0])  # of the world
# Hz below which the force is the vertical's; the first ones are for a bias of a gyro that turns
# the frame by more than a radian in the period of the last (20 deg/s, ITG-3205 PS). A log that
# is shorter than that has its own length for it.
BANDS, BIAS = (0.4, 0.1, 0.05), np.radians(20.0)
# Of gravity, by which what moves a thing is still there in such a mean: 2 m/s of change in 20 s
# are a hundredth, a drone that leans into a curve has some hundredths.
STRAYS = 0.03
SUSPENDED = 0.5  # of gravity, that the mean of a force must have to be one
# Order of the differences that noise is taken from: of a wave of a tenth of the rate they leave
# (2 sin 18 deg)^8, 2 %, while white noise is as strong in them as anywhere.
ORDER, ORDER_POWER = 4, 70.0  # (its power in them is the binomial of 8 over 4)
BLOCK = 32  # differences whose mean square has errors that are nearly normal
# Squares that count as one, by the correlation of such differences, the sum of its squares; of a
# median's standard error over that of a mean; and the median of a block's mean square, of chi
# squared with BLOCK / ALIKE degrees of freedom, over its mean [Wilson & Hilferty, PNAS 17 (1931)].
ALIKE, MEDIAN_LOSES, MEDIAN_OF_BLOCK = 2.6, 1.25, 0.947
# By how much a white noise may differ from one octave to the next: standard errors, and a share
# besides that lines and rounding make, which is then not told of it either. Means over two to
# sixteen samples, and poles up to 0.4 of the rate, leave pairs a third stronger and more.
FLAT_SIGMAS, UNTOLD = 4.0, 0.1


def of_capture(capture, rate_hz):
    """(rests, the axis of each that a label says is up, (3,) or None, calm stretches) of a
    Capture, spans (first, end) of samples: by the labels that a person gave, else those found
    here: what turns steadily, at 5 deg/s for instance, was labelled a rest when it was imported.
    In a calm stretch a robot drives slowly, as level as to a few degrees, or rests."""
    edge, least = int(EDGE_S * rate_hz), max(FEWEST, int(SHORTEST_REST_S * rate_hz))

    def inside(runs):
        return [run._replace(first=int(run.first + edge), end=int(run.end - edge)) for run in runs
                if run.end - run.first - 2 * edge >= least]

    if find_poses.by_a_person(capture):
        rests = inside(rest_finder.labelled(capture.pose))
        spans = tuple((run.first, run.end) for run in rests)
        return spans, tuple(_up(int(run.code)) for run in rests), spans
    found = calm(capture, rate_hz)
    quiet = inside(found)
    stops = still = [(run.first, run.end) for run in quiet]
    if capture.gyro is not None:
        lsb = capture.meta["gyro_lsb_per_dps"]
        still = rest_or_course.resting(capture.gyro / lsb, still, rate_hz, adequacy.usual(
            capture.meta["sensor"], "gyro"), 1.0 / lsb)
        short = [(run.first, run.end) for run in found if run.end - run.first < least + 2 * edge]
        usual = _level(capture.gyro / lsb, still + short)
        stops, still = (_unturned(capture.gyro / lsb, spans, usual) for spans in (stops, still))
    if still and (capture.gyro is None or _drives_only(capture, quiet)):
        per_g = capture.meta["accel_lsb_per_g"] * MG_FOR_DPS / 1000.0
        still = rest_or_course.resting(capture.accel / per_g, still, rate_hz, adequacy.usual(
            capture.meta["sensor"], "accel") / MG_FOR_DPS, 1.0 / per_g)
    return tuple(still), (None,) * len(still), tuple(stops) if still else ()


def _drives_only(capture, quiet):
    """Whether the gyro reads no more where it is not calm, runs of which are given, than where it
    is: it has no say in what rests. (Where all is calm nothing moves.)"""
    inside = np.zeros(len(capture), bool)
    for run in quiet:
        inside[run.first:run.end] = True
    gyro = capture.gyro.astype(float)
    if min(inside.sum(), (~inside).sum()) < rests_by_variance.WINDOW:
        return False
    noise = np.maximum(gyro[inside].var(axis=0), COUNT_VARIANCE)
    return bool((gyro[~inside].var(axis=0) < TURNS * noise).all())


def _up(code):
    """(3,) the axis that a pose's code says is up, or None."""
    face = faces.face_of_code(code) if code else -1
    return faces.SIGN[face] * np.eye(3)[faces.AXIS[face]] if face >= 0 else None


def _level(rate, spans):
    """(3,) deg/s of the gyro's rate (n, 3) where it stands: what it comes back to for longest in
    spans of calm samples, a stop between two moves as well, weighed by what a bias can be; a robot
    that turns evenly is as calm as one that rests. None where no level can be a bias."""
    if not spans:
        return None
    spans = [spans[k] for k in np.unique(np.linspace(0, len(spans) - 1, MOST_SPANS).astype(int))]
    means, lasts = (np.array(x) for x in zip(*[(rate[a:b].mean(axis=0), b - a) for a, b in spans]))
    alike = np.linalg.norm(means[:, None] - means, axis=2) < SLOW_DPS
    off = np.linalg.norm(means, axis=1) / BIAS_DPS
    best = int((np.log(alike @ lasts) - 0.5 * off ** 2).argmax())
    level = np.median(np.concatenate([rate[a:b] for (a, b), near in zip(spans, alike[best])
                                      if near]), axis=0)
    return level if np.linalg.norm(level) < NO_BIAS * BIAS_DPS else None


def _unturned(rate, spans, usual):
    """Those of the spans in which the gyro's rate (n, 3) stands where it does at rest."""
    return [] if usual is None else [
        (a, b) for a, b in spans if np.linalg.norm(rate[a:b].mean(axis=0) - usual) < SLOW_DPS]


def calm(capture, rate_hz):
    """[rests.Run] in which both sensors are no louder than a few times their quietest tenth (a
    count where they make no noise)."""
    window = max(2 * int(WINDOW_S / 2 * rate_hz) + 1, FEWEST_STILL)
    second = min(max(int(LEVEL_S * rate_hz), FEWEST), rests_by_variance.WINDOW)
    mask = np.ones(len(capture), bool)
    for counts in (capture.accel, capture.gyro):
        if counts is None:
            continue
        if len(counts) <= max(2 * window, second):  # too short to tell
            return []
        counts = counts.astype(float)
        level = max(rests_by_variance.variance_at_rest(counts, window=second), COUNT_VARIANCE)
        here = np.zeros(len(capture), bool)
        for run in rests_by_variance.find(counts, LOUDER ** 2 * level, window, 1):
            here[run.first:run.end] = True
        mask &= here
    return [rest_finder.Run(0, first, end) for first, end in rest_finder.stretches(mask)]


def levelled(t, force, rate, rate_hz, g):
    """(turn (n, 3, 3) body to world, bias (3,) rad/s that is known but about the vertical, speed
    (n, 3) m/s in the body), or None where nothing shows the vertical; force, rate (n, 3)."""
    if len(t) < 2 or (t[-1] - t[0]) * BANDS[0] < 1.0:
        return None
    slowest = max(BANDS[-1], 1.0 / (t[-1] - t[0]))
    bias = np.zeros(3)
    for band in [*(band for band in BANDS if band > slowest), slowest]:
        course = _carried(t, rate - bias)
        bias = bias + _bias(t, course, _vertical(force, course, rate_hz, band)[0], band)
    course = _carried(t, rate - bias)
    vertical, size = _vertical(force, course, rate_hz, slowest)
    if size.min() < SUSPENDED * g:
        return None
    turn = _smallest(vertical) @ course
    return turn, bias, _speed(t, turn, force - g * turn[:, 2, :], rate_hz, slowest)


def _carried(t, rate):
    """(n, 3, 3): attitudes in the frame of the first row, as a gyro carries them."""
    return carried(rotations(0.5 * (rate[1:] + rate[:-1]) * np.diff(t)[:, None]))


def _vertical(force, course, rate_hz, band):
    """((n, 3) unit vectors against gravity in that frame, which a wrong bias lets wander; (n,)
    m/s2 how large the mean force is)."""
    slow = _slow(np.einsum("nij,nj->ni", course, force), rate_hz, band)
    size = np.linalg.norm(slow, axis=1)
    return slow / np.maximum(size, 1e-12)[:, None], size


def _bias(t, course, vertical, band):
    """(3,) rad/s of the gyro that makes the vertical wander as it does; what stays along it all
    the time does not show, and keeps its prior's nothing."""
    x, y, z = vertical.T
    zero = np.zeros(len(x))
    across = np.stack([np.stack([zero, z, -y], 1), np.stack([-z, zero, x], 1),
                       np.stack([y, -x, zero], 1)], 1)
    pull = across @ course
    steps = 0.5 * (pull[1:] + pull[:-1]) * np.diff(t)[:, None, None]
    wandered = np.concatenate([np.zeros((1, 3, 3)), np.cumsum(steps, axis=0)])
    columns = _slow(wandered.reshape(-1, 9), (len(t) - 1) / (t[-1] - t[0]), band).reshape(-1, 3, 3)
    columns = (columns - columns.mean(axis=0)).reshape(-1, 3)
    off = (vertical - vertical.mean(axis=0)).ravel()
    found, number = np.zeros(3), min(1.0, 2.0 * band * (t[-1] - t[0]) / len(vertical))
    for _ in range(3):
        # Two values a period of the band are independent, and err by what is left of them.
        weight = number / max(STRAYS ** 2, 3.0 * np.mean((off - columns @ found) ** 2))
        found = np.linalg.solve(weight * columns.T @ columns + np.eye(3) / BIAS ** 2,
                                weight * columns.T @ off)
    return found


def _smallest(vertical):
    """(n, 3, 3): the smallest rotations that take unit vectors (n, 3) to the world's vertical."""
    axis = np.cross(vertical, UP)
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, vertical[:, 2])
    return rotations(axis / np.maximum(sine, 1e-12)[:, None] * angle[:, None])


def _speed(t, turn, moved, rate_hz, band):
    """(n, 3) m/s in the body: the integral of what moves it, less what is slower than a band."""
    world = np.einsum("nij,nj->ni", turn, moved)
    steps = 0.5 * (world[1:] + world[:-1]) * np.diff(t)[:, None]
    total = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    return np.einsum("nji,nj->ni", turn, total - _slow(total, rate_hz, band))


def _slow(values, rate_hz, slow_hz):
    """(n, k): what is slower than that of values (n, k), whose ends are mirrored: by themselves
    the first and the last reading would say what is there on average."""
    wide = min(len(values) - 1, int(rate_hz / slow_hz))
    longer = np.pad(values, ((wide, wide), (0, 0)), "reflect")
    return smooth(longer, rate_hz, slow_hz)[wide:len(longer) - wide]


def white(values):
    """((3,) standard deviation of a sample's white noise, its relative standard error) of values
    (n, 3) that move all the time, or None where pairs of them are not as strong as they are: then
    either is motion, or the noise has a colour, and what it is lower down is not known."""
    if len(values) < 16 * BLOCK:
        return None
    levels, errors = [], []
    for wide in (1, 2):
        means = values[:len(values) // wide * wide].reshape(-1, wide, 3).mean(axis=1)
        squares = wide * np.diff(means, ORDER, axis=0) ** 2 / ORDER_POWER
        number = len(squares) // BLOCK
        # By the median of blocks: what is jolted now and then is not the noise.
        levels.append(np.median(squares[:number * BLOCK].reshape(number, BLOCK, 3).mean(axis=1),
                                axis=0) / MEDIAN_OF_BLOCK)
        errors.append(MEDIAN_LOSES * np.sqrt(2.0 * ALIKE / len(squares)))
    ratio = np.maximum(levels[0], 1e-30) / np.maximum(levels[1], 1e-30)
    if (np.abs(np.log(ratio)) > 2.0 * UNTOLD + FLAT_SIGMAS * np.hypot(*errors)).any():
        return None
    return np.sqrt(levels[0]), float(np.hypot(0.5 * errors[0], UNTOLD))
