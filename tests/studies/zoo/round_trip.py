"""The effect put back: a real sensor has one thing that the simulator lacks; the pair is
diagnosed, exported to every target, simulated again with what was exported, and diagnosed again
against the same real log. The gap before and after is that of another motion, which nothing was
fitted to.

Conventions and parameters are judged in those two layers, what a sensor has of its own (the rows
from thermal_bias on) by the whole diagnosis. A cell has the gap that is left and the verdict; "-"
stands where the file itself lists the effect as one that its target cannot express, "?" where
the diagnosis does not name it on these logs, so that no file can hold it.
"""
import argparse
import functools
import json
import sys
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import mujoco
import numpy as np

from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import comparison, simulator_answer
from sixflip_host.export import put_back

from .. import cases
from . import defects, engine, targets

DIAGNOSED, HELD_OUT = 4, 5  # seeds of the motions
RATE_HZ = 100.0
MG, DEG = 1000.0 / defects.G, 180.0 / np.pi
SKEW = np.eye(3) + [[0.012, 0.004, -0.008], [-0.005, -0.01, 0.006], [0.007, -0.003, 0.009]]


@dataclass(frozen=True)
class Effect:
    """words: how an exported file calls it; real, simulated: changes of Parts; sensors whose gap
    is shown; measure: "difference" (root mean square of simulated less real), "noise" or "step"
    (how far those are apart); arm: the real sensor sits off the simulator's point; laps that the
    box makes of its faces."""

    words: str
    real: dict = field(default_factory=dict)
    sensors: tuple = ("accel",)
    measure: str = "difference"
    simulated: dict = field(default_factory=dict)
    arm: bool = False
    laps: int = 1


def drifts(name, sensors=("accel",), times=2.0, laps=2):
    return Effect(name, {"effect": name, "times": times}, sensors, laps=laps)


BOTH = ("accel", "gyro")
EFFECTS = {
    "bias": Effect("bias", {"accel_bias": np.array([0.3, -0.25, 0.4]),
                            "gyro_bias": np.radians([1.0, -0.7, 1.5])}, BOTH),
    "scale": Effect("scale and misalignment", {"accel": SKEW, "gyro": SKEW}, BOTH),
    "noise": Effect("noise", {"accel_noise": 0.012, "gyro_noise": 3e-4}, BOTH, "noise"),
    "step": Effect("step", {"accel_step": 64}, measure="step"),
    "range": Effect("range", {"accel_range_g": 1.15}),
    "low-pass": Effect("low-pass", {}, BOTH, simulated={"low_pass_hz": 0.0}),
    "delay": Effect("delay", {"gyro_delay_s": 0.04}, ("gyro",)),
    "lever arm": Effect("lever arm", arm=True),
    "thermal_bias": drifts("thermal_bias", sensors=BOTH),
    "warm_up": drifts("warm_up"),
    # Two minutes do not tell it from a bend that the rests do not show.
    "thermal_scale": drifts("thermal_scale", times=1.0, laps=5),
    "quadratic": drifts("quadratic"),
    "cubic": drifts("cubic"),
    "asymmetry": drifts("asymmetry"),
    "vibration": Effect("vibration", {"effect": "vibration"}, measure="shake", laps=2),
    "g_sensitivity": drifts("g_sensitivity", sensors=("gyro",), times=1.0),
}


class Hand:
    """engine.Hand so many times, one after the other."""

    def __init__(self, seed, laps):
        hands = [engine.Hand(seed + 1000 * k, True) for k in range(laps)]
        self.quaternion = np.concatenate([h.quaternion for h in hands])
        self.count = len(self.quaternion)
        self.labels, position, first, place = [], [], 0, hands[0].position[0]
        for hand in hands:
            self.labels += [(name, a + first, b + first) for name, a, b in hand.labels]
            position.append(hand.position + place - hand.position[0])
            first, place = first + hand.count, position[-1][-1]
        self.position = np.concatenate(position)

    __call__ = engine.Hand.__call__


@functools.cache
def moved(seed, laps=1, arm=None, cutoff=(0.0, 0.0)):
    """The box's Motion with its sensor at arm (x, y, z), with the engine's own limits."""
    xml = engine.BOX
    if arm is not None:
        xml = xml.replace('name="arm" pos="0.04 -0.015 0.02"', 'name="arm" pos="%.9g %.9g %.9g"'
                          % arm)
    for name, limit in zip(("accelerometer", "gyro"), cutoff):
        xml = xml.replace('<%s site="arm"/>' % name, '<%s site="arm" cutoff="%.9g"/>' % (
            name, limit))
    hand = Hand(seed, laps)
    return engine.motion(mujoco.MjModel.from_xml_string(xml), hand, "arm", hand.labels)


def log(parts, motion, seed):
    """The Capture of a sensor with these Parts."""
    # Warmer and colder again: what follows the temperature is not what follows the time.
    celsius = 24.0 + 9.0 * np.sin(np.pi * motion.t / motion.t[-1]) ** 2
    text = defects.counts(parts, motion, motion.force, motion.rate, np.random.default_rng(seed),
                          RATE_HZ, celsius_all=celsius)
    return capture_file.parse("log", text.encode())


def si(capture):
    """(force (n, 3) m/s2, rate (n, 3) rad/s, celsius (n,)) of a Capture."""
    meta = capture.meta
    return (capture.accel * (defects.G / meta["accel_lsb_per_g"]),
            np.radians(capture.gyro / meta["gyro_lsb_per_dps"]),
            capture.temp / meta["temp_lsb_per_c"] + meta["temp_offset_c"])


def simulated(effect, target, seed):
    """The Capture of the simulator on a motion with what was exported to the target (None: as it
    was)."""
    target = target or targets.Target()
    at = (0.0, 0.0, 0.0) if effect.arm else None
    if target.arm is not None and np.any(target.arm):
        at = tuple(np.add(target.arm, defects.ARM if at is None else at).tolist())
    plain = log(replace(defects.Parts(), **effect.simulated),
                moved(seed, effect.laps, at, target.cutoff), 90 + seed)
    read = target.read(*si(plain), RATE_HZ, np.random.default_rng(50 + seed))
    limit = 32767
    counts = [np.clip(np.round(x * scale), -limit, limit).astype(np.int16) for x, scale in zip(
        read, (plain.meta["accel_lsb_per_g"] / defects.G, DEG * plain.meta["gyro_lsb_per_dps"]))]
    return capture_file.Capture(plain.meta, plain.t_us, *counts, plain.temp, None, plain.pose)


def real(effect, seed, noise=70):
    return log(replace(defects.Parts(), **effect.real), moved(seed, effect.laps), noise + seed)


def gap(effect, one, other):
    """{sensor: how far two Captures of one motion are apart, in mg or deg/s (a root Hz of a
    noise)}."""
    return {kind: apart(effect.measure, kind, one, other) for kind in effect.sensors}


def apart(measure, kind, one, other):
    k = BOTH.index(kind)
    a, b = si(one)[k], si(other)[k]
    unit = (MG, DEG)[k]
    if measure == "noise":
        rest = one.pose > 0
        level = [np.median(np.abs(np.diff(x[rest], axis=0))) / 0.6745 / np.sqrt(2.0 * RATE_HZ)
                 for x in (a, b)]
        return float(unit * abs(level[1] - level[0]))
    if measure == "shake":
        place = one.pose * (one.pose > 0)
        starts = np.flatnonzero(np.diff(place, prepend=0) != 0)
        level = [np.median([x[i:j].std(axis=0).max() for i, j in zip(starts, starts[1:])
                            if place[i] > 0]) for x in (a, b)]
        return float(unit * abs(level[1] - level[0]))
    if measure == "step":
        step = [np.gcd.reduce(np.abs(x.accel.astype(int) - x.accel[0].astype(int)), axis=0)
                for x in (one, other)]
        return float(np.abs(step[1] - step[0]).mean()) * 1000.0 / one.meta["accel_lsb_per_g"]
    return unit * float(np.sqrt(((b - a) ** 2).mean()))


@dataclass(frozen=True)
class Row:
    """gap {sensor: ...} before, of noise alone; after {target: (verdict, gap), or None where its
    file says that it cannot express the effect}; verdict and names said before; named: the effect
    was, and can be put back; left: what the diagnosis found and no file holds."""

    before: dict
    noise: dict
    after: dict
    verdict: str
    names: tuple
    named: bool
    left: tuple


def answered(pair):
    """Row of (name of an effect, names of targets)."""
    name, wanted = pair
    effect = EFFECTS[name]
    mine, held = real(effect, DIAGNOSED), real(effect, HELD_OUT)
    said = judged(effect, mine, simulated(effect, None, DIAGNOSED))
    after, holds = {}, put_back.from_diagnosis(said)
    named = any(effect.words in one for one in holds.holds)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "gap.json"
        file.write_text(json.dumps(said), encoding="utf-8")
        for to in wanted:
            out = Path(folder) / ("put_back." + to)
            if cli.main(["export", str(file), "--to", to, "-o", str(out)]):
                raise RuntimeError("the export to %s failed" % to)
            text = out.read_text(encoding="utf-8")
            cannot = any(effect.words in one for one in targets.cannot(text))
            after[to] = again(effect, targets.TARGETS[to](text), mine, held) \
                if named and not cannot else None
    return Row(gap(effect, held, simulated(effect, None, HELD_OUT)),
               gap(effect, held, real(effect, HELD_OUT, 30)), after, said["verdict"],
               tuple(c["effect"] or " or ".join(c["class"]) for c in said["causes"]),
               named, holds.left)


def judged(effect, mine, sim):
    """The answer of a diagnosis; of its first two layers where the effect is in them."""
    if effect.laps > 1:
        return answer.as_dict(diagnose([("real.csv", mine)], [("sim.csv", sim)]))
    found = comparison.compare([("real.csv", mine)], "sim.csv", sim)
    return {"verdict": simulator_answer.verdict("no gap", [found]), "causes": [],
            "simulator": simulator_answer.as_json([found])}


def again(effect, target, mine, held):
    """(verdict, gap held out) of the simulator with what was exported."""
    after = judged(effect, mine, simulated(effect, target, DIAGNOSED))
    return after["verdict"], gap(effect, held, simulated(effect, target, HELD_OUT))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--effects", default=",".join(EFFECTS), metavar="NAME,…")
    parser.add_argument("--targets", default=",".join(targets.TARGETS), metavar="NAME,…")
    cases.add_arguments(parser)
    args = parser.parse_args()
    names = args.effects.split(",")
    wanted = args.targets.split(",")
    started = time.monotonic()
    rows = cases.done(answered, [(name, wanted) for name in names], cases.target(args),
                      "round trip", take=lambda row: print(row, file=sys.stderr))
    failed = show(dict(zip(names, rows)), wanted)
    print("%.0f s" % (time.monotonic() - started))
    return 1 if failed else 0


def show(rows, wanted):
    """Prints the table; the number of cells whose verdict is not "no gap"."""
    failed = 0
    line = "%-22s %-8s %8s %8s  " + " ".join(["%-9s"] * len(wanted))
    print((line % ("effect", "unit", "before", "noise", *wanted)).rstrip())
    for name, row in rows.items():
        for kind in EFFECTS[name].sensors:
            unit = ("mg" if kind == "accel" else "°/s") + (
                "/√Hz" if EFFECTS[name].measure == "noise" else "")
            nothing = "-" if row.named else "?"
            cells = [nothing if cell is None else "%.3g%s" % (
                round(cell[1][kind], 9), "" if cell[0] == "no gap" else " !")
                for cell in (row.after[one] for one in wanted)]
            print((line % (name, unit, "%.3g" % row.before[kind], "%.3g" % row.noise[kind],
                           *cells)).rstrip())
        wrong = ["%s %s" % (to, cell[0]) for to, cell in row.after.items()
                 if cell and cell[0] != "no gap"]
        failed += len(wrong)
        if wrong or row.left or not row.named:
            print("  said before: %s %s; in no file: %s; after: %s" % (
                row.verdict, ", ".join(row.names), ", ".join(row.left) or "nothing",
                ", ".join(wrong) or "no gap"))
    print("! another verdict than no gap; -: the file says that its target cannot express it; ?: "
          "not named on these logs")
    return failed


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
