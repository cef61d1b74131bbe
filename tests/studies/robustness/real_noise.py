"""Rests of real recordings, cut into pieces: the noise of synthetic poses.

There is less of it than a session needs, and a piece that comes again and again would make a
line of every chance peak of its spectrum. So each time it is played a little faster or slower. A
piece with a knock in it is left out, which would come again every minute. What lines a recording
has is computed here by scipy's spectrogram alone: a diagnosis that finds one finds what is there.
"""

import numpy as np
from scipy import signal, special

from . import real_captures

PIECE_S, SHORTEST_S, FADE_S = 12.0, 3.0, 0.1
FASTER = 0.1  # share by which a piece is played faster or slower at most
RATE = 100.0  # what they are played at; recorded at 100, 102.4 and 333 / 3 Hz
SUAREZ_REST = (50, 3600)
SETTLING = 4.0  # times what white noise lets means over a second scatter: it is no rest yet
KNOCK = 6.0  # robust deviations of a sample off those beside it; a normal one in 5e8 has it
LINE_N, LINE_P = 256, 1e-6  # samples of a stretch of a spectrum; chance of a peak in all of it
WIDEST = 41  # bins of the median that a peak stands out of, odd
STILL_MG, STILL_DPS = 8.0, 0.6  # RMS over a second of an Xsens at rest; it reads some 2.5, 0.3


def pieces(place):
    """{recording: [(n, 6) array: accel in g, gyro in deg/s; a rest's mean taken off]}."""
    suarez = real_captures.part(real_captures.suarez(place), *SUAREZ_REST)
    xsens = real_captures.xsens(place)
    ferraris = real_captures.ferraris(place)
    quiet = [_scaled(real_captures.tree(place, name))[::3] for name in real_captures.TREE_STILL]
    gyro = np.concatenate(_cut(_scaled(suarez)))[:, 3:]
    tree = [np.hstack([accel, gyro[:len(accel)]]) for accel in quiet]
    found = {"suarez": [_scaled(suarez)],
             "xsens": [_scaled(xsens)[a:b] for a, b in still(xsens)],
             "imucal": [_scaled(ferraris)[a:b] for a, b in labelled(ferraris)],
             "tree": tree}  # its board has no gyro: that of the other MPU6050
    return {name: [piece for rest in rests for piece in _cut(rest)
                   if not (settling(piece) or knocked(piece))] for name, rests in found.items()}


def knocked(piece):
    """True when a single sample lies further off those beside it than noise has it."""
    beside = np.median([piece[:-4], piece[1:-3], piece[3:-1], piece[4:]], axis=0)
    off = np.abs(piece[2:-2] - beside)
    return bool((off > KNOCK * 1.4826 * np.maximum(np.median(off, axis=0), 1e-9)).any())


def lines(cut):
    """{(sensor, axis letter): [Hz]} of the peaks in the mean spectrum of pieces (n, 6) that stand
    out of its running median: the mean of R periodograms is Gamma distributed."""
    found = {}
    for channel in range(6):
        power = [signal.spectrogram(piece[:, channel], RATE, "hann", LINE_N, 0,
                                    detrend="linear")[2] for piece in cut if len(piece) >= LINE_N]
        power = np.concatenate(power, axis=1)
        mean, number = (power / np.median(power, axis=0)).mean(axis=1), power.shape[1]
        floor = signal.medfilt(np.pad(mean, WIDEST // 2, "reflect"), WIDEST)[
            WIDEST // 2:-(WIDEST // 2)]
        chance = special.gammaincc(number, number * mean / floor)
        peaks = np.flatnonzero(chance < LINE_P / len(mean))
        if len(peaks):
            found["accel" if channel < 3 else "gyro", "xyz"[channel % 3]] = [
                RATE / LINE_N * float(k) for k in peaks]
    return found


def settling(piece):
    """True when the means over a second move as no sensor at rest does."""
    m = int(RATE)
    means = piece[:len(piece) // m * m].reshape(-1, m, 6).mean(axis=1)
    return bool((means.std(axis=0, ddof=1) > SETTLING * piece.std(axis=0) / np.sqrt(m)).any())


def _scaled(capture):
    """(n, 6) or, without a gyro, (n, 3)."""
    accel = capture.accel / capture.meta["accel_lsb_per_g"]
    if capture.gyro is None:
        return accel
    return np.hstack([accel, capture.gyro / capture.meta["gyro_lsb_per_dps"]])


def _cut(rest):
    """Pieces of a rest, about PIECE_S long, each without its mean."""
    number = max(1, round(len(rest) / RATE / PIECE_S))
    return [piece - piece.mean(axis=0) for piece in np.array_split(rest, number)
            if len(piece) >= SHORTEST_S * RATE]


def still(capture):
    """[(first, end)] of the stretches in which every second is quiet, half a second inside."""
    x, m = _scaled(capture), int(RATE)
    seconds = x[:len(x) // m * m].reshape(-1, m, 6).std(axis=1)
    quiet = (seconds[:, :3].max(axis=1) < STILL_MG / 1000.0) & (
        seconds[:, 3:].max(axis=1) < STILL_DPS)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], quiet.astype(int), [0]])))
    half = m // 2
    return [(a * m + half, b * m - half) for a, b in zip(edges[::2], edges[1::2])
            if (b - a - 1) * m >= SHORTEST_S * RATE]


def labelled(capture):
    """[(first, end)] of the rests with a label, half a second inside."""
    change = np.flatnonzero(np.diff(capture.pose)) + 1
    ends = np.append(change, len(capture))
    half = int(RATE / 2)
    return [(a + half, b - half) for a, b in zip(np.append(0, change), ends)
            if capture.pose[a] > 0 and b - a - 2 * half >= SHORTEST_S * RATE]


def source(cut):
    """A noise source for generator.Case: pieces in random order and pace, forward or backward,
    each channel with a random sign, one faded into the next."""
    def noise(rng, chip, n, rate):
        fade = max(2, int(FADE_S * rate))
        ramp = np.sqrt(np.linspace(0.0, 1.0, fade))[:, None]  # the power stays
        out, at = np.zeros((n + fade, 6)), 0
        signs = rng.choice([-1.0, 1.0], 6)
        while at < n:
            piece = cut[rng.integers(len(cut))][::rng.choice([-1, 1])] * signs
            piece = piece[rng.integers(len(piece) // 3):]
            pace = 1.0 + rng.uniform(-FASTER, FASTER)
            # white noise keeps its density, not its variance
            piece = signal.resample(piece, int(len(piece) * pace)) / np.sqrt(pace)
            piece[:fade] *= ramp
            piece[-fade:] *= ramp[::-1]
            take = min(len(piece), len(out) - at)
            out[at:at + take] += piece[:take]
            at += len(piece) - fade
        return out[:n, :3], out[:n, 3:]
    return noise
