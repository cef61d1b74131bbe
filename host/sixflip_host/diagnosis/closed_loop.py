"""The loop closed: the simulator run again with the effects found, and the gap between real and
simulated before and after, on each session held out (GAP stage 6, last sentence).

The simulated sensor repeats the real session: its attitudes, timing and temperature, its noise
and flicker, the twelve parameters fitted. What is compared are the contrasts, so that nothing
nominal is in the difference but misalignments that are known beforehand, the same in both.
"""
import math
from dataclasses import dataclass, replace

import numpy as np

from sixflip import RAIL, STANDARD_G
from sixflip_sim.effects import make as make_chain
from sixflip_sim.effects.effect import BadEffect
from sixflip_sim.effects.library import EFFECTS
from sixflip_sim.effects.library import make as make_effect
from sixflip_sim.sensor_model import SensorModel, Triad

from ..capture.capture_file import Capture
from ..experiment import blocks, nominal_rows, session_terms
from ..planning.protocols import body_to_table
from ..simulation import replica
from . import effect_estimates

# s, tried of a session's own warming: GAP has 60-300 s, and some octaves to both sides.
TAUS_S = (30.0, 60.0, 120.0, 200.0, 300.0, 400.0, 600.0, 1000.0, 3000.0)


@dataclass(frozen=True, eq=False)
class ReplayScene:
    """The attitudes of a session's placements at their times; a move holds the one before.

    starts (n,) s and attitudes (n, 9) of the placements, body to table by rows; the temperature as
    sensor_model.SensorModel asks for it: end, change (degC) and time constant (s); g in m/s^2."""

    starts: np.ndarray
    attitudes: np.ndarray
    temperature_c: float
    warm_c: float
    warm_tau_s: float
    g: float = STANDARD_G
    lever_arm: object = None

    def fill(self, motion, t_us):
        """Fill a scene_arrays.Motion."""
        t = np.asarray(t_us) * 1e-6
        place = np.clip(np.searchsorted(self.starts, t, side="right") - 1, 0, None)
        motion.attitude[:] = self.attitudes[place].T
        motion.f[:] = self.g * self.attitudes[place][:, 6:9].T
        motion.before[:] = self.g * self.attitudes[np.maximum(place - 1, 0)][:, 6:9].T
        motion.resting[:] = True
        motion.since[:] = np.maximum(t - self.starts[place], 0.0)


def replayed(session, up):
    """ReplayScene of a blocks.Session whose placements feel up (n, 3), unit vectors."""
    starts = np.array([session.t_s[first] for _, first, _ in session.runs])
    attitudes = np.array([body_to_table(u, 0.0).ravel() for u in up])
    return ReplayScene(starts, attitudes, *cooling(session))


def cooling(session):
    """(end, change, tau) of T(t) = end - change exp(-t / tau) nearest to the thermometer."""
    if session.thermometer is None:
        return 25.0, 0.0, 300.0
    t, c = session.thermometer.t, session.thermometer.c
    best = None
    for tau in TAUS_S:
        columns = np.stack([np.ones_like(t), -np.exp(-t / tau)], 1)
        size, *_ = np.linalg.lstsq(columns, c, rcond=None)
        left = float(((c - columns @ size) ** 2).sum())
        if best is None or left < best[0]:
            best = left, float(size[0]), float(size[1]), tau
    return best[1:]


def specs(gap, theta, reference_c):
    """[{effect, sensor, key: size, parameter: value}] of the chosen candidates; theta (k,). The
    simulator has the library's form alone: what a discrepancy adds beside it, and what remembers
    otherwise, goes to the nearest sizes of that."""
    effects, start = [], 0
    for candidate in gap.chosen:
        keys, powers = candidate.keys, candidate.powers
        mine = theta[start:start + len(keys)]
        start += len(keys)
        if session_terms.remembers_otherwise(candidate):
            keys, columns = _in_the_library(gap, candidate)
            powers, mine = (1,) * len(keys), _nearest(gap, candidate, columns, mine)
        elif candidate.discrepancy:
            own = np.flatnonzero(powers)
            mine = mine.copy()
            mine[own] = _nearest(gap, candidate, candidate.columns[own], mine)
        cls = EFFECTS[candidate.effect]
        spec = {"effect": candidate.effect, "sensor": gap.kind}
        for key, power, value in zip(keys, powers, mine):
            own = key if power == 1 else "%s%d" % (key, power)  # a square beside a slope: x2
            if own not in cls.keys:
                continue
            spec[own] = float(np.clip(value, -cls.largest[gap.kind], cls.largest[gap.kind]))
        spec.update(shape(candidate, reference_c))
        effects.append(spec)
    return effects


def _in_the_library(gap, candidate):
    """(keys, columns) of the library's own form of a candidate's effect, on its axes."""
    designs = gap.units[0].designs
    starts = np.cumsum([0, *(len(design.keys) for design in designs)])
    start, design = next((start, design) for start, design in zip(starts, designs)
                         if design.effect == candidate.effect and not design.variant)
    mine = [k for k, axis in enumerate(design.axes) if axis in candidate.axes]
    return [design.keys[k] for k in mine], start + np.array(mine)


def _nearest(gap, candidate, columns, theta):
    """(p,) sizes of the columns (p,) that come nearest to a candidate with coefficients theta."""
    every = np.concatenate([columns, candidate.columns])
    gram = sum(u.gram.at(i, every) for u, i in zip(gap.data.units, gap.levels()))
    mapped = effect_estimates.nearest(gram, np.arange(len(columns)),
                                      np.arange(len(columns), len(every)))
    return mapped @ theta


def shape(form, reference_c):
    """{parameter: value} of a hypotheses.Form, or of an aliases.Cause in its: those that its
    variant's name stands for, and those that the session gives."""
    effect, words, parameters = form.effect, form.variant.split(), dict(form.shape)
    if effect in ("thermal_bias", "thermal_scale"):
        parameters["reference_c"] = round(reference_c, 3)
    if words[:1] == ["tau"]:
        parameters["tau_s"] = float(words[1])
    if words[:1] == ["level"]:
        parameters["level"] = float(words[1])
    if words[:1] == ["lag"] and effect == "thermal_bias" and float(words[1]) < 0:
        parameters["lag_s"] = -float(words[1])
    return parameters


def simulated(session, nominal, level, effects, seed):
    """Capture of the simulated twin of a session. level: {sensor: flicker}; effects: specs."""
    capture = session.capture
    scene = replayed(session, nominal.up)
    inverse = np.linalg.inv(nominal.matrix)
    rate = session.rate
    sigma = session.noise_accel * math.sqrt(rate) * 1e-3 * STANDARD_G
    accel = Triad(inverse.tolist(), (-inverse @ nominal.offset * STANDARD_G).tolist(),
                  sigma.tolist(), 1, seed, 0)
    gyro = Triad(replica.UNIT, [0.0] * 3, 0.0, 1, seed, 3)
    slow = [dict(dict.fromkeys("xyz", float(size)), effect="drift", sensor=kind, seed=seed)
            for kind, size in level.items()]
    if session.gyro is not None:
        bias = np.radians(np.median(session.gyro, axis=0))
        noise = np.radians(session.noise_gyro * math.sqrt(rate))
        gyro = Triad(replica.UNIT, bias.tolist(), noise.tolist(), 1, seed, 3)
    model = SensorModel(scene, accel, gyro, seed=seed,
                        effects=make_chain([_checked(e) for e in effects] + slow, seed))
    n = len(capture)
    meta = capture.meta
    a = replica.counted(model, "accel", meta["accel_lsb_per_g"], rate, n)
    w = None if session.gyro is None else replica.counted(
        model, "gyro", meta["gyro_lsb_per_dps"], rate, n)
    return Capture(dict(meta), capture.t_us, _int16(a), None if w is None else _int16(w),
                   capture.temp, None, capture.pose)


def _int16(counts):
    return np.clip(counts, -RAIL - 1, RAIL).astype(np.int16)


def _checked(spec):
    """spec, or without what the library does not take."""
    try:
        make_effect(spec)
    except BadEffect:
        return {k: v for k, v in spec.items() if k in ("effect", "sensor", "reference_c")}
    return spec


@dataclass(frozen=True, eq=False)
class Loop:
    """For one sensor: before, after, floor (RMS of real less simulated, mg or deg/s), share of the
    gap that closes or None; effects: the specs added, from all sessions; after_twin: the last
    session's twin at rest with them (blocks.Session), or None."""

    before: float
    after: float
    floor: float
    share: float | None
    effects: list
    after_twin: object = None


def close(gap, reference_c):
    """Loop of a SensorGap, or None where there is nothing to add."""
    if not gap.chosen:
        return None
    sums, twin = np.zeros(4), None
    for held, unit in enumerate(gap.units[:len(gap.parts)]):
        added, twin = _session(gap, held, unit, specs(gap, gap.coefficients(held), reference_c))
        sums += added
    gap_square = sums[0] - sums[2]
    return Loop(*(float(np.sqrt(v / sums[3])) for v in sums[:3]),
                float((sums[0] - sums[1]) / gap_square) if gap_square > 0.1 * sums[2] else None,
                specs(gap, gap.coefficients(), reference_c), twin)


def _session(gap, held, unit, effects):
    """(sums of squares (before, after, floor) and the number of contrasts of one session, its
    twin with the effects)."""
    session, nominal = gap.parts[held]
    if gap.kind == "accel":
        nominal = uncovered(gap, session, unit, nominal)
    point = unit.grid[gap.adequacy.index[held]]
    level = {gap.kind: point[1]}
    # The twin lies as the real box lay: placement is in neither, and what is known of the nominal
    # sensor beforehand is in the real one alone.
    floor = sum(unit.noise_energy(unit.grid[0][0], point[1], common) for common in (True, False))
    squares = []
    for added in ([], effects):
        capture = simulated(session, nominal, level, added, 1000 + held)
        twin = blocks.session_of(session.name, capture)
        y = nominal_rows.accel_rows(twin, gap.parts[held][1]) if gap.kind == "accel" else \
            twin.gyro.reshape(-1)
        difference = unit.z - unit.contrasts(y)
        squares.append(float(difference @ difference))
    return np.array([*squares, float(floor), float(unit.freedom)]), twin


def uncovered(gap, session, unit, nominal):
    """NominalSensor whose directions of gravity are those of the readings without what the causes
    add to them."""
    raw = np.hstack([d.columns for d in unit.designs])[:, gap.shared.index]
    felt = nominal.corrected(session.accel) - (raw @ gap.coefficients()).reshape(-1, 3) * 1e-3
    up = nominal.up.copy()
    for place in np.unique(session.placement):
        moved = felt[session.placement == place].mean(axis=0)
        up[place] = moved / np.linalg.norm(moved)
    return replace(nominal, up=up)
