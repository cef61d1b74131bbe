"""Are the counts per unit of a header or a record those of its chip?"""

from sixflip.chips import catalogue

OFF = 0.02              # published drivers shipped 62.5 for 65.5
# An ADXL345 has 256 counts per g in every range, or 512 over the range with FULL_RES off, give or
# take 10 % (data sheet rev. E, table 1).
ADXL345_PRODUCT, ADXL345_OFF = 512, 0.1


def full_scale(chip):
    """Full scale times counts per unit, accelerometer and gyro, which is the same in every range;
    None where it is not, or where we know none."""
    if chip not in [row[0] for row in catalogue.CHIPS if row[1]]:
        return None, None
    driver = catalogue.driver(chip)
    return tuple(rows[0][0] * rows[0][1]
                 if rows and len({row[1] for row in rows}) == len(rows) else None
                 for rows in (driver.ACCEL_RANGES, driver.GYRO_RANGES))


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
