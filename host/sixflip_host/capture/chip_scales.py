"""Are the counts per unit of a header or a record those of its chip?"""

# Full scale times counts a unit, accelerometer and gyro (MPU-6000 register map 4.2, registers 27
# and 28; ITG-3205 data sheet rev. 1.0, section 3.1). An ADXL345 has 256 counts per g in every
# range, or 512 over the range with FULL_RES off, give or take 10 % (data sheet rev. E, table 1).
FULL_SCALE = {"mpu6050": (32768, 32768), "gy85": (None, 28750), "itg3205": (None, 28750)}
OFF = 0.02              # published drivers shipped 62.5 for 65.5
ADXL345_PRODUCT, ADXL345_OFF = 512, 0.1


def wrong(chip, range_g, accel_lsb, range_dps, gyro_lsb):
    """None, or (what was found, what was expected); 0 or None is what is not stated."""
    accel, gyro = FULL_SCALE.get(chip, (None, None))
    if chip in ("gy85", "adxl345") and accel_lsb:
        ranges = (2, range_g) if range_g else (2, 4, 8, 16)
        if all(abs(accel_lsb * full / ADXL345_PRODUCT - 1) > ADXL345_OFF for full in ranges):
            return "%s with %g counts per g" % (_a(chip), accel_lsb), "256"
    for product, full, lsb, unit in ((accel, range_g, accel_lsb, "g"),
                                     (gyro, range_dps, gyro_lsb, "deg/s")):
        if product and full and lsb and abs(full * lsb / product - 1) > OFF:
            return "%s with %g counts per %s at ±%g %s" % (_a(chip), lsb, unit, full, unit), \
                "%.5g" % (product / full)
    return None


def _a(chip):
    """The chip's name with its article, by how it is said."""
    return ("an " if chip[0] in "ai" else "a ") + chip
