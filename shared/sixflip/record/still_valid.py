"""Whether a calibration still holds, judged by one rest: by the board at power-up and by
`sixflip check` on the host.

A rest shows how long gravity is measured, the noise and the temperature; it says nothing of
directions. The limits are what ageing, a knock or warming by 15 K may well do to a sensor that
was calibrated, and what they do not.
"""

GOOD_MG = 5.0           # | |a| - g | at rest in any attitude, mg
NOISE_TIMES = 3.0       # noise now, in multiples of the noise at the calibration
WARMER_C = 15.0         # from the temperature of the calibration, °C


def length_error_mg(correction, means, g):
    """By how much |a| at rest is longer than gravity, mg. means: seven of counts; g in m/s²."""
    a = correction.apply(means, [0.0] * 6)
    return 1000 * ((a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) ** 0.5 / g - 1)


def drift_is_corrected(correction, temp_c):
    """Whether a term of the correction takes the accelerometer's drift out at this temperature,
    °C; None: it is not known."""
    between = getattr(correction, "range_c", None)
    return temp_c is not None and between is not None and between[0] <= temp_c <= between[1]


def against(error_mg, noise_mg, temp_c, record, corrected):
    """Sentences on what in a rest speaks against a calibration; an empty list: nothing does.

    error_mg, noise_mg, temp_c  of the rest, the last None where there is no thermometer
    record                      Record whose noise and temperature they are held against
    corrected                   drift_is_corrected() at temp_c
    """
    words = []
    if not abs(error_mg) <= GOOD_MG:
        words.append("|a| is %+.1f mg off, %.0f is the limit: calibrate again"
                     % (error_mg, GOOD_MG))
    then_mg = 1000 * (record.accel["noise_g"] or 0.0)
    if then_mg and not noise_mg <= NOISE_TIMES * then_mg:
        words.append("the noise is %.1f mg, at the calibration it was %.1f: the sensor is shaken "
                     "or damaged" % (noise_mg, then_mg))
    then_c = record.temp_c
    if temp_c is not None and then_c is not None and not abs(temp_c - then_c) <= WARMER_C \
            and not corrected:
        words.append("it is %.1f °C, at the calibration it was %.1f: biases move with temperature"
                     % (temp_c, then_c))
    return words
