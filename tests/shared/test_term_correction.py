"""The terms of a record: stored, checked, and taken out of samples that were made with them."""

import math
import unittest

import sixflip_host.record_terms as record_terms
from sixflip.accelerometer.normal_equations import DOUBLE
from sixflip.accelerometer.scale_form import inverse3
from sixflip.record.correction import Correction, correction_of
from sixflip.record.correction_record import MOST, decode, encode
from sixflip.record.record import Record
from sixflip.record.term_correction import TERMS

P = [[1.01, 0.01, 0.02, 0.0], [-0.03, 0.99, 0.0, 0.0], [0.01, 0.02, 1.03, 0.0],
     [0.1, -0.2, 0.5, 1.0]]
W = [[0.98, 0.01, 0.0], [0.0, 1.02, -0.01], [0.02, 0.0, 1.0], [0.01, -0.02, 0.005]]
BIAS = [0.5, -1.25, 2.0]
LSB, DPS, G = 16384.0, 65.5, 9.8
CALIBRATED_C, REST_C, LOW_C, HIGH_C = 24.0, 26.0, 15.0, 40.0
KNOWN = {"axes": [0, 2], "origin": "sessions held out", "source": "warming.csv cooling.csv",
         "before": 6.0, "after": 2.0, "floor": None}
RANGE = {"t0_c": 28.0, "low_c": LOW_C, "high_c": HIGH_C, "temp_lsb_per_c": 340.0,
         "temp_offset_c": 36.53}
SIGMAS = [0.25, 0.5, 0.125]
TERM = {
    "accel_thermal_bias": {"k1": [0.5, -0.7, -1.8], "k2": [0.01, 0.0, 0.03]},
    "gyro_thermal_bias": {"k1": [0.04, -0.1, 0.3], "k2": [0.0, 0.002, -0.001]},
    "accel_thermal_scale": {"k1": [0.02, -0.03, 0.05]},
    "gyro_thermal_scale": {"k1": [0.1, 0.0, -0.1]},
    "g_sensitivity": {"k": [[0.1, -0.05, 0.02], [0.0, 0.2, 0.03], [-0.04, 0.01, 0.15]]}}


def plain():
    r = Record()
    r.chip, r.who_am_i = "mpu6050", (0x68, 0x68)
    r.accel_range_g, r.gyro_range_dps = 2, 500
    r.accel_lsb_per_g, r.gyro_lsb_per_dps, r.g = LSB, DPS, G
    r.temp_c = CALIBRATED_C
    r.accel = {"P": P, "sigma_P": P, "tilt_deg": 1.5, "tilt_spread_deg": None,
               "residual_rms_g": 0.25, "noise_g": 0.5, "level": "tilt solved",
               "verdict": "good", "reason": ""}
    r.gyro = {"P": W, "sigma_P": W, "missing": [], "verdict": "good", "reason": ""}
    r.gyro_bias = {"bias_dps": BIAS, "temp_c": REST_C}
    return r


def fields_of(name):
    fields = dict(KNOWN)
    fields.update(TERM[name])
    if name == "g_sensitivity":
        fields["sigma"] = [SIGMAS] * 3
        return fields
    fields.update(RANGE)
    fields["sigma_k1"] = SIGMAS
    if "k2" in fields:
        fields["sigma_k2"] = SIGMAS
    return fields


def with_terms(names):
    r = plain()
    for name in names:
        record_terms.put(r, name, fields_of(name))
    return decode(encode(r))


ALL = [name for _, name in TERMS]


def polynomial(name, t):
    """[3] at t, what is clamped to the range."""
    d = min(max(t, LOW_C), HIGH_C) - RANGE["t0_c"]
    k1 = TERM[name]["k1"]
    k2 = TERM[name].get("k2", [0.0] * 3)
    return [k1[j] * d + k2[j] * d * d for j in range(3)]


def change(name, names, t, since):
    if name not in names:
        return [0.0] * 3
    now, then = polynomial(name, t), polynomial(name, since)
    return [now[j] - then[j] for j in range(3)]


def times(v, M):
    """Row vector times matrix."""
    return [sum([v[i] * M[i][j] for i in range(3)]) for j in range(3)]


def sample(names, f, w, t, rest_f=None, rest_c=REST_C):
    """Counts (not rounded) of a sensor with these terms: f in m/s2, w in rad/s, both true.
    rest_f: the gyro bias was measured there, at rest_c; None: over all faces."""
    stretch = change("accel_thermal_scale", names, t, CALIBRATED_C)
    drift = change("accel_thermal_bias", names, t, CALIBRATED_C)
    y = [f[j] * (1 + stretch[j] / 100) + drift[j] * 1e-3 * G for j in range(3)]
    m = times([y[j] - P[3][j] for j in range(3)], inverse3([row[:3] for row in P[:3]]))
    stretch = change("gyro_thermal_scale", names, t, CALIBRATED_C)
    read = times([w[j] * (1 + stretch[j] / 100) for j in range(3)], inverse3(W[:3]))
    drift = change("gyro_thermal_bias", names, t, rest_c)
    rates = []
    for i in range(3):
        x = math.degrees(read[i]) + BIAS[i] + drift[i]
        if "g_sensitivity" in names:
            K = TERM["g_sensitivity"]["k"][i]
            x += sum([K[j] * (f[j] - (rest_f[j] if rest_f else 0.0)) / G for j in range(3)])
        rates.append(x * DPS)
    return [x / G * LSB for x in m] + rates + [(t - 36.53) * 340.0]


class Stored(unittest.TestCase):
    def test_each_comes_back(self):
        for name in ALL:
            r = with_terms([name])
            self.assertEqual(record_terms.names_of(r), [name])
            self.assertEqual(record_terms.terms(r), {name: fields_of(name)})

    def test_all_together_fit_with_the_longest_texts(self):
        r = with_terms(ALL)
        for section in (r.accel, r.gyro):
            section["reason"] = "x" * 300
        r.flips = {"excess": [0.125] * 6, "scale_sigma": 0.25, "sequence": 7}
        r.mounting = {"roll_deg": 1.0, "pitch_deg": -2.0, "order": "xyz", "axes": "-x -y z",
                      "frame": "rep103"}
        for name in ALL:
            long = fields_of(name)
            long["source"] = "°" * 300
            record_terms.put(r, name, long)
        data = encode(r)
        self.assertTrue(len(data) <= MOST, len(data))
        self.assertEqual(encode(decode(data)), data)
        self.assertEqual(record_terms.terms(decode(data))[ALL[0]]["source"], "°" * 30)

    def test_firmware_that_does_not_know_them_keeps_them(self):
        r = with_terms(ALL)
        old = plain()
        old.unknown = r.terms  # what it makes of tags it does not know
        self.assertEqual(encode(old), encode(r))

    def test_a_new_one_takes_the_place_of_the_old(self):
        r = with_terms(ALL)
        fields = fields_of("g_sensitivity")
        fields["k"] = [[0.5] * 3] * 3
        record_terms.put(r, "g_sensitivity", fields)
        again = record_terms.terms(decode(encode(r)))
        self.assertEqual(len(again), 5)
        self.assertEqual(again["g_sensitivity"]["k"], [[0.5] * 3] * 3)

    def test_a_record_that_grows_too_large_is_not_written(self):
        r = plain()
        r.unknown.append((99, b"x" * MOST))
        self.assertRaises(ValueError, encode, r)


class Refused(unittest.TestCase):
    def refused(self, record, name, fields, words):
        with self.assertRaises(ValueError) as caught:
            record_terms.put(record, name, fields)
        self.assertIn(words, str(caught.exception))

    def test_numbers_that_no_chip_has(self):
        for key, value in (("low_c", 40.0), ("high_c", 200.0), ("t0_c", -100.0),
                           ("temp_lsb_per_c", 0.0), ("k1", [0.0, 0.0, 101.0]),
                           ("k2", [float("inf"), 0.0, 0.0]), ("origin", "a guess")):
            for name in ("accel_thermal_bias", "gyro_thermal_bias"):
                fields = fields_of(name)
                fields[key] = value
                self.refused(plain(), name, fields, "")
        fields = fields_of("accel_thermal_scale")
        fields["k1"] = [2.0, 2.0, 2.001]
        self.refused(plain(), "accel_thermal_scale", fields, "2.0 at most")
        fields["k1"], fields["low_c"] = [2.0] * 3, -20.0
        self.refused(plain(), "accel_thermal_scale", fields, "more than half")

    def test_a_sensor_that_cannot_have_it(self):
        r = plain()
        r.chip = "adxl345"
        self.refused(r, "accel_thermal_bias", fields_of("accel_thermal_bias"), "temperature")
        r = plain()
        r.temp_c = None
        self.refused(r, "gyro_thermal_bias", fields_of("gyro_thermal_bias"), "temperature")
        r.gyro_lsb_per_dps = 0.0
        self.refused(r, "g_sensitivity", fields_of("g_sensitivity"), "has none")

    def test_bytes_behind_a_right_crc(self):
        for tag, name in TERMS:
            r = with_terms([name])
            payload = r.terms[0][1]
            for bad, use in ((payload[:-3], record_terms.terms), (b"", correction_of),
                             (payload[:8] + b"\xff" * 8 + payload[16:], correction_of)):
                r.terms = [(tag, bad)]
                with self.assertRaises(ValueError) as caught:
                    use(decode(encode(r)))
                self.assertIn(name, str(caught.exception))
            r.terms = [(tag, payload), (tag, payload)]
            self.assertRaises(ValueError, correction_of, decode(encode(r)))


class Applied(unittest.TestCase):
    f = [3.0, -5.0, 7.0]
    w = [0.5, -1.0, 0.25]

    def corrected(self, correction, counts):
        return correction.apply(counts, [0.0] * 6)

    def near(self, found, expected, delta=None):
        delta = delta or (1e-9 if DOUBLE else 3e-5)
        for x, y in zip(found, expected):
            self.assertAlmostEqual(x, y, delta=delta)

    def test_without_terms_nothing_changes(self):
        r = plain()
        self.assertIs(type(correction_of(r)), Correction)

    def test_each_and_all_are_taken_out_at_any_temperature(self):
        for names in [[name] for name in ALL] + [ALL]:
            correction = correction_of(with_terms(names))
            for t in (0.0, 15.0, 24.0, 31.7, 39.0, 60.0, 24.0):
                counts = sample(names, self.f, self.w, t)
                self.near(self.corrected(correction, counts), self.f + self.w)

    def test_what_one_term_does_the_others_do_not(self):
        for name in ALL:
            counts = sample([name], self.f, self.w, 36.0)
            others = [one for one in ALL if one != name]
            found = self.corrected(correction_of(with_terms(others)), counts)
            off = max([abs(x - y) for x, y in zip(found, self.f + self.w)])
            self.assertTrue(off > 1e-3, (name, off))

    def test_a_rest_at_another_temperature_and_attitude(self):
        lying = [0.0, 0.0, G]
        correction = correction_of(with_terms(ALL))
        self.assertIsNone(correction.rest)
        for rest_c in (35.0, 10.0, 20.0):
            rest = sample(ALL, lying, [0.0] * 3, rest_c, lying, rest_c)
            correction.set_rest(rest)
            self.assertEqual(correction.rest, rest)
            self.near(self.corrected(correction, rest)[3:], [0.0] * 3)
            for t in (18.0, 37.0):
                counts = sample(ALL, self.f, self.w, t, lying, rest_c)
                self.near(self.corrected(correction, counts), self.f + self.w)

    def test_the_mounting_turns_last(self):
        r = with_terms(ALL)
        r.mounting = {"roll_deg": 90.0, "pitch_deg": 0.0, "order": "xyz", "axes": "x y z",
                      "frame": "rep103"}
        alone = plain()
        alone.mounting = r.mounting
        expected = self.corrected(correction_of(alone), sample([], self.f, self.w, 33.0))
        lying = [0.0, 0.0, G]
        correction = correction_of(r)
        self.near(self.corrected(correction, sample(ALL, self.f, self.w, 33.0)), expected)
        correction.set_rest(sample(ALL, lying, [0.0] * 3, 30.0, lying, 30.0))
        self.near(self.corrected(correction, sample(ALL, self.f, self.w, 33.0, lying, 30.0)),
                  expected)

    def test_outside_of_the_range_is_said_once(self):
        said = []
        correction = correction_of(with_terms(ALL), lambda *what: said.append(what))
        for t in (LOW_C + 0.1, HIGH_C - 0.1, CALIBRATED_C):
            self.corrected(correction, sample(ALL, self.f, self.w, t))
        self.assertEqual(said, [])
        for t in (HIGH_C + 2.0, LOW_C - 2.0, HIGH_C + 3.0):
            self.corrected(correction, sample(ALL, self.f, self.w, t))
        self.assertEqual(len(said), 1)
        self.near(said[0], (HIGH_C + 2.0, LOW_C, HIGH_C), 1e-4)
        self.near(correction.range_c, (LOW_C, HIGH_C))


if __name__ == "__main__":
    unittest.main()
