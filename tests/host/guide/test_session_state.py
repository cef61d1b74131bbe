"""Events in, state out: what a session's events make known, and that no event can break it."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sixflip_host.board.board_events import parse
from sixflip_host.board.event_words import lasting
from sixflip_host.guide import next_step as steps
from sixflip_host.guide.session_state import CALIBRATING, OVER, SIX, SOLVING, State, after

ALL = list(SIX)


def fed(*events, state=None):
    """The State after events, one a second."""
    state = state or State()
    for event in events:
        state = after(state, event, state.now + 1.0)
    return state


def calibrating(missing=ALL):
    return {"event": "calibrating", "missing": list(missing), "plan": False}


def live(box="moving", **fields):
    return dict({"event": "state", "state": box, "pose": "", "reason": "", "value": 1.2,
                 "limit": 2, "unit": "x noise", "progress": 0, "total": 400, "left_s": 290},
                **fields)


def taken(pose, missing):
    return {"event": "pose", "pose": pose, "n": 400, "missing": list(missing)}


def without(*poses):
    return [pose for pose in ALL if pose not in poses]


def test_a_session_from_hello_to_saved():
    state = fed({"event": "hello", "id": "00aa", "chip": "MPU6050"}, calibrating(),
                taken("Z+a", without("Z+a")))
    assert (state.board, state.chip, state.stage) == ("00aa", "MPU6050", CALIBRATING)
    assert state.taken == {"Z+a": 400} and len(state.missing) == 11
    state = fed({"event": "capture", "samples": 9}, state=state)
    assert state.stage == SOLVING
    state = fed({"event": "solved", "verdict": "good", "tilt_deg": 2.0},
                {"event": "saved", "slot": "a", "sequence": 3}, state=state)
    assert (state.stage, state.verdict, state.saved["sequence"]) == (OVER, "good", 3)
    assert state.log[-1] == "saved in slot a, sequence 3"


def test_a_refused_session_is_over_when_it_is_solved():
    refused = {"event": "solved", "verdict": "refused", "reason": "x"}
    assert fed(calibrating(), refused).stage == OVER


def test_undo_and_redo_give_the_poses_back():
    state = fed(calibrating(), taken("Z+a", without("Z+a")), taken("Z+b", without("Z+a", "Z+b")),
                {"event": "redo", "face": "Z+", "missing": ALL})
    assert state.taken == {} and state.missing == SIX


def test_after_an_undo_the_next_step_is_the_face_taken_back_not_the_first_of_the_round():
    lies = live(live=[0, -1000, 0, 0, 0, 0])
    state = fed(calibrating(), taken("Y-a", without("Y-a")), lies,
                {"event": "redo", "face": "Y-", "missing": ALL})
    assert steps.next_step(state).head == "Y- again, as the box lies"
    lifted = fed(live(live=[0, 0, 1000, 0, 0, 0]), state=state)
    assert steps.next_step(lifted).head == "lay the box down with Y- up"
    assert steps.next_step(fed(taken("Y-a", without("Y-a")), state=lifted)).kind == steps.FLIP


def test_an_undone_flip_of_a_plan_is_not_turned_once_more():
    words = ("Z+a: lay it down", "Z+b: half a turn to the left", "L1: lean it")
    gone = {"event": "redo", "face": "Z+b", "at": 1, "of": 3, "next": ["Z+b"]}
    state = fed(dict(calibrating(["Z+a", "Z+b", "L1"]), plan=True),
                {"event": "pose", "pose": "Z+b", "n": 400, "at": 2, "of": 3, "next": ["L1"]}, gone)
    assert steps.next_step(state, words.__getitem__).head == "Z+b again, as the box lies"
    assert lasting(gone, words.__getitem__) == ["Z+b again (1 of 3): as it lay before"]
    state = fed(dict(gone, face="Z+a", at=0, next=["Z+a"]), state=state)    # and one more
    assert steps.next_step(state, words.__getitem__).detail == "lay it down"


def test_a_session_that_goes_on_knows_what_is_done_already():
    state = fed(calibrating(without("X+a", "X+b")))
    assert set(state.taken) == {"X+a", "X+b"}
    assert state.left() is None     # no pace is known yet


def test_a_host_that_comes_later_learns_it_from_the_live_state():
    state = fed(live(live=[10, -20, 1000, 1, 2, -3]), live(missing=without("Z+a")))
    assert state.stage == CALIBRATING and state.taken == {"Z+a": 0}
    assert state.vector == (0.01, -0.02, 1.0) and state.rate == (1.0, 2.0, -3.0)


def test_the_time_left_is_the_usual_pace():
    state = fed(calibrating())
    for k, seconds in enumerate((10, 10, 100)):     # one took long: somebody rang
        state = after(state, taken(ALL[k], ALL[k + 1:]), state.now + seconds)
    assert state.left() == pytest.approx(9 * 10)
    assert after(state, live(), state.now + 4).left() == pytest.approx(86)


def test_without_a_gyro_there_is_no_rate():
    assert fed(calibrating(), live(live=[0, 0, 1000])).rate is None


def test_a_corrected_sample_moves_the_vector():
    state = fed({"event": "sample", "a": [0, 0, 9.80665], "w": [0, 0, math.radians(90)]})
    assert state.vector == (0, 0, 1) and state.rate[2] == pytest.approx(90)


def test_the_trail_and_the_log_stay_bounded():
    state = fed(*[live(live=[k, 0, 1000]) for k in range(300)],
                *[{"event": "bus_error", "errno": k} for k in range(300)])
    assert len(state.trail) == 240 and len(state.log) == 200
    assert state.trail[-1][1][0] == pytest.approx(0.299)


@pytest.mark.parametrize("missing, pose", [
    (ALL, "Z+a"), (without("Z+a"), "Z+b"), (without("Z+a", "Z+b"), "X+a"),
    (["Y-b", "Y-a", "X-b"], "X-b"), ([], "")])
def test_a_flip_that_is_due_comes_first_then_the_round(missing, pose):
    assert steps.following(tuple(missing)) == pose


@pytest.mark.parametrize("event, kind, words", [
    (live("measuring noise"), steps.REST, "leave the box alone"),
    (live(), steps.FLIP, "half a turn, Z+ stays up"),
    (live("capturing", pose="Z+b", progress=40), steps.HOLD, "KEEP STILL: Z+b"),
    (live(missing=without("Z+a", "Z+b")), steps.PLACE, "lay the box down with X+ up"),
    ({"event": "capture"}, steps.WAIT, "computes"),
    ({"event": "ready"}, steps.DONE, "done")])
def test_what_to_do_next(event, kind, words):
    state = fed(calibrating(), taken("Z+a", without("Z+a")), event)
    step = steps.next_step(state)
    assert step.kind == kind and words in step.head


@pytest.mark.parametrize("vector, words", [
    ([0, 0, 1000], "lift it"), ([0, 0, 1000, 0, 0, 0], "flat on the table")])
def test_without_a_gyro_the_box_has_to_be_lifted(vector, words):
    hello = {"event": "hello", "id": "1", "sensor": "gy85" if vector[3:] else "adxl345"}
    assert ("lift the box" in " ".join(lasting(hello))) == (not vector[3:])
    state = fed(calibrating(), taken("Z+a", without("Z+a")), live(live=vector))
    assert words in steps.next_step(state).detail


@pytest.mark.parametrize("event, words", [
    (live(reason="crooked", value=22.04, limit=15, unit="deg"), "(22 deg, limit 15 deg)"),
    (live(reason="moving", value=9.2), "not at rest yet: it moves (9.2 x noise, limit 2 x noise)"),
    (live("capturing"), ""),
    (live(reason="saturated", value=32767, limit=32767, unit="counts"), "full scale"),
    (live(reason="wrong face", unit="face", value=4, limit=0), "this is Y+, the plan wants Z+ up"),
    (live(reason="\x1b[2J"), "\\x1b[2J")])
def test_why_it_waits(event, words):
    said = steps.why_it_waits(fed(calibrating(), event))
    assert words in said if words else said == ""


def test_a_refusal_is_shown_until_the_next_rest():
    refused = {"event": "refused", "pose": "Z+", "reason": "not a flip", "value": 91, "limit": 140,
               "unit": "deg"}
    state = fed(calibrating(), refused, live(reason="moving"))
    assert "half a turn, flat on the table (91 deg, limit 140 deg)" in steps.why_it_waits(state)
    assert steps.why_it_waits(fed(live("settling"), state=state)) == ""


@pytest.mark.parametrize("vector, face", [
    ((0.1, 0, 1), "Z+"), ((0, -1, 0.1), "Y-"), ((0.7, 0.7, 0), ""), (None, "")])
def test_the_face_that_is_up(vector, face):
    assert steps.face_up(State(vector=vector)) == face


PLAN = ("Z+a: lay the box down with Z+ up", "Z+b: half a turn to the left (anticlockwise)",
        "L1: lean the box on something, still: Z+ up, but leaned", "all placements done")


@pytest.mark.parametrize("at, following, kind", [
    (0, ["Z+a"], steps.PLACE), (1, ["Z+b"], steps.FLIP), (2, ["L1"], steps.LEAN),
    (3, [], steps.REST)])
def test_a_plan_in_its_own_words(at, following, kind):
    state = fed(dict(calibrating(["Z+a", "Z+b", "L1"]), plan=True),
                live(at=at, of=3, next=following))
    step = steps.next_step(state, PLAN.__getitem__)
    assert step.kind == kind and (state.at, state.planned) == (at, 3)


JSON = st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9)
                    | st.sampled_from(ALL),
                    lambda inner: st.lists(inner, max_size=6)
                    | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=8)
KEYS = st.sampled_from(("missing", "pose", "face", "reason", "limit", "value", "unit", "verdict",
                        "id", "chip", "left_s", "progress", "total", "state", "what", "live", "at",
                        "of", "next", "a", "w", "n", "plan", "gyro", "slot", "tilt_deg"))
KINDS = st.sampled_from(("hello", "calibrating", "pose", "redo", "refused", "solved", "saved",
                         "capture", "error", "state", "sample", "ready", "stopped", "record", "x"))
SAID = st.builds(lambda kind, fields: parse(json.dumps(dict({"event": kind}, **fields))), KINDS,
                 st.dictionaries(KEYS, JSON, max_size=6))
EVENTS = st.lists(SAID.filter(bool), max_size=6)


def texts(value):
    """Every text in a value."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from texts(key)
            yield from texts(inner)
    elif isinstance(value, (list, tuple)):
        for inner in value:
            yield from texts(inner)


@settings(max_examples=80, deadline=None)
@given(EVENTS)
def test_any_event_leaves_a_state_with_nothing_that_steers_a_terminal(events):
    state = fed(*events)
    assert all(c.isprintable() for text in texts(vars(state)) for c in text)
    assert set(state.taken) | set(state.missing) <= set(SIX) | {
        p for p in (*state.taken, *state.missing) if p.startswith("L")}
    step = steps.next_step(state)
    assert step.kind and all(c.isprintable() for c in step.head + steps.why_it_waits(state))
