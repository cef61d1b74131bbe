"""Which low-pass lies between two logs of one motion: its form and its time constant, by the
spectra of what both read.

A low-pass that ends within the band compared is no small bend of the signal: at its own frequency
one of first order leaves 0.7 and has turned by an eighth of a period, and what is left of it there
looked like a scale, or like nothing known. Where a form foretells the log better than any bend
does, the other log is put behind the same low-pass before hypotheses are weighed.
Source: Bendat & Piersol, Random Data (2010), section 6.1 (one system, one input and output).
"""
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from ...experiment.low_pass import FORMS, LATE, LEAST, LowPass
from . import hypotheses
from .pairing import COHERENT, GRID_HZ, SEGMENT_S, paired

# Time constants tried: from the one whose pole leaves all but 0.03 of the widest band on, by
# half-octaves, to where a pole leaves a twentieth of it.
TIMES_S = 0.0065 * np.sqrt(2.0) ** np.arange(10)
# s of a segment: a low-pass has forgotten all but a part in a hundred of what was before it.
SEGMENTS_S = 2.0 * SEGMENT_S, SEGMENT_S
SLOWEST_HZ = 0.2  # below, a segment has no whole period
# Nats by which a form has to foretell a log better than a bend does: ten times what the best of
# all forms has by chance.
BETTER = 30.0
ALIKE = 3.0  # nats by which it has to where it is the other sensor's: as many as chance gives
FEWEST, FEWEST_HZ = 4, 6  # segments of a mean, and frequencies, which tell a form from another
DELAY_S, NEAR_S = 0.1, 0.005  # a delay that is looked for: of what is slower than 2 Hz, and finer
EVEN = 1e-9  # of each gain's own weight, so that columns that are alike have one
RATIO = 0.01, 100.0  # least and most of two logs' noise: what shakes both has no part in it


def between(real, sim, alignment, motion, live):
    """{sensor: LowPass} of two Traces of one motion, where there is one; live {sensor: (3,)}:
    channels of the simulator's that change."""
    pair, kinds = paired(real, sim, alignment, motion), [k for k in live if live[k].any()]
    asked = {kind: _asked(
        hypotheses.made(kind, alignment.turning)(pair.real(kind), pair.motion, real.g)[-1],
        pair.simulated(kind)[:, live[kind]], pair.t, pair.band_hz,
        [log.noise[kind] for log in (real, sim)]) for kind in kinds}
    own = {kind: each.low_pass for kind, each in asked.items() if each is not None}
    found = [x for x in own.values() if x is not None]
    # What one sensor of a part shows for certain the other may show less of.
    return {kind: x or found[0] for kind, x in own.items() if x is not None or (
        found and asked[kind].as_well(found[0]))}


@dataclass(frozen=True)
class _Asked:
    """A sensor's _Spectra, ratio of the noises, delay, nats of the best bend, and LowPass that
    foretells it better, or None."""

    spectra: object
    ratio: float
    delay_s: float
    bend: float
    low_pass: object

    def as_well(self, other):
        """Whether the LowPass of the other sensor of its part does better than any bend."""
        return _fitted(self.spectra, other.form, other.of, self.delay_s, self.ratio,
                       other.seconds)[0] > self.bend + ALIKE


def _asked(nameless, measured, t, band_hz, noises):
    """_Asked of the simulator's channels measured (n, k) at times t (n,), of which nothing is
    faster than band_hz, beside the signal of the nameless Hypothesis, or all that it has: what
    says more, each coefficient at half the logarithm of what it is known by [Schwarz, Estimating
    the dimension of a model, Ann. Statist. 6 (1978), 461]; noises: log_noise.Noise of the real
    log and the simulator's, or None. None of too few segments, or frequencies."""
    ratio = 1.0
    if None not in noises:
        own, theirs = (max(float((noise.density ** 2).mean() / max(x.var(axis=0).mean(), 1e-30)),
                           1e-30) for noise, x in zip(noises, (nameless.signal, measured)))
        ratio = float(np.clip(theirs / own, *RATIO))
    every = []
    for columns in (nameless.signal, np.concatenate([nameless.signal, nameless.free], 1)):
        spectra = _of(columns, measured, t, band_hz, ratio)
        if spectra is None:
            continue
        delay = spectra.late(ratio)
        bend = optimize.minimize(
            lambda p, spectra=spectra: -spectra.nats(spectra.bent(*p), ratio), [0.0, 0.0],
            method="Nelder-Mead", options=_steps([delay, 0.0], [NEAR_S, 1e-4]))
        best, nats = None, BETTER - bend.fun
        for form in FORMS:
            for of in ("sim", "real"):
                log, seconds = _fitted(spectra, form, of, delay, ratio)
                if log > nats:
                    best, nats = LowPass(form, seconds, of), log
        every.append((max(nats, -bend.fun) - spectra.costs(),
                      _Asked(spectra, ratio, delay, -bend.fun, best)))
    return max(every, key=lambda each: each[0])[1] if every else None


def _fitted(spectra, form, of, delay, ratio, known=None):
    """(nats, time constant) at which a form of low-pass foretells best; known: the time constant,
    of which the delay alone is looked for."""
    def nats(p):
        seconds = float(np.exp(p[1])) if known is None else known
        h = LowPass(form, seconds, of).response(spectra.hz)
        if not TIMES_S[0] <= seconds * LATE[form] <= TIMES_S[-1] or np.abs(h).min() < LEAST:
            return -np.inf
        return spectra.nats(spectra.delayed(p[0]) * (h if of == "sim" else 1.0 / h), ratio)

    start = max(([delay, np.log(s / LATE[form])] for s in TIMES_S), key=nats) \
        if known is None else [delay]
    if not np.isfinite(nats(start)):
        return -np.inf, 0.0
    best = optimize.minimize(lambda p: min(-nats(p), 1e300), start, method="Nelder-Mead",
                             options=_steps(start, [NEAR_S, 0.2][:len(start)]))
    return -best.fun, float(np.exp(best.x[1])) if known is None else known


def _steps(start, first):
    """Options of a search: the simplex that it starts with, and where it may end."""
    start = np.array(start)
    return {"initial_simplex": start + np.vstack([np.zeros(len(start)), np.diag(first)]),
            "xatol": 1e-5, "fatol": 0.1, "maxfev": 200}


@dataclass(frozen=True)
class _Spectra:
    """hz (f,); mean cross spectra of what is read: xx (f, q, q) of the real log's columns, xy
    (f, q, k) with the simulator's channels, yy (f, k) of these; number of segments."""

    hz: np.ndarray
    xx: np.ndarray
    xy: np.ndarray
    yy: np.ndarray
    number: int

    def delayed(self, seconds):
        return np.exp(-2j * np.pi * self.hz * seconds)

    def bent(self, seconds, s2):
        """The response of a signal that is late and smoothed by a bend, s2 as in Fit."""
        return self.delayed(seconds) * (1.0 - s2 * (2.0 * np.pi * self.hz) ** 2)

    def regression(self, h, ratio):
        """(gains (q, k), (k,) power that is left, (f,) noise) of the channels behind a response h
        (f,): both logs have noise, of which the response takes what is the real one's, so the
        squares of each frequency are weighed by that [Fuller (1987), section 1.3]."""
        noise = (ratio + np.abs(h) ** 2) / (ratio + 1.0)
        own = np.einsum("f,fij->ij", np.abs(h) ** 2 / noise, self.xx).real
        both = np.einsum("f,fik->ik", h.conj() / noise, self.xy).real
        gains = np.linalg.solve(own + EVEN * np.diag(np.diag(own)), both)
        left = (self.yy / noise[:, None]).sum(axis=0) - (gains * both).sum(axis=0)
        return gains, np.maximum(left, 1e-300), noise

    def nats(self, h, ratio):
        """Log likelihood of the simulator's channels behind a response h (f,), but for a
        constant: each frequency of each two segments, which overlap by half, counts twice."""
        _, left, noise = self.regression(h, ratio)
        return -0.5 * self.number * len(self.hz) * float(
            np.log(left).sum() + len(left) * np.log(noise).mean())

    def costs(self):
        """Nats that the gains of all columns cost."""
        return 0.5 * self.xy[0].size * np.log(self.number * len(self.hz))

    def late(self, ratio):
        """Delay of the simulator's log at which the real one foretells it best as it is."""
        return float(max(np.arange(-DELAY_S, DELAY_S, NEAR_S),
                         key=lambda s: self.nats(self.delayed(s), ratio)))

    def coherent(self, ratio):
        """The _Spectra of the frequencies at which what is foretold is coherent with what is read,
        whatever the response is there; None of too few."""
        gains, _, _ = self.regression(self.delayed(self.late(ratio)), ratio)
        foretold = np.einsum("ik,fij,jk->f", gains, self.xx, gains).real
        shared = np.abs(np.einsum("ik,fik->f", gains, self.xy)) ** 2
        keep = shared > COHERENT * foretold * self.yy.sum(axis=1)
        return None if keep.sum() < FEWEST_HZ else _Spectra(
            self.hz[keep], self.xx[keep], self.xy[keep], self.yy[keep], self.number)


def _of(columns, measured, t, band_hz, ratio):
    """_Spectra by Welch's method, of segments without a hole, at the frequencies that are coherent
    in both logs; None of too few."""
    columns = columns[:, columns.std(axis=0) > 0.0]
    columns = columns / columns.std(axis=0)
    runs = np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) > 1.5 / GRID_HZ) + 1)
    for rows in (np.array(SEGMENTS_S) * GRID_HZ).astype(int):
        starts = [k for run in runs for k in run[:max(0, len(run) - rows + 1):rows // 2]]
        if len(starts) >= FEWEST:
            break
    hz = np.fft.rfftfreq(rows, 1.0 / GRID_HZ)
    inside, window = (hz > SLOWEST_HZ) & (hz <= band_hz), np.hanning(rows)[:, None]
    if len(starts) < FEWEST or not columns.size:
        return None
    xx, xy, yy = 0.0, 0.0, 0.0
    for k in starts:
        x, y = (np.fft.rfft((each[k:k + rows] - each[k:k + rows].mean(axis=0)) * window,
                            axis=0)[inside] for each in (columns, measured))
        xx = xx + x.conj()[:, :, None] * x[:, None]
        xy = xy + x.conj()[:, :, None] * y[:, None]
        yy = yy + np.abs(y) ** 2
    return _Spectra(hz[inside], xx, xy, yy, len(starts)).coherent(ratio)
