"""What the data sheets say of the chips, and the typical sizes of GAP.md's table.

MPU6050: PS-MPU-6000A rev 3.4; ADXL345: rev E; ITG3205: PS-ITG-3205A rev 1.0.
"""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Chip:
    """Counts, noise and typical effect sizes of a sensor (or of a pair on one board)."""

    sensor: str
    accel_lsb_per_g: float
    accel_range_g: float
    gyro_lsb_per_dps: float
    gyro_range_dps: float
    temp_lsb_per_c: float
    temp_offset_c: float
    white_g: tuple              # RMS of a sample at 100 Hz, per axis
    white_dps: float
    flicker_g: float            # RMS of the 1/f part that every part has
    flicker_dps: float
    offset_g: float             # spread of zero-g offset and of rate offset
    offset_dps: float
    thermometer_lag_s: tuple    # how far the accelerometer trails the thermometer
    typical: dict = field(default_factory=dict)     # (effect, sensor) -> size


# Sizes where GAP.md's table has none are ours: what stands out of a good fit by a few sigma.
_SHARED = {
    ("warm_up", "accel"): 5e-3, ("warm_up", "gyro"): 0.3,
    ("thermal_rate", "accel"): 0.1, ("thermal_rate", "gyro"): 5.0,      # per deg C/s
    ("quadratic", "accel"): 5e-3, ("cubic", "accel"): 5e-3,
    ("cross_quadratic", "accel"): 5e-3,
    ("asymmetry", "accel"): 5e-3, ("asymmetry", "gyro"): 0.059,
    ("g_sensitivity", "gyro"): 0.1,
    ("drift", "accel"): 2e-3, ("drift", "gyro"): 0.1,
    ("dead_band", "accel"): 10e-3, ("dead_band", "gyro"): 0.5,
    ("saturation", "accel"): 0.01, ("saturation", "gyro"): 0.3,
    ("vibration", "accel"): 5e-3, ("vibration", "gyro"): 0.1,
    ("vibration_rectification", "accel"): 5e-3,
    ("dropped_samples", "device"): 0.01,
    ("filter_lag", "gyro"): 5e-3, ("filter_lag", "accel"): 5e-3,
    ("hysteresis", "accel"): 5e-3, ("creep", "accel"): 5e-3,
    ("lever_arm", "accel"): 0.03,
    ("box_tilt", "accel"): 0.1, ("table_tilt", "accel"): 1.0,
    ("local_gravity", "accel"): 0.003,
    ("torn_reads", "accel"): 0.005, ("torn_reads", "gyro"): 0.005,
    ("supply", "gyro"): 2.0,                                            # per volt
    ("axis_swap", "gyro"): 1.0, ("axis_swap", "accel"): 1.0,
    ("quantisation", "accel"): 4, ("quantisation", "gyro"): 4,
    ("stuck_bit", "accel"): 3, ("earth_rate", "gyro"): 0.0042,
}

MPU6050 = Chip(
    "mpu6050", 16384.0, 2.0, 65.5, 500.0, 340.0, 36.53,
    (2.8e-3, 2.8e-3, 3.6e-3), 0.04, 0.05e-3, 0.003, 0.04, 2.0, (0.0, 0.0),
    {**_SHARED,
     ("thermal_bias", "accel"): (0.5e-3, 0.5e-3, 0.9e-3), ("thermal_bias", "gyro"): 0.12,
     ("thermal_scale", "accel"): 2e-4, ("thermal_scale", "gyro"): 2e-4,
     ("sample_rate", "device"): 0.007})

GY85 = Chip(
    "gy85", 256.0, 16.0, 14.375, 2000.0, 280.0, 82.142857,
    (3.5e-3, 3.5e-3, 5e-3), 0.30, 0.08e-3, 0.01, 0.05, 1.5, (10.0, 60.0),
    {**_SHARED,
     ("thermal_bias", "accel"): (0.4e-3, 0.4e-3, 1.2e-3), ("thermal_bias", "gyro"): 0.3,
     ("thermal_scale", "accel"): 1e-4, ("thermal_scale", "gyro"): 1e-3,
     ("sample_rate", "device"): 0.03, ("quantisation", "accel"): 3})

CHIPS = {"mpu6050": MPU6050, "gy85": GY85}
