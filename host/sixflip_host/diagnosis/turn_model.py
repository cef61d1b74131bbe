"""The gyro in motion: what the turns between the rests (experiment/turns.py) leave unexplained."""
from dataclasses import replace

import numpy as np

from sixflip_sim.effects import typical

from ..experiment import (
    attitude_fit,
    covariance,
    linear_model,
    noise_arrays,
    nominal_rows,
    terms,
    turns,
)
from ..planning.detectable import FLIP_DEG
from . import between_sessions, stray_turns
from .detect import saturation
from .evidence import Levels
from .hypotheses import TYPICAL
from .rest_model import RestModel

EFFECTS = ("asymmetry", "quadratic", "cubic")
ATTITUDE_DEG = 0.03  # of gravity's direction at rest
# Of half a turn by hand, a level of its own: a careless one is five to ten degrees off.
FLIPS_DEG = (0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8)
FEWEST_MOVES = 6  # two equations each: as many as nine of the matrix and three of the bias
BANDS_DPS = (1.0, 4.0)  # widths over which a dead band bends the rates beyond it
TIMES = (1.0, 10.0)  # the usual width of a dead band: no data sheet gives one
# Times what its flanks foretell is what a peak that is cut off has lost: the usual coefficient,
# which is TYPICAL of a design's prior.
FORETOLD = 1.0
AT_END = 0.97  # of the largest rate read: noise and bias leave what is cut off within that
# Levels from which on a rate may read as less than it is, half an octave apart: from slow turns by
# hand to a jerk.
LEVELS_DPS = (40.0, 57.0, 80.0, 113.0, 160.0, 226.0)
JUMPS_AT = (-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75)  # of a session from -1 to 1
# Standard deviations of what the rows' first fit leaves of scale and misalignment, of the bias
# (deg/s: half turns ten degrees off in ten seconds), and of the angles between the
# accelerometer's axes (degrees: as faces of a box lie).
KNOWN = np.array([0.05] * 9 + [1.0] * 3 + [1.0] * 3)
USUAL_DEG = 0.25  # of a move from rest to rest, beside white noise


def design(name, chosen, chip, variant="", shape=None):
    """Design of an effect of the gyro in motion over the rows of all turns."""
    parts = []
    for turn in chosen:
        m = noise_arrays.moment()
        m.w = tuple(turn.middle.T)
        m.temperature = turn.temperature if turn.temperature is not None else m.temperature
        own = terms.of_terms(name, "gyro", m, len(turn.dt), variant, chip=chip, shape=shape)
        parts.append(turns.projected(turn, own.columns.reshape(len(turn.dt), 3, -1)))
    return terms.Design(name, variant, own.keys, own.axes, np.vstack(parts), own.prior)


class TurnModel(RestModel):
    """The gyro in motion: of what lies between the sessions the scales alone, and in flicker's
    place how far half a turn by hand is off."""

    drifts = False
    left_in = "motion"
    form = 0.06  # turns are linear in an effect only while it is small: a quarter of its size

    def unit(self, part, model, certified, wanted=None):
        y, chosen = turns.calibrated(turns.usable_turns(part, model.up))
        designs = [design(name, chosen, self.chip) for name in EFFECTS]
        if part.thermal:
            designs.append(design("thermal_scale", chosen, self.chip,
                                  shape={"reference_c": self.conditions.reference_c}))
        if "saturation" not in self.settings.without:
            designs += limited(chosen, self.chip)
        if "dead_band" not in self.settings.without:
            lsb = part.capture.meta["gyro_lsb_per_dps"]
            designs += [banded(chosen, width, times, lsb, self.chip) for width in BANDS_DPS
                        for times in TIMES]
        designs += [nameless(chosen, name, functions) for name, functions in STRANGERS.items()]
        designs.append(_of_rates("motion", "with gravity", chosen, _with_gravity, 10.0))
        designs += _in_time(chosen)
        if part.thermal:
            reference = self.conditions.reference_c
            designs.append(nameless(chosen, "thermal_orientation",
                                    lambda turn: _of_temperature(turn, reference)))
        bases = [np.diag(([ATTITUDE_DEG] * 2 + [0.0] * t.flip) / np.array(t.seconds)) ** 2
                 + wandering for t, wandering in zip(chosen, turns.wandering(chosen))]
        bases = [base + self.conditions.hidden * lost(t) for base, t in zip(bases, chosen)]
        by_hand = [np.diag([0.0, 0.0] + [t.seconds ** -2.0] * t.flip) for t in chosen]
        groups = covariance.apart(bases, [np.eye(len(b)) / t.seconds
                                          for b, t in zip(bases, chosen)], by_hand)
        flips = FLIPS_DEG if any(t.flip for t in chosen) else (FLIP_DEG,)
        nuisance = np.hstack([turns.nuisance(chosen), attitude_fit.squareness(chosen)])
        rows = nominal_rows.Rows(y, groups, nuisance, (stray_turns.LEVELS_DEG, flips),
                                 common=attitude_fit.unknown(chosen, model), scale=(0, 4, 8))
        # Of a half only sizes are asked: its turns, all of their samples, need not stay.
        return linear_model.unit(
            rows, designs, wanted, turns=chosen if wanted is None else (),
            signature=("turns", tuple((t.flip, round(t.turned, -1)) for t in chosen)))

    def usual(self):
        return Levels(USUAL_DEG, FLIP_DEG, 1.0, between_sessions.UNUSUAL["scale"]["gyro"])

    def between(self, units, parts):
        if len(units) < 2 or not all(session.thermometer for session, _ in parts):
            return []
        return between_sessions.unit("scale", "gyro", [scales(u, self.usual()) for u in units],
                                     units[0].designs)


def settled(unit, point):
    """The turns of a Unit with scale, misalignment and bias as they are likeliest at a point
    (level of the turns, of half turns) of its grid, the angles between the accelerometer's axes
    beside them. To its rows' first fit those are right angles, and half a turn by a hand counts
    as much as what gravity says: by a box put down degrees off it is a percent wrong."""
    factor = covariance.Factor(covariance.reduced(unit.rows.groups), point[:1], point[1])
    white = factor.whitened(covariance.turned(unit.rows.groups, np.column_stack(
        [unit.rows.nuisance, unit.rows.y])))[0]
    known = np.column_stack([np.diag(1.0 / KNOWN), np.zeros(len(KNOWN))])
    observed = np.vstack([white, known])
    sizes = np.linalg.lstsq(observed[:, :-1], observed[:, -1], rcond=None)[0]
    matrix = np.eye(3) - sizes[:9].reshape(3, 3)
    return tuple(turn.corrected(matrix, sizes[9:12]) for turn in unit.turns)


def scales(unit, levels):
    """between_sessions.Constants of a Unit, what is observed taken about the settled turns: a
    percent off, what is linear is wrong by a thousandth."""
    point = between_sessions.likeliest(unit, levels)
    chosen = settled(unit, point)
    rows = replace(unit.rows, y=np.concatenate([turns.observed(turn) for turn in chosen]))
    return between_sessions.scales(rows, unit.designs, point, chosen[0].matrix, 1000.0)


def lost(turn):
    """(2 or 3, 2 or 3): covariance of what is observed of a turn of which each sample is missing
    under a steady clock, by itself, with a small chance: of so many times that; what is missing on
    the mean is the scale's."""
    each = np.einsum("rni,ni->rn", turn.shown, turn.middle)
    return each @ each.T


def _bends(turn):
    """Of each axis' own rate: what no power names."""
    w = turn.middle
    return [np.clip(w, -20.0, 20.0) / 20.0, np.clip(w, -60.0, 60.0) / 60.0,
            np.clip(np.abs(w), 0.0, 30.0) / 30.0]


def _of_motion(turn):
    """Of the rate of the others, and of how fast the rates change."""
    w = turn.middle
    change = np.gradient(w, axis=0) / turn.dt[:, None]
    size = np.linalg.norm(w, axis=1)[:, None] / 100.0
    product = np.stack([w[:, 1] * w[:, 2], w[:, 2] * w[:, 0], w[:, 0] * w[:, 1]], 1) / 1e4
    return [change / 100.0, np.broadcast_to(size, w.shape), size * w / 100.0, product]


def _with_gravity(turn):
    """Of every rate in proportion to what gravity is along its axis."""
    felt = np.einsum("nji,j->ni", turn.attitude, turn.before)
    return [felt * turn.middle / 100.0]


def _of_temperature(turn, reference_c):
    """Of every rate in proportion to the temperature."""
    warm = (turn.temperature - reference_c)[:, None] / 5.0
    return [np.broadcast_to(warm * turn.middle[:, i:i + 1] / 100.0, turn.middle.shape)
            for i in range(3)]


def _in_time(chosen):
    """Designs of a scale of each axis that changes: steadily, alike in every session, or at once,
    at a time of a session's own."""
    first, last = chosen[0].t[0], chosen[-1].t[-1]

    def course(turn):
        return 2.0 * (0.5 * (turn.t[0] + turn.t[-1]) - first) / (last - first) - 1.0
    steady = nameless(chosen, "time", lambda turn: [course(turn) * turn.middle / 100.0])
    jump = nameless(chosen, "jump", lambda turn: [
        np.sign(course(turn) - at) * turn.middle / 100.0 for at in JUMPS_AT])
    return [steady, replace(jump, choices=[(3 * k, 3 * k + 1, 3 * k + 2)
                                           for k in range(len(JUMPS_AT))])]


STRANGERS = {"amplitude": _bends, "motion": _of_motion}


def nameless(chosen, name, functions):
    """Design of functions of a turn's rates that no effect of the library has."""
    return _of_rates(name, "", chosen, functions, 10.0)


def banded(chosen, width, times, lsb, chip):
    """Design of a dead band that what is beyond it reads less by, counts, of so many times the
    usual width: a rate that is read was larger by the band, on its own side of 0, to which it
    comes over `width` deg/s."""
    def less(turn):
        return [-turn.middle / np.sqrt(turn.middle ** 2 + width ** 2) / lsb]
    prior = 10.0 * times * typical.size("dead_band", chip, "gyro")[0]
    return replace(_of_rates("dead_band", "%g times, over %g deg/s" % (times, width), chosen, less,
                             prior), positive=True)


def limited(chosen, chip):
    """Designs of rates that read as less than they are: of what exceeds a level, the library's
    form, and of peaks that are cut off at the largest rate read, of what their flanks foretell."""
    designs = [design("saturation", chosen, chip, "level %g" % level, {"level": level})
               for level in LEVELS_DPS]
    ends = [np.max([(sign * turn.middle).max(axis=0) for turn in chosen], axis=0)
            for sign in (1.0, -1.0)]
    lost = {turn: sum(-sign * saturation.lost_at_peaks(sign * turn.middle, turn.dt, AT_END * top)
                      for sign, top in zip((1.0, -1.0), ends)) for turn in chosen}
    most = int(sum(turn.dt @ np.abs(less) for turn, less in lost.items()).argmax())
    level = max(float(np.abs(turn.rate[:, most]).max()) for turn in chosen)  # as it is read
    designs.append(replace(_of_rates("saturation", "at its end", chosen,
                                     lambda turn: [lost[turn]], FORETOLD / TYPICAL),
                           shape=(("level", round(level, 1)),)))
    return [replace(limit, positive=True) for limit in designs]


def _of_rates(effect, variant, chosen, functions, prior):
    """Design of functions of a turn, (n, 3) over its rates, a coefficient an axis each."""
    parts, number = [], 0
    for turn in chosen:
        values = functions(turn)
        number = len(values)
        parts.append(turns.projected_by_axis(turn, values))
    keys = ["%s%s" % ("xyz"[a], "" if not k and not terms.is_stranger(effect) else k)
            for k in range(number) for a in range(3)]
    return terms.Design(effect, variant, keys, [0, 1, 2] * number, np.vstack(parts),
                             np.full(3 * number, prior))


def usable(session, nominal):
    """True when there are enough turns to judge."""
    return session.gyro is not None and len(
        turns.usable_moves(session, nominal.up)) >= FEWEST_MOVES
