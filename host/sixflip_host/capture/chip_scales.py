"""Are the counts per unit of a header or a record those of its chip?"""

from sixflip.chips import catalogue

OFF = 0.02              # published drivers shipped 62.5 for 65.5
# An ADXL345 has 256 counts per g in every range, or 512 over the range with FULL_RES off, give or
# take 10 % (data sheet rev. E, table 1).
ADXL345_PRODUCT, ADXL345_OFF = 512, 0.1
# Ends of the ranges that accelerometers (g) and gyros (deg/s) are sold with, all times a power of
# two. ST calls a gyro's by 245 (L3GD20, LSM9DS1) or 250; its register ends where its 4.375 mdps a
# count do (LSM6DS3, DocID026899, table 3): 143 deg/s of 125, and 2294 of 2000.
FULL_SCALES = {"accel": tuple(2.0 * 2 ** k for k in range(5)), "gyro": tuple(
    first * 2 ** k for first in (125.0, 4.375e-3 * 2 ** 15, 245.0) for k in range(6))}
# Sensitivities are rounded: 32767 counts are 250.1 deg/s at the 131 of an MPU6050, 1998 at 16.4,
# 2279 at the 14.375 of an ITG3205.
ROUNDED = 0.01


def full_scale(chip):
    """Full scale times counts per unit, accelerometer and gyro, which is the same in every range;
    None where it is not, or where we know none."""
    if chip not in [row[0] for row in catalogue.CHIPS if row[1]]:
        return None, None
    driver = catalogue.driver(chip)
    return tuple(rows[0][0] * rows[0][1]
                 if rows and len({row[1] for row in rows}) == len(rows) else None
                 for rows in (driver.ACCEL_RANGES, driver.GYRO_RANGES))


def is_full_scale(sensor, size):
    """True when a size (g or deg/s) is where a usual range of a sensor ("accel", "gyro") ends."""
    return any(abs(size / full - 1.0) <= ROUNDED for full in FULL_SCALES[sensor])


def wrong(chip, range_g, accel_lsb, range_dps, gyro_lsb):
    """None, or (what was found, what was expected); 0 or None is what is not stated."""
    accel, gyro = full_scale(chip)
    if chip in ("gy85", "adxl345") and accel_lsb:
        ranges = (2, range_g) if range_g else (2, 4, 8, 16)
        if all(abs(accel_lsb * full / ADXL345_PRODUCT - 1) > ADXL345_OFF for full in ranges):
            return "%s with %g counts per g" % (_a(chip), accel_lsb), "256"
    for product, full, lsb, unit in ((accel, range_g, accel_lsb, "g"),
                                     (gyro, range_dps, gyro_lsb, "deg/s")):
        if product and full and lsb and abs(full * lsb / product - 1) > OFF:
            return "%s with %g counts per %s at ±%g %s" % (_a(chip), lsb, unit, full, unit), \
                "%g" % counts_at(chip, unit, full, product)
    return None


def counts_at(chip, unit, full, product):
    """The chip's counts per unit at a full scale, by its table where it has that."""
    driver = catalogue.driver(chip)
    rows = driver.ACCEL_RANGES if unit == "g" else driver.GYRO_RANGES
    return {row[0]: row[1] for row in rows}.get(full, round(product / full, 3))


def _a(chip):
    """The chip's name with its article, by how it is said."""
    return ("an " if chip[0] in "ail" else "a ") + chip
