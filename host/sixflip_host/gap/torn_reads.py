"""Samples that mix the bytes of two readings."""
import math

import numpy as np
from scipy import stats

from .finding import CERTAIN, Finding

TORN_P, SPIKE = 2e-4, 4.2  # standard deviations at which a sample stands out
CALM = 8.0  # standard deviations that the neighbours of a sample at rest may span
FEWEST_TORN = 3


def finding(sessions, sensor, columns):
    """Single samples off by 256 m whose high byte is a neighbour's: half of all other spikes
    at most would be so placed."""
    found = [torn_in(column) for counts in columns if len(counts) >= 20
             for column in counts.T.astype(np.int64)]
    chances = sum(int((np.diff(column // 256) != 0).sum()) for counts in columns
                  for column in counts.T.astype(np.int64))
    near = sum(f[0] for f in found)
    torn = max((sum(f[k] for f in found) for k in (1, 2)), default=0)
    if torn < FEWEST_TORN:
        return []
    p = stats.binom.sf(torn - 1, near, 0.5)
    if p > TORN_P or torn < 0.5 * near:
        return []
    share = 100.0 * torn / max(chances, torn)
    return [Finding("torn_reads", sensor, [], {"chance": round(share, 3)}, "%",
                    min(CERTAIN, -math.log(max(p, 1e-300))), "noise",
                    "%d samples mix the bytes of two readings" % torn)]


def torn_in(column):
    """(samples off by about 256 m, those with the page of the sample before, of the one after).

    A sample is held against the median of three on either side where these agree, against a
    cubic through two on either side where they do not; where noise alone reaches half of 256
    nothing can be said.
    """
    x = column[3:-3]
    around = np.lib.stride_tricks.sliding_window_view(column, 7)[:, [0, 1, 2, 4, 5, 6]]
    calm = np.ptp(around, axis=1) < CALM * _spread(np.diff(column))
    near = np.zeros(len(x), bool)
    for mask, level in ((calm, np.median(around, axis=1)),
                        (~calm, (4.0 * (around[:, 2] + around[:, 3]) - around[:, 1]
                                 - around[:, 4]) / 6.0)):
        jump = (x - level)[mask]
        sigma = max(_spread(jump), 1.0) if len(jump) > 50 else np.inf
        if SPIKE * sigma > 250.0:
            continue
        times = np.rint(np.abs(jump) / 256.0)
        near[mask] = (np.abs(jump) > SPIKE * sigma) & (times >= 1) & (times <= 16) & (
            np.abs(np.abs(jump) - 256.0 * times) < 2.5 * sigma)
    page = column // 256
    before, after = page[2:-4] == page[3:-3], page[4:-2] == page[3:-3]
    return int(near.sum()), int((near & before).sum()), int((near & after).sum())


def _spread(values):
    """Standard deviation by the median, blind to a few outliers."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values)))) + 1e-9
