"""The bias that a gyro's P holds; a module of its own, nothing that streams needs it."""

import math

from sixflip.scale_form import inverse3


def gyro_bias_dps(P):
    """The measured rate in deg/s that P maps to zero: b A = -o."""
    A = inverse3([[P[i][j] for j in range(3)] for i in range(3)])
    return [math.degrees(-sum([P[3][k] * A[k][j] for k in range(3)])) for j in range(3)]
