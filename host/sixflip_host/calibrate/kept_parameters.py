"""Robots that cannot take all six faces: solve what the session tells, keep the rest.

A vehicle can rest on the floor, turn on it, stand on a ramp both ways. Whatever that determines
is estimated, starting from a correction record; a parameter the session does not narrow by half
stays exactly as the record has it. Which is which depends on the session and is part of the
answer.
"""

import numpy as np

from ..errors import BadFile
from . import joint_refinement
from .joint_refinement import GYRO_OFFSET, GYRO_PER_G, GYRO_SCALE, N_ACCEL, N_GYRO, SCALE

RAD = np.pi / 180.0
TOLD = 0.5  # share of the prior variance a session must take away


def from_record(record, flips, g):
    """Parameters (see refinement_residuals) out of a correction Record."""
    p = joint_refinement.nominal(flips)
    if record.accel is None:
        raise BadFile("the record holds no accelerometer, there is nothing to keep")
    P = np.array(record.accel["P"])
    p[:9] = P[:3, :3].T.ravel()
    p[9:12] = P[3, :3] / record.g
    W = p[N_ACCEL : N_ACCEL + N_GYRO].reshape(3, 7)
    if record.gyro is not None:
        P = np.array(record.gyro["P"])
        W[:, :3], W[:, 3] = P[:3].T, P[3]
    if record.gyro_bias is not None:
        W[:, 3] = -W[:, :3] @ np.array(record.gyro_bias["bias_dps"]) * RAD
    return p


def ageing(flips):
    """How far a calibrated sensor may be off its record: biases drift, shapes hardly do."""
    typical = np.full(N_ACCEL + N_GYRO + flips, 0.002)
    typical[SCALE] = 0.003
    typical[9:12] = 0.03  # g
    typical[GYRO_SCALE] = 0.01
    typical[GYRO_OFFSET] = 2.0 * RAD
    typical[GYRO_PER_G] = 0.0
    typical[N_ACCEL + N_GYRO :] = joint_refinement.FREE_FLIP
    return typical


def refine(session, record):
    """The joint refinement of what this session tells; (Refinement, solved names, kept names)."""
    flips = len(session.flips)
    centre, typical = from_record(record, flips, session.g), ageing(flips)
    free = np.ones(len(centre), dtype=bool)
    free[GYRO_PER_G] = False
    if not session.has_gyro:
        free[N_ACCEL : N_ACCEL + N_GYRO] = False
    for k, flip in enumerate(session.flips):
        free[N_ACCEL + N_GYRO + k] = flip.move is not None
    sensor = np.arange(len(centre)) < N_ACCEL + N_GYRO
    while True:
        out = joint_refinement.refine(session, centre=centre, typical=typical, free=free)
        share = 1.0 - (out.sigma() / np.where(typical > 0, typical, 1.0)) ** 2
        weak = free & sensor & (share < TOLD)
        if not weak.any():
            break
        free[weak & (share <= share[weak].min() + 0.1)] = False
    # What is kept is as uncertain as its age, not certain because it was not touched.
    held = np.flatnonzero(~free & sensor)
    out.covariance[held, held] = typical[held] ** 2
    told = [out.names[k] for k in np.flatnonzero(free & sensor)]
    known = np.ones(len(centre), dtype=bool)
    known[GYRO_PER_G] = False
    if record.gyro is None and not session.has_gyro:
        known[N_ACCEL:] = False
    kept = [out.names[k] for k in np.flatnonzero(~free & sensor & known)]
    return out, told, kept
