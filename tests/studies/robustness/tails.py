"""How heavy the tails of real recorded noise are: the likeliest Student's t of each channel.

    python -m tests.studies.robustness.tails

Rests of the recordings (SIXFLIP_DATA), pieces with a knock left out: each sample less the median
of the two before and the two after. What the diagnosis takes for tails of noise, not for spikes,
is t of detect/spikes.TAILS.
"""
import numpy as np
from scipy import stats

from sixflip_host.capture import recordings

from . import real_noise

FREEDOM = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0, 200.0)
SCALES = np.arange(0.6, 1.41, 0.05)
CHANNELS = ("accel x", "accel y", "accel z", "gyro x", "gyro y", "gyro z")


def off(piece):
    """(n, 6) of each sample off those beside it, in deviations of its channel."""
    beside = np.median([piece[:-4], piece[1:-3], piece[3:-1], piece[4:]], axis=0)
    x = piece[2:-2] - beside
    return x / (1.4826 * np.maximum(np.median(np.abs(x), axis=0), 1e-12))


def likeliest(z):
    """Degrees of freedom of the likeliest Student's t of z (n,)."""
    nats = {f: max(float(stats.t.logpdf(z / s, f).sum()) - len(z) * np.log(s) for s in SCALES)
            for f in FREEDOM}
    return max(nats, key=nats.get)


def main():
    print("%-8s" % "noise of" + "".join("%9s" % name for name in CHANNELS))
    for name, cut in real_noise.pieces(recordings.folder()).items():
        z = np.concatenate([off(piece) for piece in cut])
        print("%-8s" % name + "".join("%9g" % likeliest(column) for column in z.T))


if __name__ == "__main__":
    main()
