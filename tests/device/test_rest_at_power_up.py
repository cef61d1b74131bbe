"""The gyro bias taken at power-up is right within 0.05 deg/s, or none is taken.

Kicks at every moment of the rest, slow turns, vibration, robots that drive off; each world is
a motion put on top of a robot that lies still.
"""

import math
import shutil
import tempfile
import unittest

from sixflip.record import correction_record
from sixflip_device import settings
from sixflip_device.events import Events
from sixflip_device.find_sensor import find
from sixflip_device.record import at_rest
from sixflip_device.sensor import Sensor
from sixflip_sim import rotation, worlds
from tests.worlds.simulated_board import SimulatedBoard, power_on

G = 9.80665
LIMIT_DPS = 0.05
BEGIN_S = 0.05      # the sensor is found and set up before that


class Moved:
    """A Scene with motion of its own: moved(t) -> (attitude angle deg, rate deg/s) about axis,
    and push(t) -> m/s2 along the body's x."""

    def __init__(self, scene, axis, moved, push):
        self.__dict__.update(scene.__dict__)
        self.inner, self.axis, self.moved, self.push = scene, axis, moved, push
        self.turned = None, None

    def __getattr__(self, name):
        return getattr(self.inner, name)

    def resting(self, i):
        return False

    def motion(self, t_us):
        angle, rate = self.moved(t_us * 1e-6)
        if self.turned[0] != angle:
            self.turned = angle, rotation.times(self.inner.end_attitude(), rotation.about(
                self.axis, math.radians(angle)))
        r = self.turned[1]
        w = tuple(math.radians(rate) * x for x in self.axis)
        f = (r[6] * G + self.push(t_us * 1e-6), r[7] * G, r[8] * G)
        return r, f, w, (0.0, 0.0, 0.0)


def still(t):
    return 0.0, 0.0


def no_push(t):
    return 0.0


def jerk(tau):
    """Minimum jerk and its derivative, 0..1."""
    tau = min(1.0, max(0.0, tau))
    return tau ** 3 * (10 - 15 * tau + 6 * tau * tau), 30 * tau * tau * (1 - tau) ** 2


def nudge(at, lasts, angle):
    """Turned by angle deg for good, from `at` on for `lasts` seconds."""
    def moved(t):
        s, ds = jerk((t - at) / lasts)
        return angle * s, angle * ds / lasts
    return moved


def rock(at, lasts, angle):
    """Turned and fallen back."""
    def moved(t):
        s, ds = jerk((t - at) / lasts * 2)
        r, dr = jerk((t - at) / lasts * 2 - 1)
        return angle * (s - r), angle * (ds - dr) / lasts * 2
    return moved


def steady(rate, since=-100.0):
    return lambda t: (rate * max(0.0, t - since), rate if t > since else 0.0)


def look(moved=still, axis=(0.0, 0.0, 1.0), push=no_push, longest_s=5.0, stored=True, wrong=0.0,
         rate_hz=100, **world):
    """(Rest, largest error of its bias in deg/s, imu) of a board that is looking for rest.

    stored: whether it has a bias of the calibration, which is wrong by `wrong` about z.
    """
    w = worlds.make(dict({"order": [], "first_rest_s": 60.0, "seed": 3}, **world))
    w.scene = w.model.scene = Moved(w.scene, axis, moved, push)
    w.model._plain = moved is still and push is no_push and w.model._plain
    board = SimulatedBoard(w, tempfile.gettempdir(), limit_s=60.0)
    values, _ = settings.merge({"rate_hz": rate_hz})
    imu = find(board, values)[0]
    sensor = Sensor(board, imu, values, Events(board.write_line))
    truth = [math.degrees(b) for b in w.truth.gyro_bias]
    then = [truth[0], truth[1], truth[2] + wrong]
    rest = at_rest.watch(board, sensor, rate_hz, longest_s,
                         {"bias_dps": then, "temp_c": 25.0} if stored else None)
    if not imu.has_gyro:
        return rest, None, None
    got = at_rest.bias_dps(rest.means, imu)
    return rest, max(abs(got[k] - truth[k]) for k in range(3)), board.ticks_us() / 1e6


class TestStill(unittest.TestCase):
    def test_every_sensor_is_believed(self):
        for sensor, seconds in (("mpu6050", 4.0), ("gy85", 5.5)):
            for seed in range(1, 9):
                rest, error, took = look(sensor=sensor, seed=seed)
                self.assertTrue(rest.still, (sensor, seed, rest.reason))
                self.assertLess(error, 0.02)
                self.assertLess(took, seconds)

    def test_other_rates(self):
        for rate_hz in (50, 200, 500):
            rest, error, _ = look(rate_hz=rate_hz)
            self.assertTrue(rest.still, (rate_hz, rest.reason))
            self.assertLess(error, LIMIT_DPS)

    def test_a_sensor_without_gyro(self):
        rest, _, _ = look(sensor="adxl345")
        self.assertTrue(rest.still)
        self.assertIsNone(rest.unseen_dps)

    def test_a_noisy_gyro_is_averaged_longer_or_refused(self):
        rest, error, took = look(gyro_noise_dps=0.15, longest_s=12.0)
        self.assertTrue(rest.still, rest.reason)
        self.assertGreater(took, 7.0)
        self.assertLess(error, LIMIT_DPS)
        rest, _, _ = look(gyro_noise_dps=0.5)
        self.assertFalse(rest.still)
        self.assertIn("would need", rest.reason)

    def test_not_waited_for(self):
        rest, _, _ = look(longest_s=0)
        self.assertFalse(rest.still)
        self.assertIn("not waited for", rest.reason)


class TestKicks(unittest.TestCase):
    def sweep(self, kick, axis, push=None, steps=70, every=1, **world):
        """A kick every 0.05 s through the whole rest (3.3 s when quiet), or every second one
        of these; how often a bias was taken."""
        taken = 0
        for step in range(0, steps, every):
            at = BEGIN_S + 0.05 * step
            rest, error, _ = look(kick(at), axis, push(at) if push else no_push, **world)
            if rest.still:
                taken += 1
                self.assertLess(error, LIMIT_DPS, (at, axis))
        return taken

    def test_rocked(self):
        taken = self.sweep(lambda at: rock(at, 0.3, 1.0), (0.0, 1.0, 0.0))
        self.assertGreater(taken, 65)  # it rests again after the kick

    def test_turned_about_the_vertical(self):
        self.assertGreater(self.sweep(lambda at: nudge(at, 0.2, 2.0), (0.0, 0.0, 1.0)), 65)

    def test_turned_a_little_about_the_vertical(self):
        for lasts, angle in ((0.1, 0.02), (1.5, 0.3)):
            taken = self.sweep(lambda at, s=lasts, a=angle: nudge(at, s, a), (0.0, 0.0, 1.0),
                               every=2)
            self.assertGreater(taken, 30, lasts)  # of 35: what is so small is waited out

    def test_a_noisier_sensor(self):
        taken = self.sweep(lambda at: nudge(at, 0.6, 0.15), (0.0, 0.0, 1.0), steps=90, every=2,
                           sensor="gy85")
        self.assertGreater(taken, 40)  # of 45

    def test_hit_without_a_turn(self):
        def push(at):
            return lambda t: 3.0 if 0 <= t - at < 0.02 else 0.0
        self.assertGreater(self.sweep(lambda at: still, (1.0, 0.0, 0.0), push), 65)


class TestTurns(unittest.TestCase):
    def test_slow_turn_that_gravity_shows(self):
        for sensor in ("mpu6050", "gy85"):
            for rate in (0.1, 0.3, 1.0, 5.0):
                for axis in ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.8, 0.0, 0.6)):
                    for stored in (True, False):
                        rest, _, _ = look(steady(rate), axis, stored=stored, sensor=sensor)
                        self.assertFalse(rest.still, (sensor, rate, axis, stored))

    def test_slower_still_is_within_the_limit_or_refused(self):
        # The mean of a rest has a noise of its own of 0.003 deg/s: 0.038 and four of these.
        for rate in (0.02, 0.038, 0.06, 0.08):
            for seed in range(1, 9):
                rest, error, _ = look(steady(rate), (1.0, 0.0, 0.0), seed=seed)
                if rest.still:
                    self.assertLess(error, LIMIT_DPS, (rate, seed))

    def test_about_the_vertical_the_stored_bias_tells(self):
        rest, _, _ = look(steady(2.0))
        self.assertFalse(rest.still)
        self.assertIn("turning about the vertical", rest.reason)

    def test_about_the_vertical_what_cannot_be_told_is_said(self):
        rest, error, _ = look(steady(0.3))
        self.assertTrue(rest.still)
        self.assertAlmostEqual(error, 0.3, delta=LIMIT_DPS)
        self.assertGreater(rest.unseen_dps, 0.3)
        self.assertLess(rest.unseen_dps, 1.5)
        rest, _, _ = look(steady(0.3), stored=False)
        self.assertEqual(rest.unseen_dps, 20.0)

    def test_warming_explains_more(self):
        self.assertFalse(look(wrong=3.0)[0].still)
        rest, error, _ = look(wrong=3.0, temperature_c=45.0)
        self.assertTrue(rest.still)
        self.assertLess(error, LIMIT_DPS)
        self.assertGreater(rest.unseen_dps, 3.0)

    def test_across_the_vertical_gravity_vouches_for_a_jump(self):
        w = {"gyro_bias_dps": [9.0, 0.5, 0.5]}
        rest, error, _ = look(stored=True, **w)
        self.assertTrue(rest.still)
        self.assertLess(error, LIMIT_DPS)
        # stored 0.5 for x as well: 8.5 deg/s of change about a level axis
        self.assertFalse(look(steady(8.5), (1.0, 0.0, 0.0))[0].still)

    def test_no_bias_is_that_large(self):
        rest, _, _ = look(steady(60.0), stored=False)
        self.assertFalse(rest.still)
        self.assertIn("no bias", rest.reason)


class TestDriving(unittest.TestCase):
    def test_starts_to_drive_in_the_middle(self):
        for step in range(0, 60, 2):
            at = BEGIN_S + 0.05 * step
            rest, error, _ = look(steady(3.0, at), push=lambda t, a=at: 0.5 if t > a else 0.0)
            if rest.still:
                self.assertLess(error, LIMIT_DPS, at)

    def test_turns_more_and_more(self):
        for rate in (0.05, 0.1, 0.3, 1.0):    # deg/s per second, from 1 s on
            rest, error, _ = look(lambda t, r=rate: (0.0, r * max(0.0, t - 1.0)), stored=False)
            if rest.still:
                self.assertLess(error, LIMIT_DPS, rate)

    def test_engine(self):
        for hz in (0.3, 0.7, 2.0, 7.3, 25.0, 33.3):
            for dps, mg in ((0.1, 2.0), (0.5, 10.0), (2.0, 60.0)):
                def moved(t, hz=hz, dps=dps):
                    return 0.0, dps * math.sin(2 * math.pi * hz * t)

                def push(t, hz=hz, mg=mg):
                    return mg * 1e-3 * G * math.cos(2 * math.pi * hz * t)
                rest, error, _ = look(moved, (0.0, 0.0, 1.0), push)
                if rest.still:
                    self.assertLess(error, LIMIT_DPS, (hz, dps, mg))


class TestEvent(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp()
        power_on(self.root)
        with open(self.root + "/record_a.bin", "rb") as f:
            self.stored = correction_record.decode(f.read()).gyro_bias["bias_dps"]

    def tearDown(self):
        shutil.rmtree(self.root)

    def rest(self, **world):
        return power_on(self.root, dict({"order": [], "first_rest_s": 30.0}, **world)).only("rest")

    def test_measured_and_what_cannot_be_told(self):
        now = [self.stored[0] + 3.0, self.stored[1] - 2.0, self.stored[2] + 0.5]
        rest = self.rest(gyro_bias_dps=now, temperature_c=26.0)
        self.assertEqual(rest["bias"], "measured now", rest)
        for got, true in zip(rest["bias_dps"], now):
            self.assertAlmostEqual(got, true, delta=LIMIT_DPS)
        self.assertIn("about the vertical below %.1f" % rest["unseen_turn_dps"], rest["note"])

    def test_shaken_by_an_engine(self):
        rest = self.rest(accel_noise_mg=12.0)
        self.assertEqual(rest["bias"], "stored")
        self.assertIn("shaken", rest["reason"])
        for got, then in zip(rest["bias_dps"], self.stored):
            self.assertAlmostEqual(got, then, places=5)


if __name__ == "__main__":
    unittest.main()
