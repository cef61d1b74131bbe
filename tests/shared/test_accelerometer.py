import math
import unittest

import flipped_box as box

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer.normal_equations import DOUBLE, SingularSystem

G = accelerometer.G
M = ((1.02, 0.01, -0.02), (0.015, 0.97, 0.01), (-0.01, 0.02, 1.03))
B = (0.03, -0.02, 0.11)
CLOSE = 2e-7 if DOUBLE else 5e-6     # sums are rounded to whole counts


class OneErrorIn(unittest.TestCase):
    """One known error put into an ideal session comes back as exactly that parameter."""

    def solve(self, M=box.IDEAL, b=(0, 0, 0), tilt=0.0, **options):
        return accelerometer.solve(box.placements(box.gravities(tilt), M, b), box.LSB, **options)

    def test_nothing(self):
        r = self.solve()
        for i in range(4):
            for j in range(4):
                self.assertAlmostEqual(r.P[i][j], float(i == j), delta=CLOSE)
        self.assertEqual(r.level, "tilt solved")

    def test_every_single_one(self):
        for i in range(3):
            for j in range(3):
                bent = [list(row) for row in box.IDEAL]
                bent[i][j] += 0.01
                r = self.solve(bent)
                for k in range(3):
                    self.assertAlmostEqual(r.scale[k], 1 / 1.01 if i == j == k else 1.0,
                                           delta=CLOSE)
                    for n in range(3):
                        expected = float(k == n) - (0.01 if (k, n) == (i, j) != (k, k) else 0)
                        self.assertAlmostEqual(r.T[k][n], expected, delta=CLOSE)
                    self.assertAlmostEqual(r.v[k], 0.0, delta=CLOSE * G)
            b = [0.0] * 3
            b[i] = 0.05
            r = self.solve(b=b)
            for k in range(3):
                self.assertAlmostEqual(r.v[k], -0.05 * G if k == i else 0.0, delta=CLOSE * G)

    def test_all_on_a_tilted_table(self):
        for tilt in (0, 1, 3, 5, 10):
            r = self.solve(M, B, tilt)
            self.assertLess(box.vector_error_mg(r.P, G, M, B), 1e-3 if DOUBLE else 1e-2)
            self.assertAlmostEqual(r.tilt_deg, tilt, delta=2e-4 if DOUBLE else 2e-3)
            self.assertLess(r.tilt_spread_deg, 1e-4 if DOUBLE else 2e-3)
            self.assertLess(r.rounds, 20)

    def test_local_gravity_scales_the_offset_alone(self):
        r, s = self.solve(M, B, 2), self.solve(M, B, 2, g=9.78)
        for j in range(3):
            self.assertAlmostEqual(s.P[3][j], r.P[3][j] * 9.78 / G, delta=1e-6)
            for i in range(3):
                self.assertEqual(s.P[i][j], r.P[i][j])


class Levels(unittest.TestCase):
    def test_flip_average_leaves_the_cosine(self):
        for tilt, mg in ((1, 0.15), (2, 0.61), (5, 3.8)):
            poses = box.placements(box.gravities(tilt))
            r = accelerometer.solve(poses, box.LSB, level="flip average")
            self.assertEqual(r.rounds, 1)
            for k in range(3):
                self.assertAlmostEqual(1000 * (r.scale[k] - 1), mg, delta=0.03)

    def test_without_flips_the_tilt_stays_in(self):
        poses = box.placements(box.gravities(2))
        r = accelerometer.solve([p for p in poses if p.pose % 2], box.LSB)
        self.assertEqual(r.level, "no flips")
        self.assertIsNone(r.tilt_deg)
        self.assertGreater(box.vector_error_mg(r.P, G), 5.0)
        self.assertEqual(len(r.residual), 6)

    def test_a_level_that_cannot_be(self):
        poses = box.placements(box.gravities())
        self.assertRaises(ValueError, accelerometer.solve, poses[:11], box.LSB, G, "tilt solved")
        self.assertRaises(ValueError, accelerometer.solve, poses, box.LSB, G, "best")

    def test_an_axis_without_a_pose_is_named(self):
        poses = [p for p in box.placements(box.gravities()) if (p.pose - 1) // 4 != 2]
        with self.assertRaises(SingularSystem) as caught:
            accelerometer.solve(poses, box.LSB)
        self.assertIn("either Y face", str(caught.exception))

    def test_a_and_b_exchanged_is_harmless(self):
        poses = box.placements(box.gravities(3), M, B)
        poses[4].pose, poses[5].pose = 6, 5
        r = accelerometer.solve(poses, box.LSB)
        self.assertLess(box.vector_error_mg(r.P, G, M, B), 1e-3 if DOUBLE else 1e-2)

    def test_a_pose_repeated_counts_as_one_more_row(self):
        poses = box.placements(box.gravities(2), M, B)
        again = box.placements(box.gravities(2), M, B)[:3]
        r = accelerometer.solve(poses + again, box.LSB)
        self.assertEqual(len(r.means), 15)
        self.assertEqual(len(r.residual), 12)
        self.assertLess(box.vector_error_mg(r.P, G, M, B), 1e-3 if DOUBLE else 1e-2)

    def test_a_leaning_pose_is_left_aside(self):
        poses = box.placements(box.gravities(2), M, B)
        leaning = box.placements({1: (0.6, 0.0, 0.8)})
        leaning[0].pose = 13
        r = accelerometer.solve(poses + leaning, box.LSB)
        self.assertEqual(r.P, accelerometer.solve(poses, box.LSB).P)


class FlipAngle(unittest.TestCase):
    def test_flips_off_half_a_turn_are_taken_as_they_were(self):
        deg = {0: 170.0, 1: 186.0, 2: 188.0, 3: 175.0, 4: 173.0, 5: 190.0}
        poses = box.placements(box.gravities(2, deg), M, B)
        without = accelerometer.solve(poses, box.LSB)
        angles = {face: math.radians(deg[face]) for face in deg}
        r = accelerometer.solve(poses, box.LSB, angles=angles)
        self.assertGreater(box.vector_error_mg(without.P, G, M, B), 0.7)
        self.assertLess(box.vector_error_mg(r.P, G, M, B), 2e-3 if DOUBLE else 2e-2)

    def test_the_wrong_way_round_is_worse_than_nothing(self):
        deg = dict.fromkeys(range(6), 170.0)
        poses = box.placements(box.gravities(2, deg), M, B)
        wrong = {face: math.radians(190.0) for face in deg}
        none = accelerometer.solve(poses, box.LSB)
        r = accelerometer.solve(poses, box.LSB, angles=wrong)
        self.assertGreater(box.vector_error_mg(r.P, G, M, B),
                           1.5 * box.vector_error_mg(none.P, G, M, B))


class Uncertainty(unittest.TestCase):
    def inside(self, across, sessions=40):
        """Share of the twelve true parameters within two standard errors, by kind."""
        P = box.IDEAL
        hits = [0, 0, 0]
        for seed in range(sessions):
            poses = box.placements(box.gravities(2), noise_g=0.004, seed=seed, across=across)
            r = accelerometer.solve(poses, box.LSB)
            for i in range(4):
                for j in range(3):
                    kind = 0 if i == j else 1 if i < 3 else 2
                    true = P[i][j] if i < 3 else 0.0
                    hits[kind] += abs(r.P[i][j] - true) <= 2 * r.sigma_P[i][j]
        return [hits[0] / (3 * sessions), hits[1] / (6 * sessions), hits[2] / (3 * sessions)]

    def test_two_sigma_holds_19_of_20_with_noise_alone(self):
        for share in self.inside(0.0):
            self.assertGreater(share, 0.88)

    def test_and_with_a_box_that_never_lies_twice_the_same(self):
        for share in self.inside(0.00087):
            self.assertGreater(share, 0.88)

    def test_it_is_no_wider_than_it_must_be(self):
        poses = box.placements(box.gravities(2), noise_g=0.004, seed=3)
        r = accelerometer.solve(poses, box.LSB)
        # One axis, two faces, two captures of 400 samples each: 0.004 / sqrt(1600).
        for k in range(3):
            self.assertAlmostEqual(r.sigma_scale[k], 1e-4, delta=2e-5)
            self.assertLess(r.sigma_v[k], 4e-4 * G)
        self.assertAlmostEqual(r.noise_g, 0.004, delta=1e-5)

    def test_a_sensor_that_rounds_away_its_noise_does_not_promise_more(self):
        poses = box.placements(box.gravities(2), lsb=256.0)
        for p in poses:
            p.noise = [0.1] * 6
        r = accelerometer.solve(poses, 256.0)
        self.assertGreater(r.sigma_scale[0], 2e-4)


if __name__ == "__main__":
    unittest.main()
