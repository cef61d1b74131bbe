"""Where a capture stands still, for those that nobody labelled while they moved on."""
import numpy as np

WINDOW_S, SHORTEST_S = 0.25, 1.0
QUIET = 0.1  # share of the windows whose noise is that of the sensor
LOUDER, SLOW_DPS = 2.5, 1.5


def runs(capture, t_s):
    """[(0, first, end)] of the rests, in samples, of at least SHORTEST_S; none where there is
    no gyro, or where it hardly ever stands still."""
    rate = capture.meta["rate_hz"]
    m = max(4, int(WINDOW_S * rate))
    k = len(t_s) // m
    if capture.gyro is None or k < 8:
        return []
    gyro = capture.gyro[:k * m].reshape(k, m, 3) / capture.meta["gyro_lsb_per_dps"]
    accel = capture.accel[:k * m].reshape(k, m, 3) / capture.meta["accel_lsb_per_g"]
    still = np.ones(k, bool)
    for values, lsb in ((gyro, 1.0 / capture.meta["gyro_lsb_per_dps"]),
                        (accel, 1.0 / capture.meta["accel_lsb_per_g"])):
        spread = np.sqrt(values.var(axis=1).sum(axis=1)) + lsb
        still &= spread < LOUDER * np.quantile(spread, QUIET)
    if not still.any():
        return []
    mean = gyro.mean(axis=1)
    still &= np.linalg.norm(mean - np.median(mean[still], axis=0), axis=1) < SLOW_DPS
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(int), [0]])))
    return [(0, int(a * m), int(b * m)) for a, b in edges.reshape(-1, 2)
            if (b - a) * m >= SHORTEST_S * rate]
