"""The sections of a correction record: fields in order, each with how it is stored.

d, f: numbers (f may be None, stored as NaN), matrices row by row; B: a bit for each of the
axes 0..2; s: text with its length; a tuple: one of these words. Numbers of kind d are what
the correction is made of and must be finite.
"""

import struct

SECTIONS = ((1, "accel"), (2, "gyro"), (3, "gyro_bias"), (4, "mounting"),
            (5, "flips"))
VERDICTS = ("good", "doubtful", "refused")
LEVELS = ("tilt solved", "flip average", "no flips")

FIELDS = {
    # P without its last column, which is 0 0 0 1.
    "accel": (("P", "d", 4, 3), ("sigma_P", "f", 4, 3), ("tilt_deg", "f"),
              ("tilt_spread_deg", "f"), ("residual_rms_g", "f"), ("noise_g", "f"),
              ("level", LEVELS), ("verdict", VERDICTS), ("reason", "s")),
    "gyro": (("P", "d", 4, 3), ("sigma_P", "f", 4, 3), ("missing", "B"),
             ("verdict", VERDICTS), ("reason", "s")),
    "gyro_bias": (("bias_dps", "d", 3), ("temp_c", "f")),
    "flips": (("excess", "d", 6), ("scale_sigma", "f"), ("sequence", "f")),
    "mounting": (("roll_deg", "d"), ("pitch_deg", "d"), ("order", ("xyz", "yxz")),
                 ("axes", "s"), ("frame", ("rep103", "ned"))),
}


def _list(value, shape):
    if not shape:
        return [value]
    if len(shape) == 1:
        return [value[i] for i in range(shape[0])]
    return [value[i][j] for i in range(shape[0]) for j in range(shape[1])]


def _fault(values, name, what):
    for x in values:
        if not abs(x) < 1e30:
            raise ValueError("%s.%s holds %s: expected a finite number" % (name, what, x))


def pack(name, fields):
    """Bytes of a section's dictionary; ValueError for a bad number or word."""
    out = b""
    for one in FIELDS[name]:
        what, kind = one[0], one[1]
        value = fields[what]
        if kind == "s":
            # Cut between characters, not inside one.
            value = value[:200]
            while len(value.encode()) > 255:
                value = value[:-1]
            text = value.encode()
            out += struct.pack("<B", len(text)) + text
        elif kind == "B":
            out += struct.pack("<B", sum([1 << axis for axis in value]))
        elif isinstance(kind, tuple):
            if value not in kind:
                raise ValueError("%s.%s is %s: expected one of %s"
                                 % (name, what, value, ", ".join(kind)))
            out += struct.pack("<B", kind.index(value))
        else:
            values = _list(value, one[2:])
            if kind == "d":
                _fault(values, name, what)
            for x in values:
                out += struct.pack("<" + kind, float("nan") if x is None else x)
    return out


def unpack(name, payload):
    """The dictionary of a section's bytes; ValueError when they are not one."""
    fields = {}
    at = 0
    try:
        for one in FIELDS[name]:
            fields[one[0]], at = _take(name, one, payload, at)
    except IndexError:
        raise ValueError("section %s of the record is too short" % name)
    if at > len(payload):
        raise ValueError("section %s of the record is too short" % name)
    if name == "accel":
        fields["P"] = [row + [x] for row, x in zip(fields["P"], (0.0, 0.0, 0.0, 1.0))]
        fields["sigma_P"] = [row + [0.0] for row in fields["sigma_P"]]
    return fields


def _take(name, one, payload, at):
    what, kind = one[0], one[1]
    if kind == "s":
        end = at + 1 + payload[at]
        return payload[at + 1:end].decode(), end
    if kind == "B":
        return [axis for axis in range(3) if payload[at] & 1 << axis], at + 1
    if isinstance(kind, tuple):
        return kind[payload[at]], at + 1
    shape = one[2:]
    size = struct.calcsize("<" + kind)
    values = []
    for _ in range((shape or (1,))[0] * (shape[1] if len(shape) == 2 else 1)):
        if at + size > len(payload):
            raise IndexError
        x = struct.unpack_from("<" + kind, payload, at)[0]
        values.append(x if kind == "d" or x == x else None)
        at += size
    if kind == "d":
        _fault(values, name, what)
    if not shape:
        return values[0], at
    if len(shape) == 1:
        return values, at
    k = shape[1]
    return [values[i * k:i * k + k] for i in range(shape[0])], at
