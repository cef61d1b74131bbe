"""The hand of a jig and the operator of a box in it: what was not heard is asked for again."""

import json

from sixflip_host.virtual.board_hands import WAYS, JigHand
from sixflip_sim.operator import LOOKS_S, REACTS_S, Operator

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
