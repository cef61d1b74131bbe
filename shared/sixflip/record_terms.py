"""The optional terms of a correction record: what was found out besides scale and bias.

Each is a section of its own (tags in record.py). It is there when the term was measured, and
says from what (origin, source), which axes, how well (sigma), between which temperatures, and
what it gained: RMS before, after and of noise alone on sessions that were held out.

    accel_thermal_bias    k1 d + k2 d^2, mg, added to the corrected reading    d = T - t0_c
    gyro_thermal_bias     k1 d + k2 d^2, deg/s, added to the rate as read
    accel_thermal_scale, gyro_thermal_scale   k1 d, percent of what is felt
    g_sensitivity         k[i][j] deg/s, added to rate i as read for 1 g along j

T comes from the chip: counts / temp_lsb_per_c + temp_offset_c, the data sheet's numbers. Of a
GY-85 it is the ITG3205's, the ADXL345 has none; alone it can have no term.
"""

from sixflip.record import TERMS
from sixflip.record_sections import pack, unpack

ORIGINS = ("sessions held out", "halves of one session", "refinement")
COLDEST, HOTTEST = -60.0, 150.0  # degrees C that a chip can be at
MOST = {"accel_thermal_bias": 100.0, "gyro_thermal_bias": 30.0, "accel_thermal_scale": 2.0,
        "gyro_thermal_scale": 2.0, "g_sensitivity": 10.0}  # a coefficient beyond is no sensor's

_KNOWN = (("axes", "B"), ("origin", ORIGINS), ("source", "s"), ("before", "f"), ("after", "f"),
          ("floor", "f"))
_RANGE = (("t0_c", "d"), ("low_c", "d"), ("high_c", "d"), ("temp_lsb_per_c", "d"),
          ("temp_offset_c", "d"))
_BIAS = (("k1", "d", 3), ("k2", "d", 3), ("sigma_k1", "f", 3), ("sigma_k2", "f", 3))
_SCALE = (("k1", "d", 3), ("sigma_k1", "f", 3))
_COUPLING = (("k", "d", 3, 3), ("sigma", "f", 3, 3))
TEXT = 60  # bytes of source


def _layout(name):
    if name == "g_sensitivity":
        return _COUPLING + _KNOWN
    return (_SCALE if name.endswith("scale") else _BIAS) + _RANGE + _KNOWN


def terms(record):
    """{name: fields} of a Record's terms; ValueError, a sentence, when one cannot be."""
    names = dict(TERMS)
    found = {}
    for tag, payload in record.terms:
        name = names[tag]
        if name in found:
            raise ValueError("section %s is there twice in the record" % name)
        found[name] = _checked(name, unpack(name, payload, _layout(name)), record)
    return found


def put(record, name, fields):
    """fields as the term of that name, in place of one there is; ValueError likewise."""
    tag = [one for one, known in TERMS if known == name][0]
    fields = dict(fields)
    while len(fields["source"].encode()) > TEXT:
        fields["source"] = fields["source"][:-1]
    payload = pack(name, _checked(name, fields, record), _layout(name))
    record.terms = [one for one in record.terms if one[0] != tag] + [(tag, payload)]
    record.terms.sort()


def _checked(name, fields, record):
    if name == "g_sensitivity":
        sizes = [x for row in fields["k"] for x in row]
    else:
        sizes = fields["k1"] + fields.get("k2", [])
    if name[0] == "g" and not record.gyro_lsb_per_dps:
        raise ValueError("section %s is of a gyro, the %s has none" % (name, record.chip))
    for x in sizes:
        if not abs(x) <= MOST[name]:
            raise ValueError("section %s holds %s: expected %s at most" % (name, x, MOST[name]))
    if name != "g_sensitivity":
        _check_range(name, fields, record)
    return fields


def _check_range(name, fields, record):
    low, high = fields["low_c"], fields["high_c"]
    if record.chip == "adxl345" or record.temp_c is None:
        raise ValueError("section %s needs the temperature of the calibration: the record has "
                         "none" % name)
    if not (COLDEST <= low < high <= HOTTEST and COLDEST <= fields["t0_c"] <= HOTTEST):
        raise ValueError("section %s is for %s to %s degrees C, about %s: expected a range of a "
                         "chip" % (name, low, high, fields["t0_c"]))
    if not 1.0 <= fields["temp_lsb_per_c"] <= 1e5:
        raise ValueError("section %s has %s counts per degree C"
                         % (name, fields["temp_lsb_per_c"]))
    if name.endswith("scale") and max([abs(k) for k in fields["k1"]]) * (high - low) > 50.0:
        raise ValueError("section %s changes the scale by more than half" % name)
