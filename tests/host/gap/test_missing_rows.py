"""Rows that are missing although the stamps are even: told by the steps of the gyro in motion."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import diagnosis, turn_model
from sixflip_host.diagnosis.detect import missing_rows, sample_clock
from sixflip_host.experiment import blocks
from tests.worlds import hand_session

RATE = 100.0


def way(number=24, seed=5):
    """(times, (n, 3) deg/s) of a box that is turned half round so often, 2 s each, 1.5 s at rest
    between; what its clock counts lost rows by is the number of the row."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 3.5 * number + 2.0, 1.0 / RATE)
    rate = np.zeros((len(t), 3))
    for k in range(number):
        u = np.clip((t - 2.0 - 3.5 * k) / 2.0, 0.0, 1.0)
        wobble = np.sin(2.0 * np.pi * (3.0 * u + rng.random()))
        shape = np.sin(np.pi * u) ** 2 * (1.0 + 0.3 * wobble)
        axis = rng.normal(size=3) * [0.1, 0.1, 0.1] + [0.0, 0.0, 1.0 - 2.0 * (k % 2)]
        rate += 180.0 * shape[:, None] * axis
    return t, rate


def log(rows=None, rate=None, shakes=0.0, seed=2):
    """Session of the rows that are left of a way, stamped as if they were all."""
    t, turned = way()
    rate = turned if rate is None else rate
    rows = np.arange(len(rate)) if rows is None else rows
    rng = np.random.default_rng(seed)
    gyro = rate[rows] + rng.normal(0.0, 0.05, (len(rows), 3))
    gyro += shakes * rng.standard_t(2.0, (len(rows), 3)) * (np.abs(rate[rows]).max(
        axis=1, keepdims=True) > 1.0)
    accel = np.rint(rng.normal([0, 0, 4096], 8.0, (len(rows), 3))).astype(np.int16)
    meta = {"sensor": "other", "rate_hz": RATE, "accel_lsb_per_g": 4096.0,
            "gyro_lsb_per_dps": 16.4}
    return blocks.session_of("hand", Capture(
        meta, np.rint(np.arange(len(rows)) * 1e6 / RATE).astype(np.int64), accel,
        np.rint(16.4 * gyro).astype(np.int16)))


def kept(share, seed=7):
    number = len(way()[0])
    return np.flatnonzero(np.random.default_rng(seed).random(number) >= share)


@pytest.mark.parametrize("share", [0.02, 0.04, 0.1])
def test_rows_that_are_missing_at_random_are_counted(share):
    """Half turns that ended 4 to 14 degrees short were a saturation of 113 deg/s."""
    session = log(kept(share))
    assert sample_clock.drops(sample_clock.clocks([session])) == []
    found, = missing_rows.findings([session])
    low, high = found.interval["chance"]
    assert found.effect == "dropped_samples" and low < 100.0 * share < high
    assert found.hidden == pytest.approx(found.value["chance"] / 100.0, rel=1e-4)
    assert found.share > 0.9


def test_bursts_of_missing_rows_are_the_same():
    rng, rows = np.random.default_rng(3), np.ones(len(way()[0]), bool)
    for first in np.flatnonzero(rng.random(len(rows)) < 0.02):
        rows[first:first + rng.geometric(0.7)] = False
    assert missing_rows.findings([log(np.flatnonzero(rows))])


@pytest.mark.parametrize("shakes", [0.0, 0.3, 2.0])
def test_a_hand_s_jerks_are_no_missing_rows(shakes):
    assert missing_rows.findings([log(shakes=shakes)]) == []


@pytest.mark.parametrize("measured_hz", [104.0, 125.0])
def test_a_sensor_that_is_read_more_slowly_than_it_measures_loses_nothing(measured_hz):
    t, rate = way()
    own = np.arange(0.0, t[-1], 1.0 / measured_hz)
    at = np.minimum(np.floor(t * measured_hz + 0.3).astype(int), len(own) - 1)
    course = np.stack([np.interp(own, t, column) for column in rate.T], 1)
    assert missing_rows.findings([log(rate=course[at])]) == []


def test_rows_that_come_late_and_catch_up_lose_nothing():
    """A row now and then is the one before, and the next one is in time again."""
    rng = np.random.default_rng(1)
    rows = np.arange(len(way()[0]))
    rows -= rng.random(len(rows)) < 0.05
    assert missing_rows.findings([log(np.maximum(rows, 0))]) == []


@pytest.mark.long
def test_what_lost_rows_do_to_the_turns_has_no_other_name():
    """Half turns between the faces, by two sensors' sessions of which every 25th row is lost."""
    sessions = []
    for seed in (1, 2):
        whole = hand_session.session(hand_session.Sensor(4), hand_session.six_faces(seed), seed)
        rows = np.random.default_rng(seed).random(len(whole)) >= 0.04
        sessions.append(blocks.session_of("s%d" % seed, Capture(
            whole.meta, whole.t_us[:rows.sum()], whole.accel[rows], whole.gyro[rows],
            pose=whole.pose[rows])))
    said = diagnosis.diagnose_sessions(sessions)
    assert said.verdict == "explained"
    assert [f.effect for f in said.findings] == ["dropped_samples"] and not said.causes
    assert not said.turns.causes and not said.nameless


def test_what_is_missing_of_a_turn_scatters_it_by_as_much_as_its_covariance_says():
    """A turn of 180 degrees in 200 steps of which one in 25 is missing."""
    rng, rate = np.random.default_rng(4), 90.0 * np.ones((200, 1)) * [0.0, 0.0, 1.0]
    seconds, dt = 2.0, 0.01
    shown = np.zeros((3, 200, 3))
    shown[2, :, 2] = dt / seconds
    turn = SimpleNamespace(shown=shown, middle=rate)
    drawn = [(rate[rng.random(200) < 0.04, 2] * dt).sum() / seconds for _ in range(4000)]
    assert 0.04 * turn_model.lost(turn)[2, 2] == pytest.approx(np.var(drawn), rel=0.1)


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_a_log_of_a_few_rows_says_nothing_of_them(rows):
    session = SimpleNamespace(capture=Capture(
        {"rate_hz": 100.0}, np.arange(rows) * 10_000, np.zeros((rows, 3), np.int16),
        np.ones((rows, 3), np.int16)), t_s=np.arange(rows) / 100.0, rate=100.0, runs=())
    assert missing_rows.findings([session]) == []
