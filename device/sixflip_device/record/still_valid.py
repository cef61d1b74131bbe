"""One rest against the record: |a|, noise and temperature, in numbers and in words."""

# |a| at rest in any attitude: what ageing, a knock or warming by 20 K may well do to a sensor
# that was calibrated, and what they do not.
GOOD_MG = 5.0
NOISE_TIMES = 3.0
WARMER_C = 15.0


def _noise_mg(rest, imu):
    return (sum([s * s for s in rest.noise[:3]]) / 3) ** 0.5 / imu.accel_lsb_per_g * 1000


def shaken(unit, rest):
    """"" or why nothing is to be measured in this rest, an engine for one: its noise."""
    if not rest.still or unit.record is None or not unit.record.accel["noise_g"]:
        return ""
    noise_mg = _noise_mg(rest, unit.sensor.imu)
    limit = NOISE_TIMES * unit.record.accel["noise_g"] * 1000
    return "" if noise_mg <= limit else "shaken: %.1f mg of noise, limit %.1f" % (noise_mg, limit)


def _known(correction, temp_c):
    """Whether the accelerometer's drift is taken out at this temperature, by a term."""
    between = getattr(correction, "range_c", None)
    return between is not None and between[0] <= temp_c <= between[1]


def compare(unit, rest):
    """A dict for an event: a_error_mg, noise_mg, temp_c, verdict, words (a list)."""
    facts = {"verdict": "none", "words": [], "a_error_mg": None, "noise_mg": None,
             "temp_c": None}
    words = facts["words"]
    if not rest.still:
        words.append("no rest: %s" % rest.reason)
        return facts
    imu = unit.sensor.imu
    out = unit.correction.apply(rest.means, [0.0] * 6)
    length = (out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) ** 0.5
    g = unit.settings["g"]
    error_mg = (length / g - 1) * 1000
    noise_mg = _noise_mg(rest, imu)
    facts["a_error_mg"] = error_mg
    facts["noise_mg"] = noise_mg
    if imu.has_temp:
        facts["temp_c"] = rest.means[6] / imu.temp_lsb_per_c + imu.temp_offset_c
    record = unit.record
    if record is None:
        words.append("no record: these are the data sheet's scales")
        return facts
    if abs(error_mg) > GOOD_MG:
        words.append("|a| is %.1f mg off, expected less than %.0f: calibrate again"
                     % (error_mg, GOOD_MG))
    noise_then = record.accel["noise_g"]
    if noise_then and noise_mg > NOISE_TIMES * noise_then * 1000:
        words.append("the noise is %.1f mg, at the calibration it was %.1f"
                     % (noise_mg, noise_then * 1000))
    now, then = facts["temp_c"], record.temp_c
    if now is not None and then is not None and abs(now - then) > WARMER_C \
            and not _known(unit.correction, now):
        words.append("it is %.0f degrees C, at the calibration it was %.0f" % (now, then))
    facts["verdict"] = "doubtful" if words else "good"
    if not words:
        words.append("|a| is right within %.1f mg (length only: it says nothing of directions)"
                     % abs(error_mg))
    return facts
