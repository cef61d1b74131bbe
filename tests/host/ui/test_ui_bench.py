"""Many clicks, stale tabs, lost boards: what the bench does with actions."""

import pytest
from served import scripted, until

from sixflip_host.errors import NoBoard
from sixflip_host.guide.session_state import SIX
from sixflip_host.ui.bench import Bench

ALL = list(SIX)


@pytest.fixture
def bench(tmp_path):
    link, make = scripted(tmp_path)
    made = make(lambda: None)
    made.board = link
    made.thread.start()
    yield made
    made.close()


def begun(bench, *poses):
    """A session with these poses taken."""
    bench.ask("start", bench.number)
    until(lambda: bench.board.resets)
    bench.board.say("calibrating", missing=ALL, plan=False)
    for k, pose in enumerate(poses):
        bench.board.say("pose", pose=pose, n=400,
                        missing=[p for p in ALL if p not in poses[:k + 1]])
    until(lambda: bench.view()["stage"] == "calibrating" and
          len(bench.session.state.taken) == len(poses))
    return bench.view()["number"]


def settled(bench):
    """Every action so far was looked at."""
    bench.ask("nothing", -1)
    until(bench.asked.empty)  # who took that one had done with those before


def commands(bench):
    settled(bench)
    return [sent for sent in bench.board.sent if isinstance(sent, dict)]


def test_a_start_clicked_many_times_is_one_session(bench):
    for _ in range(10):
        bench.ask("start", 0)
    begun(bench)
    assert bench.board.resets == 1 and bench.number == 1
    bench.ask("start", 1)       # seen by a second tab: the session is under way
    assert commands(bench) == [] and bench.board.resets == 1


def test_an_undo_clicked_twice_takes_one_placement_back(bench):
    number = begun(bench, "Z+a", "Z+b")
    assert bench.view()["undo"] == "Z+b"
    for _ in range(5):
        bench.ask("undo", number, "Z+b")
    assert commands(bench) == [{"cmd": "undo"}]
    bench.board.say("redo", face="Z+", missing=ALL)
    until(lambda: not bench.session.state.taken)
    bench.ask("undo", number, "Z+b")        # a click that comes late
    assert commands(bench) == [{"cmd": "undo"}]


def test_a_redo_clicked_often_is_sent_once_and_again_when_the_face_is_back(bench):
    number = begun(bench, "Z+a", "Z+b")
    for _ in range(4):
        bench.ask("redo", number, "Z+")
    bench.ask("redo", number, "X+")         # not taken yet: nothing to do again
    assert commands(bench) == [{"cmd": "redo", "face": "Z+"}]
    bench.board.say("redo", face="Z+", missing=ALL)
    until(lambda: not bench.session.state.taken)
    bench.board.say("pose", pose="Z+a", n=400, missing=[p for p in ALL if p != "Z+a"])
    until(lambda: bench.session.state.taken)
    bench.ask("redo", number, "Z+")
    assert commands(bench) == [{"cmd": "redo", "face": "Z+"}] * 2


def test_what_was_meant_for_an_earlier_session_changes_nothing(bench):
    old = begun(bench, "Z+a")
    bench.ask("stop", old)
    bench.ask("stop", old)
    assert commands(bench) == [{"cmd": "stop"}]
    until(lambda: bench.view()["stage"] == "over")
    bench.ask("start", old)
    until(lambda: bench.number == old + 1)
    bench.board.say("calibrating", missing=ALL, plan=False)
    until(lambda: bench.view()["stage"] == "calibrating")
    for action in ("stop", "undo", "redo", "start"):
        bench.ask(action, old, "Z+")
    assert commands(bench) == [{"cmd": "stop"}] and bench.board.resets == 2


def test_a_redo_after_the_end_goes_on_as_a_session_of_its_own(bench):
    number = begun(bench, *ALL)
    bench.board.say("solved", verdict="doubtful", reason="x")
    bench.board.say("saved", slot="a", sequence=1)
    until(lambda: bench.view()["stage"] == "over")
    for _ in range(3):
        bench.ask("redo", number, "X+")
    assert commands(bench) == [{"cmd": "redo", "face": "X+"}] and bench.number == number + 1


def test_continue_joins_a_session_under_way_and_asks_for_nothing(bench):
    bench.board.say("state", state="moving", missing=["Z+a"])
    bench.ask("continue", 0)
    until(lambda: bench.number == 1 and not bench.busy)
    bench.board.say("state", state="moving", missing=["Z+a"])
    until(lambda: len(bench.session.state.taken) == 11)
    assert bench.board.sent == [] and bench.board.resets == 0


def test_a_plan_is_asked_for_and_undone_by_its_number(tmp_path):
    words = ("Z+a: lay it down", "L1: lean it", "all placements done")
    link, make = scripted(tmp_path, request=lambda link: {"poses": "Z+a L1"},
                          step=words.__getitem__)
    bench = make(lambda: None)
    bench.board = link
    bench.thread.start()
    bench.ask("start", 0)
    until(lambda: link.resets)
    assert link.sent == [("calibrate.flag", b'{"poses": "Z+a L1"}')]
    link.say("calibrating", missing=["Z+a", "L1"], plan=True)
    link.say("pose", pose="Z+a", n=100, next=["L1"], at=1, of=2)
    until(lambda: bench.view()["undo"] == "1")
    assert bench.view()["step"]["head"] == "L1: lean it on something"
    for _ in range(3):
        bench.ask("undo", 1, "1")
    bench.ask("redo", 1, "Z+")      # a plan is undone pose by pose
    assert commands(bench) == [{"cmd": "undo"}]
    bench.close()


def test_a_lost_board_is_said_and_a_start_tries_again(tmp_path):
    tries = []

    def open_link():
        tries.append(1)
        raise NoBoard("no board is plugged in\x1b[2J")
    bench = Bench(open_link, tmp_path, keep=False)
    bench.thread.start()
    bench.ask("start", 0)
    until(lambda: bench.view()["problem"])
    assert bench.view()["problem"] == "no board is plugged in\\x1b[2J"
    assert not bench.view()["live"] and bench.number == 0
    bench.ask("start", 0)
    until(lambda: len(tries) == 2)
    assert bench.close() == ""


@pytest.mark.parametrize("action", ["start", "continue", "pull"])
def test_any_failure_is_shown_and_can_be_tried_again(bench, action, monkeypatch):
    monkeypatch.setattr(bench.board, "files", lambda hashed=None: [1 / 0])
    bench.ask(action, 0)
    until(lambda: bench.view()["problem"])
    view = bench.view()
    assert "internal error" in view["problem"] and "ZeroDivisionError" in view["problem"]
    assert view["busy"] == "" and not view["live"]
    monkeypatch.undo()
    begun(bench)


def test_answers_of_another_form_are_passed_over_or_said(bench):
    begun(bench)
    bench.board.said.put('{"event": "state", "state": [], "left_s": {}, "value": 1e999}')
    bench.board.said.put('{"event": "pose", "pose": {"x": 1}, "n": [[[[]]]]}')
    bench.board.say("pose", pose="Z+a", n=400, missing=ALL[1:])
    until(lambda: bench.session.state.taken)
    assert "cannot be used: pose: pose is an object" in " ".join(bench.view()["log"])
    bench.board.say("solved", verdict={"good": 1})
    bench.board.say("ready")
    until(lambda: bench.view()["stage"] == "over")
    assert "expected one of good, doubtful, refused" in bench.view()["log"][-1]


def test_a_report_that_fails_in_any_way_is_said(bench, monkeypatch):
    monkeypatch.setattr(bench, "report_command", lambda what, path: [1 / 0])
    bench.pulled = "somewhere"
    bench.ask("report", 0)
    until(lambda: bench.view()["problem"])
    assert not bench.view()["reporting"] and "ZeroDivisionError" in bench.view()["problem"]


def test_the_end_of_the_server_ends_the_session_in_order(tmp_path):
    link, make = scripted(tmp_path)
    bench = make(lambda: None)
    bench.board = link
    bench.thread.start()
    begun(bench, "Z+a")
    assert "the 700 samples so far stay on the board" in bench.close()
    assert {"cmd": "stop"} in link.sent and link.closed == 1
