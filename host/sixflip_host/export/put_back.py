"""What a diagnosis found against a simulator, as one sensor to put behind that simulator.

Everything is what the real sensor has beyond the simulator: it is applied to the simulator's own
forces and rates, once their conventions are right.
"""
import json
from dataclasses import dataclass, field

import numpy as np

from sixflip import STANDARD_G as G

from ..capture.registers import SENSORS
from ..errors import BadFile, UsageError
from ..experiment.low_pass import FIRST_ORDER, LowPass
from ..experiment.terms import of_the_moment

DEG = np.pi / 180.0
MARK = "put back by sixflip export"  # in every file that is made from a diagnosis
AXES = "xyz"
# How a value of an effect becomes SI units where it is not mg or deg/s.
PERCENT = {("thermal_scale", "accel"), ("thermal_scale", "gyro"), ("asymmetry", "gyro")}
# effects that the generated class can express
BY_KIND = {kind: (*of_the_moment(kind), "vibration") for kind in SENSORS}


@dataclass(frozen=True)
class Added:
    """An effect of the library: values {key: size}, m/s2 or rad/s where the library has mg or
    deg/s, and a fraction where it has %; shape, its parameters that do not enter linearly; hz
    (3,) of a steady line."""

    values: dict
    shape: dict = field(default_factory=dict)
    hz: tuple = ()

    def vector(self):
        """(3,) of an effect with one size an axis."""
        return np.array([self.values.get(a, 0.0) for a in AXES])


@dataclass(frozen=True)
class Triad:
    """One sensor in SI units: read = matrix · true + bias; noise density (3,) per root Hz; step
    (3,) and limit (3,), 0 and inf for none; lag_s: the time constant of its low-pass; delay_s;
    effects {name: Added}."""

    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    noise: np.ndarray = field(default_factory=lambda: np.zeros(3))
    step: np.ndarray = field(default_factory=lambda: np.zeros(3))
    limit: np.ndarray = field(default_factory=lambda: np.full(3, np.inf))
    lag_s: float = 0.0
    delay_s: float = 0.0
    effects: dict = field(default_factory=dict)


@dataclass(frozen=True)
class PutBack:
    """accel and gyro (Triad); lever (3,) m from the simulator's point to the sensor; rate_hz;
    reference_c; first: sentences on conventions that have to be put right before; instead:
    sentences on names that stand for a class; left: what was found and is not in here."""

    accel: Triad
    gyro: Triad
    lever: np.ndarray
    rate_hz: float
    reference_c: float
    first: tuple = ()
    instead: tuple = ()
    left: tuple = ()

    @property
    def holds(self):
        """Names of what is in here beyond the matrices and biases."""
        names = []
        for kind, triad in zip(SENSORS.values(), (self.accel, self.gyro)):
            names += ["%s of the %s" % (name, kind) for name, there in (
                ("scale and misalignment", (triad.matrix != np.eye(3)).any()),
                ("bias", triad.bias.any()), ("noise", triad.noise.any()),
                ("step", triad.step.any()), ("range", np.isfinite(triad.limit).any()),
                ("low-pass", triad.lag_s > 0), ("delay", triad.delay_s > 0)) if there]
            names += ["%s of the %s" % (name, kind) for name in triad.effects]
        return names + (["lever arm"] if self.lever.any() else [])


def read(path):
    """PutBack of the answer that `diagnose --json` printed; BadFile for anything else."""
    try:
        with open(path, encoding="utf-8") as file:
            answer = json.load(file)
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise BadFile("%s: %s, expected the JSON of sixflip diagnose --json" % (
            path, getattr(error, "strerror", None) or error)) from None
    if not isinstance(answer, dict) or "verdict" not in answer:
        raise BadFile("%s: no diagnosis, expected the JSON of sixflip diagnose --json" % path)
    if "simulator" not in answer:
        raise UsageError("%s: a diagnosis without a simulator, expected one made with --sim"
                         % path)
    try:
        return from_diagnosis(answer)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise BadFile("%s: damaged (%s), expected the JSON of sixflip diagnose --json" % (
            path, error)) from None


def from_diagnosis(answer):
    """PutBack of an answer."""
    simulator = answer["simulator"]
    numbers = simulator["parameters"]
    rate = ((numbers.get("device") or {}).get("rate") or {}).get("all") or {}
    passes = {k: low_pass(numbers.get(k, {})) for k in SENSORS}
    lags = {k: one.seconds if one and one.of == "real" and one.form == FIRST_ORDER else 0.0
            for k, one in passes.items()}
    kept = {k: one for k, one in passes.items() if one and not lags[k]}
    delays, lever, first = relative_delay(numbers, kept), np.zeros(3), []
    left = ["%s (%s)" % (one.words, k) for k, one in kept.items()]
    for c in simulator["conventions"]:
        if c["name"] == "lever_arm_missing":
            lever = np.array([c["value"][a] for a in AXES]) / 100.0
        elif c["name"] in ("gyro_delay", "accel_delay"):
            first.append("%s: %s" % (c["words"], c["set"]))
        else:
            first.append("%s%s" % (c["words"], ": " + c["set"] if c["set"] else ""))
    first += narrow(numbers)
    effects, instead = {"accel": {}, "gyro": {}}, []
    paired = {(e["sensor"], tuple(e["class"])): e for e in simulator.get("effects", [])}
    for cause in answer["causes"]:
        kind, names = cause["sensor"], cause["class"]
        # Two logs of one motion say the size beside the parameters, and which of a class.
        sized = paired.get((kind, tuple(names)), {**cause, "effect": cause.get(
            "value_of", cause["effect"])})
        name = sized["effect"] if cause["plausible"] else None
        if name not in BY_KIND.get(kind, ()) or name in effects[kind] or not whole(name, sized):
            left.append("%s (%s)" % (cause["effect"] or " or ".join(names), kind))
            continue
        effects[kind][name] = added(name, kind, sized)
        if len(names) > 1:
            instead.append("%s of the %s may as well be %s: these logs do not tell them apart" % (
                name, SENSORS[kind], " or ".join(n for n in names if n != name)))
    left += ["%s (%s)" % (name.replace("_", " "), kind) for kind in SENSORS for name in (
        "shaking", "fast_noise") if any(p["differs"] for p in numbers.get(kind, {}).get(
            name, {}).values())]
    accel, gyro = (triad(kind, numbers.get(kind, {}), effects[kind], lags[kind], delays[kind],
                         float(rate.get("real") or 100.0)) for kind in ("accel", "gyro"))
    # Slopes are about the temperature that the diagnosis took them about, and biases beside them.
    about = [one.shape["reference_c"] for side in (accel, gyro)
             for one in side.effects.values() if "reference_c" in one.shape]
    return PutBack(accel, gyro, lever, float(rate.get("real") or 100.0),
                   about[0] if about else float(simulator.get("reference_c") or 25.0),
                   tuple(first), tuple(instead), tuple(left))


def whole(name, cause):
    """Whether all is there that an effect is made of: a shake at no steady frequency is no line,
    and a warming-up without its time constant no course."""
    return bool(cause.get("hz")) if name == "vibration" else (
        name != "warm_up" or "tau_s" in cause.get("shape", {}))


def narrow(numbers):
    """Sentences on ranges and steps that nothing behind the simulator can take back."""
    said = []
    for kind, who in SENSORS.items():
        stops = [a for a, p in numbers.get(kind, {}).get("range", {}).items()
                 if p["differs"] and p["simulator"] is not None and p["difference"] > 0]
        if stops:
            said.append("the simulator's %s stops short on %s, where the real one goes on: set "
                        "its range" % (who, " and ".join(stops)))
        coarse = [a for a, p in numbers.get(kind, {}).get("step", {}).items()
                  if p["differs"] and p["difference"] < 0]
        if coarse:
            said.append("the simulator's %s has coarser steps on %s than the real one: set its "
                        "step" % (who, " and ".join(coarse)))
    return said


def added(name, kind, cause):
    """Added of a cause."""
    unit = 0.01 if (name, kind) in PERCENT else G / 1000.0 if kind == "accel" else DEG
    return Added({key: unit * float(value) for key, value in cause["value"].items()},
                 {key: float(value) for key, value in cause.get("shape", {}).items()},
                 tuple(float(cause["hz"].get(a) or 0.0) for a in AXES) if "hz" in cause else ())


def triad(kind, named, effects, lag_s, delay_s, rate_hz):
    """Triad of the parameters that differ."""
    unit = G / 1000.0 if kind == "accel" else DEG
    matrix = np.eye(3)
    for name, size in (("scale", 0.01), ("misalignment", DEG)):
        for axis, p in named.get(name, {}).items():
            if p["differs"]:
                matrix[AXES.index(axis[0]), AXES.index(axis[-1])] += p["difference"] * size
    # One axis whose noise differs is enough: the others' is measured as well as that one's.
    densities = named.get("noise_density", {})
    noisy = any(p["differs"] for p in densities.values())
    bias, noise, step, limit = np.zeros(3), np.zeros(3), np.zeros(3), np.full(3, np.inf)
    for i, axis in enumerate(AXES):
        for name, values in (("bias", bias), ("step", step), ("range", limit)):
            p = named.get(name, {}).get(axis)
            wanted = p and p["differs"] and p["difference" if name == "bias" else "real"]
            if wanted:
                values[i] = unit * wanted
        p = densities.get(axis)
        if p and noisy:
            noise[i] = unit * np.sqrt(max(p["real"] ** 2 - p["simulator"] ** 2, 0.0))
    return Triad(matrix, bias, noise, step, limit, lag_s, delay_s, effects)


def low_pass(named):
    """The LowPass that one of the two has and the other has not, or None."""
    p = named.get("smoothness", {}).get("all")
    return LowPass.of_half_square(-1e-6 * p["difference"], p.get("form", FIRST_ORDER)) \
        if p and p["differs"] else None


def relative_delay(numbers, kept):
    """{sensor: s}: the sensor to delay so that gyro and accelerometer lie as in the real one; kept
    {sensor: LowPass}: those that are not put right in here, whose delay has to be all the same."""
    p = numbers.get("gyro", {}).get("delay", {}).get("all")
    wanted = 1e-3 * p["difference"] if p and p["differs"] else 0.0
    late = {kind: kept[kind].late_s if kind in kept else 0.0 for kind in SENSORS}
    wanted -= late["gyro"] - late["accel"]
    return {"gyro": max(wanted, 0.0), "accel": abs(min(wanted, 0.0))}


def header(sensor, comment, cannot):
    """Lines that say where it comes from, what must be right first, what is not in it."""
    lines = ["%s: what the real sensor has beyond the simulator, at %g Hz" % (
        MARK, sensor.rate_hz)]
    lines += ["first: " + words for words in sensor.first]
    lines += ["holds: " + (", ".join(sensor.holds) or "nothing: the two did not differ")]
    lines += ["this target cannot express: " + ", ".join(cannot)] if cannot else []
    lines += list(sensor.instead)
    lines += ["found, and not in here: " + ", ".join(sensor.left)] if sensor.left else []
    return "".join("%s %s\n" % (comment, line.replace("--", "-")) for line in lines)
