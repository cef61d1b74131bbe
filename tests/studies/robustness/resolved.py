"""Does the one capture that is recommended resolve the ambiguity it is recommended for?

    python -m tests.studies.robustness.resolved [--seeds 6] [--jobs 2]

A case with one effect of the blind generator is diagnosed on a protocol that leaves it in a
class. The first entry of `next` is then made: the same part, box and effect, another session,
and all are diagnosed again. Resolved: the effect alone is named, or the class no longer holds
any of the rivals that the capture was to tell apart. Exits with 1 below 90 %.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

from .. import cases
from ..blind.generator import protocols
from ..blind.generator.case import Case, Specification
from ..blind.generator.hand import FACES
from . import ask

TARGET = 0.9
# (effect, sensor, size, protocol) that at least now and then end in a class
AMBIGUOUS = [("thermal_bias", "accel", 3.0, "recommended"),
             ("thermal_bias", "gyro", 3.0, "recommended"),
             ("thermal_bias", "accel", 3.0, "one session"),
             ("thermal_bias", "gyro", 3.0, "one session"),
             ("warm_up", "accel", 3.0, "one session"),
             ("warm_up", "gyro", 3.0, "one session"),
             ("thermal_rate", "gyro", 3.0, "one session"),
             ("creep", "accel", 3.0, "recommended"),
             ("hysteresis", "accel", 3.0, "recommended"),
             ("hysteresis", "accel", 3.0, "one session")]


class Recipe:
    """How the generator makes a recommended capture: poses, thermal state, seconds of rest."""

    def __init__(self, poses, state, rest_s=None):
        self.poses, self.state, self.rest_s = poses, state, rest_s

    def session(self, rng, scene):
        """(Path, Warmth) of one more session by the same hand in the same box."""
        usual = scene.habits.rest_s
        if self.rest_s:
            scene.habits.rest_s = (0.95 * self.rest_s, 1.05 * self.rest_s)
        scene.new_table()
        made = scene.path(self.poses(rng), 10.0), self.state(rng)
        scene.habits.rest_s = usual
        return made


class Heated:
    """Warm start, then heated by a hair dryer and left to cool halfway through the session."""

    def __init__(self, rng):
        self.base, self.rise = rng.uniform(22, 28), rng.uniform(8, 14)
        self.tau, self.turn = rng.uniform(60, 120), rng.uniform(130, 170)

    def at(self, t):
        up = 1 - np.exp(-t / self.tau)
        peak = 1 - np.exp(-self.turn / self.tau)
        down = peak * np.exp(-np.maximum(t - self.turn, 0) / self.tau)
        return self.base + self.rise * np.where(t < self.turn, up, down)


def warm(rng):
    """Started warm: the last two degrees."""
    high = rng.uniform(30, 34)
    return protocols.Warmth(high - 2.0, high, rng.uniform(150, 250), 50.0, 0.0)


def fixed(rng):
    return [face + which for face in FACES for which in "ab"]


def leaning(rng):
    return protocols.twelve(rng) + ["L%d" % (k + 1) for k in range(12)]


def there_and_back(rng):
    order = fixed(rng)
    return order + order[::-1]


def seven(rng):
    return [face + "a" for face in FACES] + ["Z+b"]


def twice(rng):
    return protocols.twelve(rng) + protocols.twelve(rng)


# By the words of `next`; a recommendation that nobody here knows how to follow is an error.
RECIPES = {"one cooling session, 12 poses": Recipe(protocols.twelve, protocols.cooling),
           "one session started warm, 12 poses": Recipe(protocols.twelve, warm),
           "12 poses, then the same backward": Recipe(there_and_back, warm),
           "12 poses in random order": Recipe(protocols.twelve, warm),
           "12 poses and 12 leaning ones": Recipe(leaning, warm),
           "7 poses with a minute of rest on each": Recipe(seven, warm, 60.0),
           # the generator's motor runs on and off by itself
           "12 poses with the vibration on": Recipe(protocols.twelve, warm),
           "12 poses twice, the box warmed (hair dryer) and left to cool halfway":
           Recipe(twice, Heated)}


class Longer(Case):
    """A case with one session more than its protocol has."""

    def __init__(self, spec, recipe):
        self.recipe = recipe
        super().__init__(spec)
        scene = self.scene_again()
        self.sessions = [*self.sessions, recipe.session(
            np.random.default_rng([spec.seed, 7]), scene)]
        offsets = self.part["gyro_offset"]
        self.part["gyro_offset"] = np.vstack([offsets, offsets[-1]])

    def scene_again(self):
        """The box of the case: the generator draws it from the seed first of all."""
        from ..blind.generator.hand import Habits, Scene
        rng = np.random.default_rng([self.spec.seed, 0])
        habits = dict(table_tilt_deg=abs(rng.normal(0, 1.0)), flip_error_deg=rng.uniform(0.2, 1.0))
        habits.update(self.spec.habits)
        return Scene(np.random.default_rng([self.spec.seed, 1]), Habits(**habits))


def ambiguous(answer, effect, sensor):
    """The class that holds the effect and others besides, or None."""
    for cause in answer["causes"]:
        if cause["sensor"] == sensor and effect in cause["class"] and len(cause["class"]) > 1:
            return cause["class"]
    return None


def outcome(answer, effect, sensor, rivals):
    """"resolved", "right class" (still open), "lost" (no longer there) or "wrong"."""
    mine = [c for c in answer["causes"] if c["sensor"] == sensor]
    for cause in mine:
        if effect in cause["class"]:
            return "right class" if rivals & set(cause["class"]) else "resolved"
    return "wrong" if any(c["effect"] for c in mine) else "lost"


def tried(job):
    """(job, class before, recommended words, outcome), the last None where nothing was open."""
    effect, sensor, times, protocol, seed = job
    spec = Specification(seed, "mpu6050", protocol, [(effect, sensor, times)],
                         {"box_tilt_deg": 0.0})
    with tempfile.TemporaryDirectory() as folder:
        first = ask.on_files(Case(spec).write(str(Path(folder) / "first")), "--jobs", "1")
        names = ambiguous(first, effect, sensor)
        if names is None:
            return job, None, None, None
        wanted = [(n, {r for pair in n["resolves"] if effect in pair for r in pair} - {effect})
                  for n in first["next"]]
        wanted = [(n, rivals) for n, rivals in wanted if rivals]
        if not wanted:
            return job, names, "(nothing recommended)", "none"
        advice, rivals = wanted[0]
        more = Longer(spec, RECIPES[advice["capture"]]).write(str(Path(folder) / "more"))
        second = ask.on_files(more, "--jobs", "1")
    return job, names, advice["capture"], outcome(second, effect, sensor, rivals)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=6)
    cases.add_arguments(parser)
    args = parser.parse_args()
    jobs = [(*thing, 7000 + 100 * number + seed) for number, thing in enumerate(AMBIGUOUS)
            for seed in range(args.seeds)]
    rows = cases.done(tried, jobs, cases.target(args), "resolved")
    for row in rows:
        if row[3] not in (None, "resolved"):
            print("%s %s %gx, %s, seed %d: %s; asked for %s: %s" % (
                row[0][1], row[0][0], *row[0][2:], " or ".join(row[1]), row[2], row[3]))
    print("%-14s %-6s %-12s %5s %5s %9s" % ("effect", "sensor", "protocol", "runs", "open",
                                           "resolved"))
    for thing in AMBIGUOUS:
        mine = [row for row in rows if row[0][:4] == thing]
        were = [row for row in mine if row[3]]
        print("%-14s %-6s %-12s %5d %5d %9d" % (
            thing[0], thing[1], thing[3], len(mine), len(were),
            sum(row[3] == "resolved" for row in were)))
    were = [row for row in rows if row[3]]
    good = sum(row[3] == "resolved" for row in were)
    print("%d of %d ambiguities resolved by the capture recommended first: %.0f %% (target %g %%)"
          % (good, len(were), 100.0 * good / max(len(were), 1), 100.0 * TARGET))
    return int(good < TARGET * len(were))


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
