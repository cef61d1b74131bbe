"""A low-pass that one of two logs of one motion has and the other has not: what it leaves of each
frequency, how late it makes what is slow, and how it bends that.
"""
from dataclasses import dataclass

import numpy as np

FIRST_ORDER, MEAN = "first order", "mean"
# What each has of a frequency, by x = 2 pi f times its time constant, without the delay of what is
# slow: of a pole, of Butterworth's two, and of the mean of so many seconds.
FORMS = {
    FIRST_ORDER: lambda x: np.exp(1j * x) / (1.0 + 1j * x),
    "second order (Butterworth)": lambda x: np.exp(1j * np.sqrt(2.0) * x) / (
        1.0 - x ** 2 + 1j * np.sqrt(2.0) * x),
    MEAN: lambda x: np.sinc(x / (2.0 * np.pi)) + 0j,
}
# Delay of what is slow, and half the square of the time constant of the pole that bends a slow
# signal as much (of two of Butterworth's, which bend none, of their own), in time constants.
LATE = dict(zip(FORMS, (1.0, np.sqrt(2.0), 0.5)))
HALF_SQUARE = dict(zip(FORMS, (0.5, 0.5, 1.0 / 24.0)))
LEAST = 0.05  # that a low-pass may leave of what is compared: of less nothing is known
STEP, FASTEST_HZ = 1e-3, 15.0  # of the square, and where nothing is left of the widest band


@dataclass(frozen=True)
class LowPass:
    """form: one of FORMS; seconds: its time constant, or how long its mean is; of: "sim" where
    the simulator's log is the smoother one, or "real"."""

    form: str
    seconds: float
    of: str

    @classmethod
    def of_half_square(cls, s2, form=FIRST_ORDER):
        """The LowPass by which the simulator's log is smoother, by half the square s2 of a pole's
        time constant, or by as much less: of two poles one after the other it adds up."""
        return cls(form, float(np.sqrt(abs(s2) / HALF_SQUARE[form])), "sim" if s2 > 0 else "real")

    @property
    def words(self):
        ms = 1e3 * self.seconds
        return "mean of %.3g ms" % ms if self.form == MEAN else \
            "low-pass of %s at %.3g Hz (time constant %.3g ms)" % (
                self.form, 1e3 / (2.0 * np.pi * ms), ms)

    def on(self, log):
        """What the log, "sim" or "real", has to be put behind, or None."""
        return None if log == self.of else self

    def response(self, hz):
        """Complex (k,) share that is left of frequencies hz (k,), without delay of the slow."""
        return FORMS[self.form](2.0 * np.pi * hz * self.seconds)

    def bend(self, second, rate_hz):
        """What a longer time constant does to readings behind this, per half of its square, by the
        second derivative of these, second (n, k) at a rate: of no low-pass that is itself."""
        n, beside = len(second), 1.0 + STEP
        hz = np.fft.rfftfreq(2 * n, 1.0 / rate_hz)
        longer = LowPass(self.form, self.seconds * np.sqrt(beside), self.of).response(hz)
        now, share = self.response(hz), np.zeros(len(hz), complex)
        seen = (hz > 0.0) & (hz < FASTEST_HZ) & (np.abs(now) > LEAST)
        share[seen] = -np.log(longer[seen] / now[seen]) / (
            (2.0 * np.pi * hz[seen]) ** 2 * STEP * HALF_SQUARE[self.form] * self.seconds ** 2)
        whole = np.concatenate([second, second[::-1]])
        return np.fft.irfft(np.fft.rfft(whole, axis=0) * share[:, None], 2 * n, axis=0)[:n]

    @property
    def half_square_s2(self):
        """By how much smoother the simulator's log is, see of_half_square."""
        return self._sign * HALF_SQUARE[self.form] * self.seconds ** 2

    @property
    def late_s(self):
        """By how much it makes the simulator's log later."""
        return self._sign * LATE[self.form] * self.seconds

    @property
    def _sign(self):
        return 1.0 if self.of == "sim" else -1.0
