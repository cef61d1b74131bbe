"""Something that no library effect is must not be given a library effect's name."""
import numpy as np
import pytest
from scipy import signal

from sixflip_host.capture import capture_file
from sixflip_host.diagnosis import answer, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


@pytest.fixture
def two_sessions():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 77,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0}})
    return [simulated_session.session(plan, number) for number in (0, 1)]


def test_a_step_at_another_time_in_each_session_is_unexplained(two_sessions):
    for capture, share in zip(two_sessions, (0.35, 0.6)):
        after = np.arange(len(capture)) > share * len(capture)
        capture.accel[after] += np.array([50, -40, 60], np.int16)  # 3 mg
        capture.gyro = None  # the accelerometer alone: half the work
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained"
    assert [c["effect"] for c in found["causes"]] == []
    assert (found["where"][0]["sensor"], found["where"][0]["domain"]) == ("accel", "time")


@pytest.mark.long
def test_a_table_that_gives_way_under_the_box_is_no_drift(two_sessions):
    """A third of a degree about an axis of the box, anew in each rest: it was 0.8 mg of drift."""
    for capture in two_sessions:
        for run in blocks.session_of("", capture).runs:
            since = (capture.t_us[run.first:run.end] - capture.t_us[run.first]) * 1e-6
            up = capture.accel[run.first:run.end].mean(axis=0)
            capture.accel[run.first:run.end] += np.rint(np.radians(0.33) * np.exp(
                -since / 2.3)[:, None] * np.cross([0.4, -0.6, 0.7], up)).astype(np.int16)
        capture.gyro = None  # the accelerometer alone: half the work
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert found["where"][0]["domain"] == "time_since_move"


@pytest.mark.long
@pytest.mark.parametrize("course", [
    lambda u: 1.0 * (u > 0.4), lambda u: 1.0 / (1.0 + np.exp((0.5 - u) * 30.0))],
    ids=["a scale that steps", "what soaks in"])
def test_what_changes_once_in_one_session_is_no_drift(two_sessions, course, request):
    """Both were: the first of every axis by gravity, the second all at once on all axes."""
    soaks = "soaks" in request.node.name
    for number, capture in enumerate(two_sessions):
        capture.gyro = None  # the accelerometer alone: half the work
        if number == 0:
            u = np.linspace(0.0, 1.0, len(capture))[:, None]
            added = 150.0 * course(u) * (np.array([1.0, -0.7, 0.8]) if soaks
                                         else capture.accel / 16384.0)
            capture.accel = np.rint(capture.accel + added).astype(np.int16)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert (found["where"][0]["sensor"], found["where"][0]["domain"]) == ("accel", "time")


def test_a_scale_that_follows_the_temperature_is_no_drift_where_the_library_lacks_it(two_sessions):
    for capture in two_sessions:
        warm = capture.temp / capture.meta["temp_lsb_per_c"] - 25.0
        capture.accel = np.rint(capture.accel * (1.0 + 5e-4 * warm)[:, None]).astype(np.int16)
        capture.gyro = None  # the accelerometer alone: half the work
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    settings = diagnosis.Settings(without=("thermal_scale",))
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, settings))
    assert found["verdict"] == "unexplained"
    assert found["where"][0]["domain"] == "temperature"


def test_a_log_without_a_rest_cannot_tell_that_there_is_no_gap():
    t = np.arange(0.0, 40.0, 0.01)
    generator = np.random.default_rng(3)
    angle = 1.0 * np.sin(2.0 * np.pi * 0.4 * t) + 0.5 * np.sin(2.0 * np.pi * 0.23 * t)
    force = np.stack([np.sin(angle), np.zeros_like(t), np.cos(angle)], 1) * 16384
    rate = np.stack([np.zeros_like(t), np.degrees(np.gradient(angle, 0.01)) * 65.5,
                     np.zeros_like(t)], 1)
    counts = [np.rint(x + generator.normal(0.0, 40.0, x.shape)).astype(np.int16)
              for x in (force, rate)]
    meta = {"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384.0,
            "gyro_lsb_per_dps": 65.5, "g": 9.80665}
    capture = capture_file.Capture(meta, (t * 1e6).astype(np.int64), *counts)
    found = diagnosis.diagnose_sessions([blocks.session_of("moving", capture)],
                                        diagnosis.Settings())
    assert not found.sessions[0].runs
    assert found.verdict == "cannot tell"


@pytest.mark.long
def test_a_fifth_power_is_cubic_and_no_product_of_axes(two_sessions):
    """Products of axes with a discrepancy that showed forty times more than they did were named
    as well."""
    for capture in two_sessions:
        f = capture.accel / 16384.0
        capture.accel = np.rint(capture.accel + 82.0 * f ** 5 * [1.0, -1.0, 1.0]).astype(np.int16)
        capture.gyro = None  # the accelerometer alone: half the work
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert [c["effect"] for c in found["causes"]] == ["cubic"]
    assert found["verdict"] == "explained"


@pytest.mark.long
def test_a_gyro_whose_scale_grows_is_a_gap_in_time(two_sessions):
    """3 % over a session were no gap: nothing that turns show was a function of time."""
    for capture in two_sessions:
        grown = 1.0 + 0.03 * np.linspace(-0.5, 0.5, len(capture))[:, None]
        rest = np.median(capture.gyro, axis=0)
        capture.gyro = np.rint(rest + (capture.gyro - rest) * grown).astype(np.int16)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert (found["where"][0]["sensor"], found["where"][0]["domain"]) == ("gyro", "time")


@pytest.mark.long
def test_what_a_gyro_forgets_of_its_turns_is_no_drift(two_sessions):
    """A firmware that takes off what is slow: 2 % of the mean of 15 s. It was drift that explained
    all, as nothing nameless knew how far the box had been turned."""
    for capture in two_sessions:
        rest, dt = np.median(capture.gyro, axis=0), 1.0 / capture.meta["rate_hz"]
        slow = signal.lfilter([dt / 15.0], [1.0, dt / 15.0 - 1.0], capture.gyro - rest, axis=0)
        capture.gyro = np.rint(capture.gyro - 0.02 * slow).astype(np.int16)
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained" and not found["causes"]
    assert (found["where"][0]["sensor"], found["where"][0]["domain"]) == (
        "gyro", "time_since_move")


def test_noise_of_one_session_alone_is_a_gap(two_sessions):
    """What shook a box all through a session was no gap, eight times as loud as the other."""
    generator = np.random.default_rng(3)
    loud = two_sessions[1]
    loud.accel = np.rint(loud.accel + 330.0 * generator.standard_normal(loud.accel.shape)
                         ).astype(np.int16)
    for capture in two_sessions:
        capture.gyro = None
    sessions = [blocks.session_of("%d.csv" % k, c) for k, c in enumerate(two_sessions)]
    found = answer.as_dict(diagnosis.diagnose_sessions(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained"
    assert found["where"][0]["domain"] == "noise"
    assert any("noise of the accelerometer in 1.csv" in remark for remark in found["remarks"])
