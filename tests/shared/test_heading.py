import math
import unittest

from sixflip.gyro.heading import DriftIntegrator, Heading

G = 9.80665


class Equation8(unittest.TestCase):
    def drift(self, gain, bias=0.01, n=1000):
        """Angle after n steps of 10 ms at rest, by a gyro with a bias."""
        integrator = DriftIntegrator(gain)
        for _ in range(n):
            integrator.step(bias, 0.01, 0.0)
        return integrator.angle

    def test_the_bias_is_multiplied_by_one_plus_the_gain(self):
        plain = self.drift(0.0)
        self.assertAlmostEqual(plain, 0.1, delta=1e-5)
        for gain in (-0.2, -0.5, -0.9):
            self.assertAlmostEqual(self.drift(gain) / plain, 1 + gain, delta=0.002)

    def test_gains_that_do_not_correct_are_refused(self):
        for gain in (0.1, -1.0, -2.0, float("nan")):
            self.assertRaises(ValueError, DriftIntegrator, gain)

    def test_nothing_known_is_the_gyro_alone(self):
        integrator = DriftIntegrator(-0.5)
        for _ in range(100):
            integrator.step(0.5, 0.01)
        self.assertAlmostEqual(integrator.angle, 0.5, delta=1e-5)


class Attitude(unittest.TestCase):
    def test_a_quarter_turn(self):
        heading = Heading()
        for _ in range(101):
            roll, pitch, yaw = heading.step((0.0, 0.0, G), (0.0, 0.0, math.pi / 2), 0.01)
        self.assertAlmostEqual(yaw, math.pi / 2, delta=1e-4)
        self.assertAlmostEqual(roll, 0.0, delta=1e-6)
        self.assertAlmostEqual(pitch, 0.0, delta=1e-6)

    def test_it_starts_where_gravity_is(self):
        a = (-G * math.sin(0.1), G * math.cos(0.1) * math.sin(-2.5),
             G * math.cos(0.1) * math.cos(-2.5))
        roll, pitch, yaw = Heading().step(a, (0, 0, 0), 0.01)
        self.assertAlmostEqual(roll, -2.5, delta=1e-5)
        self.assertAlmostEqual(pitch, 0.1, delta=1e-5)
        self.assertEqual(yaw, 0.0)

    def test_gravity_holds_roll_and_pitch_but_not_yaw(self):
        heading, free = Heading(-0.02), Heading(0.0)
        for _ in range(3000):
            held = heading.step((0.0, 0.0, G), (0.01, -0.01, 0.01), 0.01)
            loose = free.step((0.0, 0.0, G), (0.01, -0.01, 0.01), 0.01)
        self.assertLess(abs(held[0]) + abs(held[1]), 0.02)
        self.assertGreater(abs(loose[0]), 0.2)
        self.assertGreater(held[2], 0.25)

    def test_across_the_half_turn_it_takes_the_short_way(self):
        heading = Heading(-0.1)
        heading.step((0.0, 1e-3, -G), (0, 0, 0), 0.01)          # roll just below +180 degrees
        for _ in range(50):
            roll, _, _ = heading.step((0.0, -0.1, -G), (0, 0, 0), 0.01)
        self.assertAlmostEqual(abs(roll), math.pi, delta=0.02)

    def test_a_vehicle_that_brakes_shows_no_gravity(self):
        heading = Heading(-0.1)
        heading.step((0.0, 0.0, G), (0, 0, 0), 0.01)
        for _ in range(100):
            _, pitch, _ = heading.step((-6.0, 0.0, G), (0, 0, 0), 0.01)
        self.assertAlmostEqual(pitch, 0.0, delta=1e-6)

    def test_turning_on_a_slope_turns_about_the_vertical(self):
        # Rolled by 30 degrees: the vertical rate shows on y and z.
        roll, rate = math.radians(30), 0.5
        heading = Heading(0.0)
        a = (0.0, G * math.sin(roll), G * math.cos(roll))
        for _ in range(101):
            _, _, yaw = heading.step(a, (0.0, rate * math.sin(roll), rate * math.cos(roll)), 0.01)
        self.assertAlmostEqual(yaw, rate, delta=1e-3)

    def test_a_lever_arm_shows_the_turn_to_the_accelerometer(self):
        # 0.5 rad/s2 for a second at 0.2 m; the gyro is biased by 0.1 rad/s.
        with_arm, without = Heading(-0.5, lever_arm=0.2), Heading(-0.5)
        for k in range(101):
            rate = 0.5 * 0.01 * k
            for heading in (with_arm, without):
                yaw = heading.step((0.0, 0.5 * 0.2, G), (0.0, 0.0, rate + 0.1), 0.01)[2]
        self.assertAlmostEqual(yaw, 0.25 + 0.1, delta=0.01)
        self.assertAlmostEqual(with_arm.yaw.angle, 0.25 + 0.05, delta=0.01)


if __name__ == "__main__":
    unittest.main()
