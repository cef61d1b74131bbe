import math
import unittest

import flipped_box as box

from sixflip.accelerometer.normal_equations import DOUBLE
from sixflip.gyro import flips
from sixflip.gyro import solver as gyroscope

M = ((1.02, 0.01, -0.02), (0.015, 0.97, 0.01), (-0.01, 0.02, 1.03))
BIAS = (1.5, -2.0, 0.7)
CLOSE = 1e-6 if DOUBLE else 2e-5


def solve(session, **options):
    return gyroscope.solve(session[0], session[1], box.GYRO_LSB, **options)


def matrix_error(P, M):
    """Largest entry of the difference between M P' and 1."""
    return max([abs(sum([M[i][k] * P[i][j] for i in range(3)]) - (1 if j == k else 0))
                for j in range(3) for k in range(3)])


class OneErrorIn(unittest.TestCase):
    def test_every_single_one(self):
        for i in range(3):
            for j in range(3):
                bent = [list(row) for row in box.IDEAL]
                bent[i][j] += 0.02
                r = solve(box.gyro_session(bent))
                self.assertLess(matrix_error(r.P, bent), CLOSE * 10)
                self.assertAlmostEqual(r.P[j][i], 1 / 1.02 if i == j else -0.02, delta=1e-5)
            bias = [0.0] * 3
            bias[i] = 3.0
            r = solve(box.gyro_session(bias_dps=bias))
            for k in range(3):
                self.assertAlmostEqual(r.bias_dps[k], bias[k], delta=1e-4)
                self.assertAlmostEqual(r.P[3][k], -math.radians(bias[k]), delta=CLOSE * 10)

    def test_all_together(self):
        r = solve(box.gyro_session(M, BIAS))
        self.assertLess(matrix_error(r.P, M), CLOSE * 10)
        for k in range(3):
            self.assertAlmostEqual(r.bias_dps[k], BIAS[k], delta=2e-4)
            # What the gyro reads at rest comes out as no turn at all.
            self.assertAlmostEqual(sum([math.radians(BIAS[i]) * r.P[i][k] for i in range(3)])
                                   + r.P[3][k], 0.0, delta=CLOSE * 10)
        self.assertEqual(r.verdict, "good", r.reason)
        self.assertEqual(r.signs_seen, [0, 1, 2])
        for face in ("Z+", "X-", "Y+"):
            self.assertTrue(r.flips[face]["used"])
            self.assertAlmostEqual(r.flips[face]["angle_deg"], 180.0, delta=0.01)


class Hand(unittest.TestCase):
    def test_a_hand_off_by_0_4_degrees(self):
        errors, biases, inside, of = [], [], 0, 0
        for seed in range(40):
            r = solve(box.gyro_session(M, BIAS, 0.4, 0.05, seed=seed))
            self.assertEqual(r.verdict, "good", r.reason)
            errors.append(matrix_error(r.P, M))
            for k in range(3):
                biases.append(abs(r.bias_dps[k] - BIAS[k]))
            exact = solve(box.gyro_session(M, BIAS)).P
            for i in range(4):
                for j in range(3):
                    inside += abs(r.P[i][j] - exact[i][j]) <= 2 * r.sigma[i][j]
                    of += 1
        errors.sort()
        biases.sort()
        self.assertLess(errors[20], 0.003)
        self.assertLess(errors[37], 0.006)
        self.assertLess(biases[114], 0.02)
        self.assertGreater(inside / of, 0.93)

    def test_a_clumsy_hand_is_told_by_its_own_flips(self):
        r = solve(box.gyro_session(M, BIAS, 5.0, seed=4))
        self.assertGreater(r.hand_deg, 1.0)
        self.assertEqual(r.verdict, "doubtful")
        self.assertIn("disagree", r.reason)


class LeftOut(unittest.TestCase):
    """A flip that cannot be used is left out with its reason; the other one of its axis stays."""

    def spoiled(self, spoil):
        rests, moves = box.gyro_session(M, BIAS)
        spoil(moves[0])                 # Z+a to Z+b
        r = solve((rests, moves))
        self.assertFalse(r.flips["Z+"]["used"])
        self.assertTrue(r.flips["Z-"]["used"])
        self.assertEqual(r.missing, [])
        self.assertLess(matrix_error(r.P, M), CLOSE * 10)
        self.assertEqual(r.verdict, "doubtful", r.reason)
        self.assertIn("one flip alone about", r.reason)
        self.assertIn("left out: Z+", r.reason)
        return r.flips["Z+"]["reason"]

    def test_saturated(self):
        def spoil(move):
            move.saturated = True
        self.assertIn("saturated", self.spoiled(spoil))

    def test_a_gap(self):
        def spoil(move):
            move.largest_gap_us = 170000
        self.assertIn("gap of 170 ms", self.spoiled(spoil))

    def test_not_flat(self):
        def spoil(move):
            move.gyro_sums[0] += int(15 * 65.5 * 100)
        self.assertIn("did not stay flat", self.spoiled(spoil))

    def test_not_half_a_turn(self):
        def spoil(move):
            move.gyro_sums = [x // 2 for x in move.gyro_sums]
        self.assertIn("expected 140 to 220", self.spoiled(spoil))


class Misaligned(unittest.TestCase):
    def test_both_flips_leaning_alike_are_a_misaligned_gyro(self):
        askew = [box.turned(row, (1.0, 0.0, 0.0), math.radians(4.0)) for row in box.IDEAL]
        r = solve(box.gyro_session(askew))
        self.assertEqual(r.missing, [])
        self.assertLess(matrix_error(r.P, askew), CLOSE * 10)

    def test_a_single_flip_is_believed_with_the_accelerometers_help(self):
        askew = [box.turned(row, (1.0, 0.0, 0.0), math.radians(4.0)) for row in box.IDEAL]
        rests, moves = box.gyro_session(askew)
        moves[0].saturated = True
        self.assertEqual(solve((rests, moves)).missing, [2])
        straight = [[askew[j][i] for j in range(3)] + [0.0] for i in range(3)]
        P = [[straight[j][i] for j in range(3)] + [0.0] for i in range(3)] + [[0.0] * 3 + [1.0]]
        inverse = [[P[j][i] for j in range(3)] for i in range(3)] + [[0.0] * 3]
        leans = [solve((rests, moves), accel_P=p).missing for p in (P, inverse)]
        self.assertIn([], leans)


class Missing(unittest.TestCase):
    def test_an_axis_never_flipped_keeps_its_old_values(self):
        rests, moves = box.gyro_session(M, BIAS)
        moves = [m for m in moves if (rests[m.after].pose - 1) // 4 != 2
                 or (rests[m.before].pose - 1) // 4 != 2]
        old = solve(box.gyro_session(M, (0, 0, 0))).P
        r = solve((rests, moves), old=old)
        self.assertEqual(r.missing, [1])
        self.assertEqual(r.verdict, "doubtful")
        self.assertIn("about axis y", r.reason)
        self.assertLess(matrix_error(r.P, M), 1e-4)
        for k in range(3):
            self.assertAlmostEqual(r.bias_dps[k], BIAS[k], delta=1e-3)
        nominal = solve((rests, moves))
        self.assertAlmostEqual(nominal.P[1][1], 1.0, delta=1e-3)
        self.assertAlmostEqual(nominal.P[0][0], old[0][0], delta=1e-3)

    def test_rests_alone_give_the_bias(self):
        rests, _ = box.gyro_session(box.IDEAL, BIAS)
        r = solve((rests, []))
        self.assertEqual(r.missing, [0, 1, 2])
        for k in range(3):
            self.assertAlmostEqual(r.bias_dps[k], BIAS[k], delta=1e-4)

    def test_no_gyro_is_said(self):
        rests, moves = box.gyro_session()
        self.assertRaises(ValueError, gyroscope.solve, rests, moves, 0)
        self.assertRaises(ValueError, gyroscope.solve, [], [], 65.5)
        for p in rests:
            p.sums[3:6], p.noise[3:6] = [0] * 3, [0.0] * 3
        self.assertRaises(ValueError, gyroscope.solve, rests, moves, 65.5)


class WrongAxes(unittest.TestCase):
    def named(self, rows, *words, **options):
        wired = [[sum([rows[i][k] * M[k][j] for k in range(3)]) for j in range(3)]
                 for i in range(3)]
        r = solve(box.gyro_session(wired, BIAS, 0.4, **options))
        self.assertEqual(r.verdict, "refused", r.reason)
        for word in words:
            self.assertIn(word, r.reason)

    def test_each_inverted_axis_is_named(self):
        for k in range(3):
            rows = [list(row) for row in box.IDEAL]
            rows[k][k] = -1
            self.named(rows, "axis %s is inverted" % "xyz"[k])

    def test_exchanged_axes_are_named(self):
        self.named(((0, 1, 0), (1, 0, 0), (0, 0, 1)), "y shows x", "x shows y")
        self.named(((1, 0, 0), (0, 0, 1), (0, 1, 0)), "z shows y")

    def test_a_sign_that_no_move_shows_is_not_claimed(self):
        r = solve(box.gyro_session(M, BIAS, order=range(1, 13)))
        self.assertEqual(r.signs_seen, [1, 2])
        self.assertIn("sign of x not seen", r.reason)


class Angles(unittest.TestCase):
    def test_the_angle_really_turned(self):
        rests, moves = box.gyro_session(M, BIAS, 3.0, seed=5)
        P = solve(box.gyro_session(M, BIAS)).P
        found = flips.measured_angles(rests, moves, box.GYRO_LSB, P)
        self.assertEqual(len(found), 6)
        for move in moves:
            before, after = rests[move.before].pose, rests[move.after].pose
            face = (before - 1) // 2
            if face == (after - 1) // 2:
                k = [abs(u) for u in box.UP[face]].index(1)
                counts = [s / 65.5 - 250 * b for s, b in zip(move.gyro_sums, BIAS)]
                turn = sum([counts[i] * P[i][k] for i in range(3)]) / 100 * sum(box.UP[face])
                self.assertAlmostEqual(math.degrees(found[face]), turn % 360.0, delta=0.02)

    def test_it_pays_only_beyond_the_gyros_own_error(self):
        good = {face: math.radians(180 + 0.4 * (1 - face % 2 * 2)) for face in range(6)}
        self.assertEqual(flips.worthwhile(good, 0.003), {})
        self.assertEqual(flips.worthwhile({}, 0.003), {})
        off = {face: math.radians(190) for face in range(5)}
        off[5] = math.radians(100)
        used = flips.worthwhile(off, 0.003)
        self.assertEqual(sorted(used), [0, 1, 2, 3, 4])
        self.assertAlmostEqual(math.degrees(used[0]), 190, delta=0.1)
        less = flips.worthwhile(off, 0.03)
        self.assertAlmostEqual(math.degrees(less[0]), 184.17, delta=0.1)
        self.assertEqual(flips.worthwhile(off, float("nan")), {})


if __name__ == "__main__":
    unittest.main()
