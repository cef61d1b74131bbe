"""Layer one where the motions differ: a simulator's log against its own rests and moves.

At rest a sensor reads gravity, in the direction that a label (or the real robot's own rests) say;
and the gyro carries gravity from each rest to the next. Every hypothesis on both sensors together
predicts these directions; a move that follows nothing at all is always possible.
"""
from dataclasses import dataclass, replace

import numpy as np

from sixflip import STANDARD_G

from .. import odds
from ..detect.axis_order import SIGNED
from . import convention_findings, conventions, traces
from . import gravity_directions as directions
from .hypotheses import TIMES
from .sensor_axes import DEG

NORM_SIGMA = 0.12  # of |force| / g at rest: 80 mg of offset, 3 % of scale [MPU-6000 PS table 6.2]
RATIO_SIGMA = 1.0  # how alike two runs are in the size of their turn rates, natural logarithm
# rad that a move has to turn to say where gravity should have gone: four times the error of a
# direction (gravity_directions.SIGMA).
TURNED = 0.3
POSSIBLE = 0.002  # probability from which on a name is one of those that it may be
LEVEL_DEG = 20.0  # that gravity moves in the sensor where its axes can be told: five SIGMA
NONE = 0.0  # of gravity
MOVES = 10.0  # times its noise at rest: a gyro that turns at all
OF_GYRO = {"gyro_axes", "both_axes"}  # names that say what its axes are


@dataclass(frozen=True)
class Reading:
    """A hypothesis on both sensors: accel and gyro, signed permutations (3, 3), the gyro's unit
    or how many times too large a wrong time step makes its rates, constant (gravity always along
    one axis of the sensor), whole (where accel turns gravity over, whether all of the force is
    turned or gravity alone), world (rates along the world's axes), nameless (gravity follows
    nothing that the gyro says)."""

    accel: np.ndarray
    gyro: np.ndarray
    gyro_unit: float = 1.0
    constant: bool = False
    whole: bool = False
    world: bool = False
    nameless: bool = False


def conventions_of(real, sim, moving=True, real_turns=1.0):
    """(Conventions, sentences on what could not be seen) of the simulator's Trace; moving: either
    log moves. Of two that lie still, each somewhere, how they lie is no convention of either.
    real_turns: how many times as far as gravity the real gyro turns; what the simulator's shares
    with it is no gap."""
    unseen = ["time step, centripetal term and lever arm of the simulator: they need a log of the "
              "same motion"]
    if not sim.rests:
        return [], ["no rest in %s: gravity, axes and frame of its readings cannot be checked "
                    "against another motion" % sim.name] + unseen
    norms = np.linalg.norm(sim.rest_means(sim.force), axis=1) / sim.g
    chances, eye = by_norm(norms, moved_ratio(real, sim)), np.eye(3)
    none, small, large = (chances.get(size, 0.0) for size in (NONE, 1.0 / STANDARD_G, STANDARD_G))
    nothing = convention_findings.finding("no_gravity", "accel", none,
                                          -np.log(max(1.0 - none, 1e-300)))
    axes = ["axes and frame of %s: without gravity a log of another motion does not show them"
            % sim.name]
    if none > convention_findings.CERTAIN:
        return [nothing] + unit_by_size(real, sim), unseen + axes
    if none + small > convention_findings.CERTAIN > small:
        return [convention_findings.one_of("accel", ["accel_unit", "no_gravity"], none + small,
                                           -np.log(max(1.0 - none - small, 1e-300)))], \
            unseen + axes
    findings = []
    for unit, chance in ((1.0 / STANDARD_G, small), (STANDARD_G, large)):
        if chance > convention_findings.CERTAIN:
            findings.append(convention_findings.other_unit(
                "accel", chance, -np.log(max(1.0 - chance, 1e-300)), unit))
    if not moving and not any(face is not None for face in sim.faces):
        return findings, unseen + ["axes and frame of %s: neither log moves, and nothing says how "
                                   "either lies" % sim.name]
    ups = sim.rest_means(sim.force)
    ups = ups / np.maximum(np.linalg.norm(ups, axis=1), 1e-12)[:, None]
    ways = directions.moves(sim)
    choices = []
    for accel in SIGNED:
        seen = directions.direction_log(ups @ accel, real, sim)  # body = Sᵀ measured
        choices.append((Reading(accel, eye), seen))
    best = max(v for _, v in choices)
    accels = [(r.accel, v) for r, v in choices if v > best - 12.0 or np.array_equal(r.accel, eye)]
    tried = []
    says = directions.should_turn(ups, ways)
    planar = max(*directions.turned(ups, ways), says) < np.radians(LEVEL_DEG)
    # Where gravity stays where it is, and the gyro says so, its unit makes no difference.
    rate_units = [(0.0, 1.0)] if planar else units_of(real, sim)
    # Turned in its axes a way goes the same way, and seen in a mirror it is turned backwards.
    by = {(times, way): directions.carried_by(ways, way * times * eye)
          for _, times in rate_units for way in (1, -1)}
    for accel, seen in accels:
        body = ups @ accel
        for unit_log, rate_unit in rate_units:
            for gyro in SIGNED:
                way = round(np.linalg.det(gyro))
                tried.append((Reading(accel, gyro, gyro_unit=rate_unit),
                              seen + unit_log + by[rate_unit, way].log(body @ (way * gyro.T))))
        if np.array_equal(accel, eye) and not planar:
            tried.append((Reading(accel, eye, world=True),
                          seen + directions.world_log(body, ways)))
    if not planar:
        plain = directions.direction_log(ups, real, sim)
        tried += [(Reading(eye, eye, gyro_unit=times), plain + directions.carried_log(
            ups, ways, eye * times)) for times in TIMES]
        tried.append((Reading(eye, eye), plain + directions.carried_log(
            ups, ways, eye * real_turns)))
    if says > TURNED:
        tried.append((Reading(eye, eye, constant=True), directions.constant_log(ups, ways, sim)))
    tried.append((Reading(eye, eye, nameless=True), directions.direction_log(
        ups, real, sim) + directions.nameless_log(ups, ways)))
    # What else moves it is another thing in another motion, and does not say its own sign.
    tried += [(replace(reading, whole=True), log) for reading, log in tried
              if np.array_equal(reading.accel, -eye)]
    more = judged(tried)
    if len(sim.rests) < 2 or not ways:
        unseen.append("axes and frame of the gyro of %s: no move between two rests" % sim.name)
    elif planar and not any({c.name, *c.one_of} & OF_GYRO for c in more):
        unseen.append("axes and frame of the gyro of %s: gravity stays where it is in the sensor"
                      % sim.name)
    return findings + more, unseen


def by_norm(norms, moved=None):
    """{1.0, NONE, or a unit of the accelerometer: probability} of what reads |force| / g = norms
    (n,) at rest. moved: moved_ratio(): a bias of a tenth of g at rest is both no gravity and one
    in m/s2, and what moves it says which."""
    def log(mean):
        off = (norms - mean) / (NORM_SIGMA * max(mean, 0.5))
        return np.log((1 - directions.ASTRAY) * np.exp(-0.5 * off ** 2)
                      + directions.ASTRAY * 1e-2).sum()

    def by_motion(unit):
        return 0.0 if moved is None else -0.5 * (np.log(moved / unit) / RATIO_SIGMA) ** 2
    each = np.log(conventions.PRIOR_EACH)
    return odds.shares({
        1.0: log(1.0) + by_motion(1.0) + np.log(conventions.PRIOR_HEALTHY),
        NONE: log(0.0) + by_motion(1.0) + each,
        1.0 / STANDARD_G: log(1.0 / STANDARD_G) + by_motion(1.0 / STANDARD_G) + each,
        STANDARD_G: log(STANDARD_G) + by_motion(STANDARD_G) + each})


def moved_ratio(real, sim):
    """How much the simulator's force changes from row to row beside the real one's, or None: what
    shakes a robot on its way has gravity in neither."""
    if min(len(x.force) for x in (real, sim)) < 2:
        return None
    sizes = [float(np.sqrt((np.diff(x.force, axis=0) ** 2).sum(axis=1).mean()) * x.rate_hz)
             for x in (real, sim)]
    return sizes[1] / sizes[0] if min(sizes) > 0.0 else None


def units_of(real, sim):
    """[(log, unit of the gyro)] by how fast the two logs turn."""
    sizes = [np.sqrt((x.rate - traces.rest_line(x, x.rate)).var(axis=0).sum())
             for x in (real, sim) if x.rate is not None]
    if len(sizes) < 2 or min(sizes) <= 0:
        return [(0.0, 1.0)]
    quiet = [np.sqrt(sum(x.rate[a:b].var(axis=0) for a, b in x.rests).sum() / len(x.rests))
             for x in (real, sim) if x.rests]
    if len(quiet) < 2 or any(s < MOVES * q for s, q in zip(sizes, quiet)):
        return [(0.0, 1.0)]
    ratio = np.log(sizes[1] / sizes[0])
    return [(float(-0.5 * ((ratio - np.log(u)) / RATIO_SIGMA) ** 2), u)
            for u in (1.0, DEG, 1.0 / DEG)]


def unit_by_size(real, sim):
    """The gyro's unit where nothing else says it."""
    scored = {u: v + np.log(conventions.PRIOR_HEALTHY if u == 1.0 else conventions.PRIOR_EACH)
              for v, u in units_of(real, sim)}
    unit, chance = max(odds.shares(scored).items(), key=lambda pair: pair[1])
    if unit == 1.0 or chance < convention_findings.CERTAIN:
        return []
    return [convention_findings.other_unit("gyro", chance, scored[unit] - scored[1.0], unit)]


def names_of(reading):
    """What a Reading says the simulator does other than a sensor, by name: [] is healthy."""
    eye = np.eye(3)
    if reading.nameless:
        return ["unknown"]
    if reading.constant:
        return ["gravity_after_rotation"]
    names = ["world_frame_rates"] if reading.world else []
    if np.array_equal(reading.accel, reading.gyro) and not np.array_equal(reading.accel, eye):
        names.append("both_axes")
    else:
        if np.array_equal(reading.accel, -eye):
            names.append("force_sign" if reading.whole else "gravity_sign")
        elif not np.array_equal(reading.accel, eye):
            names.append("accel_axes")
        if not np.array_equal(reading.gyro, eye):
            names.append("gyro_axes")
    if reading.gyro_unit != 1.0:
        names.append("time_step" if reading.gyro_unit in TIMES else "gyro_unit")
    return names


def log_prior(names):
    """Log probability of what a simulator does, by names, before looking; axes may be any of the
    47 signed permutations that are none, a time step off by any of TIMES."""
    if not names:
        return np.log(conventions.PRIOR_HEALTHY)
    return sum(np.log(conventions.prior(name) / (
        47 if name.endswith("_axes") else len(TIMES) if name == "time_step" else 1))
        for name in names)


def judged(tried):
    """[Convention] of the most probable Reading; tried: [(Reading, log likelihood), ...]."""
    named = [names_of(reading) for reading, _ in tried]
    logs = np.array([log + log_prior(names) for (_, log), names in zip(tried, named)])
    best = tried[int(logs.argmax())][0]
    return convention_findings.told(
        named, logs, POSSIBLE,
        lambda candidates: sensors.pop() if len(sensors := set(
            map(sensor_of, candidates))) == 1 else "device",
        lambda name, probability, nats: convention_as(name, best, probability, nats))


def sensor_of(name):
    """Which sensor does what a name says, or device."""
    if name in ("world_frame_rates", "gyro_axes", "gyro_unit", "time_step"):
        return "gyro"
    return "device" if name in ("both_axes", "unknown") else "accel"


def convention_as(name, reading, probability, nats):
    """The Convention of a name that a Reading has."""
    if name == "gyro_unit":
        return convention_findings.other_unit("gyro", probability, nats, reading.gyro_unit)
    if name == "time_step":
        return convention_findings.finding(
            name, "gyro", probability, nats, "its rates turn gravity %.3g times as far as it "
            "moves: divide them by that, or the steps of its time stamps" % reading.gyro_unit,
            value={"factor": float(reading.gyro_unit)}, unit="1")
    sensor = sensor_of(name)
    if not name.endswith("_axes"):
        return convention_findings.finding(name, sensor, probability, nats)
    return convention_findings.other_axes(
        name, sensor, probability, nats, reading.gyro if name == "gyro_axes" else reading.accel)
