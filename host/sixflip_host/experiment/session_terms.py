"""Every variant of the library's effects that the rests of sessions can show, as Designs over the
blocks of each.

An effect with a shape (a time constant, a lag) or a bend (a square beside the slope) has several
variants; they compete, and all go by the effect's one name.
"""
import copy
from dataclasses import replace

import numpy as np

from . import block_measures
from .projection import by_axis
from .terms import Design, of_terms
from .thermometer import MOVES_C, moved_c
from .way_memory import FRICTION, UNMOVED_G, levelling

LAGS_S = (0.0, 15.0, 30.0, 60.0, -30.0)  # GAP: a neighbouring thermometer, 10-60 s
# GAP: 60-300 s, and an octave to both sides; of a strong one the time constant shows to a tenth.
WARM_UP_S = (30.0, 42.0, 60.0, 85.0, 120.0, 170.0, 240.0, 340.0, 480.0)
STARTED_S = (60.0, 240.0)  # a short one and a long one: how warm each session started
# Sessions that have columns of their own: of more each is a small part of all, and the columns of
# all together would grow with the square of their number.
MOST_OWN = 8
FROM_BEFORE = "from before"  # variant of a hysteresis whose first pose has anything of it
CREEP_S = (5.0, 15.0, 30.0, 60.0, 120.0)  # GAP: 60-70 s seen on Z; down to a rest's length
LEVELS_OFF = 3.0  # times faster than where a rate's effect begins to level off
FORGOTTEN_S = (5.0, 20.0)  # from part of a short rest to most of a long one
LONG_MEMORY_S = 30.0  # longer than two rests with the move between them
SHIFT_MG = 5.0  # typical of what a vibration shifts, as of the library's other effects
# What a vibration all round shifts by its rms, the strongest 1: as its power, as |f| rectifies it,
# and all of it at once, as what rattles.
RECTIFIED = {"power": np.square, "strength": np.asarray,
             "at once": lambda rms: np.tanh(5.0 * rms ** 2)}
LEAST_VIBRATION_MG = 5.0  # above the quietest rest: more than the noise of a chip (typical.NOISE)


def squared(design, columns, prior):
    """design with a further column for each of its own, a square beside a slope."""
    return replace(design, keys=design.keys * 2, axes=design.axes * 2,
                   columns=np.hstack([design.columns, columns]),
                   prior=np.concatenate([design.prior, np.full(len(design.keys), prior)]),
                   powers=(1,) * len(design.keys) + (2,) * len(design.keys), record=True)


def agreed(sessions):
    """The sessions with what is looked for settled for all of them at once, so that the columns
    of one are those of the others: thermal (every one has a thermometer, and they moved, all
    together), fastest (of any temperature's changes), vibration above the quietest rests of all,
    shaken_mg (the strongest of any rest, 0 where none is shaken)."""
    thermal = moved_c(sessions) >= MOVES_C
    fastest = max(float(np.abs(s.thermometer.rate).max()) for s in sessions) if thermal else 0.0
    vibrations = block_measures.vibrations([session.loudness for session in sessions])
    strongest = max(float(vibration.max()) for vibration in vibrations)
    shaken_mg = strongest if strongest > LEAST_VIBRATION_MG else 0.0
    return [replace(session, thermal=thermal, fastest=fastest, vibration=vibration,
                    shaken_mg=shaken_mg, number=number, of=len(sessions))
            for number, (session, vibration) in enumerate(zip(sessions, vibrations))]


def library(session, up, sensor, reference_c, chip):
    """list of Design: every variant of every effect that the rests of the sessions agreed on
    can show; columns of zeros where this one shows nothing of it. up (placements, 3): unit vectors
    against gravity; reference_c: temperature about which slopes are taken."""
    m, n = session.moment(up), session.n

    def design(name, variant="", moment=m, **options):
        return of_terms(name, sensor, moment, n, variant, chip=chip, **options)

    designs = _thermal(session, m, design, sensor, reference_c) if session.thermal else []
    warm_up = {tau: design("warm_up", "tau %g s" % tau, shape={"tau_s": tau}) for tau in WARM_UP_S}
    designs += warm_up.values()
    if 1 < session.of <= MOST_OWN:
        designs += [_of_each_start(session, warm_up[tau]) for tau in STARTED_S]
    plain = design("hysteresis")
    if sensor == "gyro":
        return [*designs, plain, design("g_sensitivity")]
    cross = design("cross_quadratic")
    squares = [k for k in cross.keys if k[1] == k[2]]
    products = [k for k in cross.keys if k[1] != k[2]]
    designs += [plain, *remembered(session, m, plain), design("quadratic"), design("cubic"),
                cross, design("cross_quadratic", "squares", only=squares),
                design("cross_quadratic", "products", only=products),
                design("asymmetry"), *_creep(session, up, m, design)]
    if session.shaken_mg:
        designs += _rectified(session, m, design)
    return designs


def _rectified(session, m, design):
    """Designs of vibration rectification. What shakes a chip hardest may be far beyond its filter,
    so that a coefficient is known by what the strongest vibration shifts, not by the bend."""
    prior = 10.0 * SHIFT_MG / (session.shaken_mg * 0.001) ** 2
    designs = [design("vibration_rectification", "vertical", shape={"vertical": 1})]
    for words, power in RECTIFIED.items():
        m = copy.copy(m)
        m.vibration_mg = session.shaken_mg * np.sqrt(power(session.vibration / session.shaken_mg))
        designs.append(design("vibration_rectification", words, m, shape={"vertical": 0}))
    return [replace(variant, prior=np.maximum(variant.prior, prior)) for variant in designs]


def along_axes(session, nominal, chip):
    """Designs of the accelerometer's bends as functions of what an axis itself feels: it stands a
    degree askew in the box, so that a large bend mixes the box's axes."""
    reads = np.linalg.inv(nominal.matrix)
    reads /= np.linalg.norm(reads, axis=1)[:, None]
    m = copy.copy(session.moment(nominal.up))
    m.f = tuple(reads @ np.stack(m.f))
    return [of_terms(name, "accel", m, session.n, "along the axis", chip=chip)
            for name in ("quadratic", "cubic", "asymmetry")]


def remembered(session, m, plain):
    """Designs of hysteresis in other forms than a share of the pose before: only from which
    side the pose was reached, softly or by its sign, and what rubs along the whole way. Beside
    any of them: what is forgotten of it in the course of the rest."""
    came = np.stack(m.before, 1) - np.stack(m.f, 1)
    sign = np.sign(came) * (np.abs(came) > UNMOVED_G)
    forms = [("side", np.tanh(3.0 * came)), ("sign", sign),
             *zip(FRICTION, session.friction.transpose(1, 0, 2)),
             *levelling(np.stack(m.f, 1), session.friction).items()]
    designs = []
    for variant, values in forms:
        columns = by_axis([values]).reshape(-1, 3)
        designs.append(Design("hysteresis", variant, plain.keys, plain.axes, columns, plain.prior))
    before = np.stack(m.before, 1)
    for tau in FORGOTTEN_S:
        columns = by_axis([before * np.exp(-session.since / tau)[:, None]]).reshape(-1, 3)
        designs.append(Design("hysteresis", "forgotten, tau %g s" % tau, plain.keys, plain.axes,
                              columns, plain.prior, beside=True))
    return [*designs, *([_unseen_at_first(session, plain)] if session.of <= MOST_OWN else [])]


def remembers_otherwise(form):
    """Whether a form of hysteresis (hypotheses.Form) is none of the library's, a share of the pose
    before: its sizes are what it is at most, in mg or deg/s."""
    return form.effect == "hysteresis" and form.variant not in ("", FROM_BEFORE)


def _unseen_at_first(session, plain):
    """Design of hysteresis, what the first pose of each session has of it being anything: nobody
    saw the box come there."""
    first = np.repeat(session.placement[:, None] == 0, 3, axis=1).astype(float)
    columns = by_axis([first * (number == session.number) for number in range(session.of)])
    return replace(plain, variant=FROM_BEFORE, keys=plain.keys * (1 + session.of),
                   axes=plain.axes * (1 + session.of),
                   columns=np.hstack([plain.columns, columns.reshape(-1, 3 * session.of)]),
                   prior=np.tile(plain.prior, 1 + session.of),
                   powers=(1,) * len(plain.keys) + (0,) * len(plain.keys) * session.of)


def _of_each_start(session, warm_up):
    """Design of what a session warms up by more or less than the others: it started warmer or
    colder. By itself it is no hypothesis."""
    columns = [warm_up.columns * (number == session.number) for number in range(session.of)]
    return replace(warm_up, variant=warm_up.variant + ", of each start",
                   keys=warm_up.keys * session.of, axes=warm_up.axes * session.of,
                   columns=np.hstack(columns), prior=np.tile(warm_up.prior, session.of),
                   powers=warm_up.powers * session.of, beside=True)


def _creep(session, up, m, design):
    """Designs of creep since the move from the placement before, and of what all have left."""
    designs = []
    for tau in CREEP_S:
        designs.append(design("creep", "tau %g s" % tau, shape={"tau_s": tau}))
        if tau >= LONG_MEMORY_S:  # what came before the placement before is not forgotten yet
            felt = copy.copy(m)
            felt.before = tuple(session.remembered(up, tau).T)
            designs.append(design("creep", "tau %g s, all placements" % tau, felt,
                                  shape={"tau_s": tau}))
    return designs


def _thermal(session, m, design, sensor, reference_c):
    """Designs of slopes over the temperature with and without a lag."""
    designs = []
    for lag in LAGS_S:
        felt = copy.copy(m)
        felt.temperature = session.thermometer.lagged(session.t, lag)
        felt.temperature_rate = session.thermometer.lagged_rate(session.t, lag)
        label = "lag %g s" % lag if lag else ""
        shape = {"reference_c": reference_c}
        bias = design("thermal_bias", label, felt, only=("x", "y", "z"), shape=shape)
        designs.append(bias)
        if not lag:  # a record of the board holds a square, too
            dt = np.repeat(felt.temperature - reference_c, 3)[:, None]
            designs.append(squared(bias, bias.columns * dt, 0.1 * bias.prior[0]))
        if sensor == "accel":
            designs.append(design("thermal_scale", label, felt, shape=shape))
        designs.append(design("thermal_rate", label, felt))
    # As much however fast the temperature changes: what a package is strained by levels off.
    felt = copy.copy(m)
    fastest = max(session.fastest, 1e-9)
    felt.temperature_rate = fastest * np.tanh(LEVELS_OFF * m.temperature_rate / fastest)
    designs.append(design("thermal_rate", "levels off", felt))
    return designs
