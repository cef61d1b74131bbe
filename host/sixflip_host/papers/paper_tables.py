"""What Li et al. (Sensors 2019, 19, 4150) printed, and their sensor made from it.

Angles and factors of Table 3 are in hundredths as in the paper. v's unit is not stated there;
read as m/s² its Z bias is 58 mg, which an ADXL345 may have (data sheet: 0 g offset to 80 mg).
"""

import numpy as np

# name, mean, standard deviation, ×10⁻², of ten calibrations
TABLE_3 = (
    ("β_yz", 1.45, 0.21), ("β_zy", -5.59, 0.01), ("β_xz", -4.06, 1.96), ("β_zx", 1.98, 0.04),
    ("β_xy", 1.98, 0.03), ("β_yx", 0.90, 0.06),
    ("Scale x", 98.52, 0.10), ("Scale y", 99.05, 0.16), ("Scale z", 99.17, 0.11),
    ("v x", 0.37, 0.05), ("v y", 2.54, 0.53), ("v z", 57.25, 4.21),
)
# turn, read before and after calibration, degrees, ten repetitions averaged
TABLE_4 = ((30, 27.6, 29.6), (45, 47.2, 45.9), (60, 61.8, 59.2), (90, 88.0, 90.5))

# Where each angle stands in T of Li Eq. 5, [row, column], and its sign.
ANGLES = {"β_yz": (0, 1, -1), "β_zy": (0, 2, 1), "β_xz": (1, 0, 1), "β_zx": (1, 2, -1),
          "β_xy": (2, 0, -1), "β_yx": (2, 1, 1)}


def parameters(T, scale, v):
    """The twelve in Table 3's order, ×10⁻², of a_t = T S (a_m + v): T 3 x 3, v in m/s²."""
    angles = [sign * T[i][j] for i, j, sign in ANGLES.values()]
    return [1e2 * x for x in [*angles, *scale, *v]]


def sensor():
    """(A, b) of the paper's accelerometer, measured = A true + b, m/s²: Table 3's means."""
    means = {name: mean / 1e2 for name, mean, _ in TABLE_3}
    T = np.eye(3)
    for name, (i, j, sign) in ANGLES.items():
        T[i, j] = sign * means[name]
    scale = np.diag([means["Scale " + axis] for axis in "xyz"])
    return np.linalg.inv(T @ scale), -np.array([means["v " + axis] for axis in "xyz"])
