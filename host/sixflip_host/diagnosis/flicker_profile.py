"""How much a sensor wanders, with its interval, by the profile of the likelihood over flicker."""
import numpy as np

from . import evidence

HALF_OF_90 = 1.353  # nats below the maximum at the ends of a 90 % interval: half of chi2(0.9, 1)


def by_flicker(unit, statistics, shared, level):
    """(F,) largest log likelihood of a unit at each of its flicker levels, smallest first."""
    flickers = np.array([pair[1] for pair in unit.grid])
    found = []
    for value in np.unique(flickers):
        points = np.flatnonzero(flickers == value)
        one = evidence.fit(unit, statistics, shared, evidence.NONE, level, points)
        found.append(one.evidence[0])
    return np.array(found)


def profile(levels, course):
    """(likeliest level, low, high) of a 90 % interval from the log likelihoods at increasing
    levels, a parabola in the logarithm of the level through the three highest neighbours."""
    x = np.log(np.asarray(levels))
    k = int(np.clip(course.argmax(), 1, len(x) - 2))
    bend, slope, _ = np.polyfit(x[k - 1:k + 2] - x[k], course[k - 1:k + 2] - course[k], 2)
    if bend >= 0.0:
        return float(levels[k]), float(levels[0]), float(levels[-1])
    middle = float(np.clip(-0.5 * slope / bend, x[k - 1] - x[k], x[k + 1] - x[k])) + x[k]
    half = float(np.sqrt(HALF_OF_90 / -bend))
    return tuple(float(np.exp(v)) for v in (middle, middle - half, middle + half))
