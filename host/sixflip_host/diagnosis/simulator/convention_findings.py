"""What is said of a simulator's conventions: the name of a finding, its words, what to set; and
its log with them put right, as far as they can be: axes, signs and units. What is still to be said
of it (its numbers, its effects) is then said of the sensor it means.
"""
import copy
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import special

from sixflip import RAIL

from ...capture.registers import SENSORS
from . import sensor_axes

# Probability from which on a convention is named: whoever reads it changes a simulator, so that
# one wrong name in a hundred is the most that is allowed.
CERTAIN = 0.99
NAMELESS = 0.9  # probability of what has no name, from which on none of the others is listed
WORDS = {
    "no_gravity": "outputs acceleration without gravity",
    "gravity_sign": "adds gravity with its sign turned",
    "force_sign": "outputs specific force with its sign turned",
    "gravity_after_rotation": "adds gravity after the rotation into the body: always along the "
                              "same axis of the sensor",
    "world_frame_forces": "outputs forces along the world's axes",
    "world_frame_rates": "outputs turn rates along the world's axes",
    "euler_angle_rates": "outputs the derivatives of roll, pitch and yaw, no turn rates",
    "time_step": "divides by the wrong time step: what moves it is too large or too small, and "
                 "gravity is right",
    "no_centripetal_term": "leaves out the centripetal term",
    "lever_arm_missing": "is at the body's centre, the real sensor is not",
    "accel_axes": "has its axes swapped or mirrored",
    "gyro_axes": "has its axes swapped or mirrored",
    "both_axes": "has the axes of both sensors swapped or mirrored in the same way",
    "accel_mounting": "is mounted in another attitude than the real one",
    "gyro_mounting": "is mounted in another attitude than the real one",
    "both_mounting": "has both sensors mounted in another attitude than the real one",
    "accel_unit": "uses another unit",
    "gyro_unit": "uses another unit",
    "accel_delay": "is late against the gyro",
    "gyro_delay": "is late against the accelerometer",
    "accel_rate_held": "repeats readings: it is slower than its rows",
    "gyro_rate_held": "repeats readings: it is slower than its rows",
    "noise_per_sample": "takes a noise density for the noise of a sample",
    "constant_channel": "has a channel that never changes",
    "bias_sign": "has the bias with the wrong sign",
    "unknown": "does something that no convention here explains",
}
SET = {
    "no_gravity": "subtract the world's gravity vector before the rotation into the body: f = "
                  "Rᵀ(a - g)",
    "gravity_sign": "f = Rᵀ(a - g), with g pointing down",
    "force_sign": "change the sign of all three axes",
    "gravity_after_rotation": "f = Rᵀ(a - g): rotate after adding gravity",
    "world_frame_forces": "rotate into the body: f = Rᵀ f_world",
    "world_frame_rates": "rotate into the body: ω = Rᵀ ω_world",
    "euler_angle_rates": "of roll φ, pitch θ and yaw ψ: ω = (φ' - ψ' sin θ, θ' cos φ + "
                         "ψ' cos θ sin φ, ψ' cos θ cos φ - θ' sin φ)",
    "no_centripetal_term": "differentiate the velocity in the world's frame, then rotate",
    "lever_arm_missing": "add dω/dt × r + ω × (ω × r)",
    "noise_per_sample": "standard deviation of a sample = density · √rate",
}
# After these a simulator's numbers are not those of a sensor any more.
SPOILED = ("no_gravity", "gravity_sign", "gravity_after_rotation", "constant_channel",
           "world_frame_forces", "world_frame_rates", "euler_angle_rates", "unknown")
# These are told by what is left of the forces without gravity, from which a log without a rest
# does not tell the sensor's offset and crooked axes.
OF_ATTITUDE = ("time_step", "no_centripetal_term")
# These are wrong only while it moves, or in noise: what its rests say stands.
IN_MOTION = ("time_step", "no_centripetal_term", "lever_arm_missing", "accel_delay", "gyro_delay",
             "accel_rate_held", "gyro_rate_held", "noise_per_sample", "bias_sign")


@dataclass(frozen=True)
class Convention:
    """One finding: name; sensor accel, gyro or device; probability; nats over the healthy one;
    value {key: number} with unit and interval_90 where it has a size; words; set_to; one_of: the
    names it may be where the logs cannot tell (name is "unknown" then)."""

    name: str
    sensor: str
    probability: float
    nats: float
    words: str
    set_to: str = ""
    value: dict = field(default_factory=dict)
    unit: str = ""
    interval_90: dict = field(default_factory=dict)
    one_of: tuple = ()


def one_of(sensor, candidates, probability, nats):
    """A finding whose name the logs cannot tell."""
    known = [c for c in candidates if c != "unknown"]
    who = "the simulator" if sensor == "device" else "the simulator's " + SENSORS[sensor]
    words = "%s shows one of: %s; these logs cannot tell which" % (who, ", ".join(
        n.replace("_", " ") for n in known)) if known else "%s %s" % (who, WORDS["unknown"])
    return Convention("unknown", sensor, probability, nats, words, one_of=tuple(known))


def told(named, logs, possible, sensor_of, described):
    """[Convention] of the likeliest of several hypotheses: what each says the simulator does
    otherwise (named, () is healthy), their log probabilities (n,). Where no name is certain, one
    that may be any of those of hypotheses with more than the probability possible, of the sensor
    that sensor_of them; described: of (name, probability, nats over the healthy one)."""
    weights = special.softmax(logs)
    nats = float(logs.max() - max(v for names, v in zip(named, logs) if not names))
    findings = []
    for name in named[int(logs.argmax())]:
        probability = float(sum(w for names, w in zip(named, weights) if name in names))
        if probability >= CERTAIN:
            findings.append(described(name, probability, nats))
    quiet = float(sum(w for names, w in zip(named, weights) if not names))
    if named[int(logs.argmax())] and not findings and quiet < 1.0 - CERTAIN:
        # Where it hardly is any of those with a name, none of them is said.
        strange = sum(w for names, w in zip(named, weights) if "unknown" in names)
        candidates = set() if strange > NAMELESS else {
            n for names, w in zip(named, weights) if w > possible for n in names}
        findings.append(one_of(sensor_of(candidates), sorted(candidates), 1.0 - quiet, nats))
    return findings


def finding(name, sensor, probability, nats, set_to="", **more):
    """The Convention of a name with its sentence; set_to: what to set, else the usual words."""
    who = "the simulator" if sensor == "device" else "the simulator's " + SENSORS[sensor]
    return Convention(name, sensor, probability, nats, "%s %s" % (who, WORDS[name]),
                      set_to or SET.get(name, ""), **more)


def described(name, kind, fit, probability, nats, live):
    """The Convention with its size and what to set."""
    spread = 1.645 * fit.extra_sigma
    if name == "time_step":
        k, half = float(1.0 + fit.extra[0]), float(spread[0])
        return finding(name, kind, probability, nats, "divide what moves it by %.3g: its velocity "
                       "difference spans another time than it is divided by" % k, unit="1",
                       value={"factor": k}, interval_90={"factor": (k - half, k + half)})
    if name == "lever_arm_missing":
        value = {a: float(100.0 * v) for a, v in zip("xyz", fit.extra)}
        return finding(name, kind, probability, nats, "%s, r = (%.1f, %.1f, %.1f) cm" % (
            SET[name], *value.values()), value=value, unit="cm", interval_90={
                a: (float(100 * (v - s)), float(100 * (v + s)))
                for a, v, s in zip("xyz", fit.extra, spread)})
    if name == "constant_channel":
        dead = [a for a, row, is_live in zip("xyz", fit.axes, live) if is_live and not row.any()]
        return finding(name, kind, probability, nats, "its %s says nothing of the motion" %
                       " and ".join(dead), value=dict.fromkeys(dead, 0.0), unit="1")
    if name.endswith("_axes"):
        return other_axes(name, kind, probability, nats, fit.axes)
    if name.endswith("_mounting"):
        turn, words = sensor_axes.turn_of(fit.axes)
        return finding(name, kind, probability, nats, words, value=turn, unit="°")
    if name.endswith("_unit"):
        return other_unit(kind, probability, nats, fit.unit)
    return finding(name, kind, probability, nats)


def other_axes(name, sensor, probability, nats, axes):
    """The Convention of a sensor that reads along these axes (3, 3) of the real one's."""
    value = {a: sensor_axes.signed(row) for a, row in zip("xyz", axes)}
    return finding(name, sensor, probability, nats, "its axes are the sensor's so: " + ", ".join(
        "%s = %s" % pair for pair in value.items()), value=value, unit="axis")


def other_unit(kind, probability, nats, unit):
    """The Convention of a sensor that reads in another unit, of which so many are one."""
    return finding(kind + "_unit", kind, probability, nats, "multiply by %.5g: %s" % (
        1.0 / unit, unit_words(kind, unit)), value={"factor": float(unit)}, unit="1")


def unit_words(kind, unit):
    """What a factor between two units stands for, in words."""
    if kind == "gyro":
        return "it gives degrees where radians are expected" if unit > 1.0 else \
            "it gives radians where degrees are expected"
    return "it gives m/s² where g is expected" if unit > 1.0 else \
        "it gives g where m/s² is expected"


def merged(findings):
    """Both sensors' axes turned in the same way are one finding, of the whole device."""
    for what in ("_axes", "_mounting"):
        axes = {c.sensor: c for c in findings if c.name in ("accel" + what, "gyro" + what)}
        if len(axes) == 2 and sensor_axes.alike(*(_matrix([c], k) for k, c in axes.items())):
            accel = axes["accel"]
            findings = [c for c in findings if c not in axes.values()]
            findings.append(finding(
                "both" + what, "device", min(c.probability for c in axes.values()), sum(
                    c.nats for c in axes.values()), accel.set_to, value=accel.value,
                unit=accel.unit))
    return list(findings)


def trace_put_right(log, findings):
    """The Trace with axes, signs and units, those of its counts too, as the Conventions say they
    should be."""
    units = [_unit(findings, kind) for kind in ("accel", "gyro")]
    force = log.force @ _matrix(findings, "accel") / units[0]
    rate = None if log.rate is None else log.rate @ _matrix(findings, "gyro") / units[1]
    quantum = tuple(None if count is None else count / unit
                    for count, unit in zip(log.quantum, units))
    return replace(log, force=force, rate=rate, quantum=quantum)


def capture_put_right(log, findings):
    """The Capture likewise, a new one, or None where nothing of a sensor is left in it."""
    if any(c.name in SPOILED for c in findings):
        return None
    put_right = copy.copy(log)
    put_right.meta = dict(log.meta)
    put_right.accel = _counts(log.accel, _matrix(findings, "accel"))
    put_right.meta["accel_lsb_per_g"] *= _unit(findings, "accel")
    if log.gyro is not None:
        put_right.gyro = _counts(log.gyro, _matrix(findings, "gyro"))
        put_right.meta["gyro_lsb_per_dps"] *= _unit(findings, "gyro")
    return put_right


def only_in_motion(findings):
    """True when the log was wrong in what moves it, and the moves of it say nothing."""
    return any(c.name in IN_MOTION for c in findings)


def _counts(counts, matrix):
    """int16 (n, 3): counts along other axes; the one count without a mirror image stays."""
    if np.array_equal(matrix, np.eye(3)):
        return counts
    turned = np.rint(np.asarray(counts, dtype=np.int64) @ matrix)
    return np.clip(turned, -RAIL - 1, RAIL).astype(counts.dtype)


def _matrix(findings, kind):
    """(3, 3) by which readings (n, 3) of a sensor become the body's."""
    matrix = np.eye(3)
    for c in findings:
        if c.name in (kind + "_axes", "both_axes"):
            matrix = matrix @ sensor_axes.matrix_of(c.value)
        if c.name in (kind + "_mounting", "both_mounting"):
            matrix = matrix @ sensor_axes.mounted(c.value)
        if c.name == "force_sign" and kind == "accel":
            matrix = -matrix
    return matrix


def _unit(findings, kind):
    return float(np.prod([c.value["factor"] for c in findings if c.name == kind + "_unit"]))
