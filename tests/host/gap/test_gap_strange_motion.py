"""What a sensor does while it moves: late, deaf near zero, or in a way that has no name."""
import numpy as np
import pytest

from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import answer, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session

LSB_G, LSB_DPS = 16384.0, 65.5


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 21,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0}})
    return [simulated_session.session(plan, k) for k in range(len(plan.worlds))]


def diagnosed(captures, change):
    """The answer on captures whose counts (accel, gyro), as floats, change(t, ...) returns."""
    kept = [(c.accel, c.gyro) for c in captures]
    try:
        for capture in captures:
            t = (capture.t_us - capture.t_us[0]) * 1e-6
            changed = change(t, capture.accel.astype(float), capture.gyro.astype(float))
            capture.accel, capture.gyro = (np.rint(x).astype(np.int16) for x in changed)
        sessions = [blocks.session_of(str(k), c) for k, c in enumerate(captures)]
        return answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1)))
    finally:
        for capture, (accel, gyro) in zip(captures, kept):
            capture.accel, capture.gyro = accel, gyro


@pytest.mark.long
@pytest.mark.parametrize("delay_ms", [10.0, 80.0])
def test_a_late_gyro_is_late_and_nothing_else(captures, delay_ms):
    def late(t, accel, gyro):
        return accel, np.stack([np.interp(t - 1e-3 * delay_ms, t, x) for x in gyro.T], 1)
    found = diagnosed(captures, late)
    assert [(c["sensor"], c["effect"]) for c in found["causes"]] == [("gyro", "filter_lag")]
    assert found["causes"][0]["value"]["tau"] == pytest.approx(delay_ms, rel=0.05)
    assert found["causes"][0]["probability"] > 0.8
    assert found["verdict"] == "explained"


@pytest.mark.parametrize("band_dps", [1.0, 3.0])
def test_a_band_that_the_gyro_reads_less_by_is_a_dead_band(captures, band_dps):
    def deaf(t, accel, gyro):
        band = np.rint(band_dps * LSB_DPS)
        centred = gyro - np.rint(np.median(gyro, axis=0))
        return accel, np.sign(centred) * np.maximum(np.abs(centred) - band, 0.0)
    found = diagnosed(captures, deaf)
    assert [(c["sensor"], c["effect"]) for c in found["causes"]] == [("gyro", "dead_band")]
    for counts in found["causes"][0]["value"].values():
        assert 0.8 < counts / (band_dps * LSB_DPS) < 2.2  # what was turned within it is lost, too


@pytest.mark.long
def test_a_gyro_that_reads_more_by_a_band_has_no_dead_band(captures):
    """A band has a width: what is less than nothing is something else."""
    def more(t, accel, gyro):
        centred = gyro - np.rint(np.median(gyro, axis=0))
        return accel, gyro + np.rint(LSB_DPS * np.tanh(centred / LSB_DPS / 5.0))
    found = diagnosed(captures, more)
    assert found["verdict"] in ("unexplained", "partly explained", "explained")
    assert "dead_band" not in [name for c in found["causes"] for name in c["class"]]


@pytest.mark.parametrize("sensor", ["accel", "gyro"])
def test_a_reading_that_follows_the_size_of_the_rate_has_no_name(captures, sensor):
    def follows(t, accel, gyro):
        speed = np.linalg.norm(gyro / LSB_DPS, axis=1)
        if sensor == "accel":
            accel[:, 0] += 0.2e-3 * LSB_G * speed
        else:
            gyro[:, 1] += 0.005 * LSB_DPS * speed
        return accel, gyro
    found = diagnosed(captures, follows)
    assert found["causes"] == [] and found["verdict"] == "unexplained"
    first = found["where"][0]
    assert (first["sensor"], first["domain"]) == (sensor, "motion")
    assert first["axis"] == {"accel": "x", "gyro": "y"}[sensor]


@pytest.mark.long
def test_samples_lost_in_every_turn_under_a_steady_clock_are_a_gap():
    """All turns end degrees from where gravity says: alike, that was taken for their noise."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 4})
    sessions = []
    for number in range(2):
        whole, generator = simulated_session.session(plan, number), np.random.default_rng(number)
        keep = np.ones(len(whole.accel), bool)
        for first in np.flatnonzero((whole.pose == 0) & (generator.random(len(keep)) < 0.01)):
            keep[first:first + 8] = whole.pose[first:first + 8] != 0
        lost = Capture(dict(whole.meta), whole.t_us[:keep.sum()], whole.accel[keep],
                       whole.gyro[keep], whole.temp[keep], None, whole.pose[keep])
        sessions.append(blocks.session_of(str(number), lost))
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1)))
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert ("gyro", "motion") in {(w["sensor"], w["domain"]) for w in found["where"]}


@pytest.mark.parametrize("seed", [203, 222])
def test_a_hand_that_puts_a_healthy_box_down_degrees_off_is_no_gap_in_motion(seed):
    """The angles between the accelerometer's axes are known no better than its faces lay: taken
    for right ones they made the gyro's matrix wrong, and gravity on the way with it."""
    def plan(number, part):
        return scenario.from_dict({
            "sensor": "mpu6050", "scene": "paper", "seed": seed + 1000 * number,
            "world": {"placement_scatter_deg": 1.5, "tilt_deg": 0.7, **part}})
    first = plan(0, {}).worlds[0]
    part = {key: first[key] for key in ("accel_matrix", "accel_bias_mg", "gyro_matrix",
                                        "gyro_bias_dps")}
    sessions = [blocks.session_of(str(k), simulated_session.session(plan(k, part), 0))
                for k in range(3)]
    found = diagnosis.diagnose_sessions(sessions, diagnosis.Settings(jobs=1))
    assert found.motion.fit is not None and found.motion.nameless == ()
    assert found.verdict == "no gap"


def test_turns_that_each_end_far_off_have_no_name():
    """Runs of rows lost in moves, numbered as if there were none: with no level of noise as large
    as what the turns were off by, what chance made of it was a saturation."""
    def plan(seed, part):
        return scenario.from_dict({"sensor": "mpu6050", "scene": "paper", "seed": seed,
                                   "world": part})
    first = plan(2, {}).worlds[0]
    part = {key: first[key] for key in ("accel_matrix", "accel_bias_mg", "gyro_matrix",
                                        "gyro_bias_dps")}
    whole, lossy = (simulated_session.session(plan(*of), 0) for of in ((2, {}), (102, part)))
    generator, keep = np.random.default_rng(1), np.ones(len(lossy), bool)
    moving = np.flatnonzero(np.abs(lossy.gyro).max(axis=1) > 10.0 * LSB_DPS)
    for start in generator.choice(moving, 25):
        keep[start:start + generator.integers(8, 40)] = False
    lossy = Capture(lossy.meta, lossy.t_us[:keep.sum()], lossy.accel[keep], lossy.gyro[keep],
                    lossy.temp[keep], pose=lossy.pose[keep])
    found = diagnosis.diagnose_sessions(
        [blocks.session_of(str(k), c) for k, c in enumerate((whole, lossy))],
        diagnosis.Settings(jobs=1))
    assert found.verdict == "unexplained" and not found.causes
    assert any("samples may be lost" in said for said in found.remarks)


@pytest.mark.long
def test_rows_of_an_old_buffer_are_no_delay(captures):
    """Ten of 97 rows of the accelerometer are those of a second before: in motion it was a
    `filter_lag` beside that."""
    def old(t, accel, gyro):
        fresh = accel.copy()
        for first in range(200, len(accel) - 10, 97):
            accel[first:first + 10] = fresh[first - 100:first - 90]
        return accel, gyro
    found = diagnosed(captures, old)
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert [d["value"]["later"] for d in found["damage"]] == [100]


@pytest.mark.long
def test_what_bends_an_accelerometer_bends_a_hand_s_acceleration_with_it(captures):
    """Beside `cubic` something nameless followed the rate: a hand's acceleration on its way, which
    is read by another scale than gravity is."""
    def bent(t, accel, gyro):
        felt = accel / LSB_G
        return accel + LSB_G * np.array([0.0, 0.022, -0.015]) * np.sign(felt) * np.abs(
            felt) ** 2.6, gyro
    found = diagnosed(captures, bent)
    assert [(c["sensor"], c["effect"]) for c in found["causes"]] == [("accel", "cubic")]
    assert found["verdict"] == "explained"


@pytest.mark.long
def test_what_follows_the_rate_has_no_name_beside_a_bend_either(captures):
    """That a bend reads a hand's acceleration by another scale is no reason for it."""
    def follows(t, accel, gyro):
        felt, speed = accel / LSB_G, np.linalg.norm(gyro / LSB_DPS, axis=1)
        accel += LSB_G * 0.003 * felt ** 2 * [0.0, 1.0, 0.0]
        accel[:, 0] += 0.3e-3 * LSB_G * speed
        return accel, gyro
    found = diagnosed(captures, follows)
    assert found["verdict"] in ("partly explained", "unexplained")
    assert ("accel", "motion") in {(w["sensor"], w["domain"]) for w in found["where"]}
