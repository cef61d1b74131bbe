import unittest
from array import array

from synthetic_operator import Noise

from sixflip.poses.noise_floor import ENTER, NoiseFloor
from sixflip.poses.still_window import SAME, SPAN, StillWindow, window_length


def fill(window, rows, dt_us=10000):
    """The answers of add() for rows of seven counts."""
    return [window.add(dt_us, array("h", row)) for row in rows]


def stream(n, seed=3, sd=30, at=16000):
    """Rows of seven counts one after the other: a small heap never holds them all."""
    noise = Noise(seed)
    for _ in range(n):
        yield [noise.draw(sd), noise.draw(sd), at + noise.draw(sd),
               noise.draw(4) + 7, noise.draw(4), noise.draw(4), -3700]


def noisy_rows(n, **options):
    return list(stream(n, **options))


class Window(unittest.TestCase):
    def test_sums_and_variances_are_exact(self):
        rows = noisy_rows(25)
        window = StillWindow(25, 32767, 32767, 10000)
        self.assertEqual(fill(window, rows), [False] * 24 + [True])
        for i in range(6):
            column = [row[i] for row in rows]
            total = sum(column)
            self.assertEqual(window.total(i), total)
            self.assertEqual(window.spread(i), 25 * sum(v * v for v in column) - total * total)
            self.assertAlmostEqual(window.mean(i), total / 25, delta=0.01)
        self.assertEqual(window.total(6), -3700 * 25)
        self.assertEqual(window.us, 250000)
        self.assertFalse(window.jumped)

    def test_a_window_that_jumped_has_no_negative_variance(self):
        rows = [[0, 0, 0, 0, 0, 0, 0]] + [[30000, 0, 0, 0, 0, 0, 0]] * 24
        window = StillWindow(25, 32767, 32767, 10000)
        fill(window, rows)
        self.assertTrue(window.jumped)
        self.assertEqual(window.spread(0), 0)

    def test_a_second_window_starts_anew(self):
        window = StillWindow(25, 32767, 32767, 10000)
        fill(window, noisy_rows(25, at=5000))
        rows = noisy_rows(25, seed=9)
        fill(window, rows)
        self.assertEqual(window.total(2), sum(row[2] for row in rows))

    def test_full_scale_swings_stay_exact_and_within_30_bits(self):
        rows = [[32767 if k % 2 else -32768] * 6 + [0] for k in range(63)]
        window = StillWindow(63, 32767, 32767, 10000)
        fill(window, rows)
        self.assertTrue(window.jumped)
        self.assertEqual(window.total(0), sum(row[0] for row in rows))
        self.assertLess(max(window.q), 1 << 30)
        self.assertEqual(max(window.q), 31 * SPAN * SPAN)

    def test_a_rail_is_saturation_on_either_side(self):
        for peak, which in ((32767, "accel"), (-32768, "accel"), (32767, "gyro")):
            rows = noisy_rows(25)
            rows[11][0 if which == "accel" else 4] = peak
            window = StillWindow(25, 32767, 32767, 10000)
            fill(window, rows)
            self.assertEqual(window.accel_saturated, peak if which == "accel" else 0)
            self.assertEqual(window.gyro_saturated, peak if which == "gyro" else 0)
            fill(window, noisy_rows(25))
            self.assertEqual(window.accel_saturated, 0)

    def test_identical_readings_are_stale_at_the_thirty_second(self):
        for first in (0, 3):
            window = StillWindow(25, 32767, 32767, 10000)
            rows = noisy_rows(60)
            for row in rows:
                row[first : first + 3] = [12, 13, 14]
            seen = []
            for row in rows:
                window.add(10000, array("h", row))
                seen.append(window.stale)
            self.assertEqual(seen.index(SAME), SAME - 1)

    def test_two_axes_alike_are_not_stale(self):
        window = StillWindow(25, 32767, 32767, 10000)
        rows = noisy_rows(100)
        for row in rows:
            row[0] = row[1] = 5
        fill(window, rows)
        self.assertEqual(window.stale, 0)

    def test_no_gyro_is_not_a_stale_gyro(self):
        window = StillWindow(25, 4096, 0, 10000)
        fill(window, [row[:3] + [0, 0, 0, 0] for row in noisy_rows(100, at=256, sd=2)])
        self.assertEqual(window.stale, 0)

    def test_late_samples_by_the_timestamps(self):
        window = StillWindow(25, 32767, 32767, 10000)
        rows = noisy_rows(25)
        for k, row in enumerate(rows):
            window.add({5: 20100, 9: 49900, 10: 4000, 12: 12000}.get(k, 10000), array("h", row))
        off = {5: 10100 // 128, 9: 39900 // 128, 10: -6000 // 128}
        self.assertEqual(window.late, [sum(
            u * (rows[k - 1][3 + i] + rows[k][3 + i]) for k, u in off.items())
            for i in range(3)] + [sum(off.values())])
        self.assertEqual(window.largest_gap_us, 49900)
        self.assertEqual(window.us, 21 * 10000 + 20100 + 49900 + 4000 + 12000)

    def test_steps_of_the_counts(self):
        for step in (1, 4):
            window = StillWindow(25, 32767, 32767, 10000)
            fill(window, [[v // step * step for v in row] for row in noisy_rows(25)])
            self.assertEqual(window.step(0), step)

    def test_lengths(self):
        for rate, samples in ((100, 400), (102.4, 400), (204.8, 400), (50, 200), (333, 1000),
                              (1000, 400), (10, 30), (100, 1)):
            length = window_length(rate, samples)
            self.assertTrue(12 <= length < 64)
            StillWindow(length, 1, 1, 1)
        self.assertEqual(window_length(100, 400), 25)
        self.assertRaises(ValueError, StillWindow, 64, 1, 1, 1)


class Floor(unittest.TestCase):
    def learn(self, rows, lsb=16384, dps=65.5):
        self.window = StillWindow(25, 32767, 32767 if dps else 0, 10000)
        self.floor = NoiseFloor(lsb, dps)
        self.look(rows)
        return self.floor

    def look(self, rows):
        for row in rows:
            if self.window.add(10000, array("h", row)):
                self.floor.look(self.window)

    def test_measures_the_sensors_own_noise_and_bias(self):
        floor = self.learn(stream(100))
        self.assertTrue(floor.known)
        for i in range(3):
            self.assertAlmostEqual(floor.sd[i], 30, delta=6)
            self.assertAlmostEqual(floor.sd[3 + i], 4, delta=0.8)
        self.assertAlmostEqual(floor.bias[0], 7, delta=1.5)

    def test_three_windows_are_not_enough(self):
        self.assertFalse(self.learn(stream(99)).known)

    def test_shaking_is_not_taken_for_noise(self):
        floor = self.learn(stream(400, sd=700))  # 43 mg
        self.assertFalse(floor.known)
        self.assertEqual(floor.reason, "noisy")
        self.assertEqual(floor.limit, 30.0)
        self.assertEqual(floor.unit, "mg")
        self.assertGreater(floor.value, 30.0)

    def test_uneven_windows_are_not_learnt(self):
        floor = self.learn(())
        for k in range(16):
            self.look(stream(25, seed=k + 1, sd=30 if k % 2 else 200))
        self.assertFalse(floor.known)
        self.assertEqual(floor.reason, "moving")

    def test_quantisation_is_the_least_noise(self):
        rows = [[k % 2, k % 3 == 0, 256, (k // 5) % 2, 1, 0, 0] for k in range(100)]
        rows = [[int(v) for v in row] for row in rows]
        floor = self.learn(rows, lsb=256)
        self.assertAlmostEqual(floor.sd[2], 0.2887, delta=1e-3)

    def test_quantisation_in_steps_of_four(self):
        rows = [[4 * (k % 2), 8, 16000, (k // 5) % 2, 1, 0, 0] for k in range(100)]
        self.assertAlmostEqual(self.learn(rows).sd[1], 1.1547, delta=1e-3)

    def test_flicker_between_two_steps_is_still(self):
        self.learn([[4 * (k % 2), 8, 16000, k % 3, 1, 0, 0] for k in range(100)])
        flicker = [[4 * (k % 2), 8 + 4 * (k // 3 % 2), 16000, k % 3, 1, 0, 0] for k in range(25)]
        self.look(flicker)
        self.look(flicker)
        self.assertEqual(self.floor.judge(self.window, ENTER), "")

    def test_noise_measured_too_high_is_learnt_again_downward_and_its_bias(self):
        held = noisy_rows(100, sd=150)
        for row in held:
            row[5] += 60
        floor = self.learn(held)
        self.assertAlmostEqual(floor.sd[0], 150, delta=30)
        self.look(stream(250, seed=5))
        self.assertAlmostEqual(floor.sd[0], 30, delta=6)
        self.assertAlmostEqual(floor.bias[2], 0, delta=1.5)

    def test_noise_is_not_learnt_upward(self):
        floor = self.learn(stream(100))
        before = list(floor.sd)
        self.look(stream(500, seed=8, sd=200))
        self.assertEqual(list(floor.sd), before)
        floor.judge(self.window, ENTER)
        self.assertEqual(floor.unit, "x noise")
        self.assertGreater(floor.value, floor.limit)

    def test_steady_vibration_is_called_noisy_and_a_push_moving(self):
        floor = self.learn(stream(100))
        self.look([[row[0] + (200 if k % 2 else -200)] + row[1:]
                   for k, row in enumerate(noisy_rows(50))])
        self.assertEqual(floor.judge(self.window, ENTER), "noisy")
        self.look([[row[0] + 40 * k] + row[1:] for k, row in enumerate(noisy_rows(25))])
        self.assertEqual(floor.judge(self.window, ENTER), "moving")

    def test_a_turn_shows_in_the_gyros_mean(self):
        floor = self.learn(stream(100))
        floor.bias_fixed = True
        rows = noisy_rows(75, seed=6)
        for row in rows:
            row[5] += 98  # 1.5 deg/s
        self.look(rows)
        self.assertEqual(floor.judge(self.window, ENTER), "moving")
        self.assertEqual(floor.unit, "deg/s")
        self.assertAlmostEqual(floor.value, 1.5, delta=0.1)


if __name__ == "__main__":
    unittest.main()
