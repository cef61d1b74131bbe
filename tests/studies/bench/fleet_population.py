"""Simulated fleets: is what the batch has told from what single boards have, is the one bad board
found, and how many sound ones are named?

    python -m tests.studies.bench.fleet_population [--fleets 40] [--boards 200] [--seed 1] [--raw]

Every fleet has one effect that all boards share, another that each has for its own, and one board
with one defect. A fleet is right when both effects are called what they are and no other effect is
called anything. The estimates of the sound boards are drawn with the covariances that estimates of
simulated sessions have (tests/worlds/drawn_fleet.py); with --raw every board is solved from its
own simulated sessions (tests/worlds/simulated_fleet.py, which shares no code with the population's
model; some 0.2 s a board). The bad board always is.
"""
import argparse
import copy
from dataclasses import dataclass

import numpy as np
from scipy import stats

from sixflip_host.fleet import answer, effects
from tests.worlds import drawn_fleet
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


@dataclass(frozen=True)
class Fleet:
    """rows of the boards; truth {coefficient: "batch" or "individual"}; bad: id of the bad board,
    defect: what it has."""

    rows: list
    truth: dict
    bad: str
    defect: str


def fleet(rng, number, errors=None):
    """Fleet of so many boards; errors: drawn_fleet.Errors of the sound ones, None: each is solved
    from sessions."""
    shared, own = rng.permutation(len(EFFECTS))[:2]
    axes = rng.integers(0, 3, 2)
    defect, bad = DEFECTS[rng.integers(len(DEFECTS))], int(rng.integers(number))
    sign = rng.choice((-1.0, 1.0))
    having = [(EFFECTS[shared], int(axes[0]), 1.0, 0.2), (EFFECTS[own], int(axes[1]), 0.0, 1.0)]
    names = [with_effect(drawn(rng), name, axis, 0.0) for name, axis, _, _ in having]
    units = errors and [_unit(errors, *one[:2]) for one in having]
    rows = []
    for k in range(number):
        sizes = [sign * SIZE[name] * rng.normal(mean, spread) for name, _, mean, spread in having]
        if errors and k != bad:
            rows.append(errors.row(rng, "b%03d" % k, [
                (size * unit, sensor, size * slope)
                for size, (unit, sensor, slope) in zip(sizes, units)]))
            continue
        part = drawn(rng) if errors is None else copy.deepcopy(errors.part)
        for (name, axis, _, _), size in zip(having, sizes):
            with_effect(part, name, axis, size)
        if k == bad:
            spoilt(part, defect, int(rng.integers(3)))
        rows.append(row_of(part, rng, "b%03d" % k))
    return Fleet(rows, dict(zip(names, ("batch", "individual"))), "b%03d" % bad, defect)


def _unit(errors, name, axis):
    """(coefficients (k,), sensor, what calibrations read otherwise) of an effect of size 1."""
    part, sensor = copy.deepcopy(errors.part), name.split(".")[0]
    names = effects.NAMES[sensor]
    size = np.zeros(len(names))
    size[names.index(with_effect(part, name, axis, SIZE[name]))] = 1.0
    return size, sensor, errors.slope(part) / SIZE[name]


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
    parser.add_argument("--fleets", type=int, default=40)
    parser.add_argument("--boards", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--raw", action="store_true", help="solve every board from its sessions")
    args = parser.parse_args()
    errors = None if args.raw else drawn_fleet.Errors(np.random.default_rng((args.seed, 10 ** 6)))
    right = found = false = several = 0
    for k in range(args.fleets):
        one = fleet(np.random.default_rng((args.seed, k)), args.boards, errors)
        good, wrong, named = judged(one.rows, one.truth)
        right += good
        found += one.bad in named
        others = [name for name in named if name != one.bad]
        false += len(others)
        several += len(others) > 1
        print("fleet %2d: %s; bad board (%s) %s, %d sound ones named" % (
            k, "right" if good else "; ".join(wrong), one.defect,
            "found" if one.bad in named else "missed", len(others)), flush=True)
    print("batch told from individual in %s fleets of %d boards" % (
        share(right, args.fleets), args.boards))
    print("the bad board found in %s; %.2f sound boards named a fleet, more than one in %d" % (
        share(found, args.fleets), false / args.fleets, several))


if __name__ == "__main__":
    main()
