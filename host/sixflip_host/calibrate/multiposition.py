"""The accelerometer from |a| = g in many poses: imu_tk's own problem.

Tedaldi et al., ICRA 2014, equations 7-10: corrected = T K (measured - b), T unit upper
triangular, K diagonal; cost = 1/2 sum (g - |corrected|)^2. T K is one upper triangular matrix
U here, and the bias is kept as the offset o = -U b, which makes the model linear in its nine
parameters; the optimum is the same. Measured values in m/s^2 by the nominal scale.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from ..capture import rests_by_variance

ROWS, COLUMNS = np.triu_indices(3)
NAMES = tuple(
    "accelerometer %s" % what
    for what in (
        "x scale", "xy shear", "xz shear", "y scale", "yz shear", "z scale",
        "x bias", "y bias", "z bias",
    )
)
# What a sensor out of the factory may have: 3 % of scale, 2 % of shear, 0.5 m/s^2 of bias.
TYPICAL = np.array([0.03, 0.02, 0.02, 0.03, 0.02, 0.03, 0.5, 0.5, 0.5])
NOMINAL = np.array([1.0, 0, 0, 1.0, 0, 1.0, 0, 0, 0])
MULTIPLES = range(2, 11)  # of the variance at rest, imu_tk's search
FEWEST_RESTS = 12


@dataclass(frozen=True)
class Multiposition:
    """parameters (9,); cost as imu_tk prints it; residual (n,) m/s^2; after a search the rests
    (tuple of Run) and the multiple of the variance at rest that found them. U (3, 3) and
    offset (3,): corrected = U measured + offset."""

    parameters: np.ndarray
    cost: float
    residual: np.ndarray
    rests: tuple = ()
    multiple: int | None = None

    @property
    def U(self):
        return matrix_and_offset(self.parameters)[0]

    @property
    def offset(self):
        return matrix_and_offset(self.parameters)[1]

    def correct(self, measured):
        """measured (n, 3) m/s^2 -> corrected (n, 3)."""
        return measured @ self.U.T + self.offset

    def bias(self):
        """imu_tk's b, m/s^2, subtracted before U."""
        return -np.linalg.solve(self.U, self.offset)


def matrix_and_offset(parameters):
    U = np.zeros((3, 3))
    U[ROWS, COLUMNS] = parameters[:6]
    return U, parameters[6:]


def norm_residual(parameters, measured, g):
    """g - |U measured + o|, shape (n,)."""
    U, offset = matrix_and_offset(parameters)
    return g - np.linalg.norm(measured @ U.T + offset, axis=1)


def norm_jacobian(parameters, measured, g):
    U, offset = matrix_and_offset(parameters)
    corrected = measured @ U.T + offset
    unit = corrected / np.linalg.norm(corrected, axis=1)[:, None]
    return -np.hstack([unit[:, ROWS] * measured[:, COLUMNS], unit])


def solve(measured, g, start=None):
    """Nine parameters from samples or pose means of rests, measured (n, 3) in m/s^2.

    Whether the poses determine all nine is for refinement_answer.undetermined to say, from
    norm_jacobian at NOMINAL: where they do not, the optimum itself may lie anywhere.
    Raises ValueError for fewer poses than parameters.
    """
    start = NOMINAL if start is None else start
    if len(measured) < len(NAMES):
        raise ValueError(
            "|a| = g gives one equation a pose: %d poses cannot tell %d parameters, "
            "12 or more in different directions are wanted" % (len(measured), len(NAMES))
        )
    fit = least_squares(
        norm_residual, start, norm_jacobian, args=(measured, g), method="lm",
        x_scale=TYPICAL, xtol=1e-12, ftol=1e-12, gtol=1e-12,
    )
    return Multiposition(fit.x, float(fit.cost), fit.fun)


def search(measured, g, first_rest=None, samples_a_rest=100):
    """Rest detection and fit together: the multiple with the lowest cost wins.

    measured (n, 3) m/s^2 at an even rate; first_rest as rests_by_variance.variance_at_rest;
    samples_a_rest: the first so many of every rest are fitted (imu_tk fits 100, each on its
    own). The answer carries .rests and .multiple.
    """
    limit = rests_by_variance.variance_at_rest(measured, first_rest)
    best = None
    most = 0
    for multiple in MULTIPLES:
        still = rests_by_variance.find(measured, multiple * limit, shortest=samples_a_rest)
        most = max(most, len(still))
        if len(still) < FEWEST_RESTS:
            continue
        picked = np.vstack([measured[run.first : run.first + samples_a_rest] for run in still])
        fit = solve(picked, g)
        if best is None or fit.cost < best.cost:
            best = replace(fit, rests=tuple(still), multiple=multiple)
    if best is None:
        raise ValueError(
            "%d rests of %d samples found, %d or more are needed for |a| = g in free poses"
            % (most, samples_a_rest, FEWEST_RESTS)
        )
    return best
