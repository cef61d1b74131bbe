"""What the data sheets say of each chip's noise, offsets and temperature: one table.

The simulator draws its parts from it, the plan and the diagnosis take their typical sizes from it
(typical.py). A figure is the sheet's typical one, or its limit where it gives that alone; three in
brackets are those of x, y and z. What no sheet states (slow noise, creep, hysteresis and so on) is
in typical.py, with what stands in for it.

density       white noise, mg or °/s per sqrt(Hz)
offset        at 25 °C, mg or °/s
offset_per_c  its change, mg or °/s per °C
scale         tolerance of the sensitivity at 25 °C, %
scale_per_c   its change, % per °C
cross_axis    sensitivity to the other axes, %
bend          nonlinearity, % of full scale; None: the sheet has no figure
delay_ms      of the filter that the driver takes for 100 samples a second; None: the sheet has no
              figure, and a filter of the first order stands in, 1 / (2 pi its bandwidth)
"""

FIELDS = ("density", "offset", "offset_per_c", "scale", "scale_per_c", "cross_axis", "bend",
          "delay_ms")
SOURCE = {
    "mpu6050": "MPU-6000/6050 PS rev. 3.4, tables 6.1 and 6.2; delay: RM rev. 4.2, register 26",
    "adxl345": "ADXL345 rev. E, table 1",
    "itg3205": "ITG-3205 PS rev. 1.0, table 3.1",
    "lsm6dsox": "LSM6DSOX DS12814 rev. 4, table 2",
    "lsm6ds3trc": "LSM6DS3TR-C DocID030071 rev. 3, table 3",
    "lsm6dsv": "LSM6DSV DS13476 rev. 5, table 3",
    "icm42688": "ICM-42688-P DS-000347 rev. 1.5, tables 1 and 2",
    "icm45686": "ICM-45686 DS-000577 rev. 1.0, tables 1 and 2",
    "icm20948": "ICM-20948 DS-000189 rev. 1.3, tables 1 and 2",
    "qmi8658": "QMI8658A 13-52-25 rev. A, tables 7 and 8",
    "bmi160": "BMI160 BST-BMI160-DS000-07 rev. 0.8, tables 2 and 3, as product pages quote them",
}
# Where a sheet gives no figure, that of the chip it succeeded or its like stands in its place.
NOTE = {
    "lsm6dsox": " (with temperature: as the LSM6DSO32, DocID032891 rev. 1; cross axis: no figure, "
                "as the ICM-42688-P)",
    "lsm6ds3trc": " (noise at ±2 g: as the LSM6DS3, DocID026899 rev. 7; scale of the "
                  "accelerometer: as the gyro's; cross axis: no figure, as the ICM-42688-P)",
    "lsm6dsv": " (scale of the accelerometer and cross axis: no figure, as the ICM-42688-P)",
    "bmi160": " (cross axis, scale of both and the gyro's change of scale: no figure could be "
              "had, as the MPU6050)",
    "icm45686": " (noise density; no other figure could be had, as the ICM-42688-P)"}
ACCEL = {
    "mpu6050": (0.4, 80.0, (0.5, 0.5, 0.86), 3.0, 0.02, 2.0, 0.5, 4.9),
    "adxl345": ((0.29, 0.29, 0.43), 40.0, (0.4, 0.4, 1.2), 10.0, 0.01, 1.0, 0.5, None),
    "lsm6dsox": (0.07, 20.0, 0.1, 1.0, 0.007, 1.0, None, None),
    "lsm6ds3trc": (0.09, 40.0, 0.5, 1.0, 0.01, 1.0, None, None),
    "lsm6dsv": (0.06, 12.0, 0.07, 0.5, 0.01, 1.0, None, None),
    "icm42688": (0.07, 20.0, 0.15, 0.5, 0.005, 1.0, 0.1, None),
    "icm45686": (0.07, 20.0, 0.15, 0.5, 0.005, 1.0, 0.1, None),
    "icm20948": (0.23, 50.0, 0.8, 0.5, 0.026, 2.0, 0.5, None),
    "bmi160": (0.18, 40.0, 1.0, 3.0, 0.03, 2.0, 0.5, None),
    "qmi8658": (0.15, 100.0, 1.0, 6.0, 0.04, 1.0, 0.75, None),
}
GYRO = {
    "mpu6050": (0.005, 20.0, 0.16, 3.0, 0.016, 2.0, 0.2, 4.8),
    "itg3205": (0.03, 40.0, 0.32, 6.0, 0.08, 2.0, 0.2, None),
    "lsm6dsox": (0.0038, 1.0, 0.01, 1.0, 0.005, 1.25, None, None),
    "lsm6ds3trc": (0.005, 3.0, 0.05, 1.0, 0.007, 1.25, None, None),
    "lsm6dsv": (0.0028, 1.0, 0.006, 0.3, 0.007, 1.25, None, None),
    "icm42688": (0.0028, 0.5, 0.005, 0.5, 0.005, 1.25, 0.1, None),
    "icm45686": (0.0038, 0.5, 0.005, 0.5, 0.005, 1.25, 0.1, None),
    "icm20948": (0.015, 5.0, 0.05, 1.5, 0.024, 2.0, 0.1, None),
    "bmi160": (0.008, 3.0, 0.08, 3.0, 0.016, 2.0, None, None),
    "qmi8658": (0.013, 10.0, 0.1, 3.0, 0.05, 2.0, 0.2, None),
}
# Noise bandwidth of a first-order filter is so much wider than its 3 dB one; the chips' are
# steeper, so that this errs to the loud side.
NOISE_BANDWIDTH = 1.57


def chips(sensor):
    """(accelerometer's row, gyro's row) of a sensor: a GY-85 is two chips; None: it has none."""
    if sensor == "gy85":
        return "adxl345", "itg3205"
    return (sensor if sensor in ACCEL else None), (sensor if sensor in GYRO else None)


def figures(sensor, kind, field):
    """A field of the table, (x, y, z); None where there is none."""
    chip = chips(sensor)[kind == "gyro"]
    found = None
    if chip is not None:
        found = (GYRO if kind == "gyro" else ACCEL)[chip][FIELDS.index(field)]
    return found if found is None or isinstance(found, tuple) else (found,) * 3


def figure(sensor, kind, field):
    """That of the worst axis."""
    found = figures(sensor, kind, field)
    return None if found is None else max(found)


def source(sensor, kind):
    """The document behind a sensor's figures, and what of them is another chip's."""
    chip = chips(sensor)[kind == "gyro"]
    return SOURCE[chip] + NOTE.get(chip, "")


def noise(sensor, bandwidths_hz):
    """(mg, °/s) of one sample behind filters of these bandwidths."""
    return tuple([0.0 if figure(sensor, kind, "density") is None else
                  figure(sensor, kind, "density") * (NOISE_BANDWIDTH * hz) ** 0.5
                  for kind, hz in zip(("accel", "gyro"), bandwidths_hz)])


def part(sensor):
    """Keyword arguments of sensor_model.typical_truth: a part as the data sheet lets it be."""
    radians = 0.01 * figure(sensor, "accel", "cross_axis")
    return {"accel_bias_mg": figure(sensor, "accel", "offset"),
            "scale": 0.01 * figure(sensor, "accel", "scale"),
            "misalignment_deg": 57.29577951308232 * radians,
            "gyro_scale": 0.01 * figure(sensor, "gyro", "scale"),
            "gyro_bias_dps": figure(sensor, "gyro", "offset")}
