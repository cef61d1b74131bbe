"""A capture as its samples at rest: what they should read, and what else was going on."""

import numpy as np

from sixflip.poses import faces

EDGE_S, SHORTEST_S, SMOOTH_S = 0.1, 0.8, 5.0
BLOCK_S = 2.5
FACES = 12  # pose codes 1..12 lie on a face, all others lean


class Rest:
    """One placement: code, up (3,) unit vector against gravity; over its n samples accel (n, 3)
    mg, gyro (n, 3) deg/s or None, t (s), since (s since it began), temperature and rate (degC,
    degC/s, or None); before (3,): up of the placement before; shaken: mg rms."""


class Session:
    """rests (list of Rest); calibration: matrix (3, 3) and bias (3,) mg of the accelerometer,
    least squares over the faces. ValueError when its poses are too few for that."""

    def __init__(self, capture):
        self.rests = list(_rests(capture))
        self._calibrate()

    def _calibrate(self):
        on_face = [r for r in self.rests if r.code <= FACES]
        design = np.array([np.append(r.up, 1.0) for r in on_face]).reshape(-1, 4)
        if np.linalg.matrix_rank(design) < 4:
            raise ValueError("the poses are too few to calibrate on")
        means = np.array([r.accel.mean(axis=0) for r in on_face])
        found = np.linalg.lstsq(design, means, rcond=None)[0]
        self.matrix, self.bias = found[:3].T, found[3]
        before = None
        for rest in self.rests:
            rest.true = np.linalg.solve(self.matrix, (rest.accel - self.bias).T).T * 1000.0
            if rest.code > FACES:
                mean = rest.true.mean(axis=0)
                rest.up = mean / np.linalg.norm(mean)
            rest.before = rest.up if before is None else before
            before = rest.up


def _rests(capture):
    """Every unbroken run of a label, its edges left out."""
    if capture.pose is None:
        return
    rate = float(capture.meta["rate_hz"])
    t = (capture.t_us - capture.t_us[0]) * 1e-6
    temperature = _temperature(capture, rate)
    change = np.flatnonzero(np.diff(capture.pose)) + 1
    edge = int(EDGE_S * rate)
    for first, end in zip(np.append(0, change), np.append(change, len(capture))):
        code = int(capture.pose[first])
        inside = slice(first + edge, end - edge)
        if code == 0 or end - first - 2 * edge < SHORTEST_S * rate:
            continue
        rest = Rest()
        rest.code, rest.up = code, _up(code)
        rest.t, rest.since = t[inside], t[inside] - t[first]
        rest.accel = capture.accel[inside] * (1000.0 / capture.meta["accel_lsb_per_g"])
        rest.gyro = None if capture.gyro is None \
            else capture.gyro[inside] / capture.meta["gyro_lsb_per_dps"]
        rest.temperature = rest.rate = None
        if temperature is not None:
            rest.temperature = temperature[inside]
            rest.rate = np.gradient(temperature, t)[inside]
        rest.shaken = float(np.diff(rest.accel, axis=0).std() / np.sqrt(2.0))
        yield rest


def _up(code):
    up = np.zeros(3)
    if code <= FACES:
        face = faces.face_of_code(code)
        up[faces.AXIS[face]] = faces.SIGN[face]
    return up


def _temperature(capture, rate):
    """Running mean (n,) in degC, None where there is no thermometer or it stands still."""
    if capture.temp is None or np.ptp(capture.temp) == 0:
        return None
    celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
    m = min(max(1, int(SMOOTH_S * rate)), len(celsius))
    total = np.cumsum(np.concatenate([[0.0], celsius]))
    index = np.arange(len(celsius))
    low, high = np.maximum(index - m // 2, 0), np.minimum(index + m // 2 + 1, len(celsius))
    return (total[high] - total[low]) / (high - low)


def sessions(captures):
    """list of Session; one capture with 24 placements or more is halved, so that there is
    something to hold out."""
    found = [Session(c) for c in captures]
    if len(found) > 1 or len(found[0].rests) < 2 * FACES:
        return found
    half = len(found[0].rests) // 2
    parts = []
    for rests in (found[0].rests[:half], found[0].rests[half:]):
        part = object.__new__(Session)
        part.__dict__.update(found[0].__dict__, rests=rests)
        parts.append(part)
    return parts
