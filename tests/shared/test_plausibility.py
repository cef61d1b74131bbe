"""A record whose bytes are whole may still be no sensor's."""

import unittest

from test_correction_record import full

from sixflip.plausibility import implausible
from sixflip.record import following, newer


def spoilt(section, field, value):
    """A whole record with one field changed."""
    record = full()
    if section:
        getattr(record, section)[field] = value
    else:
        setattr(record, field, value)
    return record


def times(P, factor):
    return [[x * factor for x in row[:3]] + row[3:] for row in P]


GOOD = full()
FLAT = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
FAR = GOOD.accel["P"][:3] + [[9.0, 0.0, 0.0, 1.0]]
TURNED = [[1.0, 0.9, 0.0], [-0.9, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]
CASES = (
    ("accel", "P", times(GOOD.accel["P"], 100), "scale of axis x is"),
    ("accel", "P", FLAT, "no inverse"),
    ("accel", "P", FAR, "bias on x"),
    ("gyro", "P", times(GOOD.gyro["P"], 100), "gyro's scale"),
    ("gyro", "P", TURNED, "mixed"),
    ("gyro_bias", "bias_dps", [0.0, 1e9, 0.0], "bias on y"),
    ("mounting", "axes", "x y y", "axes x y y"),
    ("mounting", "axes", "", "expected x, y and z"),
    ("mounting", "roll_deg", 400.0, "roll_deg"),
    ("", "g", 0.0, "g is 0"), ("", "g", 98.0, "g is 98"), ("", "float_bits", 8, "8-bit"),
    ("", "accel_range_g", 16, "expected 2048"), ("", "gyro_lsb_per_dps", 62.5, "62.5 counts"),
)


class Plausibility(unittest.TestCase):
    def test_a_sensors_record(self):
        self.assertEqual(implausible(full()), "")

    def test_what_no_sensor_has_is_named(self):
        for section, field, value, words in CASES:
            self.assertIn(words, implausible(spoilt(section, field, value)))

    def test_counts_of_every_chip(self):
        for chip, accel, gyro in (("gy85", (16, 256), (2000, 14.375)),
                                  ("adxl345", (16, 256), (0, 0)),
                                  ("adxl345", (2, 256), (0, 0)), ("adxl345", (16, 32), (0, 0)),
                                  ("mpu6050", (16, 2048), (2000, 16.4)),
                                  ("other", (3, 1000), (300, 7.0))):
            record = full()
            record.chip = chip
            record.accel_range_g, record.accel_lsb_per_g = accel
            record.gyro_range_dps, record.gyro_lsb_per_dps = gyro
            self.assertEqual(implausible(record), "")


class Sequence(unittest.TestCase):
    def test_numbers_begin_again(self):
        last = 0xFFFFFFFF
        self.assertEqual(following(last), 0)
        for new, old in ((2, 1), (0, last), (5, last - 5)):
            self.assertTrue(newer(new, old))
            self.assertFalse(newer(old, new))
        self.assertFalse(newer(7, 7))


if __name__ == "__main__":
    unittest.main()
