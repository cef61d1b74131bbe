"""Reproducible noise: a pure function of (seed, channel, sample index).

No state is kept, so any sample can be asked for in any order, on the board's interpreter or,
with arrays of int64 in place of k, in numpy: the same integers come out bit for bit. Every
product stays below 2**62, the small int of a 64-bit MicroPython and well inside int64.

The hash is the multiply-xorshift of Chris Wellons' prospector ("lowbias32"), with both
multipliers below 2**30; the Gaussian is the inverse of the normal distribution's half by
linear interpolation in a table (tail cell subdivided, cut at 4.3), variance 1.0009.
"""

from array import array

MASK = 0xFFFFFFFF
UNIT = 1.0 / 8192           # what gauss_int counts in: standard deviations

# Quantile of |x| at i/128 for i = 0..127, in 1/8192.
BODY = array("H", (
    0, 80, 160, 241, 321, 401, 482, 562, 642, 723, 803, 884, 965, 1046, 1127, 1208, 1289, 1370,
    1451, 1533, 1615, 1697, 1779, 1861, 1943, 2026, 2109, 2192, 2275, 2358, 2442, 2526, 2610,
    2695, 2780, 2865, 2950, 3036, 3122, 3208, 3295, 3382, 3470, 3558, 3646, 3735, 3824, 3914,
    4004, 4095, 4186, 4277, 4370, 4462, 4556, 4650, 4744, 4839, 4935, 5032, 5129, 5227, 5326,
    5425, 5525, 5627, 5729, 5831, 5935, 6040, 6146, 6253, 6360, 6469, 6580, 6691, 6804, 6917,
    7033, 7149, 7268, 7387, 7508, 7631, 7756, 7883, 8011, 8141, 8274, 8409, 8546, 8685, 8827,
    8972, 9119, 9270, 9424, 9581, 9742, 9906, 10075, 10248, 10426, 10609, 10797, 10991, 11192,
    11399, 11615, 11838, 12071, 12313, 12568, 12834, 13115, 13413, 13729, 14068, 14432, 14827,
    15259, 15740, 16281, 16904, 17645, 18565, 19805, 21791))
# The last cell again, at 127/128 + j/8192 for j = 0..63, then the end.
TAIL = array("H", (
    21791, 21835, 21879, 21923, 21969, 22015, 22061, 22109, 22157, 22206, 22256, 22307, 22358,
    22411, 22464, 22518, 22573, 22630, 22687, 22746, 22806, 22867, 22929, 22993, 23058, 23124,
    23192, 23262, 23334, 23407, 23482, 23560, 23639, 23721, 23805, 23892, 23981, 24074, 24170,
    24269, 24371, 24478, 24589, 24705, 24826, 24953, 25085, 25225, 25373, 25529, 25695, 25873,
    26063, 26269, 26493, 26738, 27011, 27316, 27666, 28074, 28566, 29191, 30051, 31473, 35226))


def mix(x):
    """Scramble a 32-bit int (or int64 array holding such)."""
    x = ((x ^ (x >> 16)) * 0x21F0AAAD) & MASK
    x = ((x ^ (x >> 15)) * 0x31848BAB) & MASK
    return x ^ (x >> 16)


def key(seed, channel):
    """What gauss_int and uniform_int want for a stream: scalars only, once per stream."""
    return mix((mix(seed & MASK) + (channel + 1) * 0x1E3779B1) & MASK)


def hashed(k):
    """What all streams have in common in sample k (int or int64 array, 0 <= k < 2**32)."""
    return mix((k * 0x1E3779B1) & MASK)


def bits(stream, k):
    """32 random bits of sample k of a stream's key."""
    return mix(hashed(k) ^ stream)


def gauss_int(stream, k):
    """Standard normal deviate times 8192, an int, of sample k."""
    return deviate(hashed(k) ^ stream)


def deviate(x):
    """gauss_int of hashed(k) ^ stream, where several streams of one sample are wanted. mix() is
    written out: a simulated board does little else as often."""
    x = ((x ^ (x >> 16)) * 0x21F0AAAD) & 0xFFFFFFFF
    x = ((x ^ (x >> 15)) * 0x31848BAB) & 0xFFFFFFFF
    x ^= x >> 16
    cell = (x >> 24) & 0x7F
    if cell < 127:
        low = BODY[cell]
        value = low + (((BODY[cell + 1] - low) * (x & 0xFFFFFF)) >> 24)
    else:
        cell = (x >> 18) & 0x3F
        low = TAIL[cell]
        value = low + (((TAIL[cell + 1] - low) * (x & 0x3FFFF)) >> 18)
    return -value if x >> 31 else value


def gauss(stream, k):
    """Standard normal deviate of sample k."""
    return gauss_int(stream, k) * UNIT


def uniform(stream, k):
    """Uniform deviate in [-1, 1) of sample k."""
    return bits(stream, k) * (2.0 / 4294967296.0) - 1.0
