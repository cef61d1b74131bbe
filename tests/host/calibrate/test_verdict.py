"""The verdict against sessions in which something goes wrong; the bench verdict runs more."""

import pytest

from tests.worlds import hostile_sessions as hostile
from tests.worlds import sigma_coverage, verdict_table

RUNS = {"good": 60, "refused": 12, "never good": 12, "never wrong": 24, "by gyro": 24}
# every pair of poses, every wrong label: one run each
ALL = {"two poses swapped": 60, "one label wrong": 132}


@pytest.mark.parametrize("sensor", hostile.SENSORS)
@pytest.mark.parametrize("case", verdict_table.CASES, ids=lambda case: case[0])
def test_verdict(case, sensor):
    row = verdict_table.judge(case, sensor, range(ALL.get(case[0], RUNS[case[3]])))
    assert row.holds(), "%s\n%s" % (row.line(), row.broken[:3])


@pytest.mark.parametrize("scatter_deg", (0.0, hostile.SCATTER_DEG))
@pytest.mark.parametrize("sensor", hostile.SENSORS)
def test_the_truth_lies_within_sigma_as_often_as_it_should(sensor, scatter_deg):
    for name, shares in sigma_coverage.coverage(sensor, range(60), scatter_deg).items():
        assert sigma_coverage.honest(shares), (name, shares)


def test_a_stuck_axis_is_named():
    session = hostile.Session(3)
    hostile.stale(session, 14 + 24)
    from sixflip_host.calibrate import solution
    found = solution.solve(session.capture())
    assert found.verdict == "refused"
    assert "identical readings of axis z" in found.reason


def test_faces_in_parallel_but_oblique_are_named():
    session = hostile.Session(4)
    hostile.lozenge(session, 4, 12)
    from sixflip_host.calibrate import solution
    found = solution.solve(session.capture())
    assert found.verdict == "refused"
    assert "right angle" in found.reason
