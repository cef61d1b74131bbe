"""Layer three of one motion: which of the effects that each log shows by itself are in both, and
so no gap between them."""
from dataclasses import replace

import numpy as np

from ...experiment import terms
from ..hypotheses import columns_of
from .effects_beside import design, fit_with

# Standard errors within which the share of an effect in the difference is none, so that both logs
# have it, if it is also as far from all of it: either is wrong in one of 370 (normal).
BOTH = 3.0


def in_both(diagnosis):
    """{sensor: [(effect, variant, key, coefficient)]} of the causes of a Diagnosis that two logs
    of one motion show to be in the simulator as well: of what such a cause adds to the real
    readings, nothing is in their difference. Each log by itself may take one effect for several,
    and not alike, which is no gap between them."""
    shared = {}
    for kind, gap in diagnosis.gaps.items():
        fits = [comparison.fits[kind] for comparison in diagnosis.comparisons
                if kind in comparison.fits]
        for cause in gap.causes if fits else ():
            if all(_is_in_both(kind, fit, cause, diagnosis) for fit in fits):
                shared.setdefault(kind, []).extend(_coefficients(gap, cause))
    return shared


def not_compared(known, comparisons):
    """known {sensor: [(effect, variant, key, coefficient)]} of a simulator's own rests without the
    effects of which two logs of one motion tell whether they are in both: a size that the
    simulator's rests give has an error, and taken off the real ones it leaves that behind."""
    fitted = {kind for comparison in comparisons for kind, fit in comparison.fits.items()
              if fit.hypothesis.name}
    return {kind: [one for one in sizes if kind not in fitted or one[0] not in _compared_by(kind)]
            for kind, sizes in known.items()}


def _compared_by(kind):
    """Names of the effects that two logs of one motion are compared by (in_both)."""
    return (*terms.of_the_moment(kind), "box_tilt")


def _coefficients(gap, cause):
    """[(effect, variant, key, coefficient)] of a cause of a SensorGap."""
    every = [(d.effect, d.variant, key) for d in gap.units[0].designs for key in d.keys]
    columns = columns_of(cause.chosen).index
    return [(*every[column], float(size)) for column, size in zip(columns, cause.theta)]


def _is_in_both(kind, sensor_fit, cause, diagnosis):
    if sensor_fit.hypothesis.name == "" or cause.effect not in _compared_by(kind) or (
            not cause.value):
        return False
    acting = design(kind, cause.effect, cause, sensor_fit.pair, diagnosis)
    added = acting.columns @ [cause.value.get(key, 0.0) for key in acting.keys]
    fit = fit_with(kind, sensor_fit, [replace(
        acting, keys=["share"], columns=added[:, None], prior=np.ones(1))])
    share, sigma = fit.extra[-1], fit.extra_sigma[-1]
    return bool(abs(share) < BOTH * sigma < abs(1.0 - share))
