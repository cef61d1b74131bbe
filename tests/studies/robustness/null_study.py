"""Nulls carried by real recorded noise: is anything named where there is nothing?

    python -m tests.studies.robustness.null_study [--runs 120] [--jobs 2]

Poses of the blind generator, its table, box and hand; the noise of rests of the real recordings
(SIXFLIP_DATA) in place of synthetic noise. A false alarm is a cause by name, or a verdict that
there is a gap. True is what is there: a box that is crooked may be called so, alone or in one
class with its aliases, and a line of the recording's own spectrum a vibration. Exits with 1 when
there are more than 5 %, beyond chance.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy import stats

from .. import cases
from ..blind.generator.case import Case, Specification
from . import ask, real_noise

PROTOCOLS = ("recommended", "recommended", "one session", "paper")
QUIET = ("no gap", "cannot tell")
ALLOWED = 0.05


def specification(seed, recording):
    """A healthy sensor: the seed decides protocol, box, table and hand."""
    rng = np.random.default_rng([seed, 17])
    habits = {"box_tilt_deg": float(rng.choice([0.0, 0.1])),
              "free_heading": bool(rng.random() < 0.2)}
    return Specification(seed, "mpu6050", str(rng.choice(PROTOCOLS)), habits=habits,
                         new_gyro_offset=bool(rng.random() < 0.3),
                         no_thermometer=bool(rng.random() < 0.1), noise_of=recording)


def judged(job):
    """(recording, protocol, seed, verdict, [false causes by name], alarm) of one null."""
    seed, recording, cut = job
    spec = specification(seed, recording)
    with tempfile.TemporaryDirectory() as folder:
        paths = Case(spec).write(str(Path(folder) / "null"), real_noise.source(cut))
        answer = ask.on_files(paths, "--jobs", "1")
    known = real_noise.lines(cut)
    false = ["%s %s" % (c["sensor"], " or ".join(c["class"])) for c in answer["causes"]
             if not there(c, spec.habits["box_tilt_deg"] > 0.0, known)]
    true = len(answer["causes"]) > len(false) and answer["verdict"] == "explained"
    return recording, spec.protocol, seed, answer["verdict"], false, \
        bool(false) or not (true or answer["verdict"] in QUIET)


def there(cause, crooked, lines):
    """Whether a cause is in the capture: the box, or a line that the recording has, played up to
    FASTER faster or slower, by a bin of either spectrum."""
    if cause["class"] == ["vibration"]:
        near = 2.0 * real_noise.RATE / real_noise.LINE_N
        return all(any(abs(line["hz"] - hz) < real_noise.FASTER * hz + near
                       for hz in lines.get((cause["sensor"], axis), []))
                   for axis, line in cause["lines"].items())
    return crooked and cause["sensor"] == "accel" and "box_tilt" in cause["class"]


def nulls(place, runs, first=1):
    """Jobs: seeds in turn over the recordings."""
    cut = real_noise.pieces(place)
    names = sorted(cut)
    return [(first + k, names[k % len(names)], cut[names[k % len(names)]]) for k in range(runs)]


def main():
    from sixflip_host.capture import recordings
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=120)
    parser.add_argument("--first", type=int, default=1, help="seed of the first")
    cases.add_arguments(parser)
    args = parser.parse_args()
    rows = cases.done(judged, nulls(recordings.folder(), args.runs, args.first),
                      cases.target(args), "nulls")
    for row in rows:
        if row[5]:
            print("seed %d, noise of %s, %s: %s; %s" % (
                row[2], row[0], row[1], row[3], "; ".join(row[4])))
    print("%-10s %-12s %5s %13s %12s" % ("noise of", "protocol", "runs", "false alarms",
                                        "cannot tell"))
    for key in sorted({row[:2] for row in rows}):
        mine = [row for row in rows if row[:2] == key]
        print("%-10s %-12s %5d %13d %12d" % (*key, len(mine), sum(row[5] for row in mine), sum(
            row[3] == "cannot tell" for row in mine)))
    false = sum(row[5] for row in rows)
    p = stats.binom.sf(false - 1, len(rows), ALLOWED)
    print("%d of %d nulls on real recorded noise raise an alarm: %.1f %% (allowed %g %%)" % (
        false, len(rows), 100.0 * false / len(rows), 100.0 * ALLOWED))
    return int(p < 0.05)


if __name__ == "__main__":
    sys.exit(cases.main_of(__spec__.name))
