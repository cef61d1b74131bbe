"""What passes for noise that wanders and is none: leaps between levels, what leans, and what goes
straight on.

A random walk is as large from rest to rest as a telegraph, and the blocks of the rests are too few
to tell them apart. Short means within the rests are many.
"""
import numpy as np
from scipy import special

from ..experiment import long_rest
from ..experiment.noise_arrays import flicker_kernel
from . import adequacy

# s of the short means whose steps are looked at; steps that their tails are known from; steps that
# may be knocks.
STEP_S, FEWEST_STEPS, KNOCKS = (0.5, 1.0, 2.0, 4.0, 8.0), 60, 3
MEDIAN = 0.6745  # standard deviations within which half of a normal distribution lies
OF_SPREAD = 6.0  # times the variance about its mean, that a random walk has at its end
# Of gravity along an axis: a box on a face, 18 degrees off at most; differences within the rests
# that it is upright in, of an axis.
ON_FACE, FEWEST_OF_AXIS = 0.95, 6
# A reading that goes on in a straight line: means of a rest that show one; flicker beside it, and
# noise that wanders, times what is usual; mg and deg/s that a reading may be, and change by: any.
FEWEST_MEANS, BESIDE, WANDERING = 8, (1.0, 4.0, 16.0), 2.0 ** np.arange(16)
ANY = {"accel": 1e3, "gyro": 1e2}


def no_drift(kind, parts, found):
    """(how, probability) of what tells best that a wandering.Drift of the sensor, which was found
    in parts, [(Session, NominalSensor)], is none."""
    ways = {"leaps": in_leaps(kind, [session for session, _ in parts], found),
            "across gravity alone": across_gravity(kind, parts)}
    return min(ways.items(), key=lambda way: way[1])


def in_leaps(kind, sessions, found):
    """The least probability of what tells leaps from a Drift, which was found, in sessions: of
    the axes that have it, the tails of its steps within the rests, and how still it is there."""
    rests = [([values[run.first:run.end] for run in session.runs], session)
             for session in sessions for values in [long_rest.scaled(session, kind)]]
    axes = ["xyz".index(letter) for letter in found.axes] or range(3)
    p = min((min(jumps([x[:, axis] for x in of_session], session.rate),
                 _still([x[:, axis] for x in of_session], session, found.low))
             for of_session, session in rests for axis in axes), default=1.0)
    return min(2.0 * len(axes) * len(sessions) * p, 1.0)


def _still(rests, session, level):
    """Probability of such small steps within rests, list of (n,) samples of a Session, if what
    wanders by a flicker level went as evenly as it can, as a random walk that the rests see spread
    by as much: half of its steps are within the MEDIAN, and noise makes them no smaller. Most of
    what leaps between levels are. Steps of means are taken that have none in common."""
    kernel = flicker_kernel(session.t, session.seconds)
    spread = level ** 2 * (np.diagonal(kernel).mean() - kernel.mean())
    best, rate = 1.0, OF_SPREAD * spread / max(float(np.ptp(session.t)), 1.0)
    for seconds in STEP_S:
        m = max(1, int(seconds * session.rate))
        step = np.concatenate([
            np.diff(x[:len(x) // (2 * m) * 2 * m].reshape(-1, 2, m).mean(axis=2), axis=1).ravel()
            for x in rests])
        # Two neighbouring means over g seconds of a walk of rate q differ by 2/3 q g.
        small = np.count_nonzero(np.abs(step) < MEDIAN * np.sqrt(rate * seconds * 2.0 / 3.0))
        if small:
            best = min(best, len(STEP_S) * float(special.bdtrc(small - 1, len(step), 0.5)))
    return best


def jumps(rests, rate):
    """Probability of such heavy tails in the noise of rests, list of (n,) samples, that wanders:
    a walk's steps from a short mean to the next are normal, those of what jumps between levels
    are mostly none. The KNOCKS largest are left out: a knock is no way of wandering."""
    best = 1.0
    for seconds in STEP_S:
        m = max(1, int(seconds * rate))
        step = np.concatenate([np.diff(x[:len(x) // m * m].reshape(-1, m).mean(axis=1))
                               for x in rests])
        if len(step) < FEWEST_STEPS:
            break
        step = step[np.argsort(np.abs(step))[:-KNOCKS]]
        best = min(best, len(STEP_S) * adequacy.tails(step))
    return best


def across_gravity(kind, parts):
    """Probability of the accelerometer, as parts, [(Session, NominalSensor)], have it, wandering
    within its rests across gravity by so much more than along it: what leans under the box, or
    a hand that holds it, is felt there alone. Each axis is held against itself."""
    if kind != "accel":
        return 1.0
    changed, share = [], []
    for session, nominal in parts:
        same = np.flatnonzero(np.diff(session.placement) == 0)
        over = np.sqrt(1.0 / session.seconds[same] + 1.0 / session.seconds[same + 1])[:, None]
        changed.append(np.diff(session.accel, axis=0)[same] / over)
        share.append(np.abs(nominal.up[session.placement[same]]))
    along, across = [np.zeros(0)], [np.zeros(0)]
    for x, up in zip(np.concatenate(changed).T, np.concatenate(share).T):
        upright, level = x[up > ON_FACE], x[up < np.sqrt(1.0 - ON_FACE ** 2)]
        if len(upright) >= FEWEST_OF_AXIS and upright.any():
            size = np.sqrt((upright ** 2).mean())
            along.append(upright / size)
            across.append(level / size)
    along, across = map(np.concatenate, (along, across))
    enough = min(len(along), len(across)) >= adequacy.FEWEST
    return adequacy.louder(across, along) if enough else 1.0


def goes_straight(rest, kind, usual):
    """{axis letter: probability that it wanders} of a long_rest.LongRest: that its reading does
    not go on in a straight line in the longest of its rests, by any slope, beside flicker. Of
    noise that wanders, flicker or a walk of any size, each step is another one."""
    of = rest.rest == np.bincount(rest.rest, rest.seconds).argmax()
    if of.sum() < FEWEST_MEANS:
        return {}
    t, span = rest.t[of] - rest.t[of].min(), float(np.ptp(rest.t[of]))
    line = (t - t.mean()) / span
    flicker = flicker_kernel(t, rest.seconds[of])
    walk = np.minimum(t[:, None], t) / span

    def nats(y, covariance):
        lower = np.linalg.cholesky(covariance)
        return -0.5 * (np.linalg.solve(lower, y) ** 2).sum() - np.log(np.diag(lower)).sum()
    found = {}
    for letter, values, noise in zip("xyz", rest.values[kind][of].T, rest.noise[kind][of].T):
        y = values - values.mean()
        known = np.diag(np.maximum(noise, 1e-6 * ANY[kind]) ** 2) + ANY[kind] ** 2
        wanders = max(nats(y, known + (size * usual) ** 2 * kernel) for size in WANDERING
                      for kernel in (flicker, walk))
        straight = max(nats(y, known + ANY[kind] ** 2 * np.outer(line, line)
                            + (size * usual) ** 2 * flicker) for size in BESIDE)
        found[letter] = float(np.exp(min(wanders - straight, 0.0)))
    return found
