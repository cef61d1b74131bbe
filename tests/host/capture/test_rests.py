"""The one finder of rests: the board's windows bit by bit, labels, what hangs and what shakes."""
import numpy as np
import pytest

from sixflip.poses.still_window import StillWindow
from sixflip_host.capture import rests, still_windows
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis.detect import rest_parts

META = {"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384.0,
        "gyro_lsb_per_dps": 131.0, "accel_range_g": 2.0}


def recording(n=1500, seed=3, gyro=True):
    """Noise at rest with a jump, a rail, readings that hang over a window's border, and steps
    of four in the gyro until its middle."""
    rng = np.random.default_rng(seed)
    accel = np.rint(rng.normal([100, -200, 16384], 40, (n, 3))).astype(np.int16)
    rates = np.rint(rng.normal(0, 12, (n, 3))).astype(np.int16)
    rates[:n // 2] = rates[:n // 2] // 4 * 4
    accel[210, 1] = 9000
    accel[333] = 32767, 0, -32768
    accel[440:480] = accel[440]
    rates[700, 2] = -32768
    rates[910:955] = rates[910]
    return Capture(dict(META), 10000 * np.arange(n), accel, rates if gyro else None)


def boards(capture, length, rails):
    """The StillWindow of the board after each full window: (mean, variance, ...) of each."""
    window, out = StillWindow(length, *rails, 10000), []
    gyro = capture.gyro if capture.gyro is not None else np.zeros((len(capture), 3), int)
    samples = np.column_stack([capture.accel, gyro, np.zeros(len(capture), int)]).tolist()
    axes = 6 if capture.gyro is not None else 3
    for sample in samples[:len(samples) // length * length]:
        if window.add(10000, sample):
            out.append(([window.mean(i) for i in range(axes)],
                        [window.variance(i) for i in range(axes)],
                        [window.step(k) for k in range(2)],
                        [window.accel_saturated, window.gyro_saturated],
                        bool(window.stale), window.jumped))
    return out


@pytest.mark.parametrize("turned_dps, tremor, gyro, number", [
    (0.0, 0.0, True, 1), (1.0, 0.0, True, 2), (0.0, 300.0, True, 2), (0.0, 0.0, False, 2)])
def test_two_rests_are_one_where_it_is_only_louder_between_them(turned_dps, tremor, gyro, number):
    rng = np.random.default_rng(6)
    loud = np.where(np.arange(900) // 300 == 1, 5.0, 1.0)[:, None]
    accel = [0.0, 0.0, 16384.0] + 40.0 * loud * rng.normal(size=(900, 3))
    rates = 12.0 * loud * rng.normal(size=(900, 3))
    rates[400:450] += 131.0 * turned_dps
    accel[300:600] += tremor * np.sin(2.0 * np.pi * 0.09 * np.arange(300))[:, None]
    capture = Capture(dict(META), 10000 * np.arange(900), np.rint(accel).astype(np.int16),
                      np.rint(rates).astype(np.int16) if gyro else None)
    runs = [rests.Run(1, 0, 300), rests.Run(1, 600, 900)]
    joined = rest_parts.joined(capture, runs)
    assert len(joined) == number and (joined[0].first, joined[-1].end) == (0, 900)
    side_by_side = [rests.Run(1, 0, 300), rests.Run(2, 300, 900)]
    assert rest_parts.joined(capture, side_by_side) == side_by_side


@pytest.mark.parametrize("gyro", [True, False])
@pytest.mark.parametrize("at_a_time", [3, 400])
def test_the_windows_are_the_boards_bit_by_bit(gyro, at_a_time, monkeypatch):
    monkeypatch.setattr(still_windows, "AT_A_TIME", at_a_time)
    capture = recording(gyro=gyro)
    found = still_windows.cut_into_windows(capture)
    expected = boards(capture, found.length, found.rails)
    assert len(found) == len(expected) == 60
    for k, fields in enumerate(zip(*expected)):
        name = ("mean", "variance", "step", "saturated", "stale", "jumped")[k]
        assert np.array_equal(getattr(found, name), np.array(fields)), name
    assert found.jumped.sum() >= 1 and found.stale.sum() >= 1 and found.saturated.any()


def test_a_table_of_windows_is_not_changed():
    with pytest.raises(ValueError, match="read-only"):
        still_windows.cut_into_windows(recording()).mean[0] = 0.0


def test_labelled_runs_that_are_long_enough_and_not_left_out():
    pose = np.array([0, 1, 1, 1, 2, 0, 0, 3, 3, 3, 3])
    assert rests.labelled(pose) == [(1, 1, 4), (2, 4, 5), (3, 7, 11)]
    assert rests.labelled(pose, shortest=3, without=(3,)) == [(1, 1, 4)]
    assert rests.labelled(None) == [] == rests.labelled(np.zeros(0, int))


def test_the_longest_rest_has_exact_means():
    capture = recording()
    capture.accel[300:] = np.rint(np.random.default_rng(4).normal(
        [100, -200, 16384], 40, (1200, 3)))
    capture.gyro[300:] = np.rint(np.random.default_rng(5).normal(0, 12, (1200, 3)))
    found = rests.longest(capture)
    assert found.reason == "" and found.n >= 1100
    inside = capture.accel[found.first:found.first + found.n].astype(object)
    assert found.means[:3] == tuple(sum(column) / found.n for column in inside.T)
    assert found.noise_mg(16384.0)[0] == pytest.approx(40 / 16.384, rel=0.1)


def test_why_there_is_no_rest_is_said():
    shaken = recording()
    shaken.accel += np.random.default_rng(1).normal(0, 700, shaken.accel.shape).astype(np.int16)
    assert rests.longest(shaken).reason.startswith("it shakes")
    short = recording()
    short = Capture(short.meta, short.t_us[:60], short.accel[:60], short.gyro[:60])
    assert rests.longest(short).reason == "0.6 s are too short, 1.0 s of rest are needed"


def test_what_turns_at_a_steady_rate_is_no_rest():
    """A table that turns step by step: gravity stays, and the gyro is as quiet as at rest. A bias
    that creeps through the session by as much leaves its rests what they are."""
    rng = np.random.default_rng(4)
    moving = np.repeat(np.arange(15) % 2 == 1, 300)
    accel = np.rint(rng.normal([100, -200, 16384], 40, (4500, 3)))
    still = accel.copy()
    accel[moving] += np.rint(rng.normal(0, 2000, (moving.sum(), 3)))
    shape = np.repeat(np.arange(15) // 2, 300)
    for rates, number in ((np.where(shape % 2 == 1, 30.0 + 5.0 * shape, 0.4), 4),
                          (0.4 + 1.5 * shape, 8)):
        gyro = rng.normal(0, 12, (4500, 3))
        gyro[:, 2] += 131.0 * rates
        capture = Capture(dict(META), 10000 * np.arange(4500), accel.astype(np.int16),
                          np.rint(gyro).astype(np.int16))
        resting = rests.find(capture).rests
        assert len(resting) == number
        assert not moving[[(rest.first + rest.end) // 2 for rest in resting]].any()
    # A bias that jumps while nothing moves is not lost with all that follows.
    levels = np.where(np.arange(4500) < 1800, 0.4, 9.0)
    gyro = rng.normal(0, 12, (4500, 3)) + 131.0 * levels[:, None]
    jumped = Capture(dict(META), 10000 * np.arange(4500), still.astype(np.int16),
                     np.rint(gyro).astype(np.int16))
    assert sum(rest.end - rest.first for rest in rests.find(jumped).rests) > 4200


def test_a_noisy_bias_that_jumps_has_not_moved():
    rng = np.random.default_rng(3)
    gyro = rng.normal(0.0, 0.8, (4500, 3))
    gyro[1800:, 2] += 7.0
    accel = np.rint(rng.normal([100, -200, 16384], 40, (4500, 3)))
    jumped = Capture(dict(META), 10000 * np.arange(4500), accel.astype(np.int16),
                     np.rint(131.0 * gyro).astype(np.int16))
    assert sum(rest.end - rest.first for rest in rests.find(jumped).rests) > 4200


def on_its_way(rates, tilts=()):
    """Capture of rows at 100 Hz that rest on Z+ and turn at rates (n,) deg/s about z; tilts:
    (first, end, mg along x) of stretches where a hand, or a vehicle, holds it otherwise."""
    rng, n = np.random.default_rng(6), len(rates)
    accel = rng.normal([100, -200, 16384], 40, (n, 3))
    gyro = rng.normal(0, 12, (n, 3)) + np.outer(131.0 * rates, [0.0, 0.0, 1.0])
    for first, end, mg in tilts:
        accel[first:end, 0] += 16.384 * mg
        accel[first:end] += rng.normal(0, 120, (end - first, 3))
    return Capture(dict(META), 10000 * np.arange(n), np.rint(accel).astype(np.int16),
                   np.rint(gyro).astype(np.int16))


@pytest.mark.parametrize("seconds, kept", [(0.0, True), (0.1, True), (0.4, False)])
def test_a_table_that_comes_to_its_rate_within_a_second_turns(seconds, kept):
    """Between two rests, near both: with its rate taken for a rest's no turn could be told."""
    ramp = np.linspace(0.0, 1.0, int(100 * seconds) + 2)
    rates = np.concatenate([np.zeros(800), 60.0 * ramp, np.full(300, 60.0), 60.0 * ramp[::-1],
                            np.zeros(800)])
    found = rests.find(on_its_way(rates)).rests
    assert any(rest.first < len(rates) // 2 < rest.end for rest in found) == kept
    assert sum(rest.end - rest.first for rest in found) > 1400


def test_what_a_vehicle_does_on_its_way_is_no_rest_held_by_hand():
    """A hand's rests are taken for faces that no other has: a car that brakes steadily was held by
    hand in its only pose, and all its stops with it."""
    tilts = [(600, 1000, 190.0), (1600, 2000, -120.0)]
    found = rests.find(on_its_way(np.zeros(2600), tilts)).rests
    assert [rest.by_hand for rest in found] == [False] * 3
    turned = on_its_way(np.zeros(2600), tilts)
    turned.accel[600:1000] = turned.accel[600:1000, [2, 1, 0]]
    assert [rest.by_hand for rest in rests.find(turned).rests] == [False, True, False, False]


def lying(n, rng, level=(3.4, 5.2, -0.4), gyro_noise=0.6):
    """(accel mg, gyro deg/s) at rest."""
    return (rng.normal([0.0, 0.0, 1000.0], 3.0, (n, 3)),
            rng.normal(level, gyro_noise, (n, 3)))


def moving(n, rng):
    t = np.arange(n)[:, None] / 100.0
    return (rng.normal([0.0, 0.0, 1000.0], 3.0, (n, 3)) + 300.0 * np.sin(t * [3.0, 4.0, 5.0]),
            80.0 * np.sin(t * [3.3, 4.1, 5.7]) + rng.normal(0, 0.6, (n, 3)))


def recorded(parts):
    accel, gyro = (np.vstack(each) for each in zip(*parts))
    return Capture(dict(META), 10000 * np.arange(len(accel)), np.rint(
        accel * 16.384).astype(np.int16), np.rint(gyro * 131.0).astype(np.int16))


def test_a_gyro_that_hangs_is_no_rest_where_it_rests_elsewhere():
    rng = np.random.default_rng(11)
    found = rests.find(recorded([lying(500, rng), moving(600, rng), lying(
        200, rng, (13.0, 14.0, 12.0), 0.1), moving(300, rng), lying(400, rng)])).rests
    assert [rest.first < 100 or rest.first >= 1600 for rest in found] == [True, True]
    assert sum(rest.end - rest.first for rest in found) > 750


@pytest.mark.parametrize("gyro_noise", [0.6, 0.1])
def test_what_rests_for_a_short_while_beside_a_turntable_is_still_the_rest(gyro_noise):
    """A gyro that reads more in the longer stretch does not rest there."""
    rng = np.random.default_rng(12)
    found = rests.find(recorded([moving(300, rng), lying(600, rng, (0.0, 1.0, 0.0), gyro_noise),
                                 moving(300, rng), lying(300, rng, (0.0, 0.0, 45.0), 0.3)])).rests
    assert [(290 < rest.first, rest.end < 910) for rest in found] == [(True, True)]


def test_free_flight_is_no_rest_where_something_reads_gravity():
    rng = np.random.default_rng(13)
    pad, coast = lying(400, rng), lying(500, rng)
    pad = 3.0 * (pad[0] - [0, 0, 1000]) + [0, 0, 1000], pad[1]
    coast = 0.1 * (coast[0] - [0, 0, 1000]) + [100.0, 0.0, 110.0], coast[1]
    found = rests.find(recorded([pad, moving(400, rng), coast, moving(300, rng)])).rests
    assert found and all(rest.end <= 420 for rest in found)


def test_a_sensor_in_the_wrong_range_reads_half_a_g_and_rests_all_the_same():
    """With its offset some faces read less than half of 1 g and others more."""
    rng = np.random.default_rng(14)
    parts = []
    for face in np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, 0]]):
        accel, gyro = lying(300, rng)
        parts += [(0.5 * (accel - [0, 0, 1000]) + 500.0 * face + [0, 0, 25.0], gyro),
                  moving(200, rng)]
    assert len(rests.find(recorded(parts)).rests) == 4
