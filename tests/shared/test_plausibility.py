"""A record whose bytes are whole may still be no sensor's."""

import unittest

from test_correction_record import full

from sixflip.record.record import following, implausible, newer


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
    ("accel", "P", times(GOOD.accel["P"], 100), "P[0][0] of the accelerometer is 101"),
    ("accel", "P", FLAT, "P[1][0] of the accelerometer is 1:"),
    ("accel", "P", FAR, "P[3][0] of the accelerometer is 9"),
    ("gyro", "P", times(GOOD.gyro["P"], 100), "P[0][0] of the gyro"),
    ("gyro", "P", TURNED, "P[0][1] of the gyro is 0.9"),
    ("gyro_bias", "bias_dps", [0.0, 1e9, 0.0], "bias in deg/s is 1e+09"),
    ("mounting", "axes", "x y y", "axes x y y"),
    ("mounting", "axes", "", "expected x, y and z"),
    ("mounting", "roll_deg", 400.0, "roll_deg"),
    ("", "g", 0.0, "g in m/s2 is 0"), ("", "g", 98.0, "g in m/s2 is 98"),
    ("", "float_bits", 8, "8-bit"),
)


class Plausibility(unittest.TestCase):
    def test_a_sensors_record(self):
        self.assertEqual(implausible(full()), "")

    def test_what_no_sensor_has_is_named(self):
        for section, field, value, words in CASES:
            self.assertIn(words, implausible(spoilt(section, field, value)))


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
