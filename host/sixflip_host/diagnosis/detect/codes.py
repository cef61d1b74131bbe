"""Which codes a sensor gives, and how likely that would be if it gave all of them."""
import math

import numpy as np

from ...capture.registers import LOW_BITS, RAIL, codes, spacing, steps, zeros_beyond_noise

STEPS_TRIED = 1 << LOW_BITS


def step_nats(counts):
    """(3,) log likelihood ratio (nats) of every code lying on a grid of steps: without one each
    code that appears lies there with a chance of one in the width of a step."""
    out = []
    for column, step in zip(counts.T, steps(counts)):
        values = codes(column)
        number = int((np.abs(values) < RAIL).sum())
        out.append((number - 1) * math.log(step) - math.log(STEPS_TRIED) if step > 1 else 0.0)
    return np.array(out)


def distinct(counts):
    """(3,) number of codes that appear."""
    return np.array([len(np.unique(column)) for column in counts.T])


def zeros(counts):
    """(3,) number of runs of readings that are 0."""
    return np.array([_runs(column == 0) for column in counts.T])


def band_nats(counts):
    """(3,) log likelihood ratio (nats) of readings near 0 being 0: how often the readings just
    outside of the band would have gone inside (Poisson), and how much more often 0 is read than
    a code beside it; where no code is missing that alone. A run of samples counts once."""
    out = []
    for column in counts.T:
        size = np.abs(column.astype(np.int64))
        least = int(size[size > 0].min()) if size.any() else 0
        step = max(1, steps(column[:, None])[0], spacing(size, least)) if least else 1
        if least <= step:
            out.append(_flat_nats(column))
            continue
        beside = _runs((size > 0) & (size < 2 * least))
        missed = beside * (1.0 - step / least)
        expected, zeros = max(beside * step / least, 1e-3), _runs(size == 0)
        piled = zeros * math.log(max(zeros / expected, 1.0)) - max(zeros - expected, 0.0)
        out.append(missed + piled - math.log(len(codes(size))) if zeros else 0.0)
    return np.array(out)


def _flat_nats(column):
    """Nats of 0 being read more often than the codes beside it let noise do."""
    told = zeros_beyond_noise(column)
    if told is None or told[0] <= told[1]:
        return 0.0
    number, expected = told
    return (number * math.log(number / expected) - (number - expected)) * _runs(
        column == 0) / number


def bit_nats(columns):
    """Nats of a bit that never changes while the codes around it do: each code that appears in
    the columns would have it either way."""
    return len(codes(np.concatenate(columns))) * math.log(2.0)


def _runs(mask):
    return int(mask[0]) + int((mask[1:] & ~mask[:-1]).sum())
