"""The three axes of one long rest as units of the one model, the levels of their noise, and what
is foretold of a rest from other pieces of it.

Flicker and the change from one rest to the next are the levels. The figures are held out in time:
the rest is cut into pieces, every fourth one is foretold from the others.
"""
from dataclasses import dataclass, replace

import numpy as np

from ..experiment import covariance, linear_model, long_rest, nominal_rows
from ..experiment.noise_arrays import flicker_kernel
from . import adequacy, between_sessions, evidence, gap_figures, rest_forms, sway

# Levels tried: of the offset from one rest to the next from what it is where nothing was moved
# up, about half a decade apart: beyond flicker that is the Allan floor of the parts
# (typical.FLOOR), of a gyro the Earth's rate, should the box have been put down again; of flicker
# from a quiet part (typical.FLICKER) up, where parts are so close that what is left beside the
# nearest is not doubtful for that (adequacy.DOUBTFUL_RATIO, of squares).
OFFSETS = {"accel": (0.1, 0.3, 1.0, 3.0, 12.0, 50.0), "gyro": (0.003, 0.01, 0.05, 0.3, 1.0)}
FLICKERS = {"accel": (0.005, *np.geomspace(0.02, 0.8, 15).tolist(), 1.6, 4.0, 12.0, 40.0),
            "gyro": (0.0002, *np.geomspace(0.0005, 0.03, 17).tolist(), 0.1, 0.3, 1.0)}
PIECES, FOLDS = 12, 4  # three pieces, far apart, are foretold by the nine beside them


@dataclass(frozen=True)
class RestLevels:
    """What is usual: offsets (from one rest to the next, of each axis) and flicker, mg or
    deg/s."""

    offsets: tuple
    flicker: float
    known: bool

    def usual(self, unit):
        """(offset from one rest to the next, flicker) that a unit has at most."""
        return self.offsets[unit.axis], self.flicker

    def prior(self, unit, free):
        """(G,) log prior of each point of a unit's grid; free: levels that may be anything. Less
        than usual is as good as usual."""
        grid = np.array(unit.grid)
        factor = np.log(evidence.KNOWN_FACTOR if self.known else evidence.USUAL_FACTOR["flicker"])
        total = np.zeros(len(grid))
        for column, (name, level) in enumerate(zip(("switch_on", "flicker"), self.usual(unit))):
            if name not in free:
                above = np.maximum(np.log(grid[:, column] / level), 0.0)
                total -= 0.5 * (above / factor) ** 2
        return total


def levels(rest, kind, flicker, known):
    """RestLevels with this flicker, measured or not. A robot that stops again, or a box that is
    put down again, leans another way within what counts as one attitude: across gravity that is
    an accelerometer's attitude, and says nothing of the sensor."""
    moved = kind == "accel" and _several(rest)
    leaning = 1000.0 * np.sin(np.radians(long_rest.SAME_DEG)) if moved else 0.0
    across = leaning * np.sqrt(np.maximum(1.0 - rest.up ** 2, 0.0))
    offsets = [min(tried for tried in OFFSETS[kind] if tried >= min(lean, OFFSETS[kind][-1]))
               for lean in across]
    return RestLevels(tuple(offsets), flicker, known)


def axis_units(rest, kind, chip, settings):
    """[Unit] of the three axes, which share no coefficient: each has the columns of all, the
    others' being zero."""
    designs = rest_forms.designs(rest, kind, chip, settings)
    number = int(rest.rest.max()) + 1
    lateral = (rest.rest[:, None] == np.arange(number)[None]).astype(float)
    if number == 1:
        lateral = lateral[:, :0]
    kernel = flicker_kernel(rest.t, rest.seconds) * (rest.session[:, None] == rest.session)
    warming = 0 if rest.temperature is None else int(round(
        float(rest.temperature[-1] - rest.temperature[0]) / 3.0))
    units = []
    values, fixed = rest.values[kind], np.zeros((3, rest.n, rest.n))
    swaying = sway.of_rest(rest, adequacy.usual(chip, "accel"), FLICKERS[kind]) \
        if kind == "gyro" else None
    if swaying:
        values, fixed = values - swaying.rate, swaying.covariance
    for axis in range(3):
        own = [replace(d, columns=d.columns * (np.array(d.axes) == axis)) for d in designs]
        group = covariance.alone(np.diag(rest.noise[kind][:, axis] ** 2) + fixed[axis], lateral,
                                 kernel)
        rows = nominal_rows.Rows(values[:, axis], group, np.ones((rest.n, 1)),
                                 (OFFSETS[kind], FLICKERS[kind]), (0,),
                                 common=_switched_on(rest, kind))
        signature = ("rest", axis, tuple(rest.rest.tolist()), tuple(rest.session.tolist()),
                     tuple((rest.t - rest.t[0]).round().astype(int).tolist()), warming)
        unit = linear_model.unit(rows, own, signature=signature, axis=axis)
        units.append(replace(unit, energy=unit.energy / 3.0))  # the rows are those of one axis
    return units


def _several(rest):
    """Whether a session has several rests. Files of a rest each may be of a thing that stood still
    all the while, and was not switched on again."""
    return rest.rest.max() > rest.session.max()


def _switched_on(rest, kind):
    """(n, sessions) what switching on again changes of a bias, its coefficients of a standard
    deviation of 1; None of one session, and of files of a rest each."""
    sessions = np.unique(rest.session)
    if len(sessions) < 2 or not _several(rest):
        return None
    return between_sessions.ORDINARY_CHANGE["bias"][kind] * (
        rest.session[:, None] == sessions).astype(float)


def held_out(rest, unit, chosen, index, levels):
    """gap_figures.Sums of one axis over the folds: pieces of the rests, every FOLDS-th of them
    foretold by the others, all means with one weight. The floor is that of noise that wanders no
    more than a chip may, in rests that lie as they may; what wanders more is a gap that nothing
    foretells."""
    y, group, (placement, flicker) = unit.rows.y, unit.rows.groups[0], unit.grid[index]
    offset, wanders = levels.usual(unit)
    noise = covariance.dense([group], placement, flicker)
    quiet = covariance.dense([group], placement if placement <= offset else 0.0,
                             min(flicker, adequacy.TIMES_TYPICAL * wanders))
    columns = np.concatenate([f.columns for f in chosen] + [np.zeros(0, dtype=int)]).astype(int)
    prior = np.concatenate([f.prior for f in chosen] + [np.zeros(0)])
    x = unit.raw(columns)
    # How a box lies is each rest's own. So is a session's bias, where it changes by more than is
    # usual, or where its other rests tell it.
    pieces, total = _pieces(rest.rest), gap_figures.NOTHING
    own = rest.session * (placement > offset or _several(rest))
    if offset > unit.grid[0][0] and len(np.unique(pieces)) > len(np.unique(rest.rest)):
        own = rest.rest
    for fold in range(FOLDS):
        held = pieces % FOLDS == fold
        train = ~held
        constants = (own[:, None] == np.unique(own[train])).astype(float)
        held = held & constants.any(axis=1)
        plain = _foretelling(constants, x[:, :0], prior[:0], noise, train, held)
        z = plain @ y
        d = z - _foretelling(constants, x, prior, noise, train, held) @ y
        scatter = plain @ noise @ plain.T
        total = total + gap_figures.Sums(
            float(z @ z), float((z - d) @ (z - d)), float(np.trace(plain @ quiet @ plain.T)),
            float(held.sum()), gap_figures.spread(
                2.0 * float((scatter ** 2).sum()), float(z @ scatter @ z),
                float(d @ scatter @ z), float(d @ scatter @ d)))
    return total


def _pieces(rest):
    """(n,) number of the piece that each mean is in: about PIECES in all, FOLDS of each rest at
    least where it has so many means; one after the other through all rests."""
    pieces, start = [], 0
    for number in np.unique(rest):
        n = int((rest == number).sum())
        parts = min(n, max(FOLDS, int(round(PIECES * n / len(rest)))))
        pieces.append(start + np.arange(n) * parts // n)
        start += parts
    return np.concatenate(pieces)


def _foretelling(constants, x, prior, noise, train, held):
    """(held, n): what it takes to make of all means those held out less what those of `train`
    foretell of them: constants and the columns x."""
    design = np.hstack([constants, x])
    solved = np.linalg.solve(noise[np.ix_(train, train)], design[train])
    gram = design[train].T @ solved + np.diag(np.concatenate([
        np.zeros(constants.shape[1]), prior ** -2.0]))
    operator = np.eye(len(x))[held]
    operator[:, train] -= design[held] @ np.linalg.solve(gram, solved.T)
    return operator
