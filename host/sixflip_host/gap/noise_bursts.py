"""Noise that comes in bursts: rests in which some seconds are far louder than the others.

No effect of the library does that, and no touch does it often: it is said where, not what.
"""
import numpy as np

WINDOW_S = 0.5
LOUD = 9.0  # times the usual variance of the differences from sample to sample
FEWEST, FEWEST_RESTS = 4, 3


def loud(session, sensor):
    """(loud windows, rests with one, windows) of a session's rests."""
    counts = getattr(session.capture, sensor)
    m = max(8, int(WINDOW_S * session.rate))
    power, place = [], []
    for number, (_, first, end) in enumerate(session.runs):
        x = np.diff(counts[first:end].astype(float), axis=0)
        k = len(x) // m
        if k:
            power.append((x[:k * m].reshape(k, m, 3) ** 2).mean(axis=1))
            place.append(np.full(k, number))
    if not power:
        return 0, 0, 0
    power, place = np.concatenate(power), np.concatenate(place)
    usual = np.maximum(np.median(power, axis=0), 1.0 / 6.0)  # counts: rounding alone
    high = (power > LOUD * usual).any(axis=1)
    return int(high.sum()), len(np.unique(place[high])), len(high)


def found(sessions):
    """[(sensor, sentence)]"""
    out = []
    for sensor, words in (("accel", "accelerometer"), ("gyro", "gyro")):
        if any(getattr(s.capture, sensor) is None for s in sessions):
            continue
        sums = np.sum([loud(s, sensor) for s in sessions], axis=0)
        if sums[0] >= FEWEST and sums[1] >= FEWEST_RESTS:
            out.append((sensor, "the %s is far louder in %d of %d half seconds at rest: noise "
                        "that comes in bursts" % (words, sums[0], sums[2])))
    return out
