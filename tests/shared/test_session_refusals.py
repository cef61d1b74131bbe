import unittest

from session_recorder import Recorder, make, poses

from sixflip.poses import session as machine


class Refusals(unittest.TestCase):
    def refused(self, act, before=(0,), **options):
        """The session and the refusals after faces `before` and act(hands)."""
        session, hands = make(**options)
        recorder = hands.sink = Recorder(session)
        for face in before:
            hands.place(face)
            hands.rest(6)
        self.assertEqual(recorder.refusals, [])
        act(hands)
        return session, recorder

    def test_moved_while_captured(self):
        def act(hands):
            hands.place(2)
            hands.rest(2)
            hands.turn(2, 10, 1)
            hands.rest(6)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["moving"])
        self.assertEqual(poses(session), ["Z+a", "X+a"])  # and it is captured anew

    def test_knocked(self):
        def act(hands):
            hands.place(2)
            hands.rest(2)
            hands.shake = 2000
            hands.samples(3)
            hands.rest(1)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["moving"])
        self.assertGreater(recorder.refusals[0][1], recorder.refusals[0][2])
        self.assertEqual(poses(session), ["Z+a"])

    def test_slow_creep(self):
        def act(hands):
            hands.place(2)
            hands.rest(0)
            for k in range(60):
                hands.lean(2, 1.5 + 0.03 * k)  # 0.3 deg/s
                hands.samples(10)

        for accel_sd, lsb in ((30.0, 16384), (1.0, 256)):
            session, recorder = self.refused(act, accel_sd=accel_sd, lsb=lsb)
            self.assertEqual(poses(session), ["Z+a"])
            self.assertEqual(recorder.refusals[0][0], "moving")
            self.assertEqual(recorder.refusals[0][3], "mg")

    def test_a_creep_too_slow_for_windows_shows_between_the_halves(self):
        def act(hands):
            hands.place(2)
            hands.rest(0)
            for k in range(48):
                hands.lean(2, 1.5 + 0.012 * k)  # 0.12 deg/s: 4 mg from half to half
                hands.samples(10)

        session, recorder = self.refused(act, accel_sd=10.0)
        self.assertEqual(poses(session), ["Z+a"])
        self.assertEqual(recorder.refusals[0][0], "moving")

    def test_vibration(self):
        def act(hands):
            hands.place(2)
            hands.shake = 250
            hands.spin = (0, 0, 0)
            hands.samples(600)

        session, recorder = self.refused(act)
        self.assertEqual(poses(session), ["Z+a"])
        self.assertEqual(recorder.reasons[-1], "noisy")
        self.assertEqual(recorder.states[-1], "moving")

    def test_stuck_readings(self):
        def act(hands):
            hands.place(2)
            hands.rest(2)
            hands.accel_stuck = True
            hands.rest(4)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["stale"])
        self.assertEqual(recorder.reasons[-1], "stale")
        self.assertEqual(poses(session), ["Z+a"])

    def test_saturated(self):
        def act(hands):
            hands.place(2)
            hands.up[2] = 2.5
            hands.rest(6)

        session, recorder = self.refused(act)
        self.assertEqual(recorder.reasons[-1], "saturated")
        self.assertEqual((session.value, session.limit, session.unit), (32767, 32767, "counts"))
        self.assertEqual(poses(session), ["Z+a"])

    def test_crooked_and_leaning(self):
        for deg, reason in ((20, "crooked"), (40, "leaning")):
            def act(hands, deg=deg):
                hands.place(2)
                hands.lean(2, deg)
                hands.rest(8)

            session, recorder = self.refused(act)
            self.assertEqual([r[0] for r in recorder.refusals], [reason])  # once, not each window
            self.assertAlmostEqual(recorder.refusals[0][1], deg, delta=0.5)
            self.assertEqual(recorder.refusals[0][2:], (15.0, "deg"))
            self.assertEqual(recorder.reasons[-1], reason)
            self.assertEqual(poses(session), ["Z+a"])

    def test_a_bias_of_112_mg_is_not_crooked(self):
        session, hands = make()
        hands.place(2)
        hands.lean(2, 6.4 + 3)
        hands.rest(6)
        self.assertEqual(poses(session), ["X+a"])

    def test_a_quarter_turn_is_not_a_flip(self):
        def act(hands):
            hands.flip(0, 90)
            hands.rest(6)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["not a flip"])
        self.assertAlmostEqual(recorder.refusals[0][1], 90, delta=1)
        self.assertEqual(poses(session), ["Z+a"])

    def test_the_rest_of_the_flip_is_accepted(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        hands.flip(0, 90)
        hands.rest(6)
        hands.flip(0, 90)
        hands.rest(6)
        self.assertEqual(poses(session), ["Z+a", "Z+b"])

    def test_a_flip_too_fast_for_the_gyro_is_saturated(self):
        def act(hands):
            hands.turn(2, 300, 0.5)  # 600 deg/s of which 500 are seen
            hands.turn(2, -125, 1)
            hands.rest(6)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["saturated"])

    def test_already_done(self):
        def act(hands):
            hands.flip(0)
            hands.rest(6)
            hands.place(3)
            hands.rest(6)
            hands.place(0)
            hands.rest(9)

        session, recorder = self.refused(act)
        self.assertEqual([r[0] for r in recorder.refusals], ["already done"])
        self.assertEqual(poses(session), ["Z+a", "Z+b", "X-a"])

    def test_time_out_says_what_stood_in_the_way(self):
        session, hands = make(timeout_s=20)
        hands.place(0)
        hands.rest(6)
        hands.turn(1, 3000, 30)
        self.assertEqual(hands.events, [machine.POSE, machine.TIMED_OUT])
        self.assertEqual((session.state, session.reason, session.obstacle),
                         ("done", "timed out", "moving"))
        self.assertEqual((session.value, session.limit, session.unit), (20, 20, "s"))
        self.assertEqual(poses(session), ["Z+a"])

    def test_time_left_is_shown(self):
        session, hands = make(timeout_s=60)
        hands.turn(1, 90, 10)
        self.assertEqual(session.left_s, 50)

    def test_an_interrupt_throws_the_attempt_away_and_nothing_else(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        hands.place(2)
        hands.rest(3)
        self.assertEqual(session.state, "capturing")
        session.interrupt()
        self.assertEqual((session.progress, session.candidate), (0, 0))
        hands.rest(1.5)
        self.assertEqual(poses(session), ["Z+a"])
        hands.rest(5)
        self.assertEqual(poses(session), ["Z+a", "X+a"])
        self.assertEqual(session.moves[1].first + session.moves[1].n, session.placements[1].first)


    def test_an_interrupt_at_rest_does_not_take_the_pose_again(self):
        session, hands = make()
        hands.place(0)
        hands.rest(6)
        session.interrupt()
        hands.rest(6)
        self.assertEqual(hands.events, [machine.POSE])


if __name__ == "__main__":
    unittest.main()
