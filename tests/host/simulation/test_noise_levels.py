"""White noise, flicker and random walk out of a log at rest, held against allantools."""
import allantools
import numpy as np
import pytest
import yaml

from sixflip_host.capture import capture_file
from sixflip_host.capture.capture_file import Capture
from sixflip_host.experiment import signal_measures
from sixflip_host.export import other_simulators
from sixflip_host.export.noise_model import measure

RATE, N, K = 50.0, 4e-3, 4e-4


def readings(seconds, density=N, walk=K, seed=1):
    rng = np.random.default_rng(seed)
    n = int(seconds * RATE)
    return rng.normal(0.0, density * np.sqrt(RATE), n) + np.cumsum(
        rng.normal(0.0, walk / np.sqrt(RATE), n))


def test_our_allan_deviation_is_allantools_overlapping_one():
    x = readings(400.0)
    taus, theirs, _, _ = allantools.oadev(x, rate=RATE, data_type="freq",
                                          taus=[0.02, 0.2, 2.0, 20.0, 60.0])
    ours = [signal_measures.allan(x[:, None], int(round(tau * RATE)))[0] for tau in taus]
    assert ours == pytest.approx(theirs, rel=1e-9)


def test_an_hour_gives_noise_density_and_walk_back_within_three_percent_and_their_interval():
    errors = []
    for seed in range(6):
        density, _, walk = signal_measures.noise_levels([readings(3600.0, seed=seed)], RATE, True)
        errors.append(density.value / N - 1.0)
        assert density.low < density.value < density.high and density.high < 1.02 * density.low
        assert 0.5 * K < walk.high and walk.low < 1.5 * K
    assert np.abs(errors).max() < 0.03


def test_six_hours_give_the_walk_back_within_three_percent_as_allantools_has_it():
    rate, walk, errors = 5.0, 4e-3, []
    for seed in range(6):
        rng, n = np.random.default_rng(seed), int(6 * 3600 * rate)
        x = rng.normal(0.0, N * np.sqrt(rate), n) + np.cumsum(
            rng.normal(0.0, walk / np.sqrt(rate), n))
        found = signal_measures.noise_levels([x], rate, True)[2]
        assert found.value == pytest.approx(walk, rel=0.03)
        assert 0.95 * found.low < walk < 1.05 * found.high
        errors.append(found.value / walk - 1.0)
        (tau,), (deviation,), _, _ = allantools.oadev(x, rate=rate, data_type="freq", taus=[10.0])
        theirs = np.sqrt(3.0 / tau * (deviation ** 2 - N ** 2 / tau))
        assert found.value == pytest.approx(theirs, rel=0.05)
    assert abs(np.mean(errors)) < 0.015


@pytest.mark.long
def test_the_intervals_hold_the_truth_as_often_as_they_say():
    held = [0, 0]
    for seed in range(40):
        density, _, walk = signal_measures.noise_levels(
            [readings(600.0, walk=2e-3, seed=seed)], RATE, True)
        held[0] += density.low <= N <= density.high
        held[1] += walk.low <= 2e-3 <= walk.high
    assert 31 <= held[0] <= 40 and 31 <= held[1] <= 40  # 90 %: all but one run in a thousand


def test_flicker_has_the_bias_instability_that_allantools_shows_as_its_floor():
    rng, n, instability = np.random.default_rng(2), 1 << 16, 1e-3
    f = np.fft.rfftfreq(2 * n, 1.0 / RATE)[1:]
    size = np.concatenate([[0.0], np.sqrt(instability ** 2 / (2.0 * np.pi * f) * RATE * n)])
    x = np.fft.irfft(size * (rng.normal(size=n + 1) + 1j * rng.normal(size=n + 1)))[:n]
    _, floor, _ = signal_measures.noise_levels([x], RATE, True)
    _, deviation, _, _ = allantools.oadev(x, rate=RATE, data_type="freq",
                                          taus=[2.0, 5.0, 10.0, 20.0])
    assert floor.value == pytest.approx(np.median(deviation) / 0.664, rel=0.05)
    assert floor.value == pytest.approx(instability, rel=0.03)


def test_a_rest_that_reads_one_value_says_nothing_of_the_noise():
    x = readings(60.0, walk=0.0)
    levels = signal_measures.noise_levels
    assert levels([np.ones(6000), x], RATE, False) == levels([x], RATE, False)
    assert levels([np.ones(6000)], RATE, True) == (None, None, None)


@pytest.mark.parametrize("slow", [
    lambda t: 0.6 * (t > 100.0), lambda t: 0.2 * np.exp(-t / 40.0),
    lambda t: 0.12 * np.sin(2.0 * np.pi * t / 50.0)], ids=["a step", "warming up", "a swing"])
def test_what_is_slow_in_a_rest_too_short_for_a_walk_takes_nothing_from_the_white_noise(slow):
    """Beside a step of twenty times the noise of a sample it was none."""
    x = readings(250.0, walk=0.0)
    density, flicker, walk = signal_measures.noise_levels(
        [x + slow(np.arange(len(x)) / RATE)], RATE, False)
    assert density.value == pytest.approx(N, rel=0.06) and density.low > 0.8 * N
    assert flicker.low == 0.0 and walk is None


def test_a_line_is_no_noise():
    x = readings(600.0, walk=0.0)
    wave = 5e-3 * np.sin(2.0 * np.pi * 1.7 * np.arange(len(x)) / RATE)
    plain, shaken = (signal_measures.noise_levels([y], RATE, True)[0] for y in (x, x + wave))
    assert shaken.value == pytest.approx(plain.value, rel=0.01)


@pytest.fixture(scope="module")
def log():
    """A board that nobody turned: 10 minutes at rest, the gyro's bias signed."""
    lsb = 16384 / 9.80665
    accel = np.stack([readings(600.0, seed=k) + (0.0, 0.1, 9.8)[k] for k in range(3)], 1) * lsb
    gyro = np.stack([readings(600.0, 1e-4, 0.0, k + 5) for k in range(3)], 1) - 0.02
    meta = {"sensor": "mpu6050", "rate_hz": RATE, "accel_lsb_per_g": 16384,
            "gyro_lsb_per_dps": 131}
    return Capture(meta, np.arange(len(accel), dtype=np.int64) * 20000,
                   np.rint(accel).astype(np.int16),
                   np.rint(np.degrees(gyro) * 131).astype(np.int16))


def test_a_log_at_rest_is_a_noise_model(log):
    found = measure(log)
    assert found["accel"].density == pytest.approx([N] * 3, rel=0.03)
    assert found["accel"].bias is None and found["accel"].matrix is None
    assert found["gyro"].bias == pytest.approx([-0.02] * 3, rel=0.01)


def test_its_files_say_the_sign_the_interval_and_what_is_not_known(log, tmp_path):
    capture_file.write(str(tmp_path / "log.csv"), log)
    for name, write in (("imu.yaml", other_simulators.capture_kalibr),
                        ("imu.sdf", other_simulators.capture_sdf),
                        ("imu.txt", other_simulators.capture_table)):
        write(str(tmp_path / "log.csv"), str(tmp_path / name))
    text = (tmp_path / "imu.yaml").read_text(encoding="utf-8")
    assert "90 %" in text and "at rest" in text
    assert yaml.safe_load(text)["accelerometer_noise_density"] == pytest.approx(N, rel=0.03)
    sdf = (tmp_path / "imu.sdf").read_text(encoding="utf-8")
    assert sdf.count("<mean>-0.0") == 3 and sdf.count(other_simulators.NO_BIAS) == 3
    table = (tmp_path / "imu.txt").read_text(encoding="utf-8").splitlines()
    assert all(len(row.split("\t")) == 6 for row in table[1:])
