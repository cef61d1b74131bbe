import math
import struct
import unittest
from binascii import crc32

from sixflip.accelerometer.normal_equations import DOUBLE
from sixflip.record import correction_record
from sixflip.record.correction import Correction
from sixflip.record.correction_record import Record, decode, encode

P = [[1.01, 0.01, 0.02, 0.0], [-0.03, 0.99, 0.0, 0.0], [0.01, 0.02, 1.03, 0.0],
     [0.1 / 3, -0.2, 1.1, 1.0]]
W = [[0.98, 0.01, 0.0], [0.0, 1.02, -0.01], [0.02, 0.0, 1.0], [0.01, -0.02, 0.005]]


def full():
    r = Record()
    r.sequence, r.session, r.time = 7, 0xFEDCBA98, 1700000000
    r.chip, r.who_am_i = "mpu6050", (0x70, 0x70)
    r.accel_range_g, r.gyro_range_dps = 2, 500
    r.accel_lsb_per_g, r.gyro_lsb_per_dps = 16384, 65.5
    r.temp_c = 24.5
    r.accel = {"P": P, "sigma_P": P, "tilt_deg": 1.5, "tilt_spread_deg": None,
               "residual_rms_g": 0.25, "noise_g": 0.5, "level": "tilt solved",
               "verdict": "good", "reason": "2° of tilt"}
    r.gyro = {"P": W, "sigma_P": W, "missing": [0, 2], "verdict": "doubtful", "reason": ""}
    r.gyro_bias = {"bias_dps": [0.5, -1.25, 2.0], "temp_c": 24.0}
    r.mounting = {"roll_deg": 1.0, "pitch_deg": -2.0, "order": "xyz", "axes": "x y z",
                  "frame": "rep103"}
    return r


class RoundTrip(unittest.TestCase):
    def test_everything_comes_back(self):
        data = encode(full())
        r = decode(data)
        for name in ("sequence", "session", "time", "chip", "who_am_i", "accel_range_g",
                     "gyro_range_dps", "accel_lsb_per_g", "gyro_lsb_per_dps", "float_bits",
                     "temp_c", "gyro_bias", "mounting"):
            self.assertEqual(getattr(r, name), getattr(full(), name))
        self.assertEqual(r.accel["P"], P)
        self.assertEqual(r.gyro["P"], W)
        self.assertEqual(r.gyro["missing"], [0, 2])
        self.assertEqual(r.accel["reason"], "2° of tilt")
        self.assertIsNone(r.accel["tilt_spread_deg"])
        self.assertEqual(r.float_bits, 64 if DOUBLE else 32)
        self.assertEqual(encode(r), data)
        self.assertLess(len(data), 512)

    def test_flip_angles_come_back_to_the_last_bit(self):
        r = full()
        self.assertIsNone(decode(encode(r)).flips)
        r.flips = {"excess": [0.125, -0.17, 0.0, 0.0, 1e-3, 0.0], "scale_sigma": 0.25,
                   "sequence": 7}
        again = decode(encode(r))
        self.assertEqual(again.flips, r.flips)
        self.assertEqual(again.measured(), full().measured())

    def test_only_what_was_measured_is_there(self):
        r = full()
        self.assertEqual(r.measured(), ["accel", "gyro", "gyro_bias", "mounting"])
        r.gyro = r.mounting = r.temp_c = None
        r = decode(encode(r))
        self.assertEqual(r.measured(), ["accel", "gyro_bias"])
        self.assertIsNone(r.gyro)
        self.assertIsNone(r.temp_c)

    def test_a_section_of_a_later_version_is_kept(self):
        r = full()
        r.unknown.append((9, b"later"))
        self.assertEqual(decode(encode(r)).unknown, [(9, b"later")])
        self.assertEqual(encode(decode(encode(r))), encode(r))

    def test_a_reason_too_long_is_cut(self):
        r = full()
        r.accel["reason"] = "x" * 1000
        self.assertEqual(decode(encode(r)).accel["reason"], "x" * 200)
        r.accel["reason"] = "°" * 300
        self.assertIn("°°°", decode(encode(r)).accel["reason"])


class Damage(unittest.TestCase):
    def test_any_byte_changed_is_noticed(self):
        data = encode(full())
        for at in range(len(data)):
            for flip in (1, 0x80, 0xFF):
                bad = bytearray(data)
                bad[at] ^= flip
                self.assertRaises(ValueError, decode, bytes(bad))

    def test_any_cut_and_any_tail_is_noticed(self):
        data = encode(full())
        for n in range(len(data)):
            self.assertRaises(ValueError, decode, data[:n])
        self.assertRaises(ValueError, decode, data + b"\x00")

    def sealed(self, data):
        """The bytes with a right CRC: what the CRC does not catch, the rest must."""
        body = bytes(data[:-4])
        return body + struct.pack("<I", crc32(body) & 0xFFFFFFFF)

    def refused(self, data, words):
        with self.assertRaises(ValueError) as caught:
            decode(self.sealed(data))
        self.assertIn(words, str(caught.exception))

    def test_behind_a_right_crc(self):
        data = bytearray(encode(full()))
        data[4] = 2
        self.refused(data, "layout version 2")
        data[4] = 1
        self.refused(data + b"\x00", "bytes and has")
        at = correction_record.HEAD_SIZE
        wrong = bytearray(data)
        wrong[at + 1:at + 3] = struct.pack("<H", 60000)
        self.refused(wrong, "ends inside section 1")
        wrong = bytearray(data)
        wrong[at + 3:at + 11] = struct.pack("<d", float("nan"))
        self.refused(wrong, "finite")

    def test_a_number_that_is_none_is_not_written(self):
        for bad in (float("nan"), float("inf")):
            r = full()
            r.gyro["P"] = [row[:] for row in W]
            r.gyro["P"][2][1] = bad
            self.assertRaises(ValueError, encode, r)

    def test_words_that_are_no_verdict(self):
        r = full()
        r.accel["verdict"] = "fine"
        self.assertRaises(ValueError, encode, r)
        r = full()
        r.chip = "a name of more than 16 bytes"
        self.assertRaises(ValueError, encode, r)


class Apply(unittest.TestCase):
    def corrected(self, record, sample):
        out = [0.0] * 6
        self.assertIs(Correction(record).apply(sample, out), out)
        return out

    def near(self, found, expected, delta=1e-5):
        for x, y in zip(found, expected):
            self.assertAlmostEqual(x, y, delta=delta)

    def test_nothing_measured_is_the_data_sheet(self):
        r = full()
        r.accel = r.gyro = r.gyro_bias = r.mounting = None
        out = self.corrected(r, [16384, -8192, 0, 655, 0, -6550, 3])
        self.near(out, (r.g, -r.g / 2, 0, math.radians(10), 0, math.radians(-100)))

    def test_the_formula_row_by_row(self):
        r = full()
        r.gyro_bias = r.mounting = None
        sample = [1000, -2000, 15000, 100, 200, -300, 0]
        m = [c / 16384 * r.g for c in sample[:3]] + [1]
        w = [math.radians(c / 65.5) for c in sample[3:6]] + [1]
        expected = [sum([m[i] * P[i][j] for i in range(4)]) for j in range(3)]
        expected += [sum([w[i] * W[i][j] for i in range(4)]) for j in range(3)]
        self.near(self.corrected(r, sample), expected)

    def test_the_bias_of_the_last_rest_reads_zero(self):
        r = full()
        sample = [0, 0, 16384, 0.5 * 65.5, -1.25 * 65.5, 2.0 * 65.5, 0]
        self.near(self.corrected(r, sample)[3:], (0, 0, 0))
        correction = Correction(r)
        correction.set_gyro_bias([10, 20, 30])
        self.near(correction.apply([0, 0, 0, 10, 20, 30, 0], [0.0] * 6)[3:], (0, 0, 0))

    def test_the_mounting_turns_both(self):
        r = full()
        r.accel = r.gyro = r.gyro_bias = None
        r.mounting = {"roll_deg": 90.0, "pitch_deg": 0.0, "order": "xyz", "axes": "x y z",
                      "frame": "rep103"}
        # Rolled by 90 degrees gravity shows on the sensor's y; the robot's up is z.
        out = self.corrected(r, [0, 16384, 0, 0, 655, 0, 0])
        self.near(out, (0, 0, r.g, 0, 0, math.radians(10)))

    def test_without_a_gyro_its_part_is_zero(self):
        r = full()
        r.gyro = r.gyro_bias = None
        r.gyro_lsb_per_dps = 0
        self.assertEqual(self.corrected(r, [0, 0, 100, 5, 5, 5, 0])[3:], [0.0] * 3)


if __name__ == "__main__":
    unittest.main()
