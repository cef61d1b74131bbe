"""What happens inside the rests counts, too: a slow ripple, single samples that jump."""
import numpy as np
import pytest

from sixflip_host.diagnosis import answer, diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


@pytest.fixture(scope="module")
def captures():
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 21,
                               "world": {"placement_scatter_deg": 0.05}})
    found = [simulated_session.session(plan, k) for k in range(len(plan.worlds))]
    for capture in found:   # the accelerometer alone: half the work
        capture.gyro = None
    return found


def diagnosed(captures, change):
    """The answer on captures whose accelerometer counts change(t, counts, generator) changes."""
    sessions, restored = [], []
    for number, capture in enumerate(captures):
        kept, t = capture.accel, (capture.t_us - capture.t_us[0]) * 1e-6
        changed = kept.astype(float)
        change(t, changed, np.random.default_rng(number))
        capture.accel = np.rint(changed).astype(np.int16)
        sessions.append(blocks.of(str(number), capture))
        restored.append(kept)
    found = answer.of(diagnosis.of(sessions, diagnosis.Settings(jobs=1)))
    for capture, kept in zip(captures, restored):
        capture.accel = kept
    return found


def test_a_slow_ripple_of_8_mg_is_a_line_at_its_frequency(captures):
    def ripple(t, counts, generator):
        counts[:, 0] += 8e-3 * 16384 * np.sin(2.0 * np.pi * 1.03 * t)
    found = diagnosed(captures, ripple)
    cause, = found["causes"]
    assert cause["effect"] == "vibration" and cause["axes"] == ["x"]
    assert cause["value"]["x"] == pytest.approx(8.0, rel=0.1)
    assert any("1.03 Hz" in remark for remark in found["remarks"])
    assert cause["hz"]["x"] == pytest.approx(1.03, abs=0.05)


def test_spikes_in_one_percent_of_the_samples_are_a_gap(captures):
    def spikes(t, counts, generator):
        hit = generator.random(len(t)) < 0.01
        counts[hit, 1] += 256.0 * generator.choice([-1.0, 1.0], hit.sum())
    found = diagnosed(captures, spikes)
    assert found["verdict"] in ("unexplained", "partly explained")
    assert found["where"][0]["domain"] == "noise"
    assert any("spikes" in remark for remark in found["remarks"])


def test_without_either_there_is_no_gap(captures):
    found = diagnosed(captures, lambda t, counts, generator: None)
    assert found["verdict"] == "no gap" and not found["where"]
