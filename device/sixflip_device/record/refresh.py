"""The correction in force refreshed at rest: gyro bias; |a|, noise, temperature compared."""


def refresh(unit, rest_s=None, name="rest"):
    """Looks for a rest and tells it as an event of that name; whatever moves or shakes, the
    stored bias stays and the event says so."""
    from . import at_rest
    settings = unit.settings
    stored = unit.record.gyro_bias if unit.record is not None else None
    rest = at_rest.watch(unit.board, unit.sensor, settings["rate_hz"],
                         settings["rest_s"] if rest_s is None else rest_s, stored, unit.listen)
    from . import still_valid
    facts = still_valid.compare(unit, rest)
    shaken = still_valid.shaken(unit, rest)
    held = "none" if unit.bias_dps is None else "stored"
    measured = rest.still and not shaken and unit.sensor.imu.has_gyro
    if stored and unit.bias_dps != stored["bias_dps"]:
        held = "measured before"
    if measured:
        unit.correction.set_rest(rest.means)
        unit.bias_dps = rest.bias_dps(unit.sensor.imu)
    unit.events.emit(name, still=rest.still, reason=rest.reason or shaken,
                     bias_dps=unit.bias_dps,
                     bias="measured now" if measured else held,
                     unseen_turn_dps=rest.unseen_dps if measured else None,
                     note="a turn about the vertical below %.1f deg/s would pass for bias"
                     % rest.unseen_dps if measured else "", **facts)
    return rest


def check(unit):
    """Is the calibration still valid? One rest, seconds, answered as a "check" event."""
    refresh(unit, max(3.0, unit.settings["rest_s"]), "check")
