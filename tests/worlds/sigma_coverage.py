"""How often the truth lies within the standard errors that a solve gives."""

import numpy as np

from sixflip_host.calibrate import solution
from tests.worlds import hostile_sessions as hostile


def coverage(sensor, seeds, scatter_deg):
    """{"P" | "scale" | "v": (share within 1 sigma, within 2)} over honest sessions."""
    off = {"P": [], "scale": [], "v": []}
    for seed in seeds:
        tilt = np.random.default_rng([seed, 2]).uniform(0, 5)
        session = hostile.Session(seed, sensor, tilt, scatter_deg, flip_deg=0.0)
        r = solution.solve(session.capture(), half_turns=True).accel
        P, scale, v = session.truth()
        off["P"] += np.abs((np.array(r.P) - P) / np.maximum(np.array(r.sigma_P), 1e-300))[
            :, :3].ravel().tolist()
        off["scale"] += np.abs((np.array(r.scale) - scale) / r.sigma_scale).tolist()
        off["v"] += np.abs((np.array(r.v) - v) / r.sigma_v).tolist()
    return {name: tuple(float(np.mean(np.array(values) <= k)) for k in (1, 2))
            for name, values in off.items()}


def honest(shares):
    """Not smaller than the truth, and not so large that it says nothing.

    68.3 and 95.4 % are ideal. A scatter that is itself estimated from four numbers must be
    given wider than that (Student), so what is above is bounded loosely.
    """
    one, two = shares
    return 0.64 <= one <= 0.90 and 0.93 <= two
