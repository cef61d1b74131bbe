"""The screen of a state: 24 lines of 80, everything a person needs on it, without colour too."""

import io

import pytest
from hypothesis import given, settings
from rich.console import Console
from rich.text import Text
from test_session_state import ALL, EVENTS, calibrating, fed, live, taken, without

from sixflip_host.guide import screen
from sixflip_host.guide.session_state import State

STATES = {
    "waiting": State(),
    "noise": fed({"event": "hello", "id": "00aa", "chip": "MPU6050"}, calibrating(),
                 live("measuring noise", unit="", live=[0, 0, 1000, 0, 0, 0])),
    "flip": fed(calibrating(), taken("Z+a", without("Z+a")),
                live(reason="moving", value=9.0, live=[20, 0, 1001, 5, 4, 120])),
    "capturing": fed(calibrating(), taken("Z+a", without("Z+a")),
                     live("capturing", pose="Z+b", progress=100, left_s=3.0,
                          live=[0, 10, 1000, 0, 0, 0])),
    "crooked": fed(calibrating(), live(reason="crooked", value=22.0, limit=15, unit="deg")),
    "plan": fed(dict(calibrating(["Z+a", "L1"]), plan=True), live(at=1, of=2, next=["L1"])),
    "good": fed(calibrating([]), {"event": "solved", "verdict": "good", "tilt_deg": 2.0,
                                  "reason": "scale known to 0.1 mg per g"},
                {"event": "saved", "slot": "a", "sequence": 4}),
    "unsaved": fed(calibrating([]), {"event": "solved", "verdict": "good", "reason": "fine"},
                   {"event": "saved", "slot": "a", "sequence": 4, "written": False,
                    "reason": "nothing new"}),
    "refused": fed(calibrating(ALL), {"event": "solved", "verdict": "refused",
                                      "reason": "timed out " * 30}),
}


def shown(state, **more):
    return [line.plain for line in screen.screen(state, "/dev/ttyACM0", **more)]


@pytest.mark.parametrize("asking", ["", "redo", "quit", "help"])
@pytest.mark.parametrize("name", STATES)
def test_it_is_24_lines_of_80_characters_in_unicode_and_in_ascii(name, asking):
    for ascii_only in (False, True):
        lines = shown(STATES[name], asking=asking, ascii_only=ascii_only)
        assert len(lines) == 24 and max(map(len, lines)) <= 80
        assert not ascii_only or "".join(lines).isascii()


@pytest.mark.parametrize("name, words", [
    ("waiting", ["waiting for the board", "q quit"]),
    ("noise", ["board 00aa", "MPU6050", "leave the box alone", "|a|  1.000 g", "/dev/ttyACM0"]),
    ("flip", ["half a turn, Z+ stays up", "▶1 Z+ up      ✓", "x   +0.020 g", "+120 deg/s",
              "noise 9, limit 2 x", "too much", "it moves (9 x noise, limit 2 x noise)",
              "about 0:10", "r redo a face   u undo   q quit"]),
    ("capturing", ["KEEP STILL: Z+b", " 25 %", "still 3.0 s", "1 of 12 taken", "Y+"]),
    ("crooked", ["does not lie flat on this face (22 deg, limit 15 deg)"]),
    ("plan", ["1 of 2", "next  L1", "leaned"]),
    ("good", ["verdict: good", "scale known to 0.1 mg per g", "table tilt 2.00 deg",
              "saved in slot a, sequence 4", "next: sixflip pull"]),
    ("unsaved", ["verdict: good", "not written, no better than slot a, sequence 4:",
                 "nothing new"]),
    ("refused", ["verdict: refused", "timed out timed out"])])
def test_what_stands_on_it(name, words):
    steps = (lambda at: "L1: lean the box on something, still: leaned") if name == "plan" else None
    text = "\n".join(shown(STATES[name], step=steps))
    for word in words:
        assert word in text, text


def test_every_face_is_drawn_when_it_comes():
    for face in ("Z+", "X+", "Y+", "Z-", "X-", "Y-"):
        text = "\n".join(shown(fed(calibrating([face + "a", face + "b"]), live())))
        assert "lay the box down with %s up" % face in text and "╱      %s     ╱" % face in text


def test_the_questions_and_a_note_are_asked_in_plain_sight():
    assert "1 Z+  2 X+  3 Y+  4 Z-  5 X-  6 Y-" in shown(STATES["flip"], asking="redo")[-1]
    assert "stays on the board: y yes" in shown(STATES["flip"], asking="quit")[-1]
    assert " no such key" in shown(STATES["flip"], note="no such key")


def test_without_colour_nothing_is_lost(monkeypatch):
    """NO_COLOR leaves the same characters and not one colour code."""
    monkeypatch.setenv("NO_COLOR", "1")
    out = io.StringIO()
    Console(file=out, force_terminal=True, width=80, color_system="standard").print(
        Text("\n").join(screen.screen(STATES["capturing"])), end="")
    codes = out.getvalue()
    assert "\x1b[3" not in codes and "\x1b[9" not in codes
    assert "KEEP STILL" in codes and " 25 %" in codes


@settings(max_examples=60, deadline=None)
@given(EVENTS)
def test_any_board_gets_a_screen_of_that_size(events):
    lines = screen.screen(fed(*events), "port")
    assert len(lines) == 24
    assert all(line.cell_len <= 80 and line.plain.isprintable() for line in lines)
