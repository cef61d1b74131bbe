"""The scenario file of `sixflip simulate`, in TOML, and the worlds it describes.

    sensor = "mpu6050"        # or any other of sixflip.chips.catalogue
    scene = "recommended"     # paper return random backward thermal recommended soak
                              # turntable drive, or plan = "session.json"
    seed = 1
    rate_hz = 100
    flicker = true            # slow noise of the size typical for the sensor; false: white only
    touch_every = 0           # every so manieth pose somebody touches the box

    [world]                   # any key of sixflip_sim.worlds.DEFAULTS: part, table, hand, noise
    tilt_deg = 1.5
    placement_scatter_deg = 0.05

    [[effects]]               # any canonical effect, as often as wanted
    effect = "thermal_bias"
    sensor = "accel"
    x = 0.5                   # mg/degC

Each session becomes one description of a world, plain JSON, which the virtual board runs too.
"""
import math

from sixflip import STANDARD_G
from sixflip.chips import catalogue
from sixflip_sim import worlds
from sixflip_sim.effects import typical
from sixflip_sim.effects.library import NAMES
from sixflip_sim.effects.library import make as make_effect

from ..did_you_mean import instead
from ..errors import BadFile
from ..planning import plan_file, protocols
from .scenario_checks import check_world, known, number

try:
    import tomllib
except ImportError:  # Python 3.10
    import tomli as tomllib

KEYS = ("sensor", "scene", "plan", "seed", "rate_hz", "session_s", "touch_every", "flicker",
        "world", "effects")
LARGEST = 1 << 14       # bytes; reading a.a.a.a ... takes the square of its length
MOVING = ("turntable", "drive")
SCENES = protocols.NAMES
NUMBERS = {"seed": (0, 2 ** 30, True), "rate_hz": (1, 1000, False),
           "session_s": (1, 200000, False), "touch_every": (0, 1000, True)}


class Scenario:
    """sensor, rate_hz, seed, effects (specs), scene (name), worlds: a world's spec a session,
    rest_s: stillness at the end of each, moving: "turntable", "drive" or "", seconds."""

    def __init__(self, sensor, rate_hz, seed, effects, scene, specs, rest_s, seconds):
        self.sensor, self.rate_hz, self.seed = sensor, rate_hz, seed
        self.effects, self.scene, self.worlds = effects, scene, specs
        self.rest_s, self.seconds = rest_s, seconds
        self.moving = scene if scene in MOVING else ""


def read(path):
    """The Scenario in a file; BadFile names the file and what was expected."""
    try:
        with open(path, "rb") as stream:
            text = stream.read(LARGEST + 1)
        if len(text) > LARGEST:
            raise BadFile("%s: more than %d KB, expected a scenario" % (path, LARGEST >> 10))
        content = tomllib.loads(text.decode("utf-8"))
    except OSError as error:
        raise BadFile("%s: %s" % (path, error.strerror)) from None
    except (ValueError, RecursionError) as error:
        raise BadFile("%s: not TOML: %s" % (path, str(error).replace("\n", " "))) from None
    try:
        return from_dict(content)
    except BadFile:
        raise
    except ValueError as error:
        raise BadFile("%s: %s" % (path, error)) from None


def from_dict(content):
    """The Scenario that a dict describes; ValueError says what was expected."""
    known(content, KEYS, "scenario")
    numbers = {"seed": 1, "rate_hz": 100, "session_s": 300, "touch_every": 0}
    for key, (low, high, whole) in NUMBERS.items():
        numbers[key] = number(content.get(key, numbers[key]), low, high, key, whole)
    sensor = content.get("sensor", "mpu6050")
    if not isinstance(sensor, str) or sensor not in catalogue.SENSORS:
        raise ValueError("sensor is %r, %s" % (sensor, instead(str(sensor), catalogue.SENSORS)))
    effects = content.get("effects", [])
    if not isinstance(effects, list):
        raise ValueError("effects is %r, expected [[effects]] tables" % (effects,))
    for spec in effects:
        name = spec.get("effect") if isinstance(spec, dict) else None
        if isinstance(name, str) and name not in NAMES:
            raise ValueError("unknown effect %r, %s" % (name, instead(name, NAMES)))
        make_effect(spec)
    flicker = content.get("flicker", True)
    if not isinstance(flicker, bool):
        raise ValueError("flicker is %r, expected true or false" % (flicker,))
    world = check_world(content.get("world", {}))
    _same_part(world, sensor, numbers["seed"])
    scene = content.get("scene", "plan" if "plan" in content else "paper")
    common = dict(world, sensor=sensor)
    slow = slow_noise(sensor) if flicker else []
    if scene in MOVING:
        spec = dict(common, seed=numbers["seed"], order=[], effects=effects + slow)
        return Scenario(sensor, numbers["rate_hz"], numbers["seed"], effects, scene, [spec],
                        0.0, numbers["session_s"])
    if "plan" in content:
        if not isinstance(content["plan"], str):
            raise ValueError("plan is %r, expected the name of a plan file" % (content["plan"],))
        if not isinstance(content["plan"], str) or "\0" in content["plan"]:
            raise ValueError("plan is %r, expected the name of a file" % (content["plan"],))
        protocol = plan_file.read(content["plan"])
    elif isinstance(scene, str) and scene in SCENES:
        protocol = protocols.named(scene, numbers["seed"] + 6)
    else:
        raise ValueError("scene is %r, %s" % (scene, instead(scene, SCENES)))
    specs = [_session(session, k, common, numbers) for k, session in
             enumerate(protocol.sessions)]
    for spec in specs:
        spec["effects"] = effects + [dict(e, seed=spec["seed"] % 2 ** 30) for e in slow]
    rest = protocol.sessions[0].rest_s
    return Scenario(sensor, numbers["rate_hz"], numbers["seed"], effects, scene, specs, rest, 0.0)


def _same_part(world, sensor, seed):
    """One and the same sensor in every session: what is not given is drawn from the seed."""
    if world.get("ideal"):
        return
    drawn = worlds.part(sensor, seed)
    world.setdefault("accel_matrix", drawn[0])
    world.setdefault("accel_bias_mg", [b / STANDARD_G * 1000.0 for b in drawn[1]])
    world.setdefault("gyro_matrix", drawn[2])
    world.setdefault("gyro_bias_dps", [math.degrees(b) for b in drawn[3]])


def slow_noise(sensor):
    """Specs of the drift effects that every real part has, accelerometer and gyro."""
    specs = []
    for kind in ("accel", "gyro"):
        if sensor == "adxl345" and kind == "gyro":
            continue
        floor = typical.FLOOR[typical.chip_of(sensor, kind)]
        specs.append({"effect": "drift", "sensor": kind, "x": floor, "y": floor, "z": floor})
    return specs


def _session(session, number, common, numbers):
    """The description of the world of one session of a protocol."""
    spec = dict(common)
    rests = session.rests
    spec["seed"] = numbers["seed"] + number * 1000
    spec.setdefault("placement_scatter_deg", 0.05)
    spec.setdefault("dwell_s", rests[0].dwell_s)
    spec.setdefault("move_s", max(0.1, rests[0].move_s))
    spec.setdefault("first_rest_s", max(session.rest_s, 5.0))
    # T(t) = start + change (1 - exp(-t / tau)) is end - change exp(-t / tau)
    spec.setdefault("temperature_c", session.start_c + session.change_c)
    spec.setdefault("warm_c", session.change_c)
    spec.setdefault("warm_tau_s", session.tau_s)
    spec.setdefault("turn", rests[0].turn)
    spec["order"] = [_entry(rest, spec, common) for rest in rests]
    every = numbers["touch_every"]
    spec["mishaps"] = [{"kind": "touched", "pose": pose, "at_s": 0.5 * spec["dwell_s"]}
                       for pose in sorted({r.pose for r in rests[::every]})] if every else []
    return spec


def _entry(rest, spec, common):
    """A rest in the order of a world: its name, and what is not as in the rest of the session.
    What the [world] table says holds for all."""
    entry = {"pose": rest.pose}
    for key, value in (("dwell_s", rest.dwell_s), ("move_s", max(0.1, rest.move_s)),
                       ("turn", rest.turn)):
        if key not in common and value != spec[key]:
            entry[key] = value
    if rest.leaning:
        entry["up"] = list(rest.up)
    return entry if len(entry) > 1 else rest.pose
