"""The plausibility gate: a fit far beyond what any part has is numerically helpful, no more."""
from sixflip_sim.effects import typical

TIMES = 5.0  # GAP stage 3
LOOSE = {"warm_up": 10.0, "drift": 10.0, "vibration": 1e9, "sample_rate": 10.0,
         "dropped_samples": 1e9, "saturation": 1e9, "torn_reads": 1e9, "axis_swap": 1e9,
         "quantisation": 1e9, "dead_band": 1e9, "box_tilt": 20.0, "creep": 5.0,
         "lever_arm": 10.0, "filter_lag": 20.0}


# What a part's drift with temperature amounts to while it warms up, and in what follows the
# thermometer by a minute: no data sheet gives these two by themselves.
BY_TEMPERATURE = {"warm_up": 10.0, "thermal_rate": 1.0}  # degC, minutes


def limit(effect, chip, sensor, key):
    """Largest size that is believed, or None where there is no typical one."""
    kind = "accel" if sensor == "device" else sensor
    size = typical.size(effect, chip, kind, key)[0]
    if size is None:
        size = typical.size(effect, chip, kind)[0]
    if size is None:
        return None
    top = LOOSE.get(effect, TIMES) * abs(size)
    if effect in BY_TEMPERATURE:
        slope = typical.size("thermal_bias", chip, kind, key)[0]
        top = max(top, TIMES * abs(slope) * BY_TEMPERATURE[effect])
    return top


def believable(effect, chip, sensor, values, sigmas=None):
    """True when no coefficient exceeds its limit by more than twice its own uncertainty."""
    for key, value in values.items():
        top = limit(effect, chip, sensor, key)
        slack = 2.0 * sigmas[key] if sigmas else 0.0
        if top is not None and abs(value) - slack > top:
            return False
    return True
