"""What a batch shares and what single boards have, on fleets made by another code."""
import errno

import numpy as np
import pyarrow.parquet
import pytest

from sixflip_host.errors import BadFile
from sixflip_host.fleet import (
    answer,
    effect_blocks,
    effects,
    hierarchy,
    judgement,
    members,
    store,
)
from tests.worlds import simulated_fleet
from tests.worlds.simulated_fleet import drawn, row_of

N = 24


@pytest.fixture(scope="module")
def found():
    """(Members, Batch) of N boards: a slope of z in all, of y in each its own; board 3 has a bias
    of its own, board 5 one that moves."""
    rng, rows = np.random.default_rng(11), []
    for k in range(N):
        part = drawn(rng)
        part.slope = rng.normal((0.0, 0.0, -1.0), (0.0, 0.4, 0.1))
        if k == 3:
            part.bias_mg = part.bias_mg + np.array([0.0, 200.0, 0.0])
        if k == 5:
            part.moved_mg = np.array([0.0, 0.0, 6.0])
        rows.append(row_of(part, rng, "b%02d" % k))
    (them, batches, lots), = answer.judged(rows)
    assert lots == []
    return them, batches[0]


def kind(batch, name):
    return next(p for p in batch.parameters if p.name == name)


def test_what_all_have_is_systematic_and_what_each_has_individual(found):
    _, batch = found
    z, y, x = (kind(batch, "accel.thermal_bias." + axis) for axis in "zyx")
    assert z.kind in ("batch", "both") and z.share > 0.5
    assert abs(z.mean + 1.0) < 4.0 * z.error
    assert y.kind == "individual" and 0.2 < y.spread < 0.7
    assert x.kind == "neither"
    assert kind(batch, "gyro.g_sensitivity.xy").kind == "neither"


def test_the_two_boards_that_stand_out_are_named_with_their_reason(found):
    _, batch = found
    assert {(o.board, o.parameter, o.why) for o in batch.outliers} == {
        ("b03", "accel_bias_y_mg", "differs"), ("b05", "accel_bias_z_mg", "drifted")}


def test_an_answer_is_json_with_everything_in_it(found):
    them, batch = found
    said = answer.population([(them, [batch], [])], [("x", "why")], [])
    names = {p["name"] for p in said["groups"][0]["batches"][0]["parameters"]}
    assert {"accel_scale_x", "gyro_bias_z_dps", "accel.thermal_bias.z"} <= names
    assert said["failures"] == [{"board": "x", "why": "why"}]


def test_every_board_has_its_shrunk_estimates_in_a_file(found, tmp_path):
    them, batch = found
    answer.write_estimates(tmp_path, [(them, [batch], [])])
    rows = {row["board"]: row for row in pyarrow.parquet.read_table(
        tmp_path / answer.ESTIMATES).to_pylist()}
    assert len(rows) == N
    slopes = np.array([row["accel.thermal_bias.z"] for row in rows.values()])
    block, one = batch.populations["accel.thermal_bias"]
    assert slopes.std() < block.y[:][:, 2].std() and abs(slopes.mean() - one.mean[2]) < 0.1
    assert rows["b03"]["accel_bias_y_mg"] > 150.0 and rows["b03"]["accel_bias_y_mg_sigma"] < 5.0


def test_estimates_are_as_far_off_as_they_say():
    rng, off = np.random.default_rng(2), []
    for k in range(12):
        part = drawn(rng)
        row = row_of(part, rng, "b%d" % k, plans=simulated_fleet.THERMAL[:1])
        one, true = members.analysis.estimates(row)[0], simulated_fleet.truth(part)
        for block in ("accel_scale", "accel_bias", "gyro_bias"):
            value, covariance = one.of(block)
            names = members.parameters.BLOCKS[block]
            wander = {"accel_bias": simulated_fleet.SWITCH_ON_MG,
                      "gyro_bias": simulated_fleet.SWITCH_ON_DPS}.get(block, 0.0)
            off += [(v - true[n]) / np.hypot(s, wander) for v, n, s in zip(
                value, names, np.sqrt(np.diag(covariance)))]
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.6


def normal_boards(rng, n, spread, noise, mean=(1.0, 0.0, -2.0)):
    R = np.tile(np.diag([noise ** 2] * 3), (n, 1, 1))
    return np.array(mean) + rng.normal(0.0, spread, (n, 3)) + rng.normal(0.0, noise, (n, 3)), R


def test_mean_and_spread_are_those_drawn_and_boards_shrink():
    rng = np.random.default_rng(1)
    y, R = normal_boards(rng, 400, 0.5, 0.5)
    one = hierarchy.fit(y, R)
    assert np.all(np.abs(one.mean - (1.0, 0.0, -2.0)) < 4.0 * np.sqrt(np.diag(one.error)))
    assert np.allclose(np.sqrt(np.diag(one.spread)), 0.5, rtol=0.2)
    shrunk = (one.shrunk(y, R, one.belongs)[0] - one.mean).std() / (y - one.mean).std()
    assert 0.4 < shrunk < 0.6 and one.rare < 0.02


def test_some_broken_boards_move_neither_mean_nor_spread():
    rng = np.random.default_rng(3)
    y, R = normal_boards(rng, 200, 0.5, 0.1)
    y[:8] += 30.0
    one = hierarchy.fit(y, R)
    assert np.allclose(one.mean, (1.0, 0.0, -2.0), atol=0.2)
    assert np.allclose(np.sqrt(np.diag(one.spread)), 0.5, rtol=0.25)
    assert (one.belongs[:8] < 0.01).all() and one.belongs[8:].mean() > 0.95
    shrunk, _ = one.shrunk(y, R, one.belongs)
    assert np.allclose(shrunk[:8], y[:8], atol=0.5)     # not drawn to a batch they are not of


def test_more_boards_than_are_in_memory_at_a_time_give_the_same(monkeypatch):
    rng = np.random.default_rng(12)
    y, R = normal_boards(rng, 50, 0.5, 0.3)
    y[7] += 20.0
    y[9, 1] = np.nan
    stored = store.Stored(50, (3, 3))
    for k in (*range(25, 50), *range(25)):
        stored.put(k, R[k])
    whole = hierarchy.fit(y, R)
    monkeypatch.setattr(hierarchy, "PIECE", 16)
    assert np.array_equal(store.Picked(stored, [3, 4, 9])[1:], R[[4, 9]])
    pieces = hierarchy.fit(y, stored)
    for name in ("mean", "spread", "error", "belongs"):
        assert np.allclose(getattr(pieces, name), getattr(whole, name)), name


def test_missing_values_are_no_boards():
    rng = np.random.default_rng(4)
    y, R = normal_boards(rng, 60, 0.5, 0.1)
    y[:20, 1] = np.nan
    one = hierarchy.fit(y, R)
    assert np.allclose(one.mean, (1.0, 0.0, -2.0), atol=0.4)
    assert hierarchy.fit(y[:2], R[:2]) is None


def test_many_boards_do_not_make_seen_what_none_of_them_tells():
    names = effects.NAMES["accel"]
    for number in (200, 100_000):
        typical = effect_blocks.EffectBlocks("accel", "mpu6050", np.eye(len(names)), 1)
        told = np.where([".cubic." in name for name in names], 1.0 / 50.0, 1.0 / 5.0)
        total = number * np.diag(told ** 2 * typical.floor * effect_blocks.TIMES_TYPICAL ** 2)
        seen = effect_blocks.EffectBlocks("accel", "mpu6050", total, number)
        assert "cubic of the accel" in seen.unseen
        assert "accel.thermal_bias" in [block.name for block in seen.blocks]


def test_a_batch_without_spread_has_none():
    rng = np.random.default_rng(5)
    y, R = normal_boards(rng, 100, 0.0, 0.3)
    one = hierarchy.fit(y, R)
    assert np.sqrt(np.diag(one.spread)).max() < 0.15


def test_a_lot_that_differs_is_named_and_sound_lots_are_not():
    rng = np.random.default_rng(6)
    for shift, wanted in ((0.0, set()), (1.0, {"accel.thermal_bias.z"})):
        y, R = normal_boards(rng, 60, 0.3, 0.1)
        y[30:, 2] += shift
        names = tuple("accel.thermal_bias.%s" % a for a in "xyz")
        block = members.Block("accel.thermal_bias", names, y, R, np.ones(3))
        them = members.Members("mpu6050", 2.0, 500.0, tuple("b%d" % k for k in range(60)),
                               ("one",) * 30 + ("two",) * 30, [block], [], {}, ())
        batches = judgement.batches(them)
        assert [b.name for b in batches] == ["one", "two"]
        assert {one.parameter for one in judgement.lots(batches)} == wanted


def test_few_boards_of_many_batches_are_judged_together():
    rng = np.random.default_rng(8)
    y, R = normal_boards(rng, 12, 0.3, 0.1)
    block = members.Block("accel_bias", members.parameters.BLOCKS["accel_bias"], y, R)
    them = members.Members("mpu6050", 2.0, 500.0, tuple("b%d" % k for k in range(12)),
                           ("a", "b", "c") * 4, [block], [], {}, ())
    assert [(b.name, len(b.boards)) for b in judgement.batches(them)] == [("the others", 12)]


def test_sound_fleets_name_hardly_a_board():
    rng, named = np.random.default_rng(9), 0
    for _ in range(20):
        y, R = normal_boards(rng, 200, 0.5, 0.2)
        block = members.Block("accel_bias", members.parameters.BLOCKS["accel_bias"], y, R)
        them = members.Members("mpu6050", 2.0, 500.0, tuple("b%d" % k for k in range(200)),
                               ("",) * 200, [block], [], {}, ())
        named += len(judgement.batches(them)[0].outliers)
    assert named <= 12      # a quarter of a board is expected in each fleet


def test_a_full_disk_is_one_sentence(found, tmp_path, monkeypatch):
    full = OSError(errno.ENOSPC, "No space left on device")

    def no_space(*_):
        raise full
    monkeypatch.setattr(store.os, "pwrite", no_space)
    with pytest.raises(BadFile, match="No space left on device.*TMPDIR names another folder"):
        store.Stored(3, (2,))
    monkeypatch.setattr(pyarrow.parquet.ParquetWriter, "write_table", no_space)
    with pytest.raises(BadFile, match="estimates.parquet: cannot be written: No space left"):
        answer.write_estimates(tmp_path, [(*found[:1], [found[1]], [])])
    assert list(tmp_path.iterdir()) == []
