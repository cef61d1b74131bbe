"""Effects of the library in a live chip: each shows up where it belongs, by its size."""

import math
import unittest
from array import array

from sixflip.chips import probe
from sixflip.poses.faces import FACES
from sixflip_sim import worlds
from sixflip_sim.effects import library, moment


def reading(seconds, *effects, **more):
    """Counts of an ideal, noiseless MPU6050 (±2 g, ±500 deg/s) at a time."""
    spec = {"order": [], "ideal": True, "accel_noise_mg": 0, "gyro_noise_dps": 0,
            "effects": list(effects), "first_rest_s": 1}
    spec.update(more)
    world = worlds.make(spec)
    imu = probe.find(world.i2c, world.clock.sleep_ms)[0]
    imu.configure(100)
    world.clock.sleep_us(int(seconds * 1e6) - world.clock.now_us())
    out = array("h", [0] * 7)
    imu.read_into(out)
    return list(out)


class Effects(unittest.TestCase):
    def test_none(self):
        self.assertEqual(reading(1)[:6], [0, 0, 16384, 0, 0, 0])

    def test_thermal_bias(self):
        """1 mg/°C on y: 10 °C more are 10 mg more, 164 counts, on y alone."""
        effect = {"effect": "thermal_bias", "sensor": "accel", "y": 1.0}
        cold = reading(1, effect, temperature_c=25.0)
        warm = reading(1, effect, temperature_c=35.0)
        self.assertAlmostEqual(warm[1] - cold[1], 163.84, delta=1)
        self.assertEqual((warm[0], warm[2]), (0, 16384))

    def test_gyro_gets_what_is_the_gyros(self):
        effect = {"effect": "thermal_bias", "sensor": "gyro", "x": 0.1}
        change = (reading(1, effect, temperature_c=35.0)[3]
                  - reading(1, effect, temperature_c=25.0)[3])
        self.assertAlmostEqual(change, 65.5, delta=1)

    def test_box_tilt_on_its_face_only(self):
        effect = {"effect": "box_tilt", "Z+x": 0.5}
        self.assertAlmostEqual(reading(1, effect)[0], 16384 * 0.0087266, delta=1)
        self.assertEqual(reading(12, effect, order=["Z+a", "X+a"])[2], 0)

    def test_box_tilt_turns_gravity_on_a_tilted_table_too(self):
        """On a table that leans by 3.4 degrees a face off by half a degree added 0.5 mg to |f|."""
        at = moment.Moment()
        at.face = FACES.index("Z+")
        at.f = at.up = (0.06, -0.08, math.sqrt(0.99))
        felt = [1000.0 * f for f in at.f]
        for key, axis, value in library.make({"effect": "box_tilt", "Z+x": 0.5}).terms(at):
            felt[axis] += 0.5 * value if key == "Z+x" else 0.0
        length = math.sqrt(sum(f * f for f in felt))
        self.assertAlmostEqual(length, 1000.0, delta=0.05)
        self.assertAlmostEqual(felt[0], 60.0 + 8.7266 * (1.0 - 0.06 ** 2), delta=0.01)

    def test_counts(self):
        step = reading(1, {"effect": "quantisation", "sensor": "accel", "z": 1000})
        self.assertEqual(step[2], 16000)
        swapped = reading(1, {"effect": "axis_swap", "sensor": "accel", "x": -3, "z": 1})
        self.assertEqual(swapped[:3], [-16384, 0, 0])

    def test_delay(self):
        """In a turn that gets faster, a late filter shows the slower rate of before."""
        more = {"order": ["Z+a", "Z+b"], "first_rest_s": 1, "dwell_s": 1, "flip_error_deg": 0}
        late = reading(2.8, {"effect": "filter_lag", "sensor": "device", "tau": 20.0}, **more)
        self.assertAlmostEqual(late[5], reading(2.78, **more)[5], delta=2)
        self.assertGreater(reading(2.8, **more)[5] - late[5], 100)

    def test_what_does_not_exist(self):
        self.assertRaises(ValueError, reading, 1, {"effect": "gremlins"})


if __name__ == "__main__":
    unittest.main()
