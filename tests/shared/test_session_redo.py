import unittest

from session_recorder import Recorder, make, poses

from sixflip.poses import session as machine
from sixflip.poses.faces import pose_code, pose_name


class Redo(unittest.TestCase):
    def test_a_face_is_redone_and_the_moves_close_over_it(self):
        session, hands = make()
        recorder = hands.sink = Recorder(session, keep=True)
        hands.six_faces(order=(0, 3, 4))
        self.assertEqual(session.redo(3), [7, 8])
        self.assertEqual(session.withdrawn, [7, 8])
        self.assertEqual(poses(session), ["Z+a", "Z+b", "Y+a", "Y+b"])
        self.assertEqual(session.missing()[2:4], [pose_code("X+a"), pose_code("X+b")])
        hands.six_faces(order=(3,))
        self.assertEqual(poses(session)[4:], ["X-a", "X-b"])
        at = 0
        for i, (p, move) in enumerate(zip(session.placements, session.moves)):
            self.assertEqual((move.before, move.after, move.first), (i - 1, i, at))
            self.assertEqual(move.first + move.n, p.first)
            self.assertEqual(move.gyro_sums, [
                recorder.total(3 + k, at, p.first) for k in range(3)])
            self.assertEqual(move.duration_us, 10000 * move.n)
            at = p.first + p.n

    def test_the_face_the_box_rests_on_is_captured_at_once(self):
        session, hands = make()
        hands.six_faces(order=(0,))
        session.redo(0)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a"])

    def test_a_capture_on_another_face_goes_on(self):
        session, hands = make()
        hands.six_faces(order=(0,))
        hands.place(2)
        hands.rest(3)
        self.assertEqual(pose_name(session.candidate), "X+a")
        session.redo(0)
        self.assertEqual(session.state, "capturing")
        hands.rest(3)
        self.assertEqual(poses(session), ["X+a"])

    def test_another_accepted_rest_is_not_taken_twice(self):
        session, hands = make()
        hands.six_faces(order=(0, 2))
        session.redo(0)
        before = session.placements[-1]
        hands.rest(6)
        self.assertIs(session.placements[-1], before)

    def test_lifted_and_put_back_replaces_the_same_pose(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        first = session.placements[0].first
        hands.turn(0, 30, 1)
        hands.turn(0, -30, 1)
        hands.rest(4)
        hands.rest(1.5)
        self.assertEqual(poses(session), ["Z+a"])
        self.assertGreater(session.placements[0].first, first)
        self.assertEqual(session.moves[0].before, -1)

    def test_what_was_replaced_is_told_with_the_new_pose(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        told = []

        def sink(dt_us, sample):
            event = session.feed(dt_us, sample)
            if event == machine.POSE:
                told.extend(session.withdrawn)
            return event

        hands.sink = sink
        hands.turn(0, 0, 1)
        hands.rest(6)
        self.assertEqual(told, [1])

    def test_b_is_found_when_the_face_comes_back_later(self):
        session, hands = make()
        for face in (0, 2, 0, 2):
            hands.place(face)
            hands.rest(6)
        self.assertEqual(poses(session), ["Z+a", "X+a", "Z+b", "X+b"])

    def test_after_the_end_a_face_can_be_redone(self):
        session, hands = make(timeout_s=10)
        hands.turn(0, 900, 12)
        self.assertEqual(session.state, "done")
        session.redo(0)
        hands.place(0)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a"])


if __name__ == "__main__":
    unittest.main()
