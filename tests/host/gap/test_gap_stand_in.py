"""One cause in another form than the library's is that cause, and nothing else."""
import numpy as np

from sixflip_host.diagnosis import diagnosis
from sixflip_host.experiment import blocks
from sixflip_host.simulation import scenario, simulated_session


def played(readings, play=0.2):
    """Where a gear with that play to both sides is, driven by the readings."""
    at, found = 0.0, []
    for now in readings:
        at = min(max(at, now - play), now + play)
        found.append(at)
    return found


def test_a_play_along_the_whole_way_is_hysteresis_whatever_its_form():
    """A play of 0.2 g, as a gear has it, through a tanh: no form that the simulator has."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 77,
                               "world": {"placement_scatter_deg": 0.05}, "effects": []})
    sessions = []
    for number in range(2):
        capture = simulated_session.session(plan, number)
        g = capture.accel / 16384.0
        added = 0.02 * np.tanh((np.transpose([played(x) for x in g.T.tolist()]) - g) / 0.1)
        capture.accel = np.rint(capture.accel + 16384.0 * added).astype(np.int16)
        capture.gyro = None     # nothing was added to it: half the work
        sessions.append(blocks.of(str(number), capture))
    found = diagnosis.of(sessions, diagnosis.Settings())
    assert {name for _, cause in found.causes for name in cause.names} <= {"hysteresis", "creep"}
    assert found.verdict in ("explained", "partly explained")
    one = diagnosis.of(sessions[:1], diagnosis.Settings())
    assert one.verdict != "no gap"
    assert len(one.gaps["accel"].causes) <= 2
