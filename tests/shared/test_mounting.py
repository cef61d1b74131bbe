import math
import unittest

from sixflip.record import mounting

# Promrit, V: the average output of an MPU6050 on a wedge of 30 and 15 degrees.
PAPER = (-0.2235, 0.4937, 0.8330)


def degrees(pair):
    return [math.degrees(x) for x in pair]


def times(R, v):
    return [sum([R[i][k] * v[k] for k in range(3)]) for i in range(3)]


class Paper(unittest.TestCase):
    def test_the_worked_example(self):
        order, left, right = mounting.choose(*PAPER)
        self.assertEqual(order, "xyz")
        self.assertAlmostEqual(left, 0.0317, delta=5e-5)
        # The paper prints 0.1975: it squared -0.2235 to a negative number.
        self.assertAlmostEqual(right, 0.1375, delta=5e-5)
        self.assertAlmostEqual(abs(math.sqrt(-0.2235 ** 2 + 0.8330 ** 2) - 1), 0.1975, delta=5e-5)
        roll, pitch = degrees(mounting.angles(*(PAPER + ("xyz",))))
        self.assertAlmostEqual(roll, 30.6543, delta=2e-4)
        self.assertAlmostEqual(pitch, 12.9971, delta=2e-4)
        # As printed, from a G with more digits than it prints.
        self.assertAlmostEqual(roll, 30.6532, delta=0.003)
        self.assertAlmostEqual(pitch, 12.9997, delta=0.003)

    def test_how_near_the_wedge_is_met(self):
        roll, pitch = degrees(mounting.angles(*(PAPER + ("xyz",))))
        # The paper prints 99.978 % for the first.
        self.assertAlmostEqual(100 * (1 - abs(roll - 30) / 30), 97.8, delta=0.05)
        self.assertAlmostEqual(100 * (1 - abs(pitch - 15) / 15), 86.7, delta=0.06)

    def test_the_other_order_is_nearer(self):
        roll, pitch = degrees(mounting.angles(*(PAPER + ("yxz",))))
        self.assertAlmostEqual(roll, 29.79, delta=0.005)
        self.assertAlmostEqual(pitch, 15.02, delta=0.005)

    def test_where_the_rotation_stands_in_the_model(self):
        # The paper: R (I + S + M) a + b; ours: (I + S + M) R a + b; at 30/15 degrees they
        # differ by milli-g for a sensor of ordinary errors.
        E = ((1.02, 0.01, -0.015), (-0.01, 0.985, 0.02), (0.01, -0.01, 1.01))
        R = mounting.rotation(math.radians(30), math.radians(15), "xyz")
        a, b = times(R, times(E, (0, 0, 1))), times(E, times(R, (0, 0, 1)))
        gap = 1000 * math.sqrt(sum([(x - y) ** 2 for x, y in zip(a, b)]))
        self.assertGreater(gap, 3.0)
        self.assertLess(gap, 40.0)


class Quadrants(unittest.TestCase):
    def test_every_roll_and_pitch_comes_back_upside_down_too(self):
        for order, rolls, pitches in (("xyz", range(-175, 181, 25), range(-85, 86, 17)),
                                      ("yxz", range(-85, 86, 17), range(-175, 181, 25))):
            for roll in rolls:
                for pitch in pitches:
                    R = mounting.rotation(math.radians(roll), math.radians(pitch), order)
                    G = times(R, (0, 0, 1))
                    found = degrees(mounting.angles(G[0], G[1], G[2], order))
                    self.assertAlmostEqual(found[0], roll, delta=1e-4)
                    self.assertAlmostEqual(found[1], pitch, delta=1e-4)

    def test_the_matrices_turn_by_the_axes_they_name(self):
        # Promrit Eq. 1-3 by hand: roll alone takes the vehicle's z to (0, sin, cos).
        for order in ("xyz", "yxz"):
            v = times(mounting.rotation(math.radians(30), 0.0, order), (0, 0, 1))
            for x, y in zip(v, (0, 0.5, math.sqrt(0.75))):
                self.assertAlmostEqual(x, y, delta=1e-6)
            v = times(mounting.rotation(0.0, math.radians(30), order), (0, 0, 1))
            for x, y in zip(v, (-0.5, 0, math.sqrt(0.75))):
                self.assertAlmostEqual(x, y, delta=1e-6)

    def test_compensated_gravity_points_up_whatever_the_order(self):
        for G in (PAPER, (0.1, -0.2, -0.97), (-0.9, 0.3, 0.3), (0.5, 0.7, -0.5)):
            size = math.sqrt(sum([x * x for x in G]))
            for order in ("xyz", "yxz", None):
                unit = [x / size for x in G]
                section = mounting.estimate(unit[0], unit[1], unit[2], order)
                up = times(mounting.compensation(section), unit)
                for x, y in zip(up, (0, 0, 1)):
                    self.assertAlmostEqual(x, y, delta=1e-5)


class Axes(unittest.TestCase):
    def test_named_axes(self):
        self.assertEqual(mounting.parse_axes("x y z"), [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
        self.assertEqual(mounting.parse_axes("-Y, +x z"), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])

    def test_all_right_handed_ones_and_no_other(self):
        good = 0
        for order in ("xyz", "yzx", "zxy", "xzy", "zyx", "yxz"):
            for code in range(8):
                text = " ".join([("-" if code >> k & 1 else "") + order[k] for k in range(3)])
                try:
                    B = mounting.parse_axes(text)
                except ValueError:
                    continue
                good += 1
                x, y, z = B
                self.assertEqual([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2],
                                  x[0] * y[1] - x[1] * y[0]], z)
        self.assertEqual(good, 24)

    def test_nonsense_is_refused(self):
        for text in ("x y", "x x z", "x y q", "--x y z", "y x z", "-x y z", ""):
            self.assertRaises(ValueError, mounting.parse_axes, text)

    def test_robot_frames(self):
        # The sensor lies flat and is turned: its x shows to the robot's left.
        section = mounting.estimate(0.0, 0.0, 1.0, axes="-y x z")
        turned = times(mounting.compensation(section), (1, 0, 0))
        for x, y in zip(turned, (0, 1, 0)):
            self.assertAlmostEqual(x, y, delta=1e-6)
        section["frame"] = "ned"
        for v, expected in (((0, 0, 1), (0, 0, -1)), ((1, 0, 0), (0, -1, 0))):
            for x, y in zip(times(mounting.compensation(section), v), expected):
                self.assertAlmostEqual(x, y, delta=1e-6)

    def test_a_vehicle_that_does_not_rest(self):
        for G in ((0, 0, 1.2), (0, 0, 0.7), (float("nan"), 0, 1)):
            self.assertRaises(ValueError, mounting.estimate, *G)
        self.assertRaises(ValueError, mounting.estimate, 0, 0, 1, "zyx")
        self.assertRaises(ValueError, mounting.estimate, 0, 0, 1, None, "x y z", "enu")


if __name__ == "__main__":
    unittest.main()
