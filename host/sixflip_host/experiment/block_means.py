"""Rests cut into blocks, and what is measured of each: means, times, temperatures, noise."""
import numpy as np

from sixflip.poses import faces

from . import block_noise

EDGE_S = 0.1  # left out at both ends of a rest: a label is never exact
# Two blocks tell what fades within a rest, of which the fastest creep (terms.CREEP_S, 5 s) needs
# one each half of its time. All blocks of a rest are in one matrix (covariance.Group): a minute's
# rest has no more than six, and a rest as short as a protocol's no more than two.
BLOCK_S, MOST_BLOCKS = 2.5, 6
SHORT_REST_BLOCKS = 2
LONG_REST_S = 12.0


def of_runs(capture, runs, rate, t_s, labelled, smooth):
    """{field: array} of the blocks of these runs."""
    cut = []
    for placement, (code, first, end) in enumerate(runs):
        edge = min(int(EDGE_S * rate), (end - first) // 4)
        cut += [(placement, code, a, b) for a, b in cut_rest(first + edge, end - edge, rate)]
    placement, code, first, end = np.array(cut, dtype=np.int64).reshape(len(cut), 4).T.copy()
    t = t_s[(first + end) // 2]
    starts = np.array([t_s[run.first] for run in runs])
    # Where nobody labelled, a face is a guess, and only the length of gravity is used.
    face = np.array([faces.face_of_code(int(c)) if labelled else -1 for c in code], dtype=int)
    accel, gyro = readings(capture, first, end)
    found = {"placement": placement, "code": code, "first": first, "end": end, "face": face,
             "t": t, "since": t - starts[placement] if len(cut) else t,
             "seconds": (end - first) / rate, "accel": accel, "gyro": gyro,
             "temperature": smooth.at(t) if smooth else None,
             "temperature_rate": smooth.rate_at(t) if smooth else None,
             "vibration": np.zeros(len(cut)) if capture.accel is None
             else block_noise.vibration(capture, first, end), "noise_accel": None,
             "noise_gyro": None, "rounding_accel": None, "rounding_gyro": None}
    for sensor, counts, scale in _sensors(capture) if len(cut) else ():
        found["noise_" + sensor] = block_noise.white(counts, first, end, rate) * scale
        found["rounding_" + sensor] = block_noise.rounding(counts, first, end) * scale
    return found


def _sensors(capture):
    """[(name, counts, mg or deg/s a count)] of the sensors that there are."""
    meta, found = capture.meta, []
    if capture.accel is not None:
        found.append(("accel", capture.accel, 1000.0 / meta["accel_lsb_per_g"]))
    if capture.gyro is not None:
        found.append(("gyro", capture.gyro, 1.0 / meta["gyro_lsb_per_dps"]))
    return found


def readings(capture, first, end):
    """((n, 3) mg, (n, 3) deg/s): means of the blocks; None of a sensor that there is not."""
    found = dict.fromkeys(("accel", "gyro"))
    for sensor, counts, scale in _sensors(capture):
        found[sensor] = _means(counts, first, end) * scale
    return found["accel"], found["gyro"]


def _means(counts, first, end):
    return np.array([counts[a:b].mean(axis=0) for a, b in zip(first, end)]).reshape(-1, 3)


def cut_rest(first, end, rate):
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
