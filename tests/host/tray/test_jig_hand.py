"""The hand of a jig and the operator of a box in it: what was not heard is asked for again."""

import json

from sixflip_host.virtual.board_hands import WAYS, JigHand
from sixflip_sim.operator import LOOKS_S, REACTS_S, Operator
from tests.worlds.tray_rig import LIE_S, ScriptedBoard

WINDOW_S = 0.25
AT_REST, TROUBLED = {"state": "waiting", "reason": ""}, {"state": "waiting", "reason": "noisy"}


class Asked(JigHand):
    """A hand that wants the pose that the test says."""

    wants = "Z+b"

    def pose(self):
        return self.wants


def test_a_box_that_was_left_alone_while_its_board_spoke_of_noise_is_moved_all_the_same():
    hand = Asked({"one": WAYS[1]})
    one = hand.of("one")
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
        self.hand = JigHand({"one": WAYS[0], "two": WAYS[1]}, lambda: self.now)
        self.boards = {name: ScriptedBoard(way) for name, way in self.hand.mountings.items()}
        self.laid = 0

    def says(self, name, *events):
        for event in events:
            self.hand.hear(name, event)

    def begins(self, name):
        self.says(name, *self.boards[name].hello(name))

    def lie(self, *names):
        """The jig lies as the hand has laid it, and these boards take what they lack."""
        pose = self.hand.pose()
        for name in names:
            self.says(name, *self.boards[name].lay(self.laid, pose))
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


def test_half_a_turn_is_one_from_how_the_jig_lay_when_the_first_placement_was_taken():
    jig = Jig()
    for name in (*jig.boards, "one"):
        jig.begins(name)
    while jig.laid < 9 and jig.hand.pose() != "X+a":
        jig.lie("one")
    jig.says("two", *jig.boards["two"].lay(jig.laid, "Z+b"))    # taken as the jig was turned on
    assert jig.hand.pose() == "Z+a"
    assert jig.missing() == [[], []]
