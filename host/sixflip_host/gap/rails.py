"""Samples on a rail, and peaks that are cut off below it."""
import numpy as np

from .counts import RAIL, steps
from .finding import CERTAIN, Finding

FEWEST_RAILED = 1


def saturation(sessions, sensor, columns):
    """Samples on a rail, or many that share the largest value and none near it."""
    value, words = {}, ""
    for i in range(3):
        for session, counts in zip(sessions, columns):
            size = np.abs(counts[:, i].astype(np.int64))
            rail = _range_rail(session, sensor)
            on_rail = int((size >= rail).sum())
            if on_rail >= FEWEST_RAILED:
                value["xyz"[i]] = 1
                words = "%d samples sit on the rail" % on_rail
            elif _plateau(counts[:, i]):
                value["xyz"[i]] = 1
                words = "peaks are cut off at %d counts" % int(size.max())
    if not value:
        return []
    return [Finding("saturation", sensor, sorted(value), value, "1", CERTAIN, "amplitude", words,
                    {k: (v, v) for k, v in value.items()})]


def railed(session, sensor="accel"):
    """(n,) True where a sample sits on a rail or on a level that peaks are cut off at."""
    counts = getattr(session.capture, sensor)
    rail = _range_rail(session, sensor)
    found = np.zeros(len(counts), bool)
    for column in counts.T.astype(np.int64):
        found |= np.abs(column) >= rail
        for sign in (1, -1):
            if _cut_off(sign * column):
                found |= sign * column == (sign * column).max()
    return found


def _range_rail(session, sensor):
    """Count of the rail of the range the header states (accel_range_g, gyro_range_dps)."""
    meta = session.capture.meta
    top, lsb = (("accel_range_g", "accel_lsb_per_g") if sensor == "accel"
                else ("gyro_range_dps", "gyro_lsb_per_dps"))
    if top not in meta:
        return RAIL - 3
    return min(RAIL - 3, int(meta[top] * meta[lsb]) - 4)


def _plateau(column):
    """True when the peaks of either sign are cut off."""
    x = column.astype(np.int64)
    return _cut_off(x) or _cut_off(-x)


def _cut_off(x):
    """True when the largest value is met in runs, and hardly anything lies just inside."""
    top = x.max()
    at = x == top
    if at.all() or np.median(np.abs(np.diff(x[~at]))) == 0:
        return False  # rounded so coarsely that any rest looks cut off
    spread = max(4.0, 3.0 * steps(x[:, None])[0], 0.02 * float(np.ptp(x)))
    inside = ((x < top) & (x > top - spread)).sum()
    runs = int((at[1:] & at[:-1]).sum())
    return bool(at.sum() >= 12 and runs >= 6 and at.sum() > 3 * inside
                and (~at).sum() > at.sum())
