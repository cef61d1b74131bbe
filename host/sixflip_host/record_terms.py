"""The optional terms of a correction record: what was found out besides scale and bias.

Each is a section of its own. It is there when the term was measured, and says from what (origin,
source), which axes, how well (sigma), between which temperatures, and what it gained: RMS before,
after and of noise alone on sessions that were held out.

    accel_thermal_bias    k1 d + k2 d^2, mg, added to the corrected reading    d = T - t0_c
    gyro_thermal_bias     k1 d + k2 d^2, deg/s, added to the rate as read
    accel_thermal_scale, gyro_thermal_scale   k1 d, percent of what is felt
    g_sensitivity         k[i][j] deg/s, added to rate i as read for 1 g along j

T comes from the chip: counts / temp_lsb_per_c + temp_offset_c, the data sheet's numbers. Of a
GY-85 it is the ITG3205's, the ADXL345 has none; alone it can have no term.
"""

from sixflip.record.correction_record import FIELDS, pack, unpack
from sixflip.record.term_correction import TERMS, check, numbers

ORIGINS = ("sessions held out", "halves of one session", "refinement")
TEXT = 60  # bytes of source

# What stands first is read by sixflip/record/term_correction.py, too.
_KNOWN = (("axes", "B"), ("origin", ORIGINS), ("source", "s"), ("before", "f"), ("after", "f"),
          ("floor", "f"))
_RANGE = (("t0_c", "d"), ("low_c", "d"), ("high_c", "d"), ("temp_lsb_per_c", "d"),
          ("temp_offset_c", "d"))
_BIAS = (("k1", "d", 3), ("k2", "d", 3)) + _RANGE + (
    ("sigma_k1", "f", 3), ("sigma_k2", "f", 3)) + _KNOWN
_SCALE = (("k1", "d", 3),) + _RANGE + (("sigma_k1", "f", 3),) + _KNOWN
_COUPLING = (("k", "d", 3, 3), ("sigma", "f", 3, 3)) + _KNOWN


for _, _name in TERMS:
    FIELDS[_name] = _COUPLING if _name == "g_sensitivity" else (
        _SCALE if _name.endswith("scale") else _BIAS)


def names_of(record):
    """Names of the terms that a Record has."""
    names = dict(TERMS)
    return [names[tag] for tag, _ in record.terms]


def terms(record):
    """{name: fields} of a Record's terms; ValueError, a sentence, when one cannot be."""
    numbers(record)
    names = dict(TERMS)
    return {names[tag]: unpack(names[tag], payload) for tag, payload in record.terms}


def put(record, name, fields):
    """fields as the term of that name, in place of one there is; ValueError likewise."""
    tag = [term for term, known in TERMS if known == name][0]
    fields = dict(fields)
    while len(fields["source"].encode()) > TEXT:
        fields["source"] = fields["source"][:-1]
    if name == "g_sensitivity":
        check(name, [x for row in fields["k"] for x in row], 9, record)
    else:
        sizes = list(fields["k1"]) + list(fields.get("k2", ()))
        check(name, sizes + [fields[item[0]] for item in _RANGE], len(sizes), record)
    payload = pack(name, fields)
    record.terms = [term for term in record.terms if term[0] != tag] + [(tag, payload)]
    record.terms.sort()
