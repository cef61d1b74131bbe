import unittest

from sixflip_host.calibrate import local_gravity


class Local(unittest.TestCase):
    def test_the_ellipsoids_own_values(self):
        # WGS84, NGA.STND.0036, table 3.5: at the equator and at the pole.
        self.assertAlmostEqual(local_gravity.local(0), 9.7803253359, delta=2e-6)
        self.assertAlmostEqual(local_gravity.local(90), 9.8321849379, delta=2e-6)
        self.assertEqual(local_gravity.local(-37.5, 20), local_gravity.local(37.5, 20))

    def test_standard_gravity_is_met_near_45_degrees(self):
        self.assertAlmostEqual(local_gravity.local(45), 9.80620, delta=1e-5)

    def test_free_air(self):
        self.assertAlmostEqual(local_gravity.local(45) - local_gravity.local(45, 1000), 3.0855e-3,
                               delta=5e-6)

    def test_nonsense_is_refused(self):
        for lat, height in ((91, 0), (-91, 0), (float("nan"), 0), (0, 30000), (0, float("nan"))):
            self.assertRaises(ValueError, local_gravity.local, lat, height)


if __name__ == "__main__":
    unittest.main()
