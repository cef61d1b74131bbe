"""How the noise of two logs falls off at rest: a chip's own filter, which no motion is fast enough
to show."""
import numpy as np
import pytest
from scipy.signal import butter, lfilter

from sixflip_host.capture.capture import Capture
from sixflip_host.diagnosis import answer
from sixflip_host.diagnosis.diagnose import diagnose
from sixflip_host.diagnosis.simulator import noise_band, traces
from sixflip_host.export import put_back
from tests.worlds import tumbled

RATE_HZ = 200.0


def capture(seed, corner_hz=None, seconds=60.0, beside=lambda t: 0.0, rate_hz=RATE_HZ):
    """The Capture of a board on a table whose noise goes through a Butterworth filter of second
    order, as that of a chip does, with something beside it on z, g."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate_hz)
    noise = rng.standard_normal((len(t), 6))
    if corner_hz:
        noise = lfilter(*butter(2, corner_hz, fs=rate_hz), noise, axis=0)
    force = 0.004 * noise[:, :3] + [0.0, 0.0, 1.0]
    force[:, 2] += beside(t)
    return Capture({**tumbled.META, "rate_hz": rate_hz}, np.rint(1e6 * t).astype(np.int64),
                   np.rint(force * 8192).astype(np.int16),
                   np.rint(0.05 * noise[:, 3:] * 65.5).astype(np.int16))


def resting(*what, **more):
    return traces.trace_from_capture("log", capture(*what, **more))


def falls_off(real, sim):
    return [p.sensor for p in noise_band.falls_off(real, sim) if p.differs]


@pytest.mark.parametrize("corner_hz", [20.0, 44.0])
def test_a_filter_of_one_of_them_is_told_of_both_sensors(corner_hz):
    filtered, white = resting(1, corner_hz), resting(2)
    for logs, words in (((filtered, white), "as the sensor does"), ((white, filtered), "less")):
        accel, gyro = noise_band.falls_off(*logs)
        assert accel.differs and gyro.differs and accel.set_to is None
        assert words in accel.how and "between 40 and 80 Hz" in accel.how
        size = {id(white): 0.004e3 / np.sqrt(RATE_HZ)}.get(id(logs[0]))
        assert size is None or accel.real == pytest.approx(size, rel=0.05)


@pytest.mark.parametrize("corner_hz", [None, 44.0])
def test_noise_of_one_kind_falls_off_alike(corner_hz):
    for seed in range(10, 30, 2):
        assert not falls_off(resting(seed, corner_hz), resting(seed + 1, corner_hz))


@pytest.mark.parametrize("beside", [
    lambda t: 0.01 * np.sin(2.0 * np.pi * 61.0 * t), lambda t: 0.05 * np.sin(6.0 * t),
    lambda t: 0.2 * np.exp(-30.0 * (t % 15.0)) * np.sin(2.0 * np.pi * 70.0 * t)],
    ids=["a fan", "swaying", "knocks"])
def test_what_shakes_one_axis_is_no_filter(beside):
    assert not falls_off(resting(3, beside=beside), resting(4))


def test_seconds_of_rest_and_slow_logs_say_nothing():
    assert not noise_band.falls_off(resting(1, 20.0, seconds=8.0), resting(2))
    assert not noise_band.falls_off(resting(1, 5.0, rate_hz=50.0), resting(2))
    assert falls_off(resting(1, 5.0, rate_hz=100.0), resting(2)) == ["accel", "gyro"]


def test_a_simulator_of_the_same_density_without_the_filter_is_no_right_one():
    """It was: "no gap"."""
    filtered, white = capture(1, 44.0), capture(2)
    found = answer.as_dict(diagnose([("real", filtered)], [("sim", white)]))
    assert [name for name, axes in found["simulator"]["parameters"]["gyro"].items()
            if any(p["differs"] for p in axes.values())] == ["fast_noise"]
    assert put_back.from_diagnosis(found).left == ("fast noise (accel)", "fast noise (gyro)")
