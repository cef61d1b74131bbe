"""The step that all values of a log are whole multiples of, as far as its decimals show it."""
import numpy as np

MOST_DISTINCT = 1 << 17 # sizes of values in whole steps: 16 bits have a quarter of that
MOST_ROUNDED = 40       # sizes of whole numbers that may be rounded ones: counts at rest have less
ROUNDED = 1e-5, 1e-9    # of the largest value: gaps that are less, of singles, of doubles
ON_GRID = 0.02          # of a step: how far values may lie off whole steps to be called counts
FEWEST_PRINTED, COARSER = 32, 2.0   # sizes; last decimals of a step: half lie on it by chance


class Sizes:
    """The different sizes that values have, collected block by block, as long as they can be
    those of counts."""

    def __init__(self):
        self._distinct = np.zeros(0)

    def add(self, values):
        """More values, float of any shape."""
        if self._distinct is None:
            return
        self._distinct = np.union1d(self._distinct, np.abs(values))
        if len(self._distinct) > MOST_DISTINCT:
            self._distinct = None

    def are_many(self):
        """True for more sizes than whole degrees a second have, which somebody rounded to."""
        return self._distinct is None or len(self._distinct) > MOST_ROUNDED

    def step(self):
        """What all are whole multiples of, or None; the smallest gap is the first guess."""
        distinct = np.zeros(0) if self._distinct is None else self._distinct
        gaps = np.diff(np.concatenate(([0.0], distinct)))
        largest = max(distinct.max(initial=0.0), 1e-300)
        for least in least_gaps(gaps, largest):
            step, off = _fitted(distinct, least, (8, 50, 1000, np.inf))
            levels = len(np.unique(np.rint(distinct / step)))
            if off < ON_GRID and levels >= min(len(distinct), FEWEST_PRINTED):
                return step
        return _as_printed(distinct, gaps[gaps > ROUNDED[1] * largest])


def least_gaps(gaps, largest):
    """[size] of the least gaps that are no rounding of singles, or of doubles, so large."""
    return [float(gaps[gaps > part * largest].min()) for part in ROUNDED
            if (gaps > part * largest).any()]


def _fitted(distinct, step, nears):
    """(step, how far the sizes lie off whole ones) by least squares from a rough step, which is
    good for multiples up to each of nears only."""
    for near in nears:
        multiples = np.rint(distinct / step)
        few = (multiples <= near) & (multiples > 0)
        if few.any():
            step = float((distinct[few] * multiples[few]).sum() / (multiples[few] ** 2).sum())
    return step, float(np.abs(distinct / step - np.rint(distinct / step)).max())


def _as_printed(distinct, gaps):
    """The step that decimals hide: sizes lie off it by half of their last ones, or None."""
    printed = _last_places(distinct)
    if printed is None or len(distinct) < FEWEST_PRINTED:
        return None
    for some in (gaps, gaps[:2 * FEWEST_PRINTED]):  # the smallest sizes have most decimals
        step, _ = _fitted(distinct, float(some[some < some.min() + 1.5 * printed.min()].mean()),
                          (3, 8, 50, 1000, np.inf))
        off = np.abs(distinct / step - np.rint(distinct / step))
        if step > COARSER * printed.max() and (off < ON_GRID + 0.5 * printed / step).all():
            return step
    return None


def _last_places(distinct):
    """Of each size the last decimal that it is printed with: so many of all, or so many digits of
    each, of which the coarser one is what it was rounded to; None where no number of either will
    do. Of as many digits as a float has nothing is hidden."""
    whole = np.maximum(distinct, distinct[distinct > 0].min(initial=np.inf))
    digits = 10.0 ** (np.floor(np.log10(whole)) + 1.0)
    every = [places for places in (
        next((x for x in tried if np.abs(distinct / x - np.rint(distinct / x)).max()
              < ON_GRID / 100), None)
        for tried in ((np.full(len(distinct), 10.0 ** -k) for k in range(1, 8)),
                      (digits * 10.0 ** -k for k in range(3, 8)))) if places is not None]
    return np.max(every, axis=0) if every else None
