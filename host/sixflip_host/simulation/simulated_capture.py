"""A capture of a simulated world (sixflip_sim.worlds) at numpy's speed, labels included."""

import numpy as np

from sixflip.chips import probe

from ..capture.capture_file import Capture
from . import simulated_session, simulator


def capture(world, rate_hz=100):
    """Capture of all that is planned in a world, polled at rate_hz; its rests are labelled."""
    imu, _ = probe.find(world.i2c)
    imu.configure(rate_hz)
    n = int(world.scene.end_us() * 1e-6 * rate_hz)
    t_us = np.rint(np.arange(n) * (1e6 / rate_hz)).astype(np.int64)
    found = {}
    for output in simulator.outputs_of(world.chips):
        k = simulator.polled(output, t_us)
        found[output.kind] = simulator.counts(world.model, output, k).astype(np.int16)
    meta = dict(imu.metadata(), g=world.scene.g)
    return Capture(meta, t_us, found["accel"].T, found["gyro"].T if "gyro" in found else None,
                   found["temp"][0] if "temp" in found else None, None,
                   simulated_session.labels(world, t_us, False))
