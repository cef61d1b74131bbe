"""Twelve poses as exact sums, made in numpy, and how far two corrections of them are apart."""

import numpy as np


def session_sums(seed, tilt_deg, lsb=16384, n=400):
    """Twelve placements of a sensor with errors on a tilted table: exact integer sums."""
    rng = np.random.default_rng(seed)
    A = np.eye(3) + rng.normal(0, 0.02, (3, 3))
    bias = rng.normal(0, 0.05, 3)
    placements = []
    for face in range(6):
        axis, sign = (2, 2, 0, 0, 1, 1)[face], (1, -1)[face % 2]
        yaw = rng.uniform(0, 2 * np.pi)
        for letter in range(2):
            t = np.radians(tilt_deg)
            truth = np.zeros(3)
            truth[axis] = sign * np.cos(t)
            turn = yaw + np.pi * letter
            truth[(axis + 1) % 3] = np.sin(t) * np.cos(turn)
            truth[(axis + 2) % 3] = np.sin(t) * np.sin(turn)
            counts = np.rint((A @ truth + bias + rng.normal(0, 0.004, (n, 3))) * lsb)
            sums = [int(x) for x in counts.sum(axis=0)] + [0] * 4
            noise = [float(x) for x in counts.std(axis=0)] + [0.0] * 3
            placements.append((1 + 2 * face + letter, 0, n, sums, noise, n * 10000))
    return placements


def vector_error_mg(P, Q, g=9.80665):
    """Largest difference of two corrections over the sphere of 1 g, in mg (upper bound)."""
    d = P - Q
    return (np.linalg.norm(d[:3], 2) * g + np.linalg.norm(d[3])) / g * 1000
