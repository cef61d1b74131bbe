"""The known effects by their canonical names: how each is made, and in which sensors."""

from . import known_digital as digital
from . import known_memory as memory
from . import known_motion as motion
from . import known_static as static

KNOWN = {
    "thermal_bias": (static.thermal_bias, ("accel", "gyro")),
    "thermal_scale": (static.thermal_scale, ("accel", "gyro")),
    "warm_up": (static.warm_up, ("accel", "gyro")),
    "thermal_rate": (static.thermal_rate, ("accel", "gyro")),
    "quadratic": (static.quadratic, ("accel",)),
    "cross_quadratic": (static.cross_quadratic, ("accel",)),
    "cubic": (static.cubic, ("accel",)),
    "asymmetry": (static.asymmetry, ("accel", "gyro")),
    "g_sensitivity": (static.g_sensitivity, ("gyro",)),
    "drift": (memory.drift, ("accel", "gyro")),
    "quantisation": (digital.quantisation, ("accel", "gyro")),
    "dead_band": (digital.dead_band, ("accel", "gyro")),
    "saturation": (digital.saturation, ("accel", "gyro")),
    "vibration": (motion.vibration, ("accel", "gyro")),
    "vibration_rectification": (motion.vibration_rectification, ("accel",)),
    "sample_rate": (digital.sample_rate, ("device",)),
    "dropped_samples": (digital.dropped_samples, ("device",)),
    "filter_lag": (motion.filter_lag, ("accel", "gyro")),
    "hysteresis": (memory.hysteresis, ("accel",)),
    "creep": (memory.creep, ("accel",)),
    "lever_arm": (motion.lever_arm, ("accel",)),
    "box_tilt": (motion.box_tilt, ("accel",)),
    "local_gravity": (static.local_gravity, ("accel",)),
    "torn_reads": (digital.torn_reads, ("accel", "gyro")),
    "supply": (static.supply, ("gyro",)),
    "axis_swap": (motion.axis_swap, ("accel", "gyro")),
    "stuck_bit": (digital.stuck_bit, ("accel",)),
}
# table_tilt and earth_rate are in every case: the table leans and the Earth turns.
