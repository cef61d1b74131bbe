"""The hypotheses of a rest that goes on: what its readings may follow while nothing moves.

The library's effects of temperature and of the time since switching on, and nameless functions
of temperature and time, jumps and waves, as columns over the means of a long rest; the same
function on each axis with a coefficient of its own. Where a thermometer moved by
tens of degrees a straight slope is not all there is: a form with its square and cube beside it
competes, made perpendicular to the slope so that the slope keeps its meaning.
"""
from dataclasses import replace

import numpy as np

from ..experiment import session_terms, terms
from ..experiment.terms import Design
from ..experiment.thermometer import MOVES_C
from . import closed_loop, odds, strangers

DECAYS = (0.25, 0.5, 1.0, 2.0)  # of the rest's length: decays beside those of the library
CORNERS, JUMPS, WALK = 8, 24, 16  # as session_strangers.py has them
STRAIGHT = 4.0  # rests: a decay that lasts so many bends by a thirtieth of what it changes in one
WAVES = 24  # half periods in a rest, at most; what is faster is looked for in the spectrum
BEND = 0.5  # of the slope's own effect: standard deviation of its square and of its cube
LASTS = 4.0  # times a lag: a shorter rest cannot show it
ALONG = 0.5  # share of gravity that an axis feels at least when a scale can change its reading


def designs(rest, sensor, chip, settings):
    """list of Design, columns (n, k): a function of each axis is in one column."""
    designs = []
    if rest.moved_c >= MOVES_C:
        designs += _thermal(rest, sensor, chip)
    for tau in sorted({*session_terms.WARM_UP_S, *(share * rest.span_s for share in DECAYS)}):
        designs.append(_library("warm_up", rest, sensor, chip, rest.moment(), "tau %.3g s" % tau,
                                {"tau_s": float(np.clip(tau, 1.0, 7200.0))}))
    designs += _nameless(rest, sensor)
    return [d for d in designs if d.effect not in settings.without]


def _library(name, rest, sensor, chip, moment, variant, shape, axes=(0, 1, 2)):
    """Design of an effect of the library on these axes."""
    whole = terms.of_terms(name, sensor, moment, rest.n, variant, only=("x", "y", "z"),
                           shape=shape, chip=chip)
    own = [i for i, a in enumerate(whole.axes) if a in axes]
    columns = np.stack([whole.columns[whole.axes[i]::3, i] for i in own], 1)
    return Design(name, variant, [whole.keys[i] for i in own], [whole.axes[i] for i in own],
                  columns, whole.prior[own])


def _thermal(rest, sensor, chip):
    """Slopes over the temperature with and without a lag, straight and bent; its rate; a scale
    that follows it, where an axis feels gravity."""
    designs, shape = [], {"reference_c": float(rest.temperature.mean())}
    along = tuple(i for i in range(3) if abs(rest.up[i]) >= ALONG and sensor == "accel")
    for lag in (lag for lag in session_terms.LAGS_S if rest.span_s >= LASTS * abs(lag)):
        felt, label = rest.moment(lag), "lag %g s" % lag if lag else ""
        slope = _library("thermal_bias", rest, sensor, chip, felt, label, shape)
        designs += [slope, _bent(slope)]
        designs.append(_library("thermal_rate", rest, sensor, chip, felt, label, {}))
        if along:
            designs.append(_library("thermal_scale", rest, sensor, chip, felt, label, shape,
                                    along))
    return designs


def _bent(slope):
    """The slope with its square and cube, as large as itself by unit, beside it."""
    t = slope.columns[:, 0]
    basis, size = [np.ones(len(t)), t - t.mean()], np.std(t)
    for power in (2, 3):
        bend = (t / max(size, 1e-12)) ** power
        done = np.stack(basis, 1)
        bend = bend - done @ np.linalg.lstsq(done, bend, rcond=None)[0]
        basis.append(bend * size / max(float(np.std(bend)), 1e-12))
    return replace(slope, variant=(slope.variant + " cube").strip(), keys=slope.keys * 3,
                   axes=slope.axes * 3, columns=np.hstack([slope.columns, *(
                       np.repeat(bend[:, None], 3, axis=1) for bend in basis[2:])]),
                   prior=np.concatenate([slope.prior, np.tile(BEND * slope.prior, 2)]),
                   powers=tuple(power for power in (1, 2, 3) for _ in slope.keys))


def _nameless(rest, sensor):
    """What is smooth in time or temperature, jumps, waves and a walk."""
    designs = []

    def add(name, functions, choices=(), variant=""):
        """Three columns a function; choices: of which functions one is taken."""
        keys = ["%s%d" % (letter, k) for k in range(len(functions)) for letter in "xyz"]
        columns = np.repeat(np.stack(functions, 1), 3, axis=1)
        designs.append(Design(name, variant, keys, [0, 1, 2] * len(functions), columns,
                              np.full(len(keys), strangers.SCALE[sensor]),
                              [tuple(3 * k + axis for k in choice for axis in range(3))
                               for choice in choices]))
    u = (rest.t - rest.t.min()) / max(float(np.ptp(rest.t)), 1e-9)
    add("time", strangers.hats(rest.t, CORNERS))
    if rest.moved_c >= MOVES_C:
        add("temperature", strangers.hats(rest.temperature, CORNERS))
    places = np.unique(np.linspace(1, rest.n - 1, JUMPS + 2)[1:-1].round().astype(int))
    add("jump", [np.where(np.arange(rest.n) < k, -0.5, 0.5) for k in places],
        [(k,) for k in range(len(places))])
    halves = range(3, min(WAVES, rest.n // 3) + 1)
    if len(halves) > 1:
        waves = [wave(np.pi * k * u) for k in halves for wave in (np.cos, np.sin)]
        add("periodic", waves, [(2 * k, 2 * k + 1) for k in range(len(halves))])
    turns = (np.arange(WALK) + 0.5) * np.pi
    add("drift", [np.sqrt(2.0) * np.sin(k * u) / k for k in turns], [tuple(range(WALK))], "walk")
    return designs


def place(cause, model, forms, posterior, rest):
    """{name: probability} of what stands where a cause (aliases.Cause) does; model: a
    scored_sets.Model. Of a decay of which a rest shows so little that a straight line says as much
    of it, to within what tells two names apart, nobody can tell whether it is a walk's course; of
    any without a thermometer not whether it goes with the temperature."""
    known, name = posterior.places[cause.effect], cause.effect
    if name != "warm_up":
        return known
    if rest.temperature is None:
        known = {**known, name: 0.5 * known[name], "thermal_bias": 0.5 * known[name]}
    others = [form for form in posterior.best.forms if form.effect != name]

    def change(form):
        """Share of its size that a decay changes by in the rest."""
        return -np.expm1(-rest.span_s / closed_loop.shape(form, 0.0)["tau_s"])
    lines = [_as_large(form, change(cause.chosen[0]) / change(form)) for form in forms
             if form.effect == name and change(form) < 1.0 / STRAIGHT]
    lines = [model.scored((*others, line)).score for line in lines]
    if max(lines, default=-np.inf) < posterior.best.score - odds.PRESENT:
        return known
    alike = [name, "drift", *(["thermal_bias"] if rest.temperature is None else [])]
    return {**known, **dict.fromkeys(alike, sum(known.get(n, 0.0) for n in alike) / len(alike))}


def _as_large(form, times):
    """A form whose size is so many times as large, so that another course changes as much."""
    return replace(form, variant=form.variant + " straight", shared=replace(
        form.shared, prior=times * form.shared.prior))


def limits(rest, sensor, name):
    """Why an effect could not be looked for in a rest, or ""."""
    if name in ("thermal_bias", "thermal_rate", "thermal_scale"):
        if rest.temperature is None:
            return "no temperature column"
        if rest.moved_c < MOVES_C:
            return "the temperature moved by %.2g degC only" % rest.moved_c
    if name == "thermal_scale" and sensor == "gyro":
        return "needs turns between the poses: the gyro was judged at rest"
    return ""
