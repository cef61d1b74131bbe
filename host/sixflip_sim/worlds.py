"""A whole world from one description: clock, bus, chip, table, hand. Used by the virtual
board, the demo and the tests alike.

make({"sensor": "mpu6050", "tilt_deg": 2, "seed": 1}) is a person who does the paper's twelve
poses on a table tilted by 2°. Every key has a default, see DEFAULTS; the description is
plain JSON. An unknown key is a ValueError.
"""

import math

from sixflip import STANDARD_G
from sixflip.chips import catalogue
from sixflip_sim import noise
from sixflip_sim.bus import SimulatedI2C
from sixflip_sim.clock import VirtualClock
from sixflip_sim.operator import PAPER_ORDER, Operator
from sixflip_sim.sensor_model import SensorModel, Triad, typical_truth

_DEGREE = math.pi / 180.0

DEFAULTS = {
    "sensor": "mpu6050",        # of sixflip.chips.catalogue
    "who_am_i": None,           # None: the usual one; of the mpu6050's relative, of a clone
    "address": None,            # None: the usual one of the chip with the gyro, or ADXL345
    "magnetometer": None,       # HMC5883L, QMC5883L
    "also": None,               # a sensor: one more chip, at its usual address
    "stranger": None,           # [address, register, id]: a chip that answers no more than that
    "chip_clock_off": 0.0,      # %, of the chip with the gyro
    "seed": 1,                  # of part, noise and hand
    # the part: None is drawn from the seed; lists otherwise
    "ideal": False,             # no errors of scale, misalignment and bias
    "accel_matrix": None, "accel_bias_mg": None,
    "gyro_matrix": None, "gyro_bias_dps": None,
    "accel_noise_mg": None, "gyro_noise_dps": None,     # None: the sensor's figure
    "accel_step": 1, "gyro_step": 1,                    # counts
    # the world
    "g": STANDARD_G, "tilt_deg": 0.0, "tilt_dir_deg": 30.0, "lever_arm_m": None,
    "temperature_c": 25.0, "warm_c": 0.0, "warm_tau_s": 300.0,
    # the hand
    # None: the paper's twelve; "random"; [] lies still; or a list as in a plan file, of names
    # and of {"pose": "Z+a", "dwell_s": 5, "move_s": 10, "turn": "left"}, "up" for leaning ones
    "order": None,
    "dwell_s": 6.5, "move_s": 2.5, "first_rest_s": 8.0,
    "flip_error_deg": 0.4, "placement_scatter_deg": 0.0, "turn": "alternate",
    "tremor_mg": 0.0,           # of a box in the hand; of real ones 10 to 60 (RMS, 5 to 20 Hz)
    "mishaps": [],              # see _do
    "effects": [],              # [{"effect": "thermal_bias", "z": 0.9}], see sixflip_sim.effects
    # the bus
    "flavour": "rp2", "freq": 400000, "faults": [],
}
# Noise with the filter the drivers choose for 100 Hz, mg and °/s, where units were seen; of the
# others the data sheet's.
SEEN = {"mpu6050": (3.0, 0.05), "gy85": (4.0, 0.1), "adxl345": (4.0, 0.1)}
ORDER_KEYS = ("pose", "dwell_s", "move_s", "turn", "up")
MISHAPS = ("crooked", "missing", "quarter", "moved", "knocked", "touched", "swapped", "long")


class Truth:
    """What was put in, for judging what comes out.

    accel_matrix A, accel_bias b: measured = A·true + b, m/s²; gyro likewise, rad/s.
    flips_deg {face: turn from a to b, right-handed about the face's axis}; placements
    [pose, t0_us, t1_us]; tilt_deg.
    """


class World:
    """.clock .i2c .chips .scene .operator .model .truth .spec .end_us"""


def make(spec=None):
    """World of a description (dict)."""
    settings = dict(DEFAULTS)
    for name in spec or {}:
        if name not in DEFAULTS:
            raise ValueError("unknown key %r in a world, expected one of %s"
                             % (name, " ".join(sorted(DEFAULTS))))
        settings[name] = spec[name]
    if settings["sensor"] not in catalogue.SENSORS:
        raise ValueError("sensor is %r, expected one of %s"
                         % (settings["sensor"], " ".join(catalogue.SENSORS)))
    world = World()
    world.spec = settings
    world.clock = VirtualClock()
    world.operator = _session(settings)
    world.scene = world.operator.scene
    world.end_us = world.scene.end_us()
    world.truth = _truth(settings)
    world.truth.flips_deg = world.operator.flips_deg
    world.truth.placements = world.operator.log
    world.model = _model(settings, world)
    world.chips = _chips(settings, world.clock, world.model)
    world.i2c = SimulatedI2C(world.clock, world.chips, settings["flavour"], settings["freq"],
                             settings["faults"])
    return world


def _truth(s):
    seed = s["seed"]
    drawn = part(s["sensor"], seed)
    if s["ideal"]:
        unit = [[1.0 if i == j else 0.0 for j in range(3)] for i in range(3)]
        drawn = (unit, [0.0] * 3, unit, [0.0] * 3)
    truth = Truth()
    truth.accel_matrix = s["accel_matrix"] or drawn[0]
    truth.accel_bias = drawn[1]
    if s["accel_bias_mg"] is not None:
        truth.accel_bias = [b * 1e-3 * STANDARD_G for b in s["accel_bias_mg"]]
    truth.gyro_matrix = s["gyro_matrix"] or drawn[2]
    truth.gyro_bias = drawn[3]
    if s["gyro_bias_dps"] is not None:
        truth.gyro_bias = [b * _DEGREE for b in s["gyro_bias_dps"]]
    truth.tilt_deg = s["tilt_deg"]
    return truth


def _model(s, world):
    accel_mg, gyro_dps = usual_noise(s["sensor"])
    if s["accel_noise_mg"] is not None:
        accel_mg = s["accel_noise_mg"]
    if s["gyro_noise_dps"] is not None:
        gyro_dps = s["gyro_noise_dps"]
    truth = world.truth
    accel = Triad(truth.accel_matrix, truth.accel_bias, accel_mg * 1e-3 * STANDARD_G,
                  s["accel_step"], s["seed"], 0)
    gyro = Triad(truth.gyro_matrix, truth.gyro_bias, gyro_dps * _DEGREE, s["gyro_step"],
                 s["seed"], 3)
    effects = ()
    if s["effects"]:
        from sixflip_sim.effects import make as make_effects
        effects = make_effects(s["effects"], s["seed"])
    return SensorModel(world.scene, accel, gyro, seed=s["seed"], effects=effects)


def parts_of(sensor):
    """Names of the chips a sensor is made of."""
    return ("adxl345", "itg3205") if sensor == "gy85" else (sensor,)


def simulated(name):
    """The class of a simulated chip: in the file of its driver's name."""
    module = "sixflip_sim.chips." + catalogue.row_of(name)[1].split(".")[0]
    return __import__(module, None, None, ["SIMULATED"]).SIMULATED[name]


def usual_noise(sensor):
    """(mg, °/s) of a sample with the filters the driver chooses for 100 Hz."""
    if sensor in SEEN:
        return SEEN[sensor]
    from sixflip_sim.effects import datasheets
    return datasheets.noise(sensor, simulated(sensor).nominal_hz)


def part(sensor, seed):
    """(A, b, gyro A, gyro b) of a part of this sensor drawn from a seed."""
    if sensor in SEEN:
        return typical_truth(seed)
    from sixflip_sim.effects import datasheets
    return typical_truth(seed, **datasheets.part(sensor))


def _chips(s, clock, model):
    parts = parts_of(s["sensor"])
    chips = []
    for name in parts:
        own = name == parts[-1]     # what is said of "the chip" is said of the one with the gyro
        chips.append(_chip(name, clock, model, s["address"] if own else None,
                           s["who_am_i"] if own else None))
    for chip in chips:
        if hasattr(chip, "clock_off"):
            chip.clock_off = s["chip_clock_off"]
    for name in parts_of(s["also"]) if s["also"] else ():
        _add(chips, _chip(name, clock, model))
    if s["stranger"]:
        from sixflip_sim.chips.stranger import Stranger
        _add(chips, Stranger(clock, *s["stranger"]))
    if s["magnetometer"]:
        from sixflip_sim.chips.magnetometers import SimulatedMagnetometer
        chips.append(SimulatedMagnetometer(clock, s["magnetometer"]))
    return chips


def _chip(name, clock, model, address=None, who_am_i=None):
    row = catalogue.row_of(name)
    if not row[2]:
        raise ValueError("also is %r, expected one chip" % name)
    return simulated(name)(clock, model, address or row[2][0],
                           min(row[4]) if who_am_i is None else who_am_i)


def _add(chips, more):
    """One more chip; where there is one at its address already, the two share it."""
    for i in range(len(chips)):
        if chips[i].address == more.address:
            from sixflip_sim.chips.shared_address import SharedAddress
            chips[i] = SharedAddress(chips[i], more)
            return
    chips.append(more)


def _session(s):
    """The operator, with everything that will be done already planned."""
    order = _order(s)
    mishaps = s["mishaps"]
    for m in mishaps:
        if m.get("kind") not in MISHAPS:
            raise ValueError("mishap %r, expected a kind of %s" % (m, " ".join(MISHAPS)))
    crooked = {}
    for m in mishaps:
        if m["kind"] == "crooked":
            crooked[m["pose"][:2]] = (m.get("deg", 8.0), m.get("dir_deg", 0.0))
    operator = Operator(
        s["tilt_deg"], s["tilt_dir_deg"], s["flip_error_deg"], s["placement_scatter_deg"],
        s["seed"], s["turn"], s["move_s"], crooked=crooked,
        first_pose=order[0]["pose"] if order and order[0]["pose"][0] != "L" else "Z+a",
        scene_args={"g": s["g"], "lever_arm": s["lever_arm_m"],
                    "temperature_c": s["temperature_c"], "warm_c": s["warm_c"],
                    "warm_tau_s": s["warm_tau_s"],
                    "tremor": s["tremor_mg"] * math.sqrt(2.0) * 1e-3 * STANDARD_G})
    operator.rest(s["first_rest_s"])
    for number, asked in enumerate(order):
        pose = asked["pose"]
        here = [m for m in mishaps if m.get("pose") in (pose, pose[:2])]
        _do(operator, asked, s["dwell_s"], here, number == 0)
    return operator


def _order(s):
    order = s["order"]
    if order is None or order == "random":
        order = list(PAPER_ORDER)
        if s["order"] == "random":
            stream = noise.key(s["seed"], 0x400)
            order.sort(key=lambda pose: noise.bits(stream, PAPER_ORDER.index(pose)))
    order = [_asked(entry) for entry in order]
    for m in s["mishaps"]:
        names = [asked["pose"] for asked in order]
        if m.get("kind") == "missing":
            order = [a for a in order if m["pose"] not in (a["pose"], a["pose"][:2])]
        elif m.get("kind") == "swapped":
            i, j = names.index(m["pose"]), names.index(m["with"])
            order[i], order[j] = order[j], order[i]
    return order


def _asked(entry):
    """An entry of the order as a dict."""
    if isinstance(entry, str):
        return {"pose": entry}
    if not isinstance(entry, dict) or not isinstance(entry.get("pose"), str):
        raise ValueError("order holds %r, expected a pose's name or a dict with one" % (entry,))
    for name in entry:
        if name not in ORDER_KEYS:
            raise ValueError("unknown key %r in the order, expected one of %s"
                             % (name, " ".join(ORDER_KEYS)))
    return entry


def _do(operator, asked, dwell_s, mishaps, first):
    """One pose with what goes wrong in it. A mishap is {"kind": …, "pose": "X+a" or "X+"}:
    crooked (deg 8, dir_deg: the face is not square), missing, swapped (with), quarter (a turn
    of 90° for the flip), long (dwell_s), and at_s (3) into the rest: moved (deg 20: turned
    and left there), knocked (deg 1, likewise), touched (deg 0.5: back where it was)."""
    pose = asked["pose"]
    dwell_s = asked.get("dwell_s", dwell_s)
    turned = 180.0
    events = []
    for m in mishaps:
        if m["kind"] == "quarter":
            turned = 90.0
        elif m["kind"] == "long":
            dwell_s = m.get("dwell_s", 20.0)
        elif m["kind"] in ("moved", "knocked", "touched"):
            events.append((m.get("at_s", 3.0), m["kind"], m.get("deg")))
    if not (first and pose == operator.pose):
        operator.place(pose, asked.get("move_s"), turned, asked.get("turn"), asked.get("up"))
    done = 0.0
    for at_s, kind, deg in sorted(events):
        operator.rest(at_s - done)
        done = at_s
        if kind == "moved":
            operator.knock(20.0 if deg is None else deg, 1.0)
        elif kind == "knocked":
            operator.knock(1.0 if deg is None else deg)
        else:
            operator.touch(0.5 if deg is None else deg)
    operator.rest(dwell_s - done)
