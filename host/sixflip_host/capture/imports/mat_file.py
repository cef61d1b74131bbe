"""Numeric arrays out of a MAT-file of format 5 (save -v6 and -v7).

Our own and not scipy's: a damaged file ends scipy's reader with a bus error. Of structures the
fields are read; cells, text and sparse arrays are passed over, and objects named. Source:
MathWorks, MAT-File Format (R2023), chapter 1.
"""

import struct
import zlib

import numpy as np

HEADER = 128
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8",
         13: "u8"}
MATRIX, COMPRESSED = 14, 15
STRUCTURE, OPAQUE = 2, 17   # classes; the second one is MATLAB's own and not in the manual
DEEPEST = 8                 # structures in each other
NUMERIC = range(6, 16)      # classes of double, single and the integers
COMPLEX = 0x08


def arrays(data, most_bytes):
    """({name: array} of the bytes of a MAT-file, classes of the objects in it); ValueError where
    they are none. A field of a structure has its name, a dot and its own.

    most_bytes  that all arrays together may have, unpacked
    """
    if len(data) < HEADER or data[126:128] not in (b"IM", b"MI"):
        raise ValueError("its header is cut short or damaged")
    order = "<" if data[126:128] == b"IM" else ">"
    named, objects = {}, []
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
            _put(named, objects, name, value)
    named.pop("", None)         # MATLAB's own, of the objects
    outer = sorted(named, key=lambda name: name.count("."))     # arrays before fields
    return {name: named[name] for name in outer}, objects


def _put(named, objects, name, value):
    """Puts a matrix that has been read where it belongs: an array, one for each field of a
    structure, or the class of an object."""
    if isinstance(value, dict):
        for field, one in value.items():
            _put(named, objects, "%s.%s" % (name, field) if name else "", one)
    elif isinstance(value, str):
        objects.append(value)
    elif value is not None:
        named[name] = value


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


def _matrix(body, order, deep=0):
    """(name, array) of a matrix; {field: array} of a structure, the class of an object, or None
    for what is no full, real, numeric array."""
    parts = _elements(body, order)
    flags = next(parts, (0, b""))[1]
    if len(flags) >= 8 and flags[0 if order == "<" else 3] == OPAQUE:
        words = [part[1].decode("ascii", "replace") for part, _ in zip(parts, range(3))]
        return "".join(words[:1]), "".join(words[2:])
    shape = _numbers(*next(parts, (5, b"")), order)
    name = next(parts, (1, b""))[1].decode("ascii", "replace")
    if len(flags) < 8 or not len(shape):
        raise ValueError("an array has no head")
    bits, = struct.unpack_from(order + "I", flags)
    if bits & 0xFF == STRUCTURE and deep < DEEPEST and _product(map(int, shape)) == 1:
        return name, _fields(parts, order, deep)
    if bits & 0xFF not in NUMERIC or bits >> 8 & COMPLEX:
        return name, None
    sizes = [int(size) for size in shape]
    values = _numbers(*next(parts, (9, b"")), order)
    if any(size < 0 for size in sizes) or _product(sizes) != len(values):
        raise ValueError("the array %r has %d values, not %s" % (
            name, len(values), " x ".join(map(str, sizes))))
    return name, values.reshape(sizes, order="F").astype(float)


def _fields(parts, order, deep):
    """{name: array} of the fields of a structure, behind its head."""
    length = _numbers(*next(parts, (5, b"")), order)
    names = next(parts, (1, b""))[1]
    if len(length) != 1 or not 0 < int(length[0]) <= len(names):
        raise ValueError("a structure has no names of fields")
    size = int(length[0])
    fields = [names[first:first + size].split(b"\0")[0].decode("ascii", "replace")
              for first in range(0, len(names) - size + 1, size)]
    return {field: _matrix(body, order, deep + 1)[1]
            for field, (kind, body) in zip(fields, parts) if kind == MATRIX and body}


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
