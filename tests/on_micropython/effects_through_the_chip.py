"""Run on either interpreter: counts of a simulated chip with effects, one line a sample."""
import sys
from array import array

for folder in sys.argv[1].split(":"):
    sys.path.insert(0, folder)

from sixflip.chips import probe  # noqa: E402
from sixflip_sim import worlds  # noqa: E402

EFFECTS = [
    {"effect": "thermal_bias", "x": 5.0}, {"effect": "creep", "z": 5.0, "tau_s": 2.0},
    {"effect": "drift", "y": 2.0}, {"effect": "g_sensitivity", "xz": 0.1},
    {"effect": "quantisation", "x": 4}, {"effect": "torn_reads", "chance": 5.0},
    {"effect": "box_tilt", "Z-x": 0.3}, {"effect": "axis_swap", "sensor": "gyro", "x": -2},
    {"effect": "filter_lag", "sensor": "device", "tau": 5.0}]


def main():
    world = worlds.make({"seed": 3, "dwell_s": 1.0, "first_rest_s": 1.0, "warm_c": 8.0,
                         "order": ["Z+a", "Z+b", "Z-a"], "effects": EFFECTS})
    imu, _ = probe.find(world.i2c)
    imu.configure(100)
    sample = array("h", [0] * 7)
    while world.clock.now_us() < world.end_us:
        imu.read_into(sample)
        print(" ".join([str(count) for count in sample]))
        world.clock.sleep_us(9000)


main()
