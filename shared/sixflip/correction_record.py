"""A calibration as bytes on flash. Little-endian, layout version 1:

head (magic ... time), sections (tag u8, length u16, payload), CRC-32 of all before it (u32).
A section is there when the thing was really measured. Unknown sections are kept as they are:
firmware from before the terms (record_terms.py) loads and keeps a record that has some.
"""

import struct
from binascii import crc32

from sixflip.record import Record
from sixflip.record_sections import SECTIONS, pack, unpack

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
    nobody has looked into them."""
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
