"""The board at rest, after power-up or when the host asks: the gyro's bias is measured anew, and
|a|, noise and temperature are held against the record.
"""

from sixflip.record.still_valid import (
    NOISE_TIMES,
    against,
    drift_is_corrected,
    length_error_mg,
)

from .active_record import activate


def _noise_mg(rest, imu):
    return (sum([s * s for s in rest.noise[:3]]) / 3) ** 0.5 / imu.accel_lsb_per_g * 1000


def shaken(firmware, rest):
    """"" or why nothing is to be measured in this rest: noise, an engine's for one."""
    if not rest.still or firmware.record is None or not firmware.record.accel["noise_g"]:
        return ""
    noise_mg = _noise_mg(rest, firmware.sensor.imu)
    limit = NOISE_TIMES * firmware.record.accel["noise_g"] * 1000
    return "" if noise_mg <= limit else "shaken: %.1f mg of noise, limit %.1f" % (noise_mg, limit)


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
    error_mg = length_error_mg(firmware.correction, rest.means, firmware.settings["g"])
    noise_mg = _noise_mg(rest, imu)
    temp_c = rest.means[6] / imu.temp_lsb_per_c + imu.temp_offset_c if imu.has_temp else None
    facts["a_error_mg"] = error_mg
    facts["noise_mg"] = noise_mg
    facts["temp_c"] = temp_c
    if firmware.record is None:
        words.append("no record: these are the data sheet's scales")
        return facts
    words.extend(against(error_mg, noise_mg, temp_c, firmware.record,
                         drift_is_corrected(firmware.correction, temp_c)))
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
