"""Which cases a blind run is made of: suites, each a list of specifications from a seed."""

import numpy as np

from .generator.case import Specification
from .generator.held_out import HELD_OUT
from .generator.library import KNOWN
from .generator.strangers import STRANGERS

SIZES = (0.3, 1.0, 3.0)
POWER_SIZES = (0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0)
POWER = [("thermal_bias", "accel"), ("g_sensitivity", "gyro"), ("cubic", "accel"),
         ("creep", "accel"), ("thermal_bias", "gyro")]
PAIRS = [("thermal_bias", "accel"), ("thermal_bias", "gyro"), ("g_sensitivity", "gyro"),
         ("creep", "accel"), ("cubic", "accel"), ("warm_up", "accel"), ("warm_up", "gyro"),
         ("quantisation", "accel"), ("sample_rate", "device"), ("vibration", "accel"),
         ("asymmetry", "gyro"), ("thermal_scale", "accel"), ("dropped_samples", "device"),
         ("drift", "gyro")]
# Without rows that jump about, or they are all that is seen.
LEFT_OUT = [("thermal_bias", "accel"), ("thermal_bias", "gyro"), ("g_sensitivity", "gyro"),
            ("creep", "accel"), ("cubic", "accel"), ("warm_up", "gyro"), ("asymmetry", "gyro"),
            ("thermal_scale", "accel"), ("vibration", "accel"), ("drift", "accel")]
PAPER = [("thermal_bias", "accel"), ("quadratic", "accel"), ("cubic", "accel"),
         ("asymmetry", "accel"), ("hysteresis", "accel"), ("creep", "accel"),
         ("local_gravity", "accel"), ("warm_up", "accel"), ("drift", "accel"),
         ("axis_swap", "gyro"), ("saturation", "accel"), ("g_sensitivity", "gyro"),
         ("thermal_scale", "accel"), ("vibration", "accel"), ("supply", "gyro")]
SHARE = [("thermal_bias", "accel"), ("thermal_bias", "gyro"), ("g_sensitivity", "gyro"),
         ("cubic", "accel"), ("warm_up", "gyro"), ("asymmetry", "gyro"), ("creep", "accel"),
         ("thermal_scale", "accel")]
KNOWN_PAIRS = [(name, sensor) for name, (_, sensors) in KNOWN.items() for sensor in sensors]

# Parts of a run of all suites.
SHARES = {"null": 20, "single": 38, "pair": 8, "stranger": 15, "held out": 9, "left out": 4,
          "paper": 6, "power": 6, "share": 7}


def chip_of(rng):
    return "gy85" if rng.random() < 0.3 else "mpu6050"


def seed_of(rng):
    return int(rng.integers(2 ** 31))


def null(rng, count):
    """No effect: several chips and protocols; half the boxes crooked, some hands careless."""
    out = []
    for number in range(count):
        protocol = rng.choice(["recommended", "recommended", "recommended", "paper", "one session",
                               "rest"])
        no_labels = protocol != "rest" and rng.random() < 0.1
        habits = {"box_tilt_deg": 0.1 * (number % 2), "free_heading": bool(rng.random() < 0.2),
                  "touches": 0.1 * bool(rng.random() < 0.3)}
        out.append(Specification(
            seed_of(rng), chip_of(rng), str(protocol), habits=habits,
            new_gyro_offset=bool(rng.random() < 0.3), no_thermometer=bool(rng.random() < 0.1),
            no_labels=bool(no_labels)))
    return out


def _specification(rng, effects, **more):
    habits = {"box_tilt_deg": 0.0, "free_heading": bool(rng.random() < 0.2)}
    protocol = "recommended"
    if any(name in ("lever_arm", "filter_lag") for name, _, _ in effects):
        protocol = "driving"
    if len(effects) == 1 and effects[0][0] == "drift" and rng.random() < 0.3:
        protocol = "rest"
    return Specification(seed_of(rng), more.pop("chip", None) or chip_of(rng),
                         more.pop("protocol", protocol), effects, habits, **more)


def _spread(rng, things, count):
    """count things: whole rounds of all of them, each in random order."""
    out = []
    while len(out) < count:
        out += [things[k] for k in rng.permutation(len(things))]
    return out[:count]


def single(rng, count):
    things = [(*pair, size) for pair in KNOWN_PAIRS for size in SIZES]
    return [_specification(rng, [thing]) for thing in _spread(rng, things, count)]


def pair(rng, count):
    out = []
    while len(out) < count:
        first, second = (PAIRS[k] for k in rng.permutation(len(PAIRS))[:2])
        out.append(_specification(rng, [(*first, 1.0), (*second, 1.0)]))
    return out


def _families(rng, families, count, sizes):
    things = [(name, sensor, size) for name, (_, sensors) in families.items()
              for sensor in sensors for size in sizes]
    return [_specification(rng, [thing]) for thing in _spread(rng, things, count)]


def stranger(rng, count):
    return _families(rng, STRANGERS, count, SIZES)


def held_out(rng, count):
    return _families(rng, HELD_OUT, count, SIZES)


def left_out(rng, count):
    """A known effect with its name taken out of the library."""
    return [_specification(rng, [(*thing, 2.0)], options=["--without", thing[0]])
            for thing in _spread(rng, LEFT_OUT, count)]


def paper(rng, count):
    """The paper's 12 poses: little can be told, and that must be said."""
    return [_specification(rng, [(*thing, 1.0)], protocol="paper")
            for thing in _spread(rng, PAPER, count)]


def power(rng, count):
    things = [(*thing, size) for thing in POWER for size in POWER_SIZES]
    return [_specification(rng, [thing], chip="mpu6050")
            for thing in _spread(rng, things, count)]


def share(rng, count):
    """How far the gap shrinks, each case with a twin that has its noise and no effect."""
    things = [(*thing, size) for thing in SHARE for size in SIZES]
    return [_specification(rng, [thing], twin=True) for thing in _spread(rng, things, count)]


SUITES = {"null": null, "single": single, "pair": pair, "stranger": stranger,
          "held out": held_out, "left out": left_out, "paper": paper, "power": power,
          "share": share}


def specifications(seed, count, suites):
    """[(suite, Specification)], about `count` of them, in random order."""
    chosen = {name: SHARES[name] for name in suites}
    out = []
    for number, name in enumerate(SUITES):
        if name in chosen:
            rng = np.random.default_rng([seed, number])
            share = max(1, round(count * chosen[name] / sum(chosen.values())))
            out += [(name, spec) for spec in SUITES[name](rng, share)]
    order = np.random.default_rng([seed, 99]).permutation(len(out))
    return [out[k] for k in order]
