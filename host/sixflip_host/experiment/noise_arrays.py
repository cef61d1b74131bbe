"""The deviates of sixflip_sim/noise.py for whole arrays of sample numbers: the same bit for bit,
and a hundred times as fast; and the moment of the effects that is as many moments at once."""
import numpy as np

from sixflip_sim import noise
from sixflip_sim.effects.moment import Moment

_BODY = np.append(np.array(noise.BODY, dtype=np.int64), 0)  # the 128th is never used
_TAIL = np.array(noise.TAIL, dtype=np.int64)


def gauss_int(stream, k):
    """noise.gauss_int for sample numbers k (n,), int64 or whole floats -> int64 (n,)."""
    x = noise.bits(stream, np.asarray(k).astype(np.int64))
    cell = (x >> 24) & 0x7F
    low = _BODY[cell]
    value = low + (((_BODY[cell + 1] - low) * (x & 0xFFFFFF)) >> 24)
    tail = cell == 127
    if tail.any():
        rare = x[tail]
        cell = (rare >> 18) & 0x3F
        low = _TAIL[cell]
        value[tail] = low + (((_TAIL[cell + 1] - low) * (rare & 0x3FFFF)) >> 18)
    return np.where(x >> 31, -value, value)


def gauss(stream, k):
    """(n,) standard normal deviates of sample numbers k (n,). Where the same few numbers come
    again and again, as the corners of slow noise do, each is made once."""
    k = np.atleast_1d(k).astype(np.int64)
    if len(k) > 64:
        low = int(k.min())
        spread = int(k.max()) - low + 1
        if spread < len(k) // 4:
            return gauss_int(stream, np.arange(low, low + spread))[k - low] * noise.UNIT
    return gauss_int(stream, k) * noise.UNIT


def uniform(stream, k):
    """(n,) uniform deviates in [-1, 1) of sample numbers k (n,)."""
    return noise.uniform(stream, np.asarray(k).astype(np.int64))


def moment():
    """An empty Moment whose fields may be arrays."""
    return Moment(np.exp, np.sin, np.floor, gauss)
