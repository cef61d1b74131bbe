"""Li's repeatability test (Table 3) simulated: their sensor calibrated ten times by hand."""

import numpy as np

from sixflip import STANDARD_G
from sixflip.accelerometer import solver as accelerometer
from sixflip_sim import worlds

from ..simulation.simulated_capture import capture
from . import paper_tables

CALIBRATIONS = 10
HAND_DEG = 0.4              # of each flip, standard deviation
PLACING_DEG = 0.05          # how flush a hand lays a box on a table
TILT_DEG = 1.5


def experiment(seed, placing_deg):
    """The twelve parameters of every calibration, (CALIBRATIONS, 12), ×10⁻²."""
    A, b = paper_tables.sensor()
    rows = []
    for number in range(CALIBRATIONS):
        world = worlds.make({
            "sensor": "gy85", "accel_matrix": A.tolist(),
            "accel_bias_mg": (1e3 / STANDARD_G * b).tolist(), "seed": 1000 * seed + number,
            "tilt_deg": TILT_DEG, "tilt_dir_deg": 36.0 * number, "flip_error_deg": HAND_DEG,
            "placement_scatter_deg": placing_deg})
        session = capture(world)
        found = accelerometer.solve(session.placements(), session.meta["accel_lsb_per_g"])
        rows.append(paper_tables.parameters(found.T, found.scale, found.v))
    return np.array(rows)
