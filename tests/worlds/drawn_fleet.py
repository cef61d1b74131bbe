"""Fleets whose boards' estimates are drawn, thousands a second, instead of solved from sessions.

The errors have the covariance, all parameters of both sessions and all effects together, with
which the estimates of one and the same part scatter over sessions that simulated_fleet.py makes;
each board claims the covariances that one of those sessions claimed. So what is judged is the
population's model on estimates as wrong as they are, not as wrong as they say. Left out are errors
that are not normal, errors that depend on the part, and a mean error too small to be told from
that of so few sessions (SURE standard errors).
"""
import numpy as np

from sixflip_host.fleet import analysis, parameters

from .simulated_fleet import drawn, row_of

# Standard deviation of a batch's parts; of the noise none.
SPREAD = {"accel_scale": 0.006, "accel_misalignment": 0.35, "accel_bias": 15.0,
          "gyro_scale": 0.008, "gyro_misalignment": 0.45, "gyro_bias": 0.8}
WIDTH = np.concatenate([np.full(len(names), SPREAD.get(block, 0.0))
                        for block, names in parameters.BLOCKS.items()])
SENSORS = ("accel", "gyro")
SURE = 4.0


class Errors:
    """How the estimates of a part scatter; number: of boards that are made for it."""

    def __init__(self, rng, number=400):
        self.part = drawn(rng)
        self.rows = [row_of(self.part, rng, "") for _ in range(number)]
        values = np.array([one["values"] for one in self.rows])
        self.middle = values.mean(axis=0)
        root = np.sqrt(number - 1.0)
        self.off = (values - self.middle) / root
        self.told = {s: [analysis.information(one, s) for one in self.rows] for s in SENSORS}
        white = {s: np.array([np.linalg.solve(_root(one.precision), one.score) for one in told])
                 for s, told in self.told.items()}
        self.white = {s: (_sure(one), (one - one.mean(axis=0)) / root) for s, one in white.items()}
        self._plain = row_of(self.part, np.random.default_rng(0), "")

    def slope(self, part):
        """(sessions, parameters): what calibrations read otherwise of a part with an effect than
        of this part without."""
        other = row_of(part, np.random.default_rng(0), "")
        return np.subtract(other["values"], self._plain["values"])

    def row(self, rng, board, effects=(), batch=""):
        """The row of a board of the batch; effects: [(coefficients (k,), sensor, what calibrations
        read otherwise for it)]."""
        mix = rng.normal(size=len(self.rows))
        values = self.middle + rng.normal(0.0, WIDTH) + np.tensordot(mix, self.off, 1)
        claims = int(rng.integers(len(self.rows)))
        found = dict(self.rows[claims], board=board, batch=batch)
        for sensor in SENSORS:
            told, (middle, off) = self.told[sensor][claims], self.white[sensor]
            score = _root(told.precision) @ (middle + mix @ off)
            for size, its, otherwise in effects:
                if its == sensor:
                    score = score + told.precision @ size
                    values = values + otherwise
            found["score_" + sensor] = score.tolist()
        return dict(found, values=values.tolist())


def _sure(values):
    """(k,) mean of (n, k), 0 where its standard error leaves that open."""
    middle = values.mean(axis=0)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    return np.where(np.abs(middle) > SURE * error, middle, 0.0)


def _root(precision):
    """Lower triangular L, L L' = precision, of what is not told a little."""
    own = np.diag(precision)
    return np.linalg.cholesky(precision + np.diag(1e-9 * own + 1e-12))
