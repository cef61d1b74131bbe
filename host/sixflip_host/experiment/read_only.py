"""Values that are made once and shared: what one of their readers wrote, all would read."""
import numpy as np


class ReadOnlyArrays:
    """Base of a frozen dataclass whose arrays are made read-only as it is made."""

    def __post_init__(self):
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
