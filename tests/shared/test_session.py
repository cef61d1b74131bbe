import unittest

from session_recorder import Recorder, make, poses

from sixflip.poses import session as machine
from sixflip.poses.faces import pose_name


class SixFaces(unittest.TestCase):
    def test_twelve_poses_in_any_order(self):
        session, hands = make()
        hands.six_faces(order=(2, 5, 0, 1, 4, 3))
        self.assertEqual(poses(session), ["X+a", "X+b", "Y-a", "Y-b", "Z+a", "Z+b",
                                          "Z-a", "Z-b", "Y+a", "Y+b", "X-a", "X-b"])
        self.assertEqual(hands.events, [machine.POSE] * 11 + [machine.COMPLETE])
        self.assertEqual(session.state, "done")
        self.assertEqual(session.missing(), [])

    def test_sums_are_exact_and_moves_fill_what_lies_between(self):
        session, hands = make()
        recorder = hands.sink = Recorder(session, keep=True)
        hands.six_faces(order=(0, 3))
        at = 0
        for i, (p, move) in enumerate(zip(session.placements, session.moves)):
            self.assertEqual((move.before, move.after, move.first), (i - 1, i, at))
            self.assertEqual(move.first + move.n, p.first)
            self.assertEqual(move.gyro_sums, [
                recorder.total(3 + k, at, p.first) for k in range(3)])
            self.assertEqual(move.duration_us, 10000 * move.n)
            self.assertEqual((list(move.late), move.saturated, move.largest_gap_us),
                             ([0, 0, 0, 0], False, 10000))
            end = p.first + p.n
            self.assertEqual(p.sums, [recorder.total(k, p.first, end) for k in range(7)])
            self.assertEqual((p.n, p.duration_us), (400, 4000000))
            self.assertAlmostEqual(p.noise[0], 30, delta=5)
            self.assertAlmostEqual(p.noise[5], 4, delta=1)
            at = p.first + p.n
        self.assertEqual(len(session.placements), 4)

    def test_pose_lies_wholly_within_the_rest(self):
        session, hands = make()
        hands.rest(3)
        hands.place(2)
        begin = hands.fed
        hands.rest(6)
        p = session.placements[-1]
        self.assertTrue(begin <= p.first < p.first + p.n <= hands.fed)

    def test_the_face_can_be_flipped_either_way_round(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        hands.flip(0, -170)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a", "Z+b"])

    def test_counts_in_steps_of_four_and_a_coarse_sensor(self):
        for options in ({"step": 4}, {"lsb": 256, "accel_sd": 1.0},
                        {"lsb": 256, "accel_sd": 0.6}, {"accel_sd": 2, "step": 4}):
            session, hands = make(**options)
            hands.six_faces(order=(0, 4))
            self.assertEqual(poses(session), ["Z+a", "Z+b", "Y+a", "Y+b"], str(options))

    def test_other_rates(self):
        for rate in (102.4, 204.8, 50):
            session, hands = make(rate_hz=rate, period_us=int(1e6 / rate))
            hands.six_faces(dwell=11 if rate == 50 else 6, order=(1,))
            self.assertEqual(poses(session), ["Z-a", "Z-b"])
            self.assertGreaterEqual(session.placements[0].n, 400)
            self.assertEqual(session.placements[0].n, session.pose_samples)

    def test_a_session_longer_than_two_to_the_thirty_microseconds(self):
        session, hands = make(timeout_s=5000, period_us=100000, rate_hz=10, pose_samples=40)
        hands.place(0)
        hands.rest(1200)
        hands.flip(0)
        hands.rest(10)
        self.assertEqual(poses(session), ["Z+a", "Z+b"])
        self.assertGreater(session.moves[1].duration_us, 1 << 30)

    def test_time_comes_from_the_timestamps_and_late_samples_are_apart(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        hands.period_us = 20000
        hands.samples(10)
        hands.period_us = 10000
        hands.flip(0)
        hands.rest(6)
        move = session.moves[1]
        self.assertEqual((move.late[3], move.largest_gap_us), (10 * (10000 // 128), 20000))
        self.assertEqual(move.duration_us, 10000 * (move.n + 10))


class Sensors(unittest.TestCase):
    def test_held_in_the_hand_at_the_start(self):
        session, hands = make()
        hands.bias = (130, -20, 340)
        hands.accel_sd = 150.0  # a quiet hand: 9 mg and 0.4 deg/s, taken for noise at first
        hands.gyro_sd = 25.0
        hands.rest(3)
        hands.bias = (100, -50, 300)
        hands.accel_sd = 30.0
        hands.gyro_sd = 4.0
        hands.six_faces(order=(0, 2), dwell=8)
        self.assertEqual(poses(session), ["Z+a", "Z+b", "X+a", "X+b"])
        self.assertAlmostEqual(session._noise.sd[0], 30, delta=7)

    def test_a_shaking_hand_is_no_noise_floor(self):
        session, hands = make()
        recorder = hands.sink = Recorder(session)
        hands.turn(0, 90, 4)
        self.assertEqual(session.state, "measuring noise")
        self.assertIn(recorder.reasons[-1], ("noisy", "moving"))
        hands.lean(0, 1)
        hands.rest(7)
        self.assertEqual(poses(session), ["Z+a"])

    def test_without_a_gyro_a_move_is_a_flip_and_a_knock_is_none(self):
        session, hands = make(dps=0)
        hands.place(0)
        hands.rest(6)
        for _ in range(4):
            hands.shake = 2000
            hands.samples(5)
            hands.rest(6)
        self.assertEqual(poses(session), ["Z+a"])
        hands.flip(0)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a", "Z+b"])
        self.assertEqual(session.placements[0].sums[3:6], [0, 0, 0])

    def test_gyro_bias_that_depends_on_gravity_is_no_motion(self):
        session, hands = make()
        for face in (0, 1, 2):
            hands.place(face)
            hands.bias = (100 + 10 * face, -50, 300 - 12 * face)  # 0.2 deg/s from face to face
            hands.rest(6)
        self.assertEqual(len(session.placements), 3)

    def test_live_values_while_all_is_well(self):
        session, hands = make()
        hands.place(0)
        hands.rest(3)
        self.assertEqual((session.state, session.reason, session.face), ("capturing", "", 0))
        self.assertEqual(pose_name(session.candidate), "Z+a")
        self.assertTrue(0 < session.progress < session.pose_samples)
        self.assertEqual((session.limit, session.unit), (3.0, "x noise"))
        self.assertTrue(0.5 < session.value < 3)


if __name__ == "__main__":
    unittest.main()
