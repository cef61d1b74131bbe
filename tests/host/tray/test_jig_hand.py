"""The hand of a jig and the operator of a box in it: what was not heard is asked for again."""

import json
import os
import select
from types import SimpleNamespace

from sixflip_host.tray.leading import leaves
from sixflip_host.virtual.jig_hand import UNMOVED, WAYS, Box, JigHand
from sixflip_host.virtual.pty_relay import PtyRelay
from sixflip_sim.operator import LOOKS_S, REACTS_S, Operator
from tests.worlds.tray_rig import LIE_S, TWELVE, ScriptedBoard

WINDOW_S = 0.25
AT_REST, TROUBLED = {"state": "waiting", "reason": ""}, {"state": "waiting", "reason": "noisy"}
REST = {"event": "state", "state": "moving", "reason": ""}
MOVES = dict(REST, reason="moving")


class Asked(JigHand):
    """A hand that wants the pose that the test says."""

    wants = "Z+b"

    def pose(self):
        return self.wants


def test_a_box_that_was_left_alone_while_its_board_spoke_of_noise_is_moved_all_the_same():
    hand = Asked({"one": WAYS[1]}, pause_s=0.0)
    one = hand.hand_for("one")
    operator = Operator(first_pose=hand.own("one", "Z+a"))
    operator.rest(1.0)
    end_s = operator.scene.end_us() * 1e-6

    def says(at_s, more):
        for command in one.hear(json.dumps(dict({"event": "state"}, **more)).encode() + b"\n"):
            operator.asked(int((end_s + at_s) * 1e6), **json.loads(command))

    assert operator.pose == "Z-a"
    for window in range(4):         # too soon after the last move: it is not touched yet
        says(window * WINDOW_S, (AT_REST, TROUBLED)[window % 2])
    assert operator.pose == "Z-a"
    says(LOOKS_S + WINDOW_S, AT_REST)
    assert operator.pose == "Z-b"
    moved_us = operator.scene.end_us()
    says(LOOKS_S + REACTS_S + 20.0, AT_REST)        # lies as it is to: it is let lie
    assert operator.pose == "Z-b" and operator.scene.end_us() == moved_us


def test_a_pose_asked_for_anew_is_placed_anew():
    operator = Operator()
    operator.rest(1.0)
    before_us = operator.scene.end_us()
    operator.asked(before_us + 3_000_000, "Z+a", anew=False)
    assert operator.scene.end_us() == before_us
    operator.asked(before_us + 3_000_000, "Z+a")
    assert operator.scene.end_us() > before_us + 3_000_000


class Jig:
    """A JigHand and the boards in it, each of which says at once what it has to say."""

    def __init__(self):
        self.now = 0.0
        self.hand = JigHand({"one": WAYS[0], "two": WAYS[1]}, lambda: self.now, pause_s=0.0)
        self.boards = {name: ScriptedBoard(way) for name, way in self.hand.mountings.items()}
        self.laid = 0

    def says(self, name, *events):
        for event in events:
            self.hand.hear(name, event)

    def begins(self, name):
        self.says(name, *self.boards[name].hello(name))

    def moved(self, name):
        """The jig's pose that a board's box is brought to, as the hand wants, and seen in."""
        box = self.hand.boxes[name]
        self.says(name, REST)
        if box.asked != box.lies:
            self.says(name, REST, REST, MOVES, MOVES)
        return box.lies

    def lie(self, *names):
        """The jig lies as the hand has laid it, and these boards take what they lack."""
        for name in names:
            self.says(name, *self.boards[name].lay(self.laid, self.moved(name)))
        self.laid, self.now = self.laid + 1, self.now + LIE_S

    def missing(self, most=20):
        """What no board ever takes, in so many layings of the jig."""
        for _ in range(most):
            self.lie("one", "two")
        return [board.missing for board in self.boards.values()]


def test_boards_restarted_one_after_the_other_are_turned_as_the_jig_is():
    """As a host restarts them: the second is in its session while the first still ends another."""
    jig = Jig()
    hello, calibrating = jig.boards["two"].hello("two")
    jig.begins("one")
    jig.says("one", {"event": "capture", "samples": 7200})
    jig.says("two", hello)
    jig.says("one", {"event": "solved", "verdict": "good"}, {"event": "saved", "slot": "a"})
    jig.says("two", calibrating)
    assert jig.hand.tray.reference == "two"
    jig.lie("two")
    jig.begins("one")
    assert jig.missing() == [[], []]


def test_a_board_that_tells_late_what_it_took_is_known_to_sit_as_it_does():
    jig = Jig()
    for name in (*jig.boards, "one"):       # as the second starts, the first begins anew
        jig.begins(name)
    while jig.laid < 9 and jig.hand.pose() != "X+a":
        jig.lie("one")
    jig.lie("one")
    jig.says("two", *jig.boards["two"].lay(jig.laid, "Z+a"))
    assert jig.hand.tray.member("two").mounting == WAYS[1]
    assert jig.missing() == [[], []]


def test_a_box_is_not_held_to_a_pose_that_its_operator_was_not_asked_for():
    """Its board begins anew while the jig is still on the face of the session before."""
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
    while jig.hand.pose() != "X+b":
        jig.lie("one", "two")
    jig.boards = {name: ScriptedBoard(way) for name, way in jig.hand.mountings.items()}
    for name in ("two", "one"):
        jig.begins(name)
    assert [box.asked for box in jig.hand.boxes.values()] == ["Z+a", "Z+a"]


def test_the_jig_lies_until_the_host_knows_how_each_board_sits_in_a_session_that_goes_on():
    """Where it was turned before, the host would take the face up for the one that it asks for."""
    jig = Jig()
    whole = {"one": "Z+", "two": "Z-"}
    for name, face in whole.items():
        jig.boards[name].missing = [pose for pose in TWELVE if pose[:2] != face]
        jig.begins(name)
    assert [jig.hand.hear(name, REST) for name in whole] == ["Z+a", "Z-a"]
    jig.says("one", *jig.boards["one"].lay(0, "Z+a"))
    assert jig.hand.pose() == "Z+a"
    jig.says("two", *jig.boards["two"].lay(0, "Z+a"))
    assert jig.hand.pose() == "X+a"
    assert jig.missing() == [[], []]


def test_half_a_turn_is_one_from_how_the_jig_lay_when_the_first_placement_was_taken():
    jig = Jig()
    for name in (*jig.boards, "one"):
        jig.begins(name)
    jig.lie("one")
    jig.says("one", *jig.boards["one"].lay(1, "Z+b"))
    jig.says("two", REST, *jig.boards["two"].lay(1, "Z+a"))     # told late, before it is turned
    assert jig.hand.pose() == "Z+b"


def test_a_first_placement_taken_in_the_half_turn_is_followed_by_one_turned_back():
    """As it is where a host has the face taken back after the half turn."""
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
        jig.hand.boxes[name].lies = jig.hand.boxes[name].asked = "Z+b"
    for name in jig.boards:
        jig.says(name, *jig.boards[name].lay(0, "Z+b"))
    assert jig.hand.tray.letter == "b" and jig.hand.pose() == "Z+a"
    assert jig.missing() == [[], []]


def test_a_pose_asked_for_is_kept_to_until_the_box_is_moved_to_it_or_lay_so_already():
    box = Box(WAYS[0])
    assert box.ask("Z+b", 0.0, 0.0) == "Z+b" and box.ask("X+a", 1.0, 0.0) == "Z+b"
    for event in (REST, REST, MOVES):
        box.hear(event)
    assert box.lies == "Z+b" and box.ask("X+a", 2.0, 0.0) == "X+a"
    for event in (MOVES, MOVES, REST):      # the rest of the move before
        box.hear(event)
    assert box.lies == "Z+b"
    for _ in range(UNMOVED):
        box.hear(REST)
    assert box.lies == "X+a"


def test_a_hand_has_the_patience_of_the_host_in_every_session():
    hand = JigHand({"one": WAYS[0], "two": WAYS[1]}, patience=8.0, pause_s=0.5)
    assert hand.tray.patience == 8.0 and hand.pause_s == 4.0
    hand.restarted("one")
    assert hand.tray.patience == 8.0


def test_a_box_is_moved_once_its_pose_was_wanted_for_a_while():
    box = Box(WAYS[0])
    asked = [box.ask(pose, now, 1.0) for now, pose in (
        (0.0, "X+a"), (0.6, "Z+a"), (0.8, "X+a"), (1.7, "X+a"), (1.8, "X+a"))]
    assert asked == ["Z+a", "Z+a", "Z+a", "Z+a", "X+a"]


def test_the_jig_is_not_turned_under_a_board_that_lacks_its_first_placement():
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
    jig.says("one", *jig.boards["one"].lay(0, "Z+a"))
    assert jig.hand.tray.letter == "a" and jig.hand.pose() == "Z+a"
    jig.says("two", *jig.boards["two"].lay(0, "Z+a"))
    assert jig.hand.pose() == "Z+b"


def test_boards_that_took_their_first_placements_in_two_half_turns_are_each_turned():
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
    jig.says("one", *jig.boards["one"].lay(0, "Z+a"))
    jig.hand.boxes["two"].lies = jig.hand.boxes["two"].asked = "Z+b"
    jig.says("two", *jig.boards["two"].lay(0, "Z+b"))
    boxes = jig.hand.boxes
    assert [boxes[name].second("Z+") for name in boxes] == ["b", "a"]
    for box in boxes.values():
        box.lies = box.asked = "X+a"        # both were brought away and come again
    assert [jig.hand.hear(name, REST) for name in boxes] == ["Z+b", "Z-a"]


def test_a_board_that_takes_a_face_back_takes_the_jig_there():
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
    while jig.hand.pose()[:2] != "Y+":
        jig.lie("one", "two")
    jig.says("two", *jig.boards["two"].obey(jig.laid, {"cmd": "redo", "face": "Z-"}))
    assert jig.hand.tray.face == "Z+" and jig.hand.tray.letter == "a"
    assert jig.missing() == [[], []]


def test_a_board_that_was_silent_for_faces_is_led_on_as_soon_as_it_speaks():
    jig = Jig()
    for name in jig.boards:
        jig.begins(name)
    jig.hand.tray = leaves(jig.hand.tray, jig.hand.tray.member("two"), "3 faces in a row")
    jig.lie("one")
    assert jig.missing() == [[], []]


def test_nothing_is_asked_for_by_words_that_are_not_the_newest():
    hand = SimpleNamespace(hear=lambda data: [b"1\n", b"2\n"])
    relay = PtyRelay(SimpleNamespace(hand_asked=hand))
    os.write(relay.inner_slave, b"more")
    relay.ask_operator(b"what it said before")
    assert not select.select([relay.hand_read], [], [], 0)[0]
    assert os.read(relay.inner_master, 10) == b"more"
    for _ in range(2):      # what is not done yet is not asked for twice
        relay.ask_operator(b"more")
    assert os.read(relay.hand_read, 10) == b"2\n"
    relay.close()
