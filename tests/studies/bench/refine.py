"""Host refinement beside imu_tk, and what the flips' measured angles are worth.

The column imu_tk holds figures taken from a run of imu_tk elsewhere; it is not run here.
python -m tests.studies.bench.refine [sessions]   Recordings: SIXFLIP_DATA, or ../shared/data.
"""

import os
import sys
import time
from pathlib import Path

import numpy as np

from sixflip.accelerometer import solver as accelerometer
from sixflip_host.calibrate import (
    joint_refinement,
    multiposition,
    refinement,
    refinement_answer,
)
from tests.worlds import hand_session, xsens_recording

ROOT = Path(__file__).resolve().parents[3]
RAD = np.pi / 180


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def xsens(folder):
    """imu_tk's own problem on its own recording, then the fuller one."""
    capture = xsens_recording.read(folder)
    measured, g = xsens_recording.measured(capture), xsens_recording.G
    began = time.perf_counter()
    fit = multiposition.search(measured, g, xsens_recording.INITIAL_REST)
    seconds = time.perf_counter() - began
    means = np.array([measured[f : f + 100].mean(axis=0) for _, f, _ in fit.rests])
    off = multiposition.norm_residual(fit.parameters, means, g)
    left = xsens_recording.leave_one_out(means, fit.parameters)
    print("Xsens recording, imu_tk's own problem      imu_tk      ours")
    print("  cost                                  %9.6f %9.6f" % (0.120131, fit.cost))
    print("  | |a|-g | per pose, mg rms            %9.3f %9.3f" % (0.153, 1e3 * rms(off) / g))
    print("  leave one pose out, mg rms            %9.3f %9.3f" % (0.207, 1e3 * rms(left) / g))
    print("  rest detection, search and fit, s     %9.1f %9.2f" % (0.7, seconds))
    began = time.perf_counter()
    session, _ = refinement.session_of(capture, free=True)
    plain = joint_refinement.refine(session)
    fuller = joint_refinement.refine(session, per_g=True)
    seconds = time.perf_counter() - began
    without, with_it, _ = refinement.bias_of_rests(session)
    print("fuller problem: all of every rest, all moves, the gyro (%.1f s)" % seconds)
    print("  | |a|-g | per pose, mg rms %.3f" % rms(refinement_answer.norm_off_mg(fuller)))
    print("  chi2/dof of the gyro's rests, x y z: %s without g-sensitivity, %s with it" % (
        " ".join("%.1f" % c for c in without), " ".join("%.2f" % c for c in with_it)))
    print("  g-sensitivity up to %.3f deg/s/g" % (np.abs(fuller.gyro()[2]).max() / RAD))
    print("  gravity at both ends of the moves: %.3f deg rms without, %.3f with it" % tuple(
        refinement_answer.moves_off_deg(session, result) for result in (plain, fuller)))
    print("  gyro scale %s ± %s" % tuple(" ".join("%.5f" % v for v in values[[12, 20, 28]])
                                        for values in (fuller.p, fuller.sigma())))


def flips(sessions):
    """Vector error on a 2 degree table, flips off half a turn all to the same side."""
    print("six faces on a 2 deg table, vector error, mg (median of %d sessions)" % sessions)
    print("  flips off   hand   scatter   180 assumed   refined angles   joint   gyro scale")
    for off, hand, scatter in ((0, 0, 0), (0, 0.4, 0), (5, 0, 0), (10, 0, 0), (-10, 0, 0),
                               (5, 0.4, 0.05)):
        rows = np.array([one_session(seed, off, hand, scatter) for seed in range(sessions)])
        print("  %6.0f deg %6.1f %9.2f %13.3f %16.3f %7.3f %10.3f %%" % (
            (off, hand, scatter) + tuple(np.median(rows, axis=0))))


def one_session(seed, off, hand, scatter):
    sensor = hand_session.Sensor(seed)
    poses = hand_session.six_faces(seed, 2.0, off, scatter, hand)
    capture = hand_session.session(sensor, poses, seed)
    session, _ = refinement.session_of(capture)
    result = joint_refinement.refine(session)
    errors = []
    for angles in (None, refinement_answer.angles(session, result)):
        P = np.array(accelerometer.solve(
            capture.placements(), hand_session.LSB_G, angles=angles).P)
        errors.append(sensor.vector_error_mg(P[:3, :3].T, P[3, :3] / accelerometer.G))
    scale = np.diag(result.first.gyro()[0] @ sensor.Kw) - 1
    return [*errors, sensor.vector_error_mg(*result.accelerometer()), 100 * np.abs(scale).max()]


def free_hand(sessions):
    """Gyro scale of sessions held by hand, 30 free poses."""
    worst = []
    began = time.perf_counter()
    for seed in range(sessions):
        sensor = hand_session.Sensor(seed)
        capture = hand_session.session(sensor, hand_session.free_poses(seed, 30), seed)
        session, _ = refinement.session_of(capture)
        result = joint_refinement.refine(session)
        U, _, V = np.linalg.svd(result.accelerometer()[0] @ sensor.K)
        error = (U @ V).T @ result.gyro()[0] @ sensor.Kw - np.eye(3)
        worst.append(100 * np.abs(np.diag(error)).max())
    print("free hand, 30 poses: largest gyro scale error %.4f %% median, %.4f %% worst of %d "
          "(imu_tk: 0.03-0.04 %%), %.1f s a session with its simulation" % (
              np.median(worst), max(worst), sessions, (time.perf_counter() - began) / sessions))


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    recordings = Path(os.environ.get("SIXFLIP_DATA", ROOT.parent / "shared" / "data"))
    if recordings.is_dir():
        xsens(recordings)
    else:
        print("no recordings at %s: set SIXFLIP_DATA for the Xsens part" % recordings)
    flips(count)
    free_hand(count)
