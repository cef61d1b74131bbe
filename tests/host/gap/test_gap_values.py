"""What is handed out is a value: parts share nothing with the whole, nothing is changed later."""
import copy
import dataclasses
import json

import numpy as np
import pytest

from sixflip_host.diagnosis import (
    answer,
    closed_loops,
    diagnosis,
    gap_figures,
    rest_model,
    scored_sets,
    turn_model,
)
from sixflip_host.experiment import attitude_fit, blocks, session_terms, turns
from sixflip_host.experiment.session import OF_BLOCKS
from sixflip_host.present import gap_words
from sixflip_host.simulation import scenario, simulated_session

SENSITIVE = {"effect": "g_sensitivity", "sensor": "gyro"}


def session(effects=(), seed=31, number=0):
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": seed,
                               "effects": list(effects),
                               "world": {"placement_scatter_deg": 0.05}})
    return simulated_session.session(plan, number)


@pytest.fixture(scope="module")
def capture():
    return session()


def test_blocks_cannot_be_changed(capture):
    whole, = session_terms.agreed([blocks.session_of("s", capture)])
    with pytest.raises(dataclasses.FrozenInstanceError):
        whole.accel = None
    for name in (*OF_BLOCKS, "t_s", "noise_accel", "rounding_gyro"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(whole, name)[0] = 0
    fewer = whole.without_poses(["Z+a"])
    assert len(fewer.runs) < len(whole.runs) == len(blocks.session_of("s", capture).runs)


def test_a_capture_that_nobody_labelled_stays_so(capture):
    bare = copy.copy(capture)
    bare.pose = None
    found = blocks.session_of("s", bare)
    assert bare.pose is None and found.runs and not found.labelled


def test_the_halves_of_a_session_have_turns_of_their_own(capture):
    """They once were the whole session's, and so held out against themselves."""
    whole = blocks.session_of("s", capture)
    up = attitude_fit.fit(whole).up
    every = {(t.first, t.last) for t in turns.usable_turns(whole, up)}
    half = whole.placements() // 2
    parts = [whole.part(range(half)), whole.part(range(half, whole.placements()))]
    one, other = ({(t.first, t.last) for t in turns.usable_turns(part, up)} for part in parts)
    assert one and other and not one & other
    assert one | other <= every and len(one | other) < len(every)  # the one between is neither's
    first = min(parts[1].first)
    assert max(last for _, last in one) <= first <= min(last for _, last in other)


def test_a_half_is_not_changed_by_calibrating_the_whole(capture):
    whole = blocks.session_of("s", capture)
    up = attitude_fit.fit(whole).up
    before = [turn.middle.copy() for turn in turns.usable_turns(whole, up)]
    y, calibrated = turns.calibrated(turns.usable_turns(whole, up))
    assert all(np.array_equal(a, t.middle) for a, t in zip(before, turns.usable_turns(whole, up)))
    assert any(not np.allclose(a, t.middle) for a, t in zip(before, calibrated))


def test_stamps_that_scatter_turn_no_box_and_two_of_the_same_time_stop_nothing(capture):
    generator, scattered = np.random.default_rng(3), copy.copy(capture)
    scatter = np.rint(2500.0 * generator.standard_normal(len(capture))).astype(np.int64)
    scattered.t_us = np.maximum.accumulate(capture.t_us + scatter)
    assert (np.diff(scattered.t_us) == 0).any()
    up = attitude_fit.fit(blocks.session_of("s", capture)).up
    even, other = (turns.usable_turns(blocks.session_of("s", c), up) for c in (capture, scattered))
    assert len(even) == len(other)
    for one, same in zip(even, other):
        assert one.dt.min() > 0 and same.dt.min() > 0
        assert np.degrees(np.abs(one.end - same.end)).max() < 0.25


def pulled_by_gravity(capture, some):
    up = capture.accel[some] / capture.meta["accel_lsb_per_g"]
    return 0.5 * up[:, [1, 2, 0]]


def steeper_one_way(capture, some):
    return 0.03 * np.maximum(capture.gyro[some], 0) / capture.meta["gyro_lsb_per_dps"]


@pytest.mark.parametrize("model, name, change", [
    (rest_model.RestModel, "g_sensitivity", pulled_by_gravity),
    (turn_model.TurnModel, "asymmetry", steeper_one_way)])
def test_what_one_half_alone_shows_is_not_explained_in_the_other(capture, model, name, change):
    """Were the halves the same data, the share would be 1 whatever was in them."""
    shares = []
    for both in (True, False):
        one = copy.copy(capture)
        runs = blocks.session_of("s", capture).runs
        some = slice(0, None if both else runs[len(runs) // 2].first)
        one.gyro = capture.gyro.copy()
        one.gyro[some] += np.rint(change(capture, some) * capture.meta["gyro_lsb_per_dps"]
                                  ).astype(np.int16)
        session = blocks.session_of("s", one)
        settings = diagnosis.Settings(jobs=1)
        gap = model("gyro", "mpu6050", settings).fit([session], [attitude_fit.fit(session)])
        assert gap.same_session
        shares.append(gap.model.shrunk(gap.with_effect(name)).shrinkage.share)
    assert shares[0] > 0.9
    assert shares[1] is None or shares[1] < 0.7


@pytest.fixture(scope="module")
def found():
    sizes = {a + b: 0.12 + 0.02 * k for k, (a, b) in enumerate(
        (a, b) for a in "xyz" for b in "xyz")}
    two = [session([dict(SENSITIVE, **sizes), {"effect": "thermal_bias", "sensor": "accel",
                                               "z": -1.8}], 35, k) for k in range(2)]
    return diagnosis.diagnose_sessions([blocks.session_of(str(k), c) for k, c in enumerate(two)],
                                              diagnosis.Settings(jobs=1))


def test_every_coefficient_is_in_the_table_the_largest_too(found, capsys):
    said = answer.as_dict(found)
    cause = next(c for c in said["causes"] if c["effect"] == "g_sensitivity")
    assert len(cause["value"]) == len(cause["interval_90"]) == 9
    gap_words.show(said)
    shown = capsys.readouterr().out
    for key, value in cause["value"].items():
        assert "%s %s" % (key, "%.3g" % value) in " ".join(shown.split()), key


def test_the_share_is_that_of_the_figures_printed(found):
    """It was of whitened contrasts once, and the figures were not."""
    for gap in answer.as_dict(found)["gap"].values():
        before, after, floor = (gap[k] ** 2 for k in ("before", "after", "floor"))
        share = (before - after) / (before - floor)
        assert min(share, 1.0) == pytest.approx(gap["explained_share"], abs=0.005)
        assert gap["interval_90"][0] <= gap["explained_share"] <= gap["interval_90"][1]
        assert gap["before"] > 1.5 * gap["floor"]


def test_adding_an_effect_changes_nothing_that_was_found(found):
    before = json.dumps(answer.as_dict(found))
    gap = found.gaps["accel"]
    more = gap.with_effect("creep")
    assert [f.effect for f in more.chosen] == [*(f.effect for f in gap.chosen), "creep"]
    assert gap.with_effect("thermal_bias") is gap
    closed_loops.close_all(found, ["creep"])
    assert json.dumps(answer.as_dict(found)) == before
    assert isinstance(more.shrinkage, gap_figures.Shrinkage)


def test_a_cause_that_takes_what_is_held_out_further_off_has_no_name(found):
    """A lump of dust was "cubic" beside figures that grew by a quarter with it."""
    gap = found.gaps["accel"]
    model = scored_sets.Model(gap.units, gap.data.statistics, gap.noise)
    assert gap.refuted(model) is gap and [c.effect for c in gap.causes] == ["thermal_bias"]
    further = gap_figures.Shrinkage(1.0, 1.25, 0.3, None, None, True)
    held = dataclasses.replace(gap, shrinkage=further).refuted(model)
    assert held.causes == [] and held.chosen == [] and held.unexplained
    assert [f.effect for f in held.strangers] == ["thermal_bias"]
    assert held.strange_axes["thermal_bias"]


def test_an_interval_of_a_drift_is_that_of_its_likelihood():
    """Not half and twice the size, which it once was whatever the data said."""
    ratios = []
    for seed, size in ((41, 0.06), (42, 0.12)):
        drift = {"effect": "drift", "sensor": "gyro", "x": size, "y": size, "z": size}
        whole = blocks.session_of("s", session([drift], seed))
        found = rest_model.RestModel("gyro", "mpu6050", diagnosis.Settings()).fit(
            [whole], [attitude_fit.fit(whole)]).drift
        assert found.low < found.level < found.high and 0.5 < found.share <= 1.0
        ratios += [found.level / found.low, found.high / found.level]
    assert max(ratios) < 1.9 and np.ptp(ratios) > 0.005
