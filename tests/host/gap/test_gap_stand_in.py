"""Names that only stand in for something that nobody knows are not given."""
import numpy as np

from sixflip_host.gap import diagnosis, observations
from sixflip_host.simulating import scenario, simulate


def test_what_follows_the_way_there_is_not_named_after_the_attitude():
    """A play of 0.2 g, as a gear has it, along the whole way: no effect of the library."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 77,
                               "world": {"placement_scatter_deg": 0.05}, "effects": []})
    sessions = []
    for number in range(2):
        capture = simulate.session(plan, number)
        state = np.zeros(3)
        g = capture.accel / 16384.0
        added = np.empty_like(g)
        for k, now in enumerate(g):
            state = np.clip(state, now - 0.2, now + 0.2)
            added[k] = 0.05 * np.tanh((state - now) / 0.1)
        capture.accel = np.rint(capture.accel + 16384.0 * added).astype(np.int16)
        sessions.append(observations.Session(str(number), capture))
    found = diagnosis.Diagnosis(sessions, diagnosis.Settings())
    assert found.verdict == "unexplained"
    assert not [c for _, c in found.causes if c.plausible and not c.members
                and c.effect not in ("hysteresis", "creep")]
    one = diagnosis.Diagnosis(sessions[:1], diagnosis.Settings())
    assert one.verdict in ("unexplained", "cannot tell", "partly explained")
    assert len(one.gaps["accel"].causes) <= 2
