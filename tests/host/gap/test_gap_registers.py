"""What registers and noise do to the rests: rails, steps, torn reads, stuck bits, bursts."""
from types import SimpleNamespace

import numpy as np
import pytest

from sixflip_host.capture import registers as counts
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer, diagnosis, samples_judged
from sixflip_host.diagnosis.detect import (
    noise_bursts,
    rest_spectra,
    saturation,
    spectral_lines,
    spikes,
    torn_reads,
)
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.experiment import block_measures, blocks
from sixflip_host.present import gap_sentence
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.still_session import resting


def captures(effects=(), seed=71, sensor="mpu6050"):
    plan = scenario.from_dict({"sensor": sensor, "scene": "recommended", "seed": seed,
                               "effects": list(effects)})
    return [simulated_session.session(plan, k) for k in range(2)]


def diagnosed(two):
    """The diagnosis of their accelerometers alone, which is half the work."""
    for capture in two:
        capture.gyro = None
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two)]
    return diagnosis.diagnose_sessions(sessions, diagnosis.Settings())


def test_the_edge_of_a_dead_band_shakes_nothing():
    """Within it an axis is silent and at its edge it leaps: neither is how much the box shakes."""
    two = captures(seed=3)
    for capture in two:
        capture.accel[np.abs(capture.accel[:, 0]) < 492, 0] = 0
    found = diagnosed(two)
    assert [(f.effect, f.value) for f in found.findings] == [("dead_band", {"x": 492})]
    assert found.causes == []


def test_rests_cut_off_at_a_rail_tell_of_the_rail_only():
    two = captures()
    for capture in two:
        capture.accel = np.minimum(capture.accel, 16330).astype(np.int16)  # 0.997 g
    found = diagnosed(two)
    assert [(f.effect, f.sensor) for f in found.findings] == [("saturation", "accel")]
    assert found.causes == []
    assert any("rests on a rail were left out" in remark for remark in found.remarks)
    one = found.findings[0]
    assert one.unit == "counts" and set(one.value.values()) == {16330}
    assert "cut off at 16330 counts (0.9967 g), below the rail of 2 g" in one.words
    said = answer.as_dict(found)
    cause, = said["causes"]
    assert cause["effect"] == "saturation"  # the library's name of any level that cuts off
    assert cause["cut_off_at"] == dict.fromkeys(cause["axes"], "below_range")
    assert "is cut off below its range" in gap_sentence.sentence(said)


@pytest.mark.parametrize("clipped", [False, True])
def test_readings_that_go_on_beyond_the_stated_range_sit_on_no_rail(clipped):
    """An LSM6DS3 counts 8.75 mdps, and reaches 286 deg/s in the range that is called 250."""
    turns = 30900.0 * np.sin(np.arange(3000) / 50.0) * (np.arange(3000) % 1000 > 500)
    gyro = np.rint(turns[:, None] + np.random.default_rng(2).normal(0.0, 5.0, (3000, 3)))
    if clipped:
        gyro = np.clip(gyro, -28571, 28571)
        gyro[[40, 1900]] = 30000  # read wrongly
    capture = Capture({"sensor": "other", "rate_hz": 100.0, "gyro_range_dps": 250,
                       "gyro_lsb_per_dps": 1000.0 / 8.75}, 10_000 * np.arange(3000), None,
                      gyro.astype(np.int16))
    assert counts.rail(capture, "gyro") == (28571 if clipped else 32768)
    assert counts.gyro_railed(capture, 500, 1000) == clipped
    session = SimpleNamespace(capture=capture, at_rest=np.arange(3000) % 1000 <= 500)
    assert bool(saturation.saturation([session], "gyro", [capture.gyro])) == clipped


def test_readings_that_end_just_beyond_the_stated_range_end_there():
    """Thirteen bits at 4 mg a count, by name: 4095 of them, where the range of 16 g would be
    4000."""
    x = np.clip(np.rint(6000.0 * np.sin(np.arange(3000) / 40.0)), -4096, 4095)
    capture = Capture({"sensor": "other", "rate_hz": 100.0, "accel_range_g": 16,
                       "accel_lsb_per_g": 250.0}, 10_000 * np.arange(3000),
                      np.column_stack([x, x, x]).astype(np.int16))
    assert counts.rail(capture, "accel") == 4096
    session = SimpleNamespace(capture=capture, at_rest=np.zeros(3000, bool))
    found, = saturation.saturation([session], "accel", [capture.accel])
    assert "sit on the rail" in found.words


def test_a_rest_at_the_largest_reading_ends_no_peak():
    """Noise of a count ends at one code many times, also where a rest is just not one any more."""
    generator = np.random.default_rng(0)
    x = np.rint(247.0 + 0.8 * generator.standard_normal(12000)).astype(np.int64)
    moving = np.zeros(12000, bool)
    for first in range(0, 12000, 400):
        x[first:first + 100] -= np.rint(200 * np.sin(np.linspace(0.0, np.pi, 100))).astype(int)
        moving[first:first + 240] = True
    assert not present(saturation.cut_off_nats(np.minimum(x, 249)))
    peaks = np.rint(400 * np.sin(np.arange(12000) / 60.0) ** 3).astype(np.int64)
    assert present(saturation.cut_off_nats(np.minimum(peaks, 249)))


def test_a_rail_is_no_quiet_second_that_others_are_shaken_beside():
    """Of the paper's twelve poses too few were left to judge, and of the rest of the recording
    what was on the rail was the quiet: a vibration beside the saturation."""
    plan = scenario.from_dict({"sensor": "gy85", "scene": "paper", "seed": 71})
    capture = simulated_session.session(plan, 0)
    capture.accel = np.clip(capture.accel, -250, 250).astype(np.int16)  # 0.98 g
    found = diagnosed([capture])
    assert not found.gaps and "accel" in found.rest
    assert [(f.effect, f.sensor) for f in found.findings] == [("saturation", "accel")]


def test_a_rail_of_the_chip_is_its_range():
    two = captures()
    for capture in two:
        capture.accel = np.clip(capture.accel.astype(int) * 2, -32768, 32767).astype(np.int16)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two)]
    found, = saturation.saturation(sessions, "accel", [c.accel for c in two])
    assert set(found.limits.values()) == {"range"}


@pytest.mark.long
def test_coarse_steps_are_no_bend():
    two = captures(sensor="gy85")  # 4 mg a count, noise narrower than the step
    for capture in two:
        capture.accel = (8 * np.rint(capture.accel / 8.0)).astype(np.int16)
    found = diagnosed(two)
    assert [f.effect for f in found.findings] == ["quantisation"]
    assert found.findings[0].value == {"x": 8, "y": 8, "z": 8}
    assert found.causes == []


@pytest.mark.parametrize("noise", [20.0, 70.0, 100.0])
def test_wide_noise_is_no_bit_that_is_read_wrongly(noise):
    assert all(torn_reads.jumps([resting(noise, seed)]) == [] for seed in range(5))


def test_a_bit_of_256_is_seen_where_the_numbers_are_the_chips_own():
    session, decimals = resting(12.0), resting(12.0, accel_values="float")
    for s in (session, decimals):
        s.capture.accel[50::40, 1] += 256
    assert [sensor for sensor, _, _ in torn_reads.jumps([session])] == ["accel"]
    assert torn_reads.jumps([decimals]) == []


def test_a_strong_vibration_now_and_then_is_no_bit_that_is_read_wrongly():
    """Two thousand samples of 140 mg at 43 Hz "were off by 256 counts"."""
    session = resting(40.0, n=4000)
    t = np.arange(24000) / 100.0
    phase = 2.0 * np.pi * np.cumsum(43.0 + 0.15 * np.sin(t / 6.0)) / 100.0
    on = np.convolve(t % 40.0 < 20.0, np.full(100, 0.01), "same") * (1.0 + 0.25 * np.sin(t / 2.0))
    session.capture.accel[:, 2] += np.rint(655.0 * on * (
        np.sin(phase) + 0.3 * np.sin(2.0 * phase + 0.7))).astype(np.int16)
    assert torn_reads.jumps([session]) == []


@pytest.mark.parametrize("noise", [0.0, 0.15, 0.3, 1.0])
def test_what_rounding_leaves_of_a_mean(noise):
    """Against rounding tried: levels spread over a step, many samples each."""
    step, lsb = 4, 16384.0
    generator = np.random.default_rng(3)
    levels = 5000.0 + np.linspace(0.0, step, 40, endpoint=False)
    errors = []
    for level in levels:
        x = level + noise * step * generator.standard_normal(4000)
        errors.append((step * np.rint(x / step)).mean() - level)
    capture = captures()[0]
    session = blocks.session_of("s", capture)
    counts = session.capture.accel
    counts[:] = step * np.rint(counts / step)
    for a, b in zip(session.first, session.end):
        level = 5000.0 + step * generator.random(3)
        x = level + noise * step * generator.standard_normal((b - a, 3))
        counts[a:b] = step * np.rint(x / step)
    session = blocks.session_of("s", session.capture)
    got = session.rounding_accel / 1000.0 * lsb
    # Sheppard's correction knows little of noise below a third of a step: rather too much.
    assert (got > 0.8 * np.std(errors) - 0.02 * step).all()
    assert (got < min(0.3, 2.0 * np.std(errors) / step + 0.02) * step).all()


@pytest.mark.long
def test_torn_reads_in_noise_of_a_fifth_of_a_page():
    torn = captures([{"effect": "torn_reads", "sensor": "accel", "chance": 0.5}], seed=5)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(torn)]
    assert [(f.effect, f.sensor) for f in samples_judged.judge(sessions).findings] == [
        ("torn_reads", "accel")]
    sound = [blocks.session_of(str(k), c) for k, c in enumerate(captures(seed=5))]
    assert samples_judged.judge(sound).findings == ()


def test_spikes_that_are_no_torn_reads():
    two = captures(seed=6)
    generator = np.random.default_rng(8)
    for capture in two:
        at = generator.choice(len(capture), 400, replace=False)
        capture.accel[at] += generator.integers(-600, 600, (400, 3)).astype(np.int16)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two)]
    assert samples_judged.judge(sessions).findings == ()


@pytest.mark.parametrize("noise", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("bit", [1, 3])
def test_what_a_bit_that_sticks_leaves_of_a_mean(bit, noise):
    """Against readings without it, at levels spread over twice its weight and far apart."""
    weight, generator, errors, columns = 1 << bit, np.random.default_rng(4), [], []
    for level in 2 * weight * (np.arange(64) * 16 + np.arange(64) / 64):
        x = np.rint(level + noise * weight * generator.standard_normal(2000)).astype(np.int16)
        columns.append(x & ~weight)
        errors.append(columns[-1].mean() - level)
    ends = 2000 * np.arange(1, 65)
    got = block_measures.rounding(np.repeat(np.concatenate(columns)[:, None], 3, axis=1),
                               ends - 2000, ends)
    assert got == pytest.approx(np.full(3, np.std(errors)), rel=0.25, abs=0.03 * weight)


@pytest.mark.parametrize("sensor, bit, value", [("mpu6050", 3, 1), ("gy85", 1, 0)])
def test_a_bit_that_sticks_is_said_and_what_it_does_has_no_other_name(sensor, bit, value):
    two = captures(seed=7, sensor=sensor)
    for capture in two:
        capture.accel[:, 1] &= ~(1 << bit)
        capture.accel[:, 1] |= value << bit
    found = diagnosed(two)
    assert [told[:4] for told in counts.stuck_bits(found.sessions)] == [("accel", "y", bit, value)]
    assert found.verdict == "unexplained"
    assert answer.as_dict(found)["causes"] == []
    assert ("accel", "y", "amplitude") in [(w.sensor, w.axis, w.domain) for w in found.where]


def rests(levels, noise, seed=5):
    """A column of a rest of 400 samples at each level."""
    generator = np.random.default_rng(seed)
    return np.rint(np.repeat(levels, 400) + noise * generator.standard_normal(
        400 * len(levels))).astype(np.int64)


def test_two_rests_far_apart_that_are_narrower_than_a_bit_do_not_stick():
    """A turntable's vertical axis lay at 263 to 275 counts, then at 2 to 16: no bit of 32."""
    turntable = rests([269.0, 8.0, 9.0], 1.4)
    assert np.bitwise_or.reduce(turntable) & 32 == 0 and np.ptp(turntable) > 256
    assert counts.fixed_bits(turntable) == []
    session = resting(1.4)
    for axis in range(3):
        session.capture.accel[:, axis] = turntable
    assert counts.stuck_bits([session]) == []


@pytest.mark.parametrize("bit", [2, 3, 4, 5])
def test_a_bit_sticks_where_the_codes_end_at_its_edges(bit):
    swept = rests(np.linspace(-280.0, 280.0, 60), 3.0)
    assert counts.fixed_bits(swept) == []
    stuck_at_0 = swept & ~(1 << bit)
    assert counts.fixed_bits(stuck_at_0) == [(bit, 0)]
    assert present(counts.bit_nats(stuck_at_0, bit))


def test_bursts_of_noise_are_no_vibration():
    two = captures(seed=8)
    generator = np.random.default_rng(9)
    for capture in two:
        rests = np.flatnonzero(capture.pose > 0)
        for start in generator.choice(rests[:-200], 12, replace=False):
            capture.accel[start:start + 150] += np.rint(
                120.0 * generator.standard_t(1.8, (150, 3))).clip(-4000, 4000).astype(np.int16)
    found = diagnosed(two)
    assert {s for s, _, _ in noise_bursts.unsteady(found.sessions)} == {"accel"}
    assert "vibration" not in [f.effect for f in found.findings]
    assert found.verdict in ("unexplained", "partly explained")
    assert ("accel", "noise") in [(w.sensor, w.domain) for w in found.where]


@pytest.mark.long
def test_a_converter_with_fewer_codes_further_out_cuts_nothing_off():
    """Steps that grow with what is read: the largest code of most peaks was a level cut off."""
    two = captures()
    for capture in two:
        size = np.log1p(255.0 * np.abs(capture.accel / 32768.0)) / np.log(256.0)
        back = 32768.0 * np.expm1(np.rint(255.0 * size) / 255.0 * np.log(256.0)) / 255.0
        capture.accel = np.rint(np.sign(capture.accel) * back).astype(np.int16)
    found = diagnosed(two)
    assert "saturation" not in [f.effect for f in found.findings]
    assert found.verdict == "unexplained"


def test_spikes_that_reach_the_rail_are_spikes():
    """Every third of them is cut off there, and that was "explained: saturation"."""
    two, generator = captures(seed=73), np.random.default_rng(3)
    for capture in two:
        rows = np.flatnonzero(generator.random(len(capture.accel)) < 0.008)
        jumped = capture.accel[rows].astype(float) + generator.normal(0.0, 25000.0, (len(rows), 3))
        capture.accel[rows] = np.clip(jumped, -32768, 32767).astype(np.int16)
    found = diagnosed(two)
    assert "saturation" in [f.effect for f in found.findings]
    assert any(remark.endswith("before and after them: spikes") for remark in found.remarks)
    assert found.verdict == "partly explained"
    assert ("accel", "noise") in [(w.sensor, w.domain) for w in found.where]


@pytest.mark.parametrize("coarse, said", [
    (False, ["the z axis of the accelerometer never changes: it is stuck"]), (True, [])])
def test_an_axis_that_nobody_turned_in_coarse_steps_is_not_stuck(coarse, said):
    session = resting(0.2 if coarse else 20.0)
    session.capture.accel[:, 2] = 0
    if coarse:
        session.capture.accel[:, :2] = np.rint(session.capture.accel[:, :2] / 1000.0)
    assert counts.stuck([session]) == said


@pytest.mark.parametrize("wide", [1.5, 1.64, 1.7])
def test_noise_of_two_counts_has_no_spikes(wide):
    """A median of half counts says of every other rest that it is three quarters as wide."""
    generator = np.random.default_rng(4)
    gyro = np.rint(-84.3 + wide * generator.standard_normal((60000, 3))).astype(np.int16)
    session = SimpleNamespace(capture=SimpleNamespace(gyro=gyro), rate=100.0, runs=[
        (1, first, first + 500) for first in range(0, len(gyro), 500)])
    found = spikes.spikes(session, "gyro")
    assert found.looked > 59000 and found.number < spikes.LEAST_SPIKES
    gyro[100::200, 1] += 30
    assert spikes.spikes(session, "gyro").number > 200


def test_samples_with_swapped_bytes_move_no_rest():
    """With wild samples in the means of the rests a crooked box was found in them."""
    two, generator = captures(seed=9), np.random.default_rng(9)
    for capture in two:
        hit = generator.random(len(capture.accel)) < 0.005
        capture.accel[hit] = capture.accel[hit].byteswap()
    found = diagnosed(two)
    assert found.verdict == "unexplained" and found.causes == []
    assert {(w.sensor, w.domain) for w in found.where} == {("accel", "noise")}
    assert any("spikes" in remark for remark in found.remarks)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("rate", [0.6, 1.2, 3.0])
def test_a_log_of_one_row_a_second_has_no_lines_where_nothing_rests(rate):
    """Two seconds of it are a sample or two, whose window is 0: nothing was divided by nothing."""
    session = resting(12.0)
    moving = SimpleNamespace(capture=session.capture, rate=rate, runs=())
    assert rest_spectra.rests([moving], "accel") == []
    assert spectral_lines.strongest([moving], "accel", 0) is None
