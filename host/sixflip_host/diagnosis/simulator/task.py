"""Layer four: what the gap does to a robot. One attitude filter (imufusion, Madgwick's revised
complementary filter) on the real log, on the simulator's and on the simulator's put right."""
from dataclasses import dataclass, replace

import numpy as np

SETTLE_S = 3.0  # the filter's own start-up ramp


@dataclass(frozen=True)
class Task:
    """estimator; what the errors are against; attitude and heading, degrees: {"before": x,
    "after": y}; attitude: root mean square of roll and pitch; heading: by the end of the log."""

    estimator: str
    against: str
    attitude: dict
    heading: dict


def available():
    """Whether imufusion is there."""
    try:
        import imufusion  # noqa: F401
    except ImportError:
        return False
    return True


def estimated(t, force, rate, g):
    """(n, 3, 3) attitudes of the filter, body to world."""
    import imufusion
    period = float(np.median(np.diff(t)))
    ahrs = imufusion.Ahrs()
    settings = imufusion.AhrsSettings()
    settings.sample_rate = 1.0 / period
    ahrs.set_settings(settings)
    attitudes = np.empty((len(t), 3, 3))
    for i in range(len(t)):
        ahrs.update_no_magnetometer(np.degrees(rate[i]), force[i] / g)
        attitudes[i] = imufusion.quaternion_to_matrix(ahrs.get_quaternion()).reshape(3, 3)
    return attitudes


def between(a, b, t):
    """(root mean square of roll and pitch, heading at the end), degrees, of two courses of
    attitudes (n, 3, 3), the heading equal after the filter's start."""
    keep = t - t[0] > SETTLE_S
    a, b = a[keep], b[keep]
    up = np.degrees(np.arccos(np.clip((a[:, 2] * b[:, 2]).sum(axis=1), -1.0, 1.0)))
    turn = np.einsum("nij,nkj->nik", a, b)
    heading = np.unwrap(np.arctan2(turn[:, 1, 0] - turn[:, 0, 1], turn[:, 0, 0] + turn[:, 1, 1]))
    return float(np.sqrt(np.mean(up ** 2))), float(np.degrees(heading[-1] - heading[0]))


def of_pair(accel, gyro, g):
    """Task of one motion, of two conventions.SensorFit; put right: what the simulator would say
    with the conventions and parameters found, which is the real reading and what is left."""
    t = np.intersect1d(accel.pair.t, gyro.pair.t)
    at = [np.isin(x.pair.t, t) for x in (accel, gyro)]
    real = accel.pair.force[at[0]], gyro.pair.rate[at[1]]
    put_right = tuple(r + x.fit.left[k] @ x.fit.axes / x.fit.unit
                      for r, x, k in zip(real, (accel, gyro), at))
    simulated = accel.pair.sim_force[at[0]], gyro.pair.sim_rate[at[1]]
    wanted = estimated(t, *real, g)
    return made("the same filter on the real log", [
        between(estimated(t, *values, g), wanted, t) for values in (simulated, put_right)])


def of_own(real, sim, own_real, own_sim):
    """Task of two motions: each log's error against its own calibrated log, and by how much the
    simulator's is other than the real one's; after: the simulator with the real one's sensor."""
    def error(trace, sensor):
        true = sensor.applied(trace)
        return np.array(between(estimated(trace.t, trace.force, trace.rate, trace.g),
                                estimated(true.t, true.force, true.rate, trace.g), trace.t))

    wanted = error(real, own_real)
    true = own_sim.applied(sim)
    as_real = replace(sim, force=true.force @ np.linalg.inv(own_real.accel).T + own_real.bias,
                      rate=true.rate @ np.linalg.inv(own_real.gyro).T + own_real.gyro_bias)
    before, after = (error(x, y) - wanted for x, y in ((sim, own_sim), (as_real, own_real)))
    return made("the error of the same filter on the real log, each against its calibrated log",
                [before, after])


def made(against, results):
    """Task of ((tilt, heading) before, after), degrees."""
    (tilt, heading), (tilt_after, heading_after) = results
    return Task("imufusion", against,
                {"before": abs(float(tilt)), "after": abs(float(tilt_after))},
                {"before": abs(float(heading)), "after": abs(float(heading_after))})
