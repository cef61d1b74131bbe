"""The moves from rest to rest of all sessions, those with poses and those of a robot that drives:
the gyro as the rests have calibrated it, and the accelerometer on the way."""
import numpy as np

from ..experiment import inertial_fit, turns
from ..experiment.attitude_fit import NominalSensor
from ..experiment.session import MOST_BAD
from .detect import saturation


def of(sessions, models, turned):
    """list of inertial_fit.Move. sessions: list of blocks.Session, the first len(models) with
    poses; models: their NominalSensor; turned: their calibrated turns."""
    found = []
    for number, session in enumerate(sessions):
        if number < len(models):
            chosen, sensor, runs = turned[number], models[number], session.runs
        else:
            chosen, sensor, runs = _driven(session, models, found)
        if not chosen:
            continue
        course, white = _course(session.t_s), _white(session.capture, runs)
        railed = saturation.railed(session)
        found += [inertial_fit.move(turn, session.capture, sensor, course, number,
                                    number < len(models), white)
                  for turn in chosen if railed[turn.first:turn.last].mean() <= MOST_BAD]
    return found


def _driven(session, models, known):
    """(turns, NominalSensor, runs) of a session without poses: calibrated by the others."""
    runs = session.runs
    if len(runs) < 2 or not known:
        return [], None, []
    scale = 1000.0 / session.capture.meta["accel_lsb_per_g"]
    sensor = NominalSensor(np.mean([m.matrix for m in models], axis=0),
                           np.mean([m.offset for m in models], axis=0), None)
    felt = sensor.corrected(np.array([session.capture.accel[a:b].mean(axis=0) * scale
                                      for _, a, b in runs]))
    up = felt / np.linalg.norm(felt, axis=1)[:, None]
    bias = np.array([session.capture.gyro[a:b].mean(axis=0) for _, a, b in runs]
                    ) / session.capture.meta["gyro_lsb_per_dps"]
    matrix = np.mean([m.turn.matrix for m in known], axis=0)
    found = [turns.between(session, up, 0.5 * (bias[place] + bias[place + 1]), place)
             for place in range(len(runs) - 1)]
    found = [turn.corrected(matrix, np.zeros(3)) for turn in found if turn.usable(session.rate)]
    return found, sensor, runs


def _course(t):
    """(HATS, n) straight pieces over a session."""
    u = (t - t[0]) / max(t[-1] - t[0], 1e-9) * (inertial_fit.HATS - 1)
    return np.clip(1.0 - np.abs(u - np.arange(inertial_fit.HATS)[:, None]), 0.0, None)


def _white(capture, runs):
    """mg: standard deviation of the accelerometer's mean over one second, of all axes."""
    differences = np.concatenate([np.diff(capture.accel[a:b].astype(float), axis=0)
                                  for _, a, b in runs if b - a > 2])
    # A squared difference of two normal samples has a median of 0.4549 times its mean, twice
    # their variance; rounding adds a twelfth.
    counts = np.sqrt(np.median(differences ** 2, axis=0) / 0.4549 / 2.0 + 1.0 / 12.0)
    return float(counts.mean()) * 1000.0 / capture.meta["accel_lsb_per_g"] / np.sqrt(
        capture.meta["rate_hz"])
