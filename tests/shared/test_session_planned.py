import unittest

from session_recorder import Recorder, make, poses
from synthetic_operator import Operator

from sixflip.poses.faces import face_of_code, pose_code, pose_name
from sixflip.poses.placement import has_gap
from sixflip.poses.planned_session import PlannedSession, continue_from


class Planned(unittest.TestCase):
    def wanted(self, names):
        session, hands = make(wanted=[pose_code(n) for n in names])
        hands.sink = self.recorder = Recorder(session)
        return session, hands

    def test_repeated_placements_and_leaning_poses_in_the_order_planned(self):
        names = ["Z+a", "X+b", "Z+a", "L1", "L2", "Z+b"]
        session, hands = self.wanted(names)
        for name in names:
            if name[0] == "L":
                hands.turn(1, 90)
                hands.lean(0, 50, 120 * int(name[1]))
            else:
                hands.place(face_of_code(pose_code(name)))
            hands.rest(6)
        self.assertEqual(poses(session), names)
        self.assertEqual((session.state, self.recorder.refusals), ("done", []))

    def test_the_same_pose_twice_running_is_lifted_between(self):
        session, hands = self.wanted(["Z+a", "Z+a", "Z+b"])
        hands.place(0)
        hands.rest(6)
        hands.turn(0, 40, 1)
        hands.turn(0, -40, 1)
        hands.rest(6)
        hands.flip(0)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a", "Z+a", "Z+b"])

    def test_gravity_contradicts_the_plan(self):
        session, hands = self.wanted(["Z+a", "X+a"])
        hands.place(2)
        hands.rest(5)
        self.assertEqual([r[0] for r in self.recorder.refusals], ["wrong face"])
        self.assertEqual(self.recorder.refusals[0][1:3], (2, 0))
        self.assertEqual(poses(session), [])

    def test_the_gyro_contradicts_the_plan(self):
        for names, deg, reason in ((["Z+a", "Z+b"], 90, "not a flip"),
                                   (["Z+a", "Z+a"], 180, "turned")):
            session, hands = self.wanted(names)
            hands.place(0)
            hands.rest(6)
            hands.flip(0, deg)
            hands.rest(6)
            self.assertEqual([r[0] for r in self.recorder.refusals], [reason])
            self.assertEqual(poses(session), ["Z+a"])

    def test_a_leaning_pose_must_lean(self):
        session, hands = self.wanted(["L1"])
        hands.place(2)
        hands.rest(5)
        self.assertEqual([r[0] for r in self.recorder.refusals], ["not leaning"])

    def test_redo_asks_for_the_face_again(self):
        session, hands = self.wanted(["Z+a", "X+a", "Z+a"])
        for face in (0, 2, 0):
            hands.place(face)
            hands.rest(6)
        self.assertEqual(session.state, "done")
        session.redo(0)
        self.assertEqual(session.missing(), [1, 1])
        for _ in range(2):
            hands.rest(6)
            hands.turn(0, 40, 1)
            hands.turn(0, -40, 1)
        self.assertEqual(poses(session), ["X+a", "Z+a", "Z+a"])

    def test_each_pose_its_length_and_a_rest_before_the_first(self):
        wanted = [pose_code(n) for n in ("Z+a", "X+a", "L1")]
        session = PlannedSession((16384, 65.5, 32767, 32767, 100), wanted, [200, 100, 300], 20, 60)
        hands = Operator(session.feed)
        hands.sink = recorder = Recorder(session)
        hands.place(0)
        hands.rest(9)
        self.assertEqual((session.state, session.placements), ("resting", []))
        hands.rest(14)
        hands.place(2)
        hands.rest(4)
        hands.turn(1, 50)
        hands.lean(2, 40)
        hands.rest(6)
        self.assertEqual(session.state, "resting")
        hands.rest(21)
        self.assertEqual([p.n for p in session.placements], [200, 100, 300])
        self.assertEqual((session.state, recorder.refusals), ("done", []))

    def test_undo_takes_back_one_placement_of_a_pose_that_came_twice(self):
        wanted = [pose_code(n) for n in ("Z+a", "X+a", "Z+a", "X+b")]
        session = PlannedSession((16384, 65.5, 32767, 32767, 100), wanted, [100] * 4, 0, 60)
        hands = Operator(session.feed)
        for face in (0, 2, 0):
            hands.place(face)
            hands.rest(4)
        first = session.placements[0].first
        self.assertEqual(session.place(), 3)
        gone = session.undo()
        self.assertEqual((pose_name(gone.pose), session.place()), ("Z+a", 2))
        self.assertEqual([p.first for p in session.placements][:1], [first])
        hands.rest(4)
        self.assertEqual(poses(session), ["Z+a", "X+a", "Z+a"])
        self.assertEqual(len(session.moves), 3)

    def test_a_session_goes_on_after_another(self):
        before, hands = make()
        for face in range(3):
            hands.place(face)
            hands.rest(6)
            hands.flip(face)
            hands.rest(6)
        self.assertEqual(len(before.placements), 6)
        session, hands = make()
        continue_from(session, before.placements, before.samples)
        self.assertEqual(session.redo(2), [5, 6])
        for face in (2, 3, 4, 5):
            hands.place(face)
            hands.rest(6)
            hands.flip(face)
            hands.rest(6)
        self.assertEqual((session.state, session.missing()), ("done", []))
        self.assertEqual(len(session.placements), 12)
        self.assertTrue(session.placements[4].first >= before.samples)
        lost = [not m.n or has_gap(m) for m in session.moves]
        self.assertEqual(lost, [True] * 5 + [False] * 7)

    def test_with_the_moves_before_only_the_one_across_the_pause_is_lost(self):
        before, hands = make()
        hands.six_faces(order=(0, 1))
        session, hands = make()
        continue_from(session, before.placements, before.samples,
                      before.moves + [before._log.open])
        hands.six_faces(order=(2, 3, 4, 5))
        self.assertEqual(session.state, "done")
        self.assertEqual([has_gap(m) for m in session.moves], [False] * 4 + [True] + [False] * 7)
        self.assertEqual([m.before for m in session.moves], list(range(-1, 11)))


if __name__ == "__main__":
    unittest.main()
