"""Which of the two sensors of a box is turned in it, where the one lies otherwise beside the other
than in the simulator.

By its own rests and moves a log knows how its gyro lies beside its accelerometer, to a twentieth
of a degree, and not which of them is turned. A face on which the box was turned by half a turn
says it, as well as a box is square: the mean of its two directions is where the accelerometer
has the face, whatever the table leans.
"""
from dataclasses import replace

import numpy as np

from ...capture.attitude import carried, rotations
from ..box_tilt_test import USUAL_DEG
from . import gravity_directions, parameters
from .convention_findings import CERTAIN
from .sensor_axes import DEG

HALF_TURN = np.radians(150.0)  # from which on a turn between two rests on one face is a flip


def as_the_box_says(real, sim, own_real, own_sim):
    """(OwnSensor of the real Trace, sentences on what its box does not tell): where its gyro lies
    otherwise beside its accelerometer than the simulator's, the turn is the accelerometer's about
    each axis about which the faces of both boxes make that likelier."""
    beside, beside_sigma = turn_beside(own_real, own_sim)
    differs = np.abs(beside) > parameters.DIFFERS * beside_sigma
    measured, sigma = turn(real, own_real)
    other, other_sigma = turn(sim, own_sim)
    # Either the accelerometer is turned so far, or the gyro is, and the accelerometer is not.
    nats = 0.5 * ((measured - other) ** 2 - (measured - other - beside) ** 2) / (
        sigma ** 2 + other_sigma ** 2 + beside_sigma ** 2)
    open_axes = differs & (np.abs(nats) < np.log(CERTAIN / (1.0 - CERTAIN)))
    turned = np.where(differs & (nats > 0.0), beside, 0.0)
    back = rotations(turned[None])[0].T
    accel_sigma = own_real.accel_sigma.copy()
    for axis in np.flatnonzero(turned):
        i, j = (k for k in range(3) if k != axis)
        accel_sigma[[i, j], [j, i]] = np.hypot(accel_sigma[[i, j], [j, i]], beside_sigma[axis])
    return replace(own_real, accel=back @ own_real.accel, gyro=back @ own_real.gyro,
                   accel_sigma=accel_sigma, turned=turned), [
        "which of accelerometer and gyro is turned by %.2g° about %s beside the other: the faces "
        "of a square box would tell more of it, and it is said to be the %s" % (
            abs(DEG * beside[k]), "xyz"[k], "accelerometer" if turned[k] else "gyro")
        for k in np.flatnonzero(open_axes)]


def turn_beside(real, sim):
    """(turn (3,) rad, its standard errors) of the accelerometer of an OwnSensor about its gyro,
    less that of the simulator's."""
    off = np.linalg.inv(sim.gyro) - np.linalg.inv(real.gyro)
    variance = real.gyro_sigma ** 2 + sim.gyro_sigma ** 2
    pairs = ((2, 1), (0, 2), (1, 0))
    return (np.array([0.5 * (off[i, j] - off[j, i]) for i, j in pairs]),
            np.array([0.5 * np.sqrt(variance[i, j] + variance[j, i]) for i, j in pairs]))


def turn(trace, own):
    """(turn (3,) rad of the accelerometer in its box, its standard errors) of a Trace with its
    OwnSensor by the faces that it was turned on; infinite where they do not show every axis."""
    means = trace.rest_means(trace.force)
    ups = (means - own.bias) @ own.accel.T
    ups /= np.linalg.norm(ups, axis=1)[:, None]
    gram, right = np.zeros((3, 3)), np.zeros(3)
    for before, after, steps in gravity_directions.moves(trace):
        face = trace.faces[before]
        if face is None or not np.array_equal(face, trace.faces[after]):
            continue
        whole = carried(rotations(steps @ own.gyro.T))[-1]
        if np.arccos(np.clip((np.trace(whole) - 1.0) / 2.0, -1.0, 1.0)) < HALF_TURN:
            continue
        x, y, z = face
        across = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])  # turn x face
        gram += across.T @ across
        right += across.T @ (0.5 * (ups[before] + ups[after]) - face)
    if np.linalg.matrix_rank(gram) < 3:
        return np.zeros(3), np.full(3, np.inf)
    covariance = np.radians(USUAL_DEG) ** 2 * np.linalg.inv(gram)
    return np.linalg.solve(gram, right), np.sqrt(np.diag(covariance))
