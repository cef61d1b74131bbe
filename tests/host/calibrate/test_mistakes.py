"""Nothing wrong is called good, whatever goes wrong; tests/studies/bench/mistakes.py runs more."""

import pytest

from tests.worlds import mistaken_sessions as mistaken
from tests.worlds import planned_sessions

SEEDS = {"nothing": range(1000, 1040), "all flips alike by a wrong angle": range(1000, 1030)}


@pytest.mark.parametrize("name", [name for name, _ in mistaken.MISTAKES
                                  if name not in mistaken.EXEMPT])
def test_no_mistake_makes_a_wrong_correction_good(name):
    for seed in SEEDS.get(name, range(1000, 1015)):
        out = planned_sessions.run(mistaken.make(name, seed))
        assert not out.wrong(), (seed, out.error_mg, out.sigma_mg)
        assert not out.gyro_wrong(), (seed, out.matrix_error, out.matrix_sigma)


def test_sessions_without_a_mistake_are_good():
    outcomes = [planned_sessions.run(mistaken.make("nothing", seed)) for seed in range(50)]
    assert sum(out.verdict == "good" for out in outcomes) >= 49
    assert sum(out.gyro == "good" for out in outcomes) >= 49


@pytest.mark.parametrize("degrees", (174, 186))
def test_flips_all_alike_but_no_half_turns_are_held_against_the_moves(degrees):
    plan = planned_sessions.Plan(3)
    for rest in plan.flips():
        rest.turned = degrees if rest.turned > 0 else -degrees
    out = planned_sessions.run(plan)
    assert out.gyro == "doubtful"
    assert "every flip was %s by" % ("short" if degrees < 180 else "too long") in out.gyro_reason


def test_a_gyro_refused_for_its_scale_still_doubts_the_flips():
    plan = planned_sessions.Plan(3)
    for rest in plan.flips():
        rest.turned = 148 if rest.turned > 0 else -148
    out = planned_sessions.run(plan)
    assert out.gyro == "refused" and "gyro scale" in out.gyro_reason
    assert out.verdict == "doubtful"


def test_a_step_of_an_offset_between_poses_is_in_the_uncertainty():
    plan = planned_sessions.Plan(0)
    plan.changes.append((4, lambda now: setattr(now, "b", now.b + [0.0, 0.0, 0.006])))
    out = planned_sessions.run(plan)
    assert out.verdict != "good"
    assert out.error_mg < 4 * out.sigma_mg


def test_a_creep_that_hides_in_the_scale_is_in_the_uncertainty():
    plan = mistaken.make("creep", 43)
    out = planned_sessions.run(plan)
    assert out.error_mg > 2.0
    assert out.sigma_mg > out.error_mg / 4
