"""A session of faces and their half turns that nobody labelled."""
from types import SimpleNamespace

import numpy as np

ORDER = (0, 0, 4, 4, 2, 2, 3, 3, 1, 1, 5, 5, 5, 1, 1, 3, 3, 2, 2, 4, 4, 0, 0)
FACES = np.vstack([np.eye(3), -np.eye(3)])[list(ORDER)]  # of gravity, placement by placement


def unlabelled(off_mg):
    """What attitude_fit.fit reads of a session: a sensor a degree askew, off by so many mg the way
    of the placement before."""
    lean = np.random.default_rng(8).normal(0.0, 0.004, FACES.shape)
    f = FACES + lean
    f /= np.linalg.norm(f, axis=1)[:, None]
    before = np.vstack([f[:1], f[:-1]])
    askew = np.eye(3) + 0.01 * np.array([[0.4, -0.7, 0.3], [0.5, -0.3, 0.6], [-0.2, 0.8, 0.2]])
    read = 1000.0 * f @ askew.T + off_mg * before * [0.7, -1.0, 1.3] + [12.0, -20.0, 31.0]
    return SimpleNamespace(accel=read, placement=np.arange(len(f)), labelled=False,
                           runs=tuple((0, 0, 0) for _ in f), placements=lambda: len(f))
