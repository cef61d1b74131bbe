"""How loud noise at rest is: bursts, rests and sessions louder than others, noise in common."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import capture_file, rests
from sixflip_host.diagnosis.detect import noise_bursts, noise_shape, spikes
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.still_session import resting


@pytest.mark.parametrize("times, rests, said", [
    (2.0, 2, ["accel"]), (1.4, 2, []), (4.0, 1, ["accel"])])
def test_rests_that_are_louder_from_begin_to_end_are_said(times, rests, said):
    """A face with twice the noise, and one rest with four times as much, were no gap."""
    two = resting(6.0, n=1000), resting(6.0, seed=6, n=1000)
    counts = np.concatenate([s.capture.accel for s in two]).astype(float)
    level = np.repeat(8192.0 * np.vstack([np.eye(3), -np.eye(3)] * 2), 1000, axis=0)
    for rest in (3, 8)[:rests]:
        counts[1000 * rest:1000 * rest + 1000] += (times - 1.0) * (counts - level)[
            1000 * rest:1000 * rest + 1000]
    whole = blocks.session_of("twelve", capture_file.Capture(
        dict(two[0].capture.meta), 10_000 * np.arange(12000), np.rint(counts).astype(np.int16),
        pose=np.repeat(np.arange(1, 13), 1000)))
    found = noise_bursts.unsteady([whole])
    assert [sensor for sensor, _, _ in found] == said
    assert all("in %d of 12 rests" % rests in words for _, words, _ in found)


def test_a_rest_between_two_coarse_codes_is_no_louder_one():
    """Twelve bits on the left of sixteen: in one rest of twelve noise of a fifth of a step is
    seen."""
    generator = np.random.default_rng(4)
    codes = 37.0 * np.arange(12) + 0.5 * (np.arange(12) == 5)
    level = 16.0 * np.repeat(codes, 1000)[:, None] + np.zeros(3)
    counts = 16.0 * np.rint((level + 3.2 * generator.normal(size=level.shape)) / 16.0)
    session = blocks.session_of("coarse", capture_file.Capture(
        {"sensor": "other", "rate_hz": 100.0, "accel_lsb_per_g": 8192.0},
        10_000 * np.arange(12000), counts.astype(np.int16),
        pose=np.repeat(np.arange(1, 13), 1000)))
    assert (np.diff(session.capture.accel[5000:6000], axis=0) != 0).mean() > 0.4
    assert noise_bursts.unsteady([session]) == []


def test_bursts_are_seen_where_nobody_has_labelled_the_rests():
    """Too loud to be still, they were taken for moves: no gap at four times the noise."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 8})
    found = []
    for times in (1.0, 4.0):
        capture = simulated_session.session(plan, 0)
        generator, t = np.random.default_rng(2), capture.t_us * 1e-6
        loud = np.sqrt(times ** 2 - 1.0) * (t % 11.0 < 1.5)[:, None]
        for name, noise in (("accel", 40.0), ("gyro", 3.0)):
            counts = getattr(capture, name)
            added = noise * loud * generator.standard_normal(counts.shape)
            setattr(capture, name, (counts + np.rint(added)).astype(np.int16))
        capture.pose = None
        found.append({s for s, _, _ in noise_bursts.unsteady([blocks.session_of("s", capture)])})
    assert found[0] == set() and "accel" in found[1]


def test_what_a_label_leaves_out_is_no_rest():
    """Whoever labelled it left out the seconds in which a hand was on the box."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 8})
    capture = simulated_session.session(plan, 0)
    generator = np.random.default_rng(2)
    for run in rests.labelled(capture.pose)[::3]:
        touched = slice(run.first + 200, run.first + 300)
        capture.pose[touched] = 0
        for name, counts in (("accel", 600.0), ("gyro", 200.0)):
            getattr(capture, name)[touched] += np.rint(
                counts * generator.standard_normal((100, 3))).astype(np.int16)
    assert noise_bursts.unsteady([blocks.session_of("s", capture)]) == []


def test_a_vehicle_that_shakes_on_a_straight_way_is_not_at_rest_there():
    generator, t = np.random.default_rng(5), np.arange(30000) * 0.01
    part = t % 24.0  # it rests, drives, rests and turns
    driving = ((part > 6.0) & (part < 12.0))[:, None]
    accel = [0.0, 0.0, 16384.0] + generator.standard_normal((30000, 3)) * (40.0 + 1300.0 * driving)
    gyro = generator.standard_normal((30000, 3)) * (3.0 + 130.0 * driving)
    gyro[part > 20.0, 2] += 30.0 * 65.5
    session = blocks.session_of("drive", capture_file.Capture(
        {"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384.0,
         "gyro_lsb_per_dps": 65.5}, 10_000 * np.arange(30000),
        np.rint(accel).astype(np.int16), np.rint(gyro).astype(np.int16)))
    assert len(session.runs) > 10 and noise_bursts.unsteady([session]) == []


@pytest.mark.parametrize("share, said", [(1.0, 1), (-1.0, 1), (0.3, 0)])
def test_noise_that_two_axes_have_in_common_is_said(share, said):
    """As of a supply that both are on."""
    session = resting(20.0, n=600)
    level = np.repeat(8192.0 * np.vstack([np.eye(3), -np.eye(3)]), 600, axis=0)
    session.capture.accel[:, 1] += np.rint(
        share * (session.capture.accel - level)[:, 0]).astype(np.int16)
    found = noise_shape.in_common([session])
    assert len(found) == said
    assert all("x axis" in words and "y axis" in words for words in found)
    assert noise_shape.in_common([session], ["accel"]) == []


def test_a_session_between_two_coarse_codes_is_no_louder_one():
    """Steps of 64 counts: in one session the noise was a hundred times what it was in another."""
    two = []
    for number, level in enumerate((0.1, 0.5)):
        generator = np.random.default_rng(number)
        counts = 64.0 * (level + np.repeat(np.arange(12), 1000)[:, None] + np.zeros(3))
        counts = 64.0 * np.rint((counts + 8.0 * generator.normal(size=counts.shape)) / 64.0)
        two.append(blocks.session_of(str(number), capture_file.Capture(
            {"sensor": "other", "rate_hz": 100.0, "accel_lsb_per_g": 8192.0},
            10_000 * np.arange(12000), counts.astype(np.int16),
            pose=np.repeat(np.arange(1, 13), 1000))))
    assert noise_bursts.unsteady(two) == []


def test_a_knock_that_all_axes_feel_is_no_noise_in_common():
    session = resting(10.0, n=600)
    session.capture.accel[800:830] += np.rint(np.random.default_rng(2).normal(
        0.0, 2000.0, (30, 1))).astype(np.int16)
    assert noise_shape.in_common([session]) == []
    assert np.abs(noise_shape.correlations([session])[1] - np.eye(3)).max() < 0.1


def test_sessions_without_a_sensor_in_common_have_no_noise_in_common():
    one, other = resting(10.0, n=600), resting(10.0, n=600)
    other.capture.gyro, other.capture.accel = other.capture.accel, None
    assert noise_shape.in_common([one, other]) == []


def test_a_table_that_rings_under_a_box_put_down_is_no_burst_of_noise():
    """Of the first second of a rest nothing is asked: the box has not settled."""
    for settled in (0.0, 1.5):
        session = resting(4.0, n=600)
        for _, first, end in session.runs:
            t = np.arange(end - first) / session.rate - settled
            ring = 200.0 * np.exp(-t / 0.28) * np.sin(8.4 * np.pi * t) * (t >= 0.0)
            session.capture.accel[first:end] += np.rint(ring).astype(np.int16)[:, None]
        said = [sensor for sensor, _, _ in noise_bursts.unsteady([session])]
        assert said == (["accel"] if settled else [])


@pytest.mark.parametrize("before_s, said", [(0.0, []), (2.0, ["accel"])])
def test_a_hand_that_takes_the_box_up_is_no_burst_of_noise(before_s, said):
    """Labels last until the box moves: of the last third of a second, where a hand shook it, were
    bursts of noise and spikes."""
    session, generator = resting(1.5, n=600), np.random.default_rng(3)
    t = np.arange(35) / session.rate
    for _, _, end in session.runs:
        shake = 600.0 * np.sin(np.pi * t / 0.35) ** 2 * np.sin(
            2.0 * np.pi * generator.uniform(6.0, 14.0) * t)
        last = end - int(before_s * session.rate)
        session.capture.accel[last - 35:last] += np.rint(shake).astype(np.int16)[:, None]
    assert [sensor for sensor, _, _ in noise_bursts.unsteady([session])] == said
    session.capture.accel[:, :] = resting(1.5, n=600).capture.accel
    for _, _, end in session.runs:
        last = end - int(before_s * session.rate)
        session.capture.accel[last - 30:last - 5:5] += 600
    assert [sensor for sensor, _, _ in spikes.without_spikes([session])[1]] == said


def test_of_a_first_rest_shorter_than_a_hand_takes_nothing_is_looked_at():
    """Its end less half a second is before the capture, from whose end an index counts then."""
    counts = np.random.default_rng(1).normal(0.0, 10.0, (2000, 3)).astype(np.int16)
    session = SimpleNamespace(capture=SimpleNamespace(accel=counts), rate=100.0,
                              labelled=True, runs=[(1, 0, 30)])
    assert spikes.spikes(session, "accel", but_s=0.5).looked == 0
    assert len(noise_bursts.windows(session, "accel")[0]) == 0
