"""Nameless hypotheses with coefficients of each session's own: a jump at some time, something
periodic, a course in time, or of a scale in time.
"""
import numpy as np

from ..experiment import noise_arrays
from ..experiment.terms import Design
from .strangers import SCALE, hats, smooth

OWN_HATS = 8  # corners of what is smooth in time
# {seconds that most of a jump takes: times tried}: what soaks in or gives way does not jump at
# once, and of what takes longer fewer times are different.
JUMPS = {0.0: 24, 20.0: 12, 60.0: 6}
# From 16 s, faster than which rests with moves between them do not follow, to the whole session:
# in a quarter of an hour each is 1.3 times the one before, and a wave between two of them keeps
# step with one for two of its periods; the strongest of all between them are tried as well. Faster
# ones are looked for in the spectrum of the rests.
PERIODS, STRONGEST = 16, 2
FASTEST_S, OVER = 16.0, 4  # frequencies for each that a session can tell
ANOTHER = 4  # blocks on either side of the largest step, within which none is another one
WALK = 16  # terms of a random walk, and of any other course
SCALE_TERMS = 6  # of the course of a scale: with more, each pose would have one of its own
COURSE = "course"  # variant of what is a session's own in time
# How the terms of a course fall off with their number: as what a rate adds up to that is a random
# walk; as a walk itself, which moves with the poses only; not at all, another one in every pose.
ROUGHNESS = {"smooth": 2, "in steps": 1, "scattered": 0}
COURSES = {"own_time": tuple(ROUGHNESS), "time_orientation": ("in steps",)}  # that are tried
# Everything that differs from pose to pose is a course of the others, a memory of another form
# than the library's as well. So they are only asked whether a drift is one: whether it moves with
# the poses alone, or with gravity.
ASKED_OF_ALL = "smooth"


def private(session, up, sensor, left):
    """Nameless functions of time; choices: which of their columns go together, one choice a
    session; left (n, 3): what the nominal model leaves."""
    n, scale = session.n, SCALE[sensor]
    own = smooth("own_time", hats(session.t, OWN_HATS), n, scale,
                  choices=[tuple(range(3 * OWN_HATS))])
    course = smooth("own_time", courses(session.t), n, scale, COURSE, [tuple(range(3 * WALK))])
    steps = [*jumps(session), *highest(session.t, left)]
    jump = smooth("jump", steps, n, scale,
                   choices=[tuple(range(3 * k, 3 * k + 3)) for k in range(len(steps))])
    periods = [*periods_of(session.t), *strongest(session.t, left)]
    waves = [wave(2.0 * np.pi * session.t / period) for period in periods
             for wave in (np.cos, np.sin)]
    periodic = smooth("periodic", waves, n, scale,
                       choices=[tuple(range(6 * k, 6 * k + 6)) for k in range(len(periods))])
    return [own, course, _own_scale(session, up, scale), jump, periodic, walk(session, scale)]


def jumps(session):
    """[(n,)] steps from -0.5 to 0.5 between two placements, at once or over some seconds."""
    starts = np.unique(session.placement, return_index=True)[1][1:]
    if not len(starts):
        return [np.zeros(session.n)] * sum(JUMPS.values())
    steps = []
    for seconds, times in JUMPS.items():
        for k in starts[np.linspace(0, len(starts) - 1, times).round().astype(int)]:
            steps.append(np.where(np.arange(session.n) < k, -0.5, 0.5) if not seconds else
                         0.5 * np.tanh(2.0 * (session.t - session.t[k]) / seconds))
    return steps


def _own_scale(session, up, scale):
    """Design of what each axis reads of gravity that changes in the course of a session: its
    scale."""
    f = np.stack(session.moment(up).f, 1)
    parts = [course[:, None, None] * f[:, :, None] * np.eye(3)
             for course in courses(session.t)[:SCALE_TERMS]]
    keys = ["%s%d" % (axis, number) for number in range(SCALE_TERMS) for axis in "xyz"]
    columns = np.concatenate(parts, axis=2).reshape(3 * session.n, -1)
    return Design("time_orientation", COURSE, keys, [0, 1, 2] * SCALE_TERMS, columns,
                  np.full(len(keys), scale), [tuple(range(3 * SCALE_TERMS))])


def periods_of(t):
    """(PERIODS,) s that are tried in any session."""
    span = max(float(np.ptp(t)), 1.0)
    return np.geomspace(min(FASTEST_S, span), span, PERIODS)


def strongest(t, left):
    """(STRONGEST,) s: periods of the highest peaks of the spectrum of readings left (n, 3) at
    times t (n,) s, all axes together [Lomb, Astrophysics and Space Science 39 (1976) 447]."""
    span = max(float(np.ptp(t)), 1.0)
    hz = np.arange(OVER, _told_apart(t) * OVER + 1) / (OVER * span)
    left = left - left.mean(axis=0)
    if len(hz) <= 2 * OVER or not left.any():
        return np.full(STRONGEST, span)
    power = _periodogram(t, left, hz)
    periods = []
    for _ in range(STRONGEST):
        k = int(power.argmax())
        periods.append(1.0 / hz[k])
        power[max(k - OVER, 0):k + OVER + 1] = 0.0
    return np.array(periods)


def _periodogram(t, x, hz):
    """(f,) power of x (n, 3), all axes together, at frequencies hz (f,): as
    scipy.signal.lombscargle's, which takes a second to import [Lomb, equation 7]."""
    angle = 2.0 * np.pi * hz[:, None] * t
    delay = 0.5 * np.arctan2(np.sin(2.0 * angle).sum(axis=1), np.cos(2.0 * angle).sum(axis=1))
    power = 0.0
    for wave in (np.cos(angle - delay[:, None]), np.sin(angle - delay[:, None])):
        energy = np.maximum((wave ** 2).sum(axis=1), 1e-9)  # of a sine that is 0 all the while
        power = power + 0.5 * ((wave @ x) ** 2).sum(axis=1) / energy
    return power


def _told_apart(t):
    """Number of frequencies up to the fastest that a session can tell."""
    return int(max(float(np.ptp(t)), 1.0) / FASTEST_S)


def highest(t, left):
    """[(n,)] STRONGEST steps between two blocks, which may be of one rest: those that take most of
    the readings left (n, 3) of any axis by themselves, some blocks off each other."""
    n = len(t)
    left = left - left.mean(axis=0)
    taken = np.cumsum(left, axis=0)[:-1] ** 2 / np.maximum((left ** 2).sum(axis=0), 1e-12)
    before = np.arange(1, n)
    share = taken.max(axis=1) / (before * (n - before))
    found = [np.zeros(n)] * STRONGEST
    for number in range(STRONGEST):
        if share.any():
            k = int(share.argmax())
            found[number] = np.where(np.arange(n) <= k, -0.5, 0.5)
            share[max(k - ANOTHER, 0):k + ANOTHER + 1] = 0.0
    return found


def looked_at(t, each):
    """{(effect, variant, number of its choice): nats} that a choice costs which was looked for
    beforehand: the strongest period is one of all that a session can tell, the highest step one
    of those between any two blocks; each: number of choices that each period or step has."""
    tried = {"periodic": (PERIODS, _told_apart(t)), "jump": (sum(JUMPS.values()), len(t) - 1)}
    return {(effect, "", number): -float(np.log(max(every / STRONGEST, 1.0)))
            for effect, (before, every) in tried.items()
            for number in range(before * each, (before + STRONGEST) * each)}


def courses(t):
    """[(n,)] cosines over a session, the first of half a period: what any course in time is made
    of (ROUGHNESS)."""
    u = (t - t.min()) / max(float(np.ptp(t)), 1.0)
    return [np.sqrt(2.0) * np.cos(np.pi * k * u) for k in range(1, WALK + 1)]


def roughness(variant):
    """(WALK,) sizes of the terms of a course."""
    size = np.arange(1.0, WALK + 1.0) ** -ROUGHNESS[variant]
    return size / np.sqrt((size ** 2).sum())


def walk(session, scale):
    """Design of the library's drift as a random walk of each axis, which ends `scale` off on
    average. A session of its own choice."""
    return smooth("drift", noise_arrays.walk(session.t, WALK), session.n, scale, "walk",
                   [tuple(range(3 * WALK))])
