"""Simulated fleets: is what the batch has told from what single boards have, is the one bad board
found, and how many sound ones are named?

    python -m tests.studies.bench.fleet_population [--fleets 10] [--boards 200] [--seed 1]

Every fleet has one effect that all boards share, another that each has for its own, and one board
with one defect. Its boards are made by tests/worlds/simulated_fleet.py, which shares no code with
the population's model. A fleet is right when both effects are called what they are and no other
effect is called anything.
"""
import argparse

import numpy as np
from scipy import stats

from sixflip_host.fleet import answer
from tests.worlds.simulated_fleet import drawn, row_of

EFFECTS = ("accel.thermal_bias", "gyro.thermal_bias", "gyro.g_sensitivity")
SIZE = {"accel.thermal_bias": 0.5, "gyro.thermal_bias": 0.02, "gyro.g_sensitivity": 0.05}
DEFECTS = ("bias", "slope", "noise", "scale", "moved")


def with_effect(part, name, axis, size):
    """Adds an effect of a size to a Part; returns the coefficient's name."""
    if name == "accel.thermal_bias":
        part.slope[axis] += size
        return "%s.%s" % (name, "xyz"[axis])
    if name == "gyro.thermal_bias":
        part.gyro_slope[axis] += size
        return "%s.%s" % (name, "xyz"[axis])
    other = (axis + 1) % 3
    part.pull[axis, other] += size
    return "%s.%s" % (name, "xyz"[axis] + "xyz"[other])


def spoilt(part, defect, axis):
    """Puts one defect into a Part."""
    if defect == "bias":
        part.bias_mg = part.bias_mg + 150.0 * np.eye(3)[axis]
    elif defect == "slope":
        part.slope[axis] += 4.0
    elif defect == "noise":
        part.loud = 2.0
    elif defect == "scale":
        part.matrix = part.matrix + 0.08 * np.diag(np.eye(3)[axis])
    else:
        part.moved_mg = 6.0 * np.eye(3)[axis]


def fleet(rng, number):
    """(rows, {coefficient: "batch" or "individual"}, id of the bad board, its defect)"""
    shared, own = rng.permutation(len(EFFECTS))[:2]
    axes = rng.integers(0, 3, 2)
    defect, bad = DEFECTS[rng.integers(len(DEFECTS))], int(rng.integers(number))
    sign = rng.choice((-1.0, 1.0))
    rows, truth = [], {}
    for k in range(number):
        part = drawn(rng)
        for which, axis, mean, spread, kind in (
                (EFFECTS[shared], axes[0], 1.0, 0.2, "batch"),
                (EFFECTS[own], axes[1], 0.0, 1.0, "individual")):
            size = sign * SIZE[which] * rng.normal(mean, spread)
            truth[with_effect(part, which, int(axis), size)] = kind
        if k == bad:
            spoilt(part, defect, int(rng.integers(3)))
        rows.append(row_of(part, rng, "b%03d" % k))
    return rows, truth, "b%03d" % bad, defect


def judged(rows, truth):
    """(right, [wrong coefficients], boards named)"""
    (_, batches, _), = answer.judged(rows)
    wrong = []
    for p in batches[0].parameters:
        if "." not in p.name:
            continue
        said = p.kind if p.kind != "both" else "batch" if p.share >= 0.5 else "individual"
        if said != truth.get(p.name, "neither"):
            wrong.append("%s called %s, is %s" % (p.name, said, truth.get(p.name, "neither")))
    missing = set(truth) - {p.name for p in batches[0].parameters}
    wrong += ["%s is not looked at" % name for name in sorted(missing)]
    return not wrong, wrong, list(dict.fromkeys(o.board for o in batches[0].outliers))


def share(hit, among):
    """Words with the 90 % interval of a share [Clopper & Pearson 1934]."""
    low = stats.beta.ppf(0.05, hit, among - hit + 1) if hit else 0.0
    high = stats.beta.ppf(0.95, hit + 1, among - hit) if hit < among else 1.0
    return "%d of %d (90 %% interval %.2f to %.2f)" % (hit, among, low, high)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--fleets", type=int, default=10)
    parser.add_argument("--boards", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    right = found = false = 0
    for k in range(args.fleets):
        rng = np.random.default_rng((args.seed, k))
        rows, truth, bad, defect = fleet(rng, args.boards)
        good, wrong, named = judged(rows, truth)
        right += good
        found += bad in named
        others = [name for name in named if name != bad]
        false += len(others)
        print("fleet %2d: %s; bad board (%s) %s, %d sound ones named" % (
            k, "right" if good else "; ".join(wrong), defect,
            "found" if bad in named else "missed", len(others)), flush=True)
    print("batch told from individual in %s fleets of %d boards" % (
        share(right, args.fleets), args.boards))
    print("the bad board found in %s; %.2f sound boards named a fleet" % (
        share(found, args.fleets), false / args.fleets))


if __name__ == "__main__":
    main()
