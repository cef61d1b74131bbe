"""The rests of a log: as its labels have them, or where it is calm and its gyro follows no course.
"""
import numpy as np

from sixflip.poses import faces

from ...capture import rests as rest_finder
from ...capture import rests_by_variance
from ...experiment.block_measures import EDGE_S
from .. import adequacy
from . import rest_or_course

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


def of_capture(capture, rate_hz):
    """(rests, the axis of each that a label says is up, (3,) or None, calm stretches) of a
    Capture, spans (first, end) of samples: by the labels where there are any, else those found.
    In a calm stretch a robot drives slowly, as level as to a few degrees, or rests."""
    edge, least = int(EDGE_S * rate_hz), max(FEWEST, int(SHORTEST_REST_S * rate_hz))

    def inside(runs):
        return [run._replace(first=int(run.first + edge), end=int(run.end - edge)) for run in runs
                if run.end - run.first - 2 * edge >= least]

    if capture.pose is not None and (capture.pose > 0).any():
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
