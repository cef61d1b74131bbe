"""Something that no library effect is must not be given a library effect's name."""
import numpy as np
import pytest

from sixflip_host.gap import answer, diagnosis, observations
from sixflip_host.simulating import scenario, simulate


@pytest.fixture
def two_sessions(tmp_path, monkeypatch):
    monkeypatch.setenv("SIXFLIP_CACHE", str(tmp_path))
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 77,
                               "world": {"placement_scatter_deg": 0.05, "tilt_deg": 1.0}})
    return [simulate.session(plan, number) for number in (0, 1)]


def test_a_step_at_another_time_in_each_session_is_unexplained(two_sessions):
    for capture, share in zip(two_sessions, (0.35, 0.6)):
        after = np.arange(len(capture)) > share * len(capture)
        capture.accel[after] += np.array([50, -40, 60], np.int16)  # 3 mg
    sessions = [observations.Session(str(k), c) for k, c in enumerate(two_sessions)]
    found = answer.of(diagnosis.Diagnosis(sessions, diagnosis.Settings()))
    assert found["verdict"] == "unexplained"
    assert [c["effect"] for c in found["causes"]] == []
    assert (found["where"][0]["sensor"], found["where"][0]["domain"]) == ("accel", "time")
