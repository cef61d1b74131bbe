"""Nameless hypotheses, one a domain, that compete with the library's effects on equal terms.

Shared ones have the same coefficients in every session: what is smooth in temperature, what
gravity adds in proportion to it, what is even and odd in orientation, follows the pose before or
the time since the move, forgets how far the gyro was turned, changes sign with the flip, repeats
with the time since switching on, what is there while the sensor is shaken.
Private ones have coefficients of each session's own: a jump at some time, something periodic, a
course in time, or of a scale in time. The widths of their priors are tried over a decade: of a
stranger no size is known.
"""
from dataclasses import replace

import numpy as np
from numpy.polynomial import legendre

from sixflip.poses import faces

from ..experiment import flicker
from ..experiment.projection import by_axis
from ..experiment.terms import LAGS_S, RECTIFIED, Design, harmonics
from ..experiment.way_memory import TURNED_S

SCALE = {"accel": 5.0, "gyro": 0.05}  # mg, deg/s: as large as the library's effects are
HATS = 6  # corners of what is smooth in time and repeats in every session
OWN_HATS = 8  # and of what is a session's own
FADES_S = (5.0, 20.0, 80.0)  # of what follows a move
# {seconds that most of a jump takes: times tried}: what soaks in or gives way does not jump at
# once, and of what takes longer fewer times are different.
JUMPS = {0.0: 24, 20.0: 12, 60.0: 6}
DEGREES = 6  # of a bend: a box in few poses shows no finer one
PRODUCT_DEGREES = (2, 3, 5)  # of a product's; of five degrees the fourth tells least from these
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
# Of the others: their own.
DOMAIN = {"jump": "time", "periodic": "frequency", "own_time": "time",
          "time_orientation": "time", "thermal_orientation": "temperature",
          "thermal_bend": "temperature",
          "bend": "orientation", "product_bend": "orientation", "shaking": "amplitude"}


def domain(effect):
    """GAP's domain of a nameless effect."""
    return DOMAIN.get(effect, effect)


def designs(session, up, sensor, reference_c, left):
    """list of Design that are no effect's of the library but a walk, in the same order for every
    session; left (n, 3): what the nominal model leaves of its readings."""
    return shared(session, up, sensor, reference_c) + private(session, up, sensor, left)


def shared(session, up, sensor, reference_c):
    """Nameless functions whose coefficients are those of the sensor; reference_c: temperature
    that all sessions have in common, about which those of temperature are the same functions in
    each."""
    n, m = session.n, session.moment(up)
    f = np.stack(m.f, 1)
    scale = SCALE[sensor]
    designs = [_smooth("time", hats(session.t, HATS), n, scale)]
    if session.thermal:
        # A part may lag behind its thermometer by itself, too: to first order that is a share of
        # the temperature's rate, which else would be named. Without a lag last: see hypotheses.
        for lag in sorted((lag for lag in LAGS_S if lag >= 0.0), reverse=True):
            t = (session.thermometer.lagged(session.t, lag) - reference_c) / 5.0
            designs.append(_smooth("temperature", [t, t ** 2, t ** 3], n, scale,
                                   "lag %g s" % lag if lag else ""))
        t = (session.temperature - reference_c) / 5.0
        designs.append(_smooth("thermal_orientation", [t * f[:, i] for i in range(3)], n, scale))
        columns = by_axis([t[:, None] ** 2 * f]).reshape(-1, 3)
        designs.append(Design("thermal_bend", "", "xyz", (0, 1, 2), columns, np.full(3, scale),
                              beside=True))
    before = np.stack(m.before, 1)
    history = [before[:, i] for i in range(3)] + [before[:, i] * before[:, j] for i in range(3)
                                                  for j in range(i)]
    designs.append(_smooth("history", history, n, scale))
    if sensor == "gyro":
        for tau, turned in zip(TURNED_S, session.turned.transpose(1, 2, 0)):
            designs.append(_smooth("time_since_move", turned, n, scale, "turned, tau %g s" % tau))
    for tau in FADES_S:
        fade = np.exp(-session.since / tau)
        # of how it lay before, and of how it lies now, as on what gives way
        since = [fade] + [of[:, i] * fade for of in (before - f, f) for i in range(3)]
        designs.append(_smooth("time_since_move", since, n, scale, "tau %g s" % tau))
    designs.append(_smooth("orientation", harmonics(f, sensor), n, scale))
    if sensor == "accel":
        designs += [bend(f, scale), product_bend(f, scale)]
    if session.shaken_mg:
        designs.append(_shaking(session.vibration / session.shaken_mg, scale))
    return [*designs, _flip(session, scale)]


def private(session, up, sensor, left):
    """Nameless functions of time; choices: which of their columns go together, one choice a
    session; left (n, 3): what the nominal model leaves."""
    n, scale = session.n, SCALE[sensor]
    own = _smooth("own_time", hats(session.t, OWN_HATS), n, scale,
                  choices=[tuple(range(3 * OWN_HATS))])
    course = _smooth("own_time", courses(session.t), n, scale, COURSE, [tuple(range(3 * WALK))])
    steps = [*jumps(session), *highest(session.t, left)]
    jump = _smooth("jump", steps, n, scale,
                   choices=[tuple(range(3 * k, 3 * k + 3)) for k in range(len(steps))])
    periods = [*periods_of(session.t), *strongest(session.t, left)]
    waves = [wave(2.0 * np.pi * session.t / period) for period in periods
             for wave in (np.cos, np.sin)]
    periodic = _smooth("periodic", waves, n, scale,
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
    return _smooth("drift", flicker.walk(session.t, WALK), session.n, scale, "walk",
                   [tuple(range(3 * WALK))])


def _shaking(rms, scale):
    """Design of what is there while a vibration of rms (n,) is, the strongest 1."""
    return _smooth("shaking", [power(rms) for power in RECTIFIED.values()], len(rms), scale)


def _flip(session, scale):
    """Along the axis of each face, what changes sign with the flip; zero where no flip was.
    Across it that is the table's tilt and the box's."""
    sign = np.where(session.code % 2 == 1, 1.0, -1.0)  # codes 1, 3, ... are a, the others b
    keys, axes, columns = [], [], []
    for face in range(len(faces.AXIS)):
        on = session.face == face
        column = np.zeros((session.n, 3))
        if len(np.unique(sign[on])) == 2:
            column[on, faces.AXIS[face]] = sign[on]
        keys.append("%s%d" % ("xyz"[faces.AXIS[face]], face))
        axes.append(faces.AXIS[face])
        columns.append(column.reshape(-1))
    return Design("flip", "", keys, axes, np.stack(columns, 1), np.full(len(keys), scale))


def _smooth(name, functions, n, scale, variant="", choices=()):
    """Design of these functions (n,) on each axis; choices: of columns, one a session."""
    keys, axes, columns = [], [], []
    for number, values in enumerate(functions):
        for axis in range(3):
            column = np.zeros((n, 3))
            column[:, axis] = values
            keys.append("%s%d" % ("xyz"[axis], number))
            axes.append(axis)
            columns.append(column.reshape(-1))
    return Design(name, variant, keys, axes, np.stack(columns, 1),
                  np.full(len(keys), scale), choices)


def bend(f, scale):
    """Design of what any bend of an axis is made of: functions of what that axis feels, f (n, 3)
    g, beyond the straight line. By itself it is no hypothesis: another form of one."""
    felt = [legendre.Legendre.basis(degree)(f) for degree in range(2, DEGREES + 1)]
    felt.append(np.abs(f))
    columns = np.einsum("dni,ij->nidj", np.stack(felt), np.eye(3)).reshape(f.size, -1)
    keys = ["%s%d" % (axis, number) for number in range(len(felt)) for axis in "xyz"]
    return Design("bend", "", keys, [0, 1, 2] * len(felt), columns, np.full(len(keys), scale),
                  beside=True)


def product_bend(f, scale):
    """Design of what a product of two axes becomes where it is none but a function of one: of
    each product of f (n, 3) g, 1 at most, on each axis. By itself it is no hypothesis."""
    products = [2.0 * f[:, i] * f[:, j] for i in range(3) for j in range(i)]
    return replace(_smooth("product_bend", [legendre.Legendre.basis(degree)(u) for u in products
                                            for degree in PRODUCT_DEGREES], len(f), scale),
                   beside=True)


def hats(x, number):
    """Piecewise straight functions between equally spaced corners."""
    u = (x - x.min()) / max(float(np.ptp(x)), 1e-9) * (number - 1)
    return [np.clip(1.0 - np.abs(u - k), 0.0, None) for k in range(number)]
