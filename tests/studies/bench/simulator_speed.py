"""Samples a second of the numpy simulator: six axes and temperature, nominal and with effects."""
import time

import numpy as np

from sixflip.chips import probe
from sixflip_host.simulation import simulator
from sixflip_sim import worlds
from sixflip_sim.effects import make

SAMPLES = 1_000_000
FEW = [{"effect": "thermal_bias", "x": 0.5}, {"effect": "quadratic", "z": 5.0},
       {"effect": "creep", "z": 5.0}, {"effect": "g_sensitivity", "xz": 0.1}]


def seconds(effects):
    """Time for SAMPLES samples of a session long enough to hold them."""
    world = worlds.make({"dwell_s": 400.0, "move_s": 10.0, "warm_c": 8.0})
    imu, _ = probe.find(world.i2c)
    imu.configure(100)
    outputs = simulator.outputs_of(world.chips)
    world.model.effects = make(effects) if effects else []
    simulator.vectorise(world.model)
    start = time.perf_counter()
    for output in outputs:
        simulator.counts(world.model, output, np.arange(SAMPLES))
    return time.perf_counter() - start


def main():
    for words, effects in (("nominal", []), ("four effects", FEW),
                           ("and flicker", FEW + [{"effect": "drift", "x": 0.1, "y": 0.1,
                                                   "z": 0.1}])):
        taken = seconds(effects)
        print("simulator, %-12s %5.2f million samples a second (7 columns)"
              % (words + ":", SAMPLES / taken / 1e6))


if __name__ == "__main__":
    main()
