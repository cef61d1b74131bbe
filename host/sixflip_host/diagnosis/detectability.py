"""What the captures at hand could not show, effect by effect, and why."""
import numpy as np

from sixflip_sim.effects import typical
from sixflip_sim.effects.library import EFFECTS, NAMES

from ..planning import detectable

ABSORBED = {
    "cubic": "absorbed by scale", "local_gravity": "absorbed by scale",
    "quadratic": "absorbed by bias and box", "cross_quadratic": "absorbed by misalignment and box",
    "asymmetry": "absorbed by scale and box", "supply": "absorbed by bias: no voltage is recorded",
    "table_tilt": "a nuisance of every session, fitted and taken off",
    "box_tilt": "the box is certified", "thermal_bias": "absorbed by bias and box",
    "thermal_scale": "absorbed by scale", "thermal_rate": "absorbed by bias",
    "warm_up": "absorbed by bias", "hysteresis": "absorbed by bias and box",
    "creep": "absorbed by bias", "g_sensitivity": "absorbed by bias",
    "vibration_rectification": "absorbed by bias: nothing vibrated, or all the time",
    "earth_rate": "a nuisance: below the noise, or not told from g_sensitivity",
    "lever_arm": "needs rests in several poses, a gyro and a dozen turns between rests",
    "filter_lag": "needs rests in several poses, a gyro and a dozen turns between rests",
    "saturation": "no sample came near a rail; a rounded one is odd and absorbed by scale"}
STILL_ONLY = {"gyro": ("thermal_scale", "quadratic", "cubic", "asymmetry", "saturation")}
ALWAYS_SEEN = ("quantisation", "dead_band", "torn_reads", "dropped_samples", "sample_rate",
               "vibration", "axis_swap", "drift")
NOT_DETERMINED = "this capture does not determine its size"


def listed(diagnosis):
    """[{effect, reason}] in the order of the library; an effect seen by one sensor is left out
    for the other only with the sensor named."""
    unseen, named = [], _named(diagnosis)
    for name in NAMES:
        for sensor in sorted(EFFECTS[name].units):
            if name in ALWAYS_SEEN or (name, sensor) in named:
                continue
            why = reason(diagnosis, name, sensor)
            if why:
                unseen.append({"effect": name, "sensor": sensor, "reason": why})
    return unseen


def _named(diagnosis):
    names = {(n, kind) for kind, c in diagnosis.causes for n in c.names}
    return names | {(f.effect, f.sensor) for f in diagnosis.findings}


def reason(diagnosis, name, sensor):
    """Why an effect could not have been seen; "" when it could, and of a sensor that is not
    there."""
    if sensor != "device" and any(getattr(s.capture, sensor) is None for s in diagnosis.sessions):
        return ""
    if name in ("lever_arm", "filter_lag"):
        return in_motion(diagnosis, name, sensor)
    if sensor == "device" or name in ("supply", "table_tilt", "earth_rate", "local_gravity"):
        return ABSORBED.get(name, "")
    gap = diagnosis.gaps.get(sensor)
    if gap is None:
        if sensor in diagnosis.rest:
            return diagnosis.rest[sensor].reason(name)
        return "needs rests in several poses"
    if name == "saturation" and sensor == "accel":
        return ABSORBED[name]
    if name in STILL_ONLY.get(sensor, ()):
        if diagnosis.turns is None:
            return "needs turns between the poses: the gyro was judged at rest"
        gap = diagnosis.turns
    if name == "box_tilt":
        return "the box is certified" if diagnosis.settings.certified else ""
    if name.startswith("thermal") and any(s.temperature is None for s in gap.sessions):
        return "no temperature column"
    mine = [o for o in gap.options if o.effect == name and not o.record]
    if not mine:
        return "silent: " + ABSORBED.get(name, "nothing of it is left")
    smallest = least(gap, mine)
    usual = typical.size(name, gap.chip, sensor)[0]
    if not typical.determined(smallest, usual):
        return NOT_DETERMINED
    if usual and smallest > abs(usual):
        return "too small for this capture: from %.2g %s on, typical is %.2g" % (
            smallest, EFFECTS[name].units[sensor], abs(usual))
    return ""


def in_motion(diagnosis, name, sensor):
    """reason() of the effects that act in motion only."""
    if sensor == "device":
        return "both sensors are late together: shows only against a reference outside"
    motion = diagnosis.motion
    if motion is None or not motion.seen:
        return ABSORBED[name]
    if name == "lever_arm" and motion.one_hand:
        return "turned in the air: the hand's grip or the box, flips on a table tell"
    smallest, usual = motion.least(name), typical.size(name, motion.chip, sensor)[0]
    if smallest <= usual:
        return ""
    if not typical.determined(smallest, usual):
        return NOT_DETERMINED
    return "hidden by the hand's own acceleration: from %.2g %s on, typical is %.2g" % (
        smallest, EFFECTS[name].units[sensor], usual)


def least(gap, options):
    """Smallest size that would show: the middle one of the coefficients, the best variant."""
    columns = max(options, key=lambda o: len(o.columns)).columns
    information = np.zeros(len(columns))
    for unit, index in zip(gap.units, gap.levels()):
        information += np.diag(unit.gram.at(index, columns))
    sizes = np.sort(detectable.QUANTILE / np.sqrt(np.maximum(information, 1e-300)))
    return float(sizes[(len(sizes) - 1) // 2])


def visible_share(diagnosis):
    """Share of the effects of rests whose typical size the captures would have shown."""
    seen = total = 0
    for sensor in diagnosis.gaps:
        for name in NAMES:
            if sensor not in EFFECTS[name].units or name in ALWAYS_SEEN or name in (
                    "lever_arm", "supply", "table_tilt", "earth_rate", "local_gravity",
                    "filter_lag", "saturation", "vibration_rectification", "box_tilt"):
                continue
            if name in STILL_ONLY.get(sensor, ()) or name in ("thermal_rate", "asymmetry"):
                continue
            total += 1
            seen += not reason(diagnosis, name, sensor)
    return seen / max(total, 1)
