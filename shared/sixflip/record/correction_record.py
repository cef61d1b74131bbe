"""A record as bytes on flash and in files. Little-endian, layout version 1:

head (magic ... time), sections (tag u8, length u16, payload), CRC-32 of all before it (u32). A
section is there when the thing was really measured. Unknown sections are kept as they are, so
that firmware from before the terms loads and keeps a record that has some.

A section's fields stand in a fixed order, each stored as its kind says: d, f: numbers (f may be
None, stored as NaN), matrices row by row; B: a bit for each of the axes 0..2; s: text with its
length; a tuple: one of these words. Numbers of kind d are what the correction is made of and
must be finite.
"""

import struct
from binascii import crc32

from sixflip.record.record import Record

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
    packed = b""
    for field in FIELDS[name]:
        what, kind = field[0], field[1]
        value = fields[what]
        if kind == "s":
            # Cut between characters, not inside one.
            value = value[:200]
            while len(value.encode()) > 255:
                value = value[:-1]
            text = value.encode()
            packed += struct.pack("<B", len(text)) + text
        elif kind == "B":
            packed += struct.pack("<B", sum([1 << axis for axis in value]))
        elif isinstance(kind, tuple):
            if value not in kind:
                raise ValueError("%s.%s is %s: expected one of %s"
                                 % (name, what, value, ", ".join(kind)))
            packed += struct.pack("<B", kind.index(value))
        else:
            values = _list(value, field[2:])
            if kind == "d":
                _fault(values, name, what)
            for x in values:
                packed += struct.pack("<" + kind, float("nan") if x is None else x)
    return packed


def unpack(name, payload):
    """The dictionary of a section's bytes; ValueError when they are not one."""
    fields = {}
    at = 0
    try:
        for field in FIELDS[name]:
            fields[field[0]], at = _take(name, field, payload, at)
    except IndexError:
        raise ValueError("section %s of the record is too short" % name)
    if at > len(payload):
        raise ValueError("section %s of the record is too short" % name)
    if name == "accel":
        fields["P"] = [row + [x] for row, x in zip(fields["P"], (0.0, 0.0, 0.0, 1.0))]
        fields["sigma_P"] = [row + [0.0] for row in fields["sigma_P"]]
    return fields


def _take(name, field, payload, at):
    what, kind = field[0], field[1]
    if kind == "s":
        end = at + 1 + payload[at]
        return payload[at + 1:end].decode(), end
    if kind == "B":
        return [axis for axis in range(3) if payload[at] & 1 << axis], at + 1
    if isinstance(kind, tuple):
        return kind[payload[at]], at + 1
    shape = field[2:]
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


MAGIC = b"6FLP"
VERSION = 1
MOST = 2048  # bytes: every section with its longest texts, and room for more
# magic, version, length, sequence, session, float bits, who_am_i accel, gyro, chip,
# accel range g, gyro range dps, accel LSB/g and gyro LSB/dps in thousandths, degrees C,
# g in m/s2, unix time
HEAD = "<4sHHIIBBB16sHHIIfdI"
HEAD_SIZE = struct.calcsize(HEAD)


def encode(record):
    """Bytes of a Record. ValueError for a number that is not finite or does not fit."""
    body = b""
    for tag, name in SECTIONS:
        fields = getattr(record, name)
        if fields is not None:
            payload = pack(name, fields)
            body += struct.pack("<BH", tag, len(payload)) + payload
    for tag, payload in record.terms + record.unknown:
        body += struct.pack("<BH", tag, len(payload)) + payload
    temp = float("nan") if record.temp_c is None else record.temp_c
    chip = record.chip.encode()
    if len(chip) > 16:
        raise ValueError("chip name %s: expected 16 bytes at most" % record.chip)
    data = struct.pack(
        HEAD, MAGIC, VERSION, HEAD_SIZE + len(body) + 4, record.sequence, record.session,
        record.float_bits, record.who_am_i[0], record.who_am_i[1], chip,
        int(record.accel_range_g), int(record.gyro_range_dps),
        int(record.accel_lsb_per_g * 1000 + 0.5), int(record.gyro_lsb_per_dps * 1000 + 0.5),
        temp, record.g, record.time) + body
    if len(data) + 4 > MOST:
        raise ValueError("the correction record has %d bytes: expected %d at most"
                         % (len(data) + 4, MOST))
    return data + struct.pack("<I", crc32(data) & 0xFFFFFFFF)


def decode(data):
    """The Record in bytes. ValueError, one sentence, for anything else. The terms stay bytes,
    they are not looked into."""
    if len(data) < HEAD_SIZE + 4 or bytes(data[:4]) != MAGIC:
        raise ValueError("no correction record: expected %d bytes or more that begin with 6FLP"
                         % (HEAD_SIZE + 4))
    if len(data) > MOST:
        raise ValueError("the correction record has more than %d bytes" % MOST)
    end = len(data) - 4
    if crc32(bytes(data[:end])) & 0xFFFFFFFF != struct.unpack_from("<I", data, end)[0]:
        raise ValueError("the correction record is damaged: its CRC does not match")
    r = Record()
    (_, version, length, r.sequence, r.session, r.float_bits, accel_id, gyro_id, chip,
     r.accel_range_g, r.gyro_range_dps, accel_lsb_per_g, gyro_lsb_per_dps, temp, r.g,
     r.time) = struct.unpack_from(HEAD, data, 0)
    if version != VERSION:
        raise ValueError("the correction record has layout version %d: expected %d"
                         % (version, VERSION))
    if length != len(data):
        raise ValueError("the correction record says %d bytes and has %d" % (length, len(data)))
    r.who_am_i = (accel_id, gyro_id)
    r.chip = chip.rstrip(b"\x00").decode()
    r.accel_lsb_per_g = accel_lsb_per_g / 1000
    r.gyro_lsb_per_dps = gyro_lsb_per_dps / 1000
    r.temp_c = temp if temp == temp else None
    _look(r, data, end)
    return r


def _look(r, data, end):
    at = HEAD_SIZE
    names = dict(SECTIONS)
    while at < end:
        if at + 3 > end:
            raise ValueError("the correction record ends inside a section")
        tag, size = struct.unpack_from("<BH", data, at)
        payload = bytes(data[at + 3:at + 3 + size])
        at += 3 + size
        if at > end:
            raise ValueError("the correction record ends inside section %d" % tag)
        if tag in names:
            setattr(r, names[tag], unpack(names[tag], payload))
        elif 16 <= tag <= 20:  # term_numbers.TERMS
            r.terms.append((tag, payload))
        else:
            r.unknown.append((tag, payload))
