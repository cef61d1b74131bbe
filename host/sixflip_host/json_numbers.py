"""Numbers as JSON can hold them."""

import math


def finite(value):
    """JSON has no NaN: None stands for what is not a number."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
