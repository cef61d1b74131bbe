"""One long rest, or several in one attitude: what its readings follow, held out in time."""
from dataclasses import replace

import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import gap_figures, rest_gap, rest_units, scored_sets
from sixflip_host.diagnosis.detect import spectral_lines
from sixflip_host.diagnosis.diagnosis import Settings
from sixflip_host.experiment import blocks, long_rest

RATE, SECONDS = 20.0, 400.0
T = np.arange(int(RATE * SECONDS)) / RATE
SWEEP = 25.0 + 6.0 * np.sin(2.0 * np.pi * T / 170.0)  # degC, uncorrelated with a decay


def rest(added=(0.0, 0.0, 0.0), celsius=None, seed=5, start_mg=(20.0, -15.0, 1000.0), noise=0.4):
    """Session of a rest with white noise (mg/√Hz); added: mg a sample, axis by axis."""
    rng = np.random.default_rng(seed)
    mg = np.stack([np.full(len(T), start_mg[i]) + added[i] for i in range(3)], 1)
    accel = np.rint((mg + rng.normal(0.0, noise * np.sqrt(RATE), mg.shape)) * 16.384)
    gyro = np.rint((0.3 + rng.normal(0.0, 0.02, mg.shape)) * 131.0)
    temp = None if celsius is None else np.rint((celsius - 36.53) * 340.0).astype(np.int16)
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 131, "temp_lsb_per_c": 340, "temp_offset_c": 36.53}
    return blocks.session_of("rest", Capture(
        meta, np.rint(T * 1e6).astype(np.int64), accel.astype(np.int16), gyro.astype(np.int16),
        temp, None, np.ones(len(T), np.int16)))


def accel(*sessions):
    return rest_gap.gaps_by_sensor(list(sessions), Settings())["accel"]


def test_a_drift_with_temperature_has_its_slope_and_its_figures():
    found = accel(rest((0.0, 0.0, 1.5 * (SWEEP - 25.0)), SWEEP))
    cause = found.causes[0]
    assert cause.effect == "thermal_bias" and "warm_up" not in cause.names
    low, high = cause.interval["z"]
    assert low < 1.5 < high and high - low < 0.5
    one = found.by_axis["z"]
    assert one.before == pytest.approx(1.5 * 6.0 / np.sqrt(2.0), rel=0.1)
    assert one.after < 1.3 * one.floor and one.share > 0.95 and one.interval[0] > 0.9
    assert not found.nameless


def test_a_bent_drift_with_temperature_keeps_its_name():
    t = (SWEEP - 25.0) / 6.0
    found = accel(rest((0.0, 8.0 * t + 6.0 * t ** 2 - 5.0 * t ** 3, 0.0), SWEEP))
    assert [c.effect for c in found.causes] == ["thermal_bias"]
    assert found.causes[0].letters == ["y"]
    assert found.by_axis["y"].after < 1.5 * found.by_axis["y"].floor


@pytest.mark.parametrize("share", [0.15, 0.2, 0.3, 0.4])
def test_what_comes_and_goes_more_slowly_than_anything_shakes_goes_with_time(share):
    """A motor that draws for a part of every half minute was a vibration of 0.03 Hz; or of 0.06,
    where it draws for a short one."""
    def drawing(period):
        return rest((0.0, 4.0 * (T % period < share * period), 0.0))
    fast, slow = drawing(12.5), drawing(31.0)
    assert [found.effect for found in spectral_lines.findings([fast])] == ["vibration"]
    assert spectral_lines.findings([slow]) == []
    gap = accel(slow)
    assert max(gap.nameless) > 0.9 and gap.causes == ()
    assert {(place.axis, place.domain) for place in gap.places} == {("y", "time")}


def test_a_decay_is_a_warm_up_and_no_temperature():
    found = accel(rest((5.0 * np.exp(-T / 90.0), 0.0, 0.0), SWEEP))
    cause = found.causes[0]
    assert cause.effect == "warm_up" and "thermal_bias" not in cause.names
    assert cause.letters == ["x"] and found.by_axis["x"].share > 0.9


@pytest.mark.parametrize("course, names", [
    (6.0 * (T - 8.0) / 16.0, ["drift", "thermal_bias", "warm_up"]),
    (8.0 * np.exp(-T / 3.0), ["thermal_bias", "warm_up"])])
def test_a_straight_course_is_a_warm_up_or_a_walk(course, names):
    """A quarter of a minute of a drone that stands was a warm-up by 91 %, of three times what is
    seen to change; only a course that bends is one that decays, with the temperature or without:
    there is no thermometer."""
    whole = rest((course, -0.6 * course, 0.0), noise=0.3)
    few = int(16.0 * RATE)
    capture = Capture(whole.capture.meta, *(column[:few] for column in (
        whole.capture.t_us, whole.capture.accel, whole.capture.gyro)), None, None,
        whole.capture.pose[:few])
    cause, = accel(blocks.session_of("short", capture)).causes
    assert sorted(cause.names) == names
    told = list(cause.probabilities.values())
    assert sum(told) > 0.9 and max(told) == pytest.approx(min(told))


def test_a_jump_has_no_name_but_a_place():
    found = accel(rest((0.0, 0.0, np.where(T < 230.0, 0.0, 4.0)), SWEEP))
    assert found.nameless and not found.causes
    assert {(p.axis, p.domain) for p in found.places} == {("z", "time")}


def test_what_leaps_little_is_a_gap_as_well():
    """Two levels 0.5 mg apart wander no more than many a chip does, and were no gap."""
    leaps = np.random.default_rng(6).random(len(T)) < 1.0 / (8.0 * RATE)
    found = accel(rest((0.0, 0.5 * (np.cumsum(leaps) % 2), 0.0), noise=0.05))
    assert found.nameless and not found.causes
    assert {(p.axis, p.domain) for p in found.places} == {("y", "time")}


def test_a_quiet_rest_shows_nothing_and_its_floor_is_its_noise():
    found = accel(rest(celsius=SWEEP))
    assert not found.causes and not found.places and not found.nameless
    assert found.shrinkage.before == pytest.approx(found.shrinkage.floor, rel=0.15)
    assert found.reason("thermal_bias") == "" and "poses" in found.reason("quadratic")


def test_without_a_thermometer_it_is_said_that_none_was_there():
    assert accel(rest()).reason("thermal_bias") == "no temperature column"


def test_rests_that_differ_as_switching_on_makes_them_are_no_gap():
    found = accel(*(rest((offset, 0.0, -offset), seed=seed) for seed, offset in enumerate(
        (0.0, 1.2, -0.8))))
    assert not found.causes and not found.nameless


def switched_on(change_dps):
    """Two sessions of a robot that stops now and then, whose gyro's bias differs by so much."""
    sessions = []
    for number in range(2):
        made = rest(seed=number).capture
        made.gyro += np.int16(np.rint(131.0 * change_dps * number))
        made.pose[:] = np.where(np.arange(len(T)) % 400 < 300, 1, 0)
        sessions.append(blocks.session_of(str(number), made))
    return sessions


def test_a_bias_that_switching_on_changes_needs_no_cause():
    """A tenth of a deg/s between two sessions was as unlikely as between two stops: it went with
    temperature and a warm-up."""
    def nats(change_dps):
        stops = long_rest.in_one_attitude(switched_on(change_dps), ())
        units = rest_units.axis_units(stops, "gyro", "mpu6050", Settings())
        levels = rest_units.levels(stops, "gyro", 0.003, False)
        data = gap_figures.data_of(units)
        return scored_sets.Model(units, data.statistics, levels).scored(()).score
    assert nats(0.0) - nats(0.1) < 5.0
    assert nats(0.0) - nats(1.0) > 20.0  # ten times as much is not usual


def test_a_bias_that_switching_on_changes_is_no_gap_in_the_figures_either():
    found = rest_gap.gaps_by_sensor(switched_on(0.1), Settings())["gyro"]
    assert not found.causes and not found.nameless
    assert found.shrinkage.before < 1.3 * found.shrinkage.floor < 0.01


def test_rests_in_another_attitude_are_left_out():
    leaning = rest(start_mg=(700.0, 0.0, 714.0), seed=2)
    found = long_rest.in_one_attitude([rest(), rest(seed=1), leaning])
    assert set(found.session) == {0, 1}


def test_a_line_is_taken_off_before_the_means_are_made():
    wave = 8.0 * np.sin(2.0 * np.pi * 0.311 * T)
    plain, without = (long_rest.in_one_attitude([rest((0.0, 0.0, wave))], lines)
                      for lines in ((), [("accel", 2, 0.31)]))
    assert plain.values["accel"][:, 2].std() > 1.0
    assert without.values["accel"][:, 2].std() < 0.4


def test_a_bias_that_changes_from_stop_to_stop_of_one_log_is_a_gap():
    """A car's gyro went by a tenth of a deg/s within an hour, and it was no gap: switching on
    again may do that, and nobody had."""
    made = rest().capture
    stop = (T / 40.0).astype(int)
    made.pose[:] = np.where(T % 40.0 < 30.0, 1, 0)
    made.gyro[:, 2] += np.rint(131.0 * np.array(
        [0.0, 0.06, 0.01, -0.07, -0.02, 0.05, 0.1, -0.04, 0.02, -0.08])[stop]).astype(np.int16)
    found = rest_gap.gaps_by_sensor([blocks.session_of("car", made)], Settings())["gyro"]
    assert found.causes or max(found.nameless, default=0.0) > 0.5
    assert found.by_axis["z"].before > 5.0 * found.by_axis["z"].floor


def put_down_again(every_s=40.0, degrees=1.0, seed=3):
    """(n,) mg that x reads of gravity where the box is put down again, another way each time, and
    which of the samples it is moved in."""
    rng = np.random.default_rng(seed)
    place = (T / every_s).astype(int)
    lean = rng.normal(0.0, degrees, place.max() + 1)
    moved = (T % every_s > every_s - 1.5)
    return 1000.0 * np.sin(np.radians(lean[place])), moved


def test_a_box_that_lies_another_way_in_each_rest_is_no_gap():
    """How it leans was 13 mg of the accelerometer "in the session", in any log with stops."""
    leaning, moved = put_down_again()
    whole = rest((leaning, 0.0, 0.0))
    pose = np.where(moved, 0, 1 + (T / 40.0).astype(int) % 2).astype(np.int16)
    capture = whole.capture
    capture.pose = pose
    found = accel(blocks.session_of("rests", capture))
    assert not found.causes and not found.nameless and not found.places
    assert found.by_axis["x"].before == pytest.approx(found.by_axis["x"].floor, rel=0.25)
    assert found.by_axis["x"].floor < 1.0


def test_a_drift_shows_in_rests_that_each_lie_another_way():
    leaning, moved = put_down_again()
    whole = rest((leaning + 1.5 * (SWEEP - 25.0), 0.0, 0.0), SWEEP)
    whole.capture.pose = np.where(moved, 0, 1 + (T / 40.0).astype(int) % 2).astype(np.int16)
    found = accel(blocks.session_of("rests", whole.capture))
    assert [c.effect for c in found.causes] == ["thermal_bias"]
    low, high = found.causes[0].interval["x"]
    assert low < 1.5 < high
    assert found.by_axis["x"].after < 1.4 * found.by_axis["x"].floor


def test_what_brakes_where_a_rest_begins_is_no_drift_of_the_sensor():
    """A car's log: 20 mg of braking in the first second of what looks like a rest."""
    braking = np.where(T % 40.0 < 2.0, 20.0 * np.exp(-(T % 40.0)), 0.0)
    capture = rest((braking, 0.0, 0.0)).capture
    capture.pose = np.where(T % 40.0 > 38.5, 0, 1).astype(np.int16)
    found = accel(replace(blocks.session_of("stops", capture), labelled=False))
    assert not found.causes and not found.nameless and not found.places
    # Who labels a rest says that it has begun.
    assert accel(blocks.session_of("stops", capture)).by_axis["x"].before > 1.0


def test_rests_of_one_mean_each_have_figures():
    """What nothing else in a rest foretells is foretold by the other rests."""
    found = rest_units._pieces(np.array([0, 0, 0, 0, 0, 0, 1, 2, 3]))
    assert sorted(set(found % rest_units.FOLDS)) == list(range(rest_units.FOLDS))
    assert len(set(found[6:])) == 3
    leaning, moved = put_down_again(every_s=6.0)
    whole = rest((leaning, 0.0, 0.0))
    whole.capture.pose = np.where(moved, 0, 1 + (T / 6.0).astype(int) % 2).astype(np.int16)
    judged = accel(blocks.session_of("rests", whole.capture))
    assert not judged.causes and not judged.nameless
    assert all(judged.by_axis[axis].before > 0.0 for axis in "xyz")


def test_a_gyro_that_goes_straight_on_is_no_drift_that_explains_a_gap_which_stays():
    """0.57 deg/s more each second, ten times what a drift of 0.5 deg/s is, was "explained"."""
    t = np.arange(0.0, 10.0, 0.01)
    rng = np.random.default_rng(2)
    gyro = rng.normal(0.0, 0.02, (len(t), 3)) - 0.57 * t[:, None]
    accel_counts = np.rint(16384 * (rng.normal(0.0, 0.003, gyro.shape) + [0.0, 0.0, 1.0]))
    meta = {"sensor": "mpu6050", "rate_hz": 100.0, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 131}
    session = blocks.session_of("ramp", Capture(
        meta, np.rint(t * 1e6).astype(np.int64), accel_counts.astype(np.int16),
        np.rint(131.0 * gyro).astype(np.int16), None, None, np.ones(len(t), np.int16)))
    found = rest_gap.gaps_by_sensor([session], Settings())["gyro"]
    assert not found.causes and max(found.nameless) > 0.99
    assert {place.axis for place in found.places} == set("xyz")
