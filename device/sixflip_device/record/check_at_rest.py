"""The board at rest, after power-up or when the host asks: the gyro's bias is measured anew, and
|a|, noise and temperature are held against the record.
"""

from .active_record import activate

# |a| at rest in any attitude: what ageing, a knock or warming by 20 K may well do to a sensor
# that was calibrated, and what they do not.
GOOD_MG = 5.0
NOISE_TIMES = 3.0
WARMER_C = 15.0


def _noise_mg(rest, imu):
    return (sum([s * s for s in rest.noise[:3]]) / 3) ** 0.5 / imu.accel_lsb_per_g * 1000


def shaken(firmware, rest):
    """"" or why nothing is to be measured in this rest: noise, an engine's for one."""
    if not rest.still or firmware.record is None or not firmware.record.accel["noise_g"]:
        return ""
    noise_mg = _noise_mg(rest, firmware.sensor.imu)
    limit = NOISE_TIMES * firmware.record.accel["noise_g"] * 1000
    return "" if noise_mg <= limit else "shaken: %.1f mg of noise, limit %.1f" % (noise_mg, limit)


def _known(correction, temp_c):
    """Whether the accelerometer's drift is taken out at this temperature, by a term."""
    between = getattr(correction, "range_c", None)
    return between is not None and between[0] <= temp_c <= between[1]


def compare(firmware, rest):
    """What a Rest says of the record, as a dict for an event: a_error_mg by which |a| is off,
    noise_mg, temp_c, verdict "good", "doubtful" or "none", and words (a list of sentences)."""
    facts = {"verdict": "none", "words": [], "a_error_mg": None, "noise_mg": None,
             "temp_c": None}
    words = facts["words"]
    if not rest.still:
        words.append("no rest: %s" % rest.reason)
        return facts
    imu = firmware.sensor.imu
    out = firmware.correction.apply(rest.means, [0.0] * 6)
    length = (out[0] * out[0] + out[1] * out[1] + out[2] * out[2]) ** 0.5
    g = firmware.settings["g"]
    error_mg = (length / g - 1) * 1000
    noise_mg = _noise_mg(rest, imu)
    facts["a_error_mg"] = error_mg
    facts["noise_mg"] = noise_mg
    if imu.has_temp:
        facts["temp_c"] = rest.means[6] / imu.temp_lsb_per_c + imu.temp_offset_c
    record = firmware.record
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
            and not _known(firmware.correction, now):
        words.append("it is %.0f degrees C, at the calibration it was %.0f" % (now, then))
    facts["verdict"] = "doubtful" if words else "good"
    if not words:
        words.append("|a| is right within %.1f mg (length only: it says nothing of directions)"
                     % abs(error_mg))
    return facts


def refresh(firmware, rest_s=None, name="rest"):
    """Looks for a rest and tells it as an event of that name; whatever moves or shakes, the
    stored bias stays and the event says so."""
    from . import at_rest
    settings = firmware.settings
    stored = firmware.record.gyro_bias if firmware.record is not None else None
    rest = at_rest.watch(firmware.board, firmware.sensor, settings["rate_hz"],
                         settings["rest_s"] if rest_s is None else rest_s, stored, firmware.listen)
    facts = compare(firmware, rest)
    reason = shaken(firmware, rest)
    held = "none" if firmware.bias_dps is None else "stored"
    measured = rest.still and not reason and firmware.sensor.imu.has_gyro
    if stored and firmware.bias_dps != stored["bias_dps"]:
        held = "measured before"
    if measured:
        firmware.correction.set_rest(rest.means)
        firmware.bias_dps = at_rest.bias_dps(rest.means, firmware.sensor.imu)
    firmware.events.emit(name, still=rest.still, reason=rest.reason or reason,
                         bias_dps=firmware.bias_dps,
                         bias="measured now" if measured else held,
                         unseen_turn_dps=rest.unseen_dps if measured else None,
                         note="a turn about the vertical below %.1f deg/s would pass for bias"
                         % rest.unseen_dps if measured else "", **facts)
    return rest


def check(firmware):
    """Is the calibration still valid? One rest, seconds, answered as a "check" event."""
    refresh(firmware, max(3.0, firmware.settings["rest_s"]), "check")


def run(firmware):
    """Activates the record, and where there is one looks for a rest."""
    activate(firmware)
    if firmware.record is not None:
        rest = refresh(firmware)
        if firmware.settings["mounting"] is not None:
            from .mount import at_power_up
            at_power_up(firmware, rest)
