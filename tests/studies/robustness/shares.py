"""How often the interval of a share holds the share that is true.

    python -m tests.studies.robustness.shares [--cases 72] [--first 1000]

Two sessions of `sixflip simulate`'s own simulator with one effect of 0.3, 1 or 3 times its typical
size, and the same sessions, noise and all, without it: their difference is the gap, exactly. In
every other case the second session has it 0.6 times as large, so that what one session says of the
other falls short. The effect is fitted by name (the search is not what is asked here) and held out
as a diagnosis does. Two shares are true: that of the prediction in the gap itself, and that of the
figures printed, with the floor that the same noise leaves in the session without the effect.
"""
import argparse

import numpy as np

from sixflip_host.diagnosis import (
    discrepancy,
    gap_figures,
    holdout_gain,
    hypotheses,
    posterior,
    scored_sets,
)
from sixflip_host.diagnosis.rest_model import RestModel
from sixflip_host.diagnosis.settings import Settings
from sixflip_host.experiment import attitude_fit, blocks, session_terms
from sixflip_host.simulation import scenario, simulated_session

CHIP = "mpu6050"
EFFECTS = (("thermal_bias", "accel", {"x": 0.5, "y": -0.5, "z": 0.9}),
           ("cubic", "accel", {"x": 5.0, "y": -3.0, "z": 4.0}),
           ("creep", "accel", {"x": 3.0, "z": 5.0}),
           ("thermal_bias", "gyro", {"x": 0.1, "y": -0.2, "z": 0.04}),
           ("g_sensitivity", "gyro", {"xy": 0.1, "zx": -0.08, "yz": 0.05, "xx": 0.1}),
           ("warm_up", "gyro", {"x": 0.3, "y": -0.2, "z": 0.1}))
SIZES = (0.3, 1.0, 3.0)
LESS = 0.6  # of its size, in the second session of every other case


def specs(seed):
    """([effect of each of two sessions], scatter of the placements in degrees) of a case."""
    rng = np.random.default_rng([seed, 5])
    name, kind, sizes = EFFECTS[seed % len(EFFECTS)]
    times = SIZES[seed // len(EFFECTS) % len(SIZES)]
    own = {key: value * times * rng.uniform(0.7, 1.3) for key, value in sizes.items()}
    shape = {"warm_up": {"tau_s": rng.uniform(80.0, 250.0)},
             "creep": {"tau_s": rng.uniform(30.0, 90.0)},
             "thermal_bias": {"lag_s": rng.uniform(0.0, 40.0)}}.get(name, {})
    second = LESS if seed // (len(EFFECTS) * len(SIZES)) % 2 else 1.0
    both = [dict({k: v * part for k, v in own.items()}, effect=name, sensor=kind,
                 **{k: float(v) for k, v in shape.items()}) for part in (1.0, second)]
    return both, float(rng.choice([0.02, 0.05, 0.1]))


def units(model, seed, effects, scatter):
    """[Unit] of two sessions with an effect each, {} for none, and of what is between them."""
    sessions = []
    for number, effect in enumerate(effects):
        world = scenario.from_dict({
            "sensor": CHIP, "scene": "recommended", "seed": seed,
            "effects": [effect] if effect else [], "world": {"placement_scatter_deg": scatter}})
        sessions.append(blocks.session_of(str(number), simulated_session.session(world, number)))
    nominal = [attitude_fit.fit(session) for session in sessions]
    found = [model.unit(*part, False) for part in zip(session_terms.agreed(sessions), nominal)]
    return found + model.between(found, nominal)


def case(seed):
    """(effect, times 0.3, 1 or 3, Shrinkage, share of the gap itself, share by the true floor);
    both shares None where there is no interval."""
    effects, scatter = specs(seed)
    name, kind = effects[0]["effect"], effects[0]["sensor"]
    model = RestModel(kind, CHIP, Settings(jobs=1))
    whole, without = units(model, seed, effects, scatter), units(model, seed, [{}, {}], scatter)
    data = gap_figures.data_of(whole)
    forms = hypotheses.forms_of(whole, (), True)
    scores = scored_sets.Model(whole, data.statistics, model.usual())
    form = max((f for f in forms if f.effect == name and f.axis is None and not f.record),
               key=lambda f: scores.scored((f,)).score)
    set_ = scores.scored((form,))
    wider = discrepancy.with_discrepancy(scores, forms, set_, form)
    if wider is not None and scores.scored((wider,)).score > set_.score + posterior.FORM_COST:
        set_ = scores.scored((wider,))
    chosen = list(set_.forms)
    index = [int(fit.index[0]) for fit in set_.fits]
    shrinkage = holdout_gain.shrinkage(data, chosen, index, model.usual())
    index = gap_figures.usual_levels(whole, index, model.usual().flicker)
    times = SIZES[seed // len(EFFECTS) % len(SIZES)]
    if shrinkage.interval is None:
        return name, kind, times, shrinkage, None, None
    return (name, kind, times, shrinkage, *true(data, chosen, index, without, shrinkage))


def true(data, chosen, index, without, shrinkage):
    """(share of the gap itself, share by the true floor)."""
    shared = hypotheses.columns_of(chosen)
    fits = gap_figures.fits(data, shared)
    gap = left = floor = weight = 0.0
    for held, (unit, plain, point) in enumerate(zip(data.units, without, index)):
        if unit.between:
            continue
        others = fits[:held] + fits[held + 1:]
        theta = gap_figures.coefficients(others, shared)[0][0]
        added = unit.z - plain.z
        gap += unit.chi2(added, point)
        left += unit.chi2(added - unit.columns[:, shared.index] @ theta, point)
        floor += unit.chi2(plain.z, point)
        weight += unit.weight(point)
    before = shrinkage.before ** 2
    whole = max(before - floor / weight, 1e-12)
    return 1.0 - left / gap, min((before - shrinkage.after ** 2) / whole, 1.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=72)
    parser.add_argument("--first", type=int, default=1000, help="seed of the first case")
    args = parser.parse_args()
    held, printed, small = [], [], 0
    for seed in range(args.first, args.first + args.cases):
        name, kind, times, shrinkage, share, figures = case(seed)
        if share is None:
            small += 1
            print("%5d %-14s %-5s %gx: too small to measure" % (seed, name, kind, times))
            continue
        low, high = shrinkage.interval
        held.append(low <= share <= high)
        printed.append(low <= figures <= high)
        print("%5d %-14s %-5s %gx: %.4g before, %.4g after, %.4g floor; %.4f to %.4f; true %.4f, "
              "by the floor %.4f" % (
                  seed, name, kind, times, shrinkage.before, shrinkage.after, shrinkage.floor,
                  low, high, share, figures), flush=True)
    print("Of %d intervals %.1f %% hold the share of the gap, %.1f %% that of the figures with "
          "the true floor; %d too small to measure" % (
              len(held), 100.0 * np.mean(held), 100.0 * np.mean(printed), small))


if __name__ == "__main__":
    main()
