"""An imperfection of one case: what it is called, where it acts, what it does."""

from dataclasses import dataclass, field
from typing import Callable

# In this order: what the sensor feels, how it answers, its analogue side, its digital side
# (counts), the rows that are written down.
STAGES = ("world", "response", "analogue", "counts", "rows")


@dataclass
class Effect:
    """act(signals, rng) changes the signals in place; `clock` replaces the sampling times."""

    name: str
    sensor: str
    axes: list
    stage: str
    act: Callable
    parameters: dict = field(default_factory=dict)
    clock: Callable = None
    hides_clock: bool = False       # the file's times are those the driver believes in
    also: list = field(default_factory=list)    # effects that come with it: (name, sensor)


def some_axes(rng, most=3):
    """One axis mostly, sometimes more."""
    count = int(rng.choice([1, 1, 1, 2, 3])) if most == 3 else 1
    return sorted(rng.permutation(3)[:count].tolist())


def sized(rng, size, axes):
    """(3,) of the size on the axes, random signs, 0.8 to 1.25 of it."""
    import numpy as np
    out = np.zeros(3)
    size = np.broadcast_to(np.asarray(size, float), (3,))
    for axis in axes:
        out[axis] = size[axis] * rng.choice([-1, 1]) * rng.uniform(0.8, 1.25)
    return out


def names_of(axes):
    return ["xyz"[a] for a in axes]
