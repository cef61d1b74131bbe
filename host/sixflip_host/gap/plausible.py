"""The plausibility gate: a fit far beyond what any part has is numerically helpful, no more."""
from sixflip_sim.effects import typical

TIMES = 5.0  # GAP stage 3
LOOSE = {"warm_up": 10.0, "drift": 10.0, "vibration": 1e9, "sample_rate": 10.0,
         "dropped_samples": 1e9, "saturation": 1e9, "torn_reads": 1e9, "axis_swap": 1e9,
         "quantisation": 1e9, "dead_band": 1e9, "box_tilt": 20.0, "creep": 5.0}


def limit(effect, chip, sensor, key):
    """Largest size that is believed, or None where there is no typical one."""
    kind = "accel" if sensor == "device" else sensor
    size = typical.size(effect, chip, kind, key)[0]
    if size is None:
        size = typical.size(effect, chip, kind)[0]
    return None if size is None else LOOSE.get(effect, TIMES) * abs(size)


def believable(effect, chip, sensor, values, sigmas=None):
    """True when no coefficient exceeds its limit by more than twice its own uncertainty."""
    for key, value in values.items():
        top = limit(effect, chip, sensor, key)
        slack = 2.0 * sigmas[key] if sigmas else 0.0
        if top is not None and abs(value) - slack > top:
            return False
    return True
