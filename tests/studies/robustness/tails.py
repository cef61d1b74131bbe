"""How heavy the tails of real recorded noise are: the likeliest Student's t of each channel; how
much louder one rest is than the others; what two axes have in common; how far their noise is from
normal.

    python -m tests.studies.robustness.tails

Rests of the recordings (SIXFLIP_DATA), pieces with a knock left out: each sample less the median
of the two before and the two after. What the diagnosis takes for tails of noise, not for spikes,
is t of detect/spikes.TAILS. The second table is what noise_bursts.LOUDER_REST and
noise_shape.SHARED stand beside: of each recording the rests, times the variance of the median rest
that the loudest two have, and the largest correlation of two axes. The third is what
noise_shape.HEAVY and SKEW stand beside: mean squares over those that the middle half of the
samples says, and skewness, the largest of all axes.
"""
import numpy as np
from scipy import stats

from sixflip_host.capture import recordings, registers
from sixflip_host.diagnosis.detect import noise_bursts, noise_shape
from sixflip_host.experiment import blocks

from . import real_captures, real_noise

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


def of_rests(capture):
    """(rests of either sensor, the two largest of their variances over that of the median rest,
    the largest correlation of two axes) of a Capture."""
    session, every = blocks.session_of("recording", capture), []
    for sensor in registers.SENSORS:
        power, place, _ = noise_bursts.windows(session, sensor)
        steps = registers.steps(getattr(capture, sensor))
        every += noise_bursts.of_rests(power, place, steps)[1].tolist()
    _, common, _ = noise_shape.correlations([session])
    size = np.abs(common - np.eye(len(common))).max()
    return len(every), sorted(every)[-2:][::-1], float(size)


def shape(capture):
    """(pieces, times the variance of the middle half, skewness) of the axis of a Capture that has
    most of either."""
    session = blocks.session_of("recording", capture)
    sensors = [noise_shape.shapes(session, sensor) for sensor in registers.SENSORS
               if getattr(capture, sensor) is not None]
    return (len(sensors[0][0]), max(np.median(times, axis=0).max() for times, _, _ in sensors),
            max(np.abs(np.median(skew, axis=0)).max() for _, skew, _ in sensors))


def main():
    print("%-8s" % "noise of" + "".join("%9s" % name for name in CHANNELS))
    for name, cut in real_noise.pieces(recordings.folder()).items():
        z = np.concatenate([off(piece) for piece in cut])
        print("%-8s" % name + "".join("%9g" % likeliest(column) for column in z.T))
    place = recordings.folder()
    print("\n%-10s%8s%10s%10s%14s" % ("rests of", "rests", "loudest", "next", "correlation"))
    captures = {"xsens": real_captures.xsens(place), "suarez": real_captures.suarez(place),
                "suarez 90": real_captures.suarez(place, "imu_90_x_rot"),
                "ferraris": real_captures.ferraris(place)}
    for name, capture in captures.items():
        rests, loudest, size = of_rests(capture)
        print("%-10s%8d%10.2f%10.2f%14.2f" % (name, rests, *loudest, size))
    captures.update(("tree %d" % number, real_captures.tree(place, still))
                    for number, still in enumerate(real_captures.TREE_STILL))
    print("\n%-10s%8s%14s%12s" % ("noise of", "pieces", "of the middle", "skewness"))
    for name, capture in captures.items():
        print("%-10s%8d%14.2f%12.2f" % (name, *shape(capture)))


if __name__ == "__main__":
    main()
