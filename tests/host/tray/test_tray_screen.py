"""The tray's screen: 24 lines of 80 whatever the boards say, and what its keys mean."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from sixflip_host.board import board_schema
from sixflip_host.board.event_words import GUIDED_ORDER
from sixflip_host.tray import leading, tray_events, tray_screen
from sixflip_host.tray.tray_guide import TrayGuide, obey
from sixflip_host.tray.tray_value import tray
from sixflip_host.tray.tray_words import COLUMNS, results
from tests.worlds.tray_rig import Rig, ScriptedBoard

POSES = ["Z+a", "Z-b", "X+a", "X+b", "Y-a", "L1", "", None, 3]
EVENTS = some.fixed_dictionaries({
    "event": some.sampled_from(["hello", "calibrating", "state", "pose", "refused", "redo", "info",
                                "capture", "solved", "saved", "ready", "error", "stopped"])},
    optional={
        "pose": some.sampled_from(POSES), "face": some.sampled_from(POSES),
        "missing": some.lists(some.sampled_from(POSES), max_size=4),
        "state": some.sampled_from(["moving", "capturing", "settling"]),
        "live": some.lists(some.integers(-1500, 1500), max_size=6),
        "reason": some.sampled_from(["", "stale", "noisy", "already done", "\x1b[2J"]),
        "left_s": some.sampled_from([0, 4, 1e30, float("nan"), None]),
        "verdict": some.sampled_from(["good", "refused", "?"]), "what": some.text(max_size=9),
        "progress": some.integers(-1, 500), "total": some.integers(-1, 400)})
HEARD = some.lists(some.tuples(some.sampled_from("pqr"), EVENTS), max_size=12)


def lines_of(one, **more):
    lines = tray_screen.screen(one, **more)
    assert len(lines) == more.get("height", 24)
    assert all(line.cell_len <= 80 and line.plain.isprintable() for line in lines)
    return [line.plain.rstrip() for line in lines]


@settings(max_examples=60, deadline=None)
@given(HEARD)
def test_whatever_boards_say_nobody_is_lost_and_the_screen_keeps_its_size(heard):
    one = tray(dict.fromkeys("pqr"))
    for second, (port, event) in enumerate(heard):
        event = board_schema.event(event)
        one, commands = tray_events.after(one, port, event, float(second))
        assert all(to in "pqr" and command["cmd"] in ("stop", "redo", "info")
                   for to, command in commands)
        lines_of(one)
        one, _ = leading.tick(one, second + 0.9)
    assert [member.port for member in one.members] == ["p", "q", "r"]
    assert len(results(one, {"s": "nothing"})) == 4
    assert all(len(row) == len(COLUMNS) for row in results(one, {}))


@pytest.mark.parametrize("boards, height, shown", [(1, 24, 1), (8, 24, 8), (30, 24, 17),
                                                   (30, 50, 30)])
def test_boards_have_a_row_each_as_far_as_there_is_room(boards, height, shown):
    rig = Rig({"p%d" % k: ScriptedBoard() for k in range(boards)})
    rig.lay("Z+a")
    lines = lines_of(rig.tray, height=height)
    assert sum("✓·" in line for line in lines) == shown
    assert ("and %d more" % (boards - shown) in "\n".join(lines)) == (boards > shown)
    assert lines[2] == "half a turn, flat on the table, Z+ stays up"
    assert all(line.isascii() for line in lines_of(rig.tray, height=height, ascii_only=True))


def test_what_a_row_says():
    rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard(stuck_from=1), "r": ScriptedBoard(),
               "s": ScriptedBoard(lost_at=1), "t": ScriptedBoard(firmware="0.0.1")})
    rig.lay("Z+a")
    rig.hear("p", rig.boards["p"].lay(1, "Z+b"))
    rig.hear("q", rig.boards["q"].lay(1, "Z+b"))
    rig.hear("r", rig.boards["r"].lay(1, "Z+b")[:2])
    rig.take(tray_events.left(rig.tray, "s", "s: the board went away", rig.now))
    lines = lines_of(rig.tray)
    assert lines[2] == "KEEP STILL, Z+: 1 of 3 have it, still to come: 2, 3"
    assert lines[-6:-1] == [
        "  1 idp      ✓✓  ··  ··  ··  ··  ··   has it",
        "▶ 2 idq      ✓·  ··  ··  ··  ··  ··   the readings do not change: the sensor ha…",
        "▶ 3 idr      ✓•  ··  ··  ··  ··  ··   captured 0 %",
        "  4 ids      ✓·  ··  ··  ··  ··  ··   the board went away",
        "  5 idt      ··  ··  ··  ··  ··  ··   its firmware is 0.0.1, expected 0.1.0: si…"]


class Session:
    """In place of a TraySession: keeps what it is asked for."""

    def __init__(self, laid):
        rig = Rig({"p": ScriptedBoard(), "q": ScriptedBoard()})
        for pose in GUIDED_ORDER[:laid]:
            rig.lay(pose)
        self.tray, self.asked = rig.tray, []

    def redo(self, face):
        self.asked.append(face)

    def undo(self):
        self.asked.append("undo")


@pytest.mark.parametrize("laid, pressed, asked, leave, quits", [
    (3, ["r", "2"], ["X+"], False, False), (3, ["r", "esc", "u"], ["undo"], False, False),
    (3, ["q", "n", "enter", "z"], [], False, False), (3, ["q", "y"], [], True, True),
    (3, ["?", "u"], [], False, False), (12, ["u", "r", "6"], ["Y-"], False, False),
    (12, ["enter"], [], True, False), (12, ["q"], [], True, False)])
def test_what_keys_mean(laid, pressed, asked, leave, quits):
    guide = TrayGuide(Session(laid))
    for key in pressed:
        guide.press(key)
        assert len(guide.lines()) == 24
    assert (guide.session.asked, guide.leave, guide.quit) == (asked, leave, quits)


@pytest.mark.parametrize("line, asked, quits, says", [
    ("redo x+", ["X+"], False, 0), ("undo", ["undo"], False, 0), ("quit", [], True, 0),
    ("redo L1", [], False, 1)])
def test_what_typed_lines_mean(line, asked, quits, says):
    session, said = Session(3), []
    assert obey(session, line, said.append) == quits
    assert (session.asked, len(said)) == (asked, says)
