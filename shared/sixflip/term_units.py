"""From the units a record's terms are stored in to those that samples are corrected in."""

from sixflip.thermal_term import ThermalTerm


def fill(correction, found):
    """A TermCorrection with what term_numbers.numbers() found."""
    for name, values in found:
        if name == "g_sensitivity":
            _couple(correction, values)
        elif name.endswith("scale"):
            _stretch(correction, name, values)
        else:
            _drift(correction, name, values)
    if correction.record.mounting:
        from sixflip.mounting import compensation
        correction.turn = compensation(correction.record.mounting)


def _couple(correction, k):
    columns = [_rates(correction, k[j::3]) for j in range(3)]
    g = correction.record.g
    correction.coupling = [[column[j] / g for column in columns] for j in range(3)]


def _stretch(correction, name, values):
    one = ThermalTerm(3 if name[0] == "g" else 0, correction.scale,
                      [k / 100.0 for k in values[:3]], [0.0] * 3, 1.0, values[3:], False)
    one.count_from(correction.record.temp_c)
    correction.thermal.append(one)


def _drift(correction, name, values):
    record = correction.record
    then = record.temp_c
    gyro = name[0] == "g"
    if gyro:
        k1, k2 = [_rates(correction, values[i:i + 3]) for i in (0, 3)]
        if record.gyro_bias and record.gyro_bias["temp_c"] is not None:
            then = record.gyro_bias["temp_c"]
    else:
        k1, k2 = [[k * 1e-3 * record.g for k in values[i:i + 3]] for i in (0, 3)]
        correction.range_c = values[7], values[8]
    one = ThermalTerm(3 if gyro else 0, correction.shift, k1, k2, 0.0, values[6:], gyro)
    one.count_from(then)
    correction.thermal.append(one)


def _rates(correction, dps):
    """rad/s, corrected, that so many deg/s more as read make."""
    M = correction.gyro
    lsb = correction.record.gyro_lsb_per_dps
    return [sum([dps[i] * lsb * M[i][j] for i in range(3)]) for j in range(3)]
