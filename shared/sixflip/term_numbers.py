"""The numbers of a record's terms that the correction is made of, checked; all that a board needs
of a term. They stand first in its section (record_terms.py has the rest), 64 bits each:

    accel_thermal_bias, gyro_thermal_bias     k1 [3], k2 [3], t0_c, low_c, high_c,
                                              temp_lsb_per_c, temp_offset_c
    accel_thermal_scale, gyro_thermal_scale   k1 [3], then likewise
    g_sensitivity                             k [3 x 3], row by row
"""

import struct

TERMS = ((16, "accel_thermal_bias"), (17, "gyro_thermal_bias"), (18, "accel_thermal_scale"),
         (19, "gyro_thermal_scale"), (20, "g_sensitivity"))
# Of a coefficient: beyond it, it is no sensor's. mg and deg/s per degree C, percent, deg/s per g.
_MOST = (100.0, 30.0, 2.0, 2.0, 10.0)


def numbers(record):
    """[(name, [numbers])] of a Record's terms; ValueError, a sentence, when one cannot be."""
    found = []
    names = dict(TERMS)
    for tag, payload in record.terms:
        name = names[tag]
        if [1 for known, _ in found if known == name]:
            raise ValueError("section %s is there twice in the record" % name)
        sizes = 6 if tag < 18 else 3 if tag < 20 else 9
        n = sizes if tag == 20 else sizes + 5
        if len(payload) < 8 * n:
            raise ValueError("section %s of the record is too short" % name)
        values = list(struct.unpack_from("<%dd" % n, payload, 0))
        check(name, values, sizes, record)
        found.append((name, values))
    return found


def check(name, values, sizes, record):
    """ValueError unless the first `sizes` values are coefficients and the rest a range."""
    most = [limit for limit, (_, known) in zip(_MOST, TERMS) if known == name][0]
    for x in values[:sizes]:
        if not abs(x) <= most:
            raise ValueError("section %s holds %s: expected %s at most" % (name, x, most))
    if name[0] == "g" and not record.gyro_lsb_per_dps:
        raise ValueError("section %s is of a gyro, the %s has none" % (name, record.chip))
    if len(values) == sizes:
        return
    t0, low, high, lsb, offset = values[sizes:]
    if record.chip == "adxl345" or record.temp_c is None:
        raise ValueError("section %s needs the temperature of the calibration: the record has "
                         "none" % name)
    if not (-60.0 <= low < high <= 150.0 and -60.0 <= t0 <= 150.0):
        raise ValueError("section %s is for %s to %s degrees C, about %s: expected a range of a "
                         "chip" % (name, low, high, t0))
    if not (1.0 <= lsb <= 1e5 and abs(offset) <= 1000.0):
        raise ValueError("section %s reads degrees C as counts / %s + %s" % (name, lsb, offset))
    if sizes == 3 and max([abs(k) for k in values[:3]]) * (high - low) > 50.0:
        raise ValueError("section %s changes the scale by more than half" % name)
