"""Crooked faces are said to be the box's, by the face, and are no gap of the sensor."""
from dataclasses import replace

import numpy as np
import pytest

from sixflip_host.diagnosis import box_tilt_test, diagnosis
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session


def diagnosed(faces, tilt_deg=2.0):
    effects = [dict(faces, effect="box_tilt")] if faces else []
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 17,
                               "world": {"tilt_deg": tilt_deg, "placement_scatter_deg": 0.03},
                               "effects": effects})
    captures = [simulated_session.session(plan, k) for k in range(2)]
    for capture in captures:
        capture.gyro = None     # the accelerometer alone: half the work
    sessions = [blocks.session_of(str(k), c) for k, c in enumerate(captures)]
    return diagnosis.diagnose_sessions(sessions, diagnosis.Settings())


def test_a_square_box_on_a_tilted_table():
    found = diagnosed({})
    assert found.gaps["accel"].crooked[0].worst < 0.1
    assert not [w for w in found.where if w.domain == "across_gravity"]


def test_a_pair_of_faces_that_is_not_parallel():
    found = diagnosed({"X+y": 0.8, "X-y": 0.8})
    off = found.gaps["accel"].crooked[0]
    assert max(off.deg, key=off.deg.get)[0] == "X"
    # leaning alike on opposite faces is what no axis of a sensor can do
    assert off.worst == pytest.approx(0.8, abs=0.1)
    assert any(remark.endswith("a crooked box or placement, not the sensor")
               for remark in found.remarks)
    assert ("across_gravity", None) in [(w.domain, w.axis) for w in found.where]


def test_a_sensor_that_bends_is_not_blamed_on_the_box_by_faces_alone():
    """Twelve poses without any that leans: a box that is not square spans whatever is even."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "paper", "seed": 5,
                               "effects": [{"effect": "quadratic", "y": 12.0}]})
    session = blocks.session_of("s", simulated_session.session(plan, 0))
    said = box_tilt_test.squareness(session, attitude_fit.fit(session)).remark()
    assert "a crooked box or placement, or a sensor that bends" in said


@pytest.mark.parametrize("deg, said", [(0.1, False), (0.3, True)])
def test_a_box_off_by_what_boxes_are_is_no_gap(deg, said):
    """Of a healthy sensor in a box off by a tenth of a degree it was "explained"."""
    names = [face + axis for face in ("Z+", "Z-", "X+", "X-", "Y+", "Y-")
             for axis in "xyz".replace(face[0].lower(), "")]
    angles = np.random.default_rng(6).normal(0.0, deg, len(names))
    found = diagnosed(dict(zip(names, angles.tolist())))
    assert any("box_tilt" in cause.names for _, cause in found.causes) is said
    assert (found.verdict == "no gap") is not said


def test_a_crooked_box_is_no_part_of_what_a_larger_cause_leaves():
    """Beside a creep of another form 0.4 deg were a class of eleven names that explained nothing:
    no cause has the very form of the library, and a share of what it gains leans the faces."""
    gap = diagnosed({"X+y": 0.4, "X-y": 0.4}).gaps["accel"]
    alone = replace(gap, causes=[])
    assert [cause.effect for cause in box_tilt_test.search(alone)[0]] == ["box_tilt"]
    large, = (replace(cause, effect="creep", score=1e6) for cause in gap.causes)
    assert box_tilt_test.search(replace(gap, causes=[large]))[0] == []
