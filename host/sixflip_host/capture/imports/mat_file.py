"""Numeric arrays out of a MAT-file of format 5 (save -v6 and -v7).

Our own and not scipy's: a damaged file ends scipy's reader with a bus error. Structures, cells,
text and sparse arrays are passed over. Source: MathWorks, MAT-File Format (R2023), chapter 1.
"""

import struct
import zlib

import numpy as np

HEADER = 128
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8",
         13: "u8"}
MATRIX, COMPRESSED = 14, 15
NUMERIC = range(6, 16)      # classes of double, single and the integers
COMPLEX = 0x08


def arrays(data, most_bytes):
    """{name: array} of the bytes of a MAT-file; ValueError where they are none.

    most_bytes  that all arrays together may have, unpacked
    """
    if len(data) < HEADER or data[126:128] not in (b"IM", b"MI"):
        raise ValueError("its header is cut short or damaged")
    order = "<" if data[126:128] == b"IM" else ">"
    named = {}
    for kind, body in _elements(data[HEADER:], order, padded=False):
        if kind == COMPRESSED:
            unpacker = zlib.decompressobj()
            try:
                body = unpacker.decompress(body, most_bytes)
            except zlib.error as error:
                raise ValueError("a packed array is damaged: %s" % error) from None
            if unpacker.unconsumed_tail:
                raise ValueError("its arrays have more than %d MB" % (most_bytes >> 20))
            kind, body = next(_elements(body, order), (None, b""))
        if kind == MATRIX:
            name, value = _matrix(body, order)
            if value is not None:
                named[name] = value
    return named


def _elements(data, order, padded=True):
    """(type, bytes) of data elements; those of the file itself are not padded where packed."""
    at = 0
    while at + 8 <= len(data):
        word, = struct.unpack_from(order + "I", data, at)
        if word >> 16:                                  # small: type, length and data in 8 bytes
            kind, length, start = word & 0xFFFF, word >> 16, at + 4
            after = at + 8
        else:
            kind, length = struct.unpack_from(order + "II", data, at)
            start = at + 8
            after = start + (length if kind == COMPRESSED and not padded else -(-length // 8) * 8)
        if start + length > len(data):
            raise ValueError("an array is cut short")
        yield kind, data[start:start + length]
        at = after


def _matrix(body, order):
    """(name, array) of a matrix; None for the array of what is no full, real, numeric one."""
    parts = _elements(body, order)
    flags = next(parts, (0, b""))[1]
    shape = _numbers(*next(parts, (5, b"")), order)
    name = next(parts, (1, b""))[1].decode("ascii", "replace")
    if len(flags) < 8 or not len(shape):
        raise ValueError("an array has no head")
    bits, = struct.unpack_from(order + "I", flags)
    if bits & 0xFF not in NUMERIC or bits >> 8 & COMPLEX:
        return name, None
    values = _numbers(*next(parts, (9, b"")), order)
    sizes = [int(size) for size in shape]
    if any(size < 0 for size in sizes) or _product(sizes) != len(values):
        raise ValueError("the array %r has %d values, not %s" % (
            name, len(values), " x ".join(map(str, sizes))))
    return name, values.reshape(sizes, order="F").astype(float)


def _product(sizes):
    product = 1
    for size in sizes:
        product *= size
    return product


def _numbers(kind, data, order):
    if kind not in TYPES:
        raise ValueError("numbers of an unknown type, %d" % kind)
    dtype = np.dtype(order + TYPES[kind])
    if len(data) % dtype.itemsize:
        raise ValueError("an array is cut short")
    return np.frombuffer(data, dtype)
