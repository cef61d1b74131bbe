"""Correction records as boards write them, of sensors that are crooked in every way."""

import numpy as np

from sixflip.record import correction_record
from sixflip_host import record_terms

G = 9.80665
LSB, DPS = 8192.0, 65.5
TERMS = {"accel_thermal_bias": {"k1": [0.5, -0.7, -1.8], "k2": [0.01, 0.0, 0.02]},
         "gyro_thermal_bias": {"k1": [0.04, -0.1, 0.3], "k2": [0.0, 0.001, 0.0]},
         "accel_thermal_scale": {"k1": [0.02, -0.03, 0.05]},
         "gyro_thermal_scale": {"k1": [0.1, 0.0, -0.1]},
         "g_sensitivity": {"k": [[0.1, -0.05, 0.02], [0.0, 0.2, 0.03], [-0.04, 0.01, 0.15]]}}


def make_record(gyro=True, mounting=True):
    """A crooked sensor, measured where gravity is not standard."""
    rng = np.random.default_rng(5)
    matrix = lambda size: (np.eye(3) + rng.normal(0, size, (3, 3))).tolist()
    record = correction_record.Record()
    record.chip, record.who_am_i, record.g = "mpu6050", (0x68, 0), 9.78
    record.accel_range_g, record.gyro_range_dps = 4, 500
    record.accel_lsb_per_g, record.gyro_lsb_per_dps = LSB, DPS
    P = [row + [0.0] for row in matrix(0.03)] + [[0.3, -0.5, 0.2, 1.0]]
    record.accel = {"P": P, "sigma_P": P, "tilt_deg": 1.0, "tilt_spread_deg": 0.01,
                    "residual_rms_g": 1e-4, "noise_g": 1e-3, "level": "tilt solved",
                    "verdict": "good", "reason": ""}
    if gyro:
        W = matrix(0.02) + [[0.02, -0.01, 0.03]]
        record.gyro = {"P": W, "sigma_P": W, "missing": [], "verdict": "good", "reason": ""}
        record.gyro_bias = {"bias_dps": [1.5, -0.7, 0.2], "temp_c": None}
    if mounting:
        record.mounting = {"roll_deg": 20.0, "pitch_deg": -95.0, "order": "xyz",
                           "axes": "x y z", "frame": "rep103"}
    return record


def with_terms(path, names=tuple(TERMS)):
    """(path, Record) of the crooked sensor with these terms, calibrated at 24 °C."""
    record = make_record()
    record.temp_c = 24.0
    for name in names:
        fields = {"axes": [0, 1, 2], "origin": "sessions held out", "source": "a.csv b.csv",
                  "before": 6.0, "after": 2.0, "floor": 1.9, **TERMS[name]}
        if name == "g_sensitivity":
            fields["sigma"] = [[0.01] * 3] * 3
        else:
            fields.update(sigma_k1=[0.1] * 3, sigma_k2=[0.1] * 3, t0_c=28.0, low_c=15.0,
                          high_c=40.0, temp_lsb_per_c=340.0, temp_offset_c=36.53)
        record_terms.put(record, name, fields)
    path.write_bytes(correction_record.encode(record))
    return path, record


def of_a_gy85():
    """A Record of a GY-85 with uncertainties of its own."""
    r = correction_record.Record()
    r.chip, r.who_am_i, r.sequence, r.session, r.g = "gy85", (0xE5, 0x68), 1, 7, G
    r.accel_range_g, r.accel_lsb_per_g = 16, 256
    r.gyro_range_dps, r.gyro_lsb_per_dps = 2000, 14.375
    P = [[float(i == j) for j in range(3)] + [0.0] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    sigma = [[1e-3] * 3 + [0.0] for _ in range(3)] + [[2e-2, 3e-2, 4e-2, 0.0]]
    r.accel = {"P": P, "sigma_P": sigma, "tilt_deg": 0.0, "tilt_spread_deg": 0.0,
               "residual_rms_g": 1e-4, "noise_g": 3e-3, "level": "tilt solved",
               "verdict": "good", "reason": ""}
    r.gyro = {"P": P, "sigma_P": sigma, "missing": [], "verdict": "good", "reason": ""}
    return r
