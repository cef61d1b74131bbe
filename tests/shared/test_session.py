import unittest
from array import array

from synthetic_operator import Operator

from sixflip import session as machine
from sixflip.faces import face_of_code, pose_name
from sixflip.move_turn import has_gap
from sixflip.planned_session import PlannedSession
from sixflip.pose_codes import pose_code
from sixflip.resumed_session import resume
from sixflip.session import Session


def make(**options):
    """A session and an operator who feeds it."""
    own = {}
    for key in ("wanted", "timeout_s", "pose_samples", "rate_hz"):
        if key in options:
            own[key] = options.pop(key)
    dps = options.get("dps", 65.5)
    lsb = options.get("lsb", 16384)
    rail = 32767 if lsb == 16384 else 4095
    session = Session(lsb, dps, rail, 32767, own.pop("rate_hz", 100), **own)
    return session, Operator(session.feed, **options)


def poses(session):
    return [pose_name(p.pose) for p in session.placements]


class Recorder:
    """Between operator and session: keeps reasons and states, and exact totals if asked to.

    Totals are kept at every window's end: placements and moves begin and end there.
    """

    WINDOW = 25  # samples, at 100 Hz

    def __init__(self, session, keep=False):
        self.session = session
        self.totals = [array("i", [0]) for _ in range(7)] if keep else []
        self.running = [0] * 7
        self.refusals = []
        self.states = []
        self.reasons = []

    def __call__(self, dt_us, sample):
        event = self.session.feed(dt_us, sample)
        if self.totals:
            for i in range(7):
                self.running[i] += sample[i]
            if self.session.samples % self.WINDOW == 0:
                for total, v in zip(self.totals, self.running):
                    total.append(v)
        if event == machine.REFUSED:
            s = self.session
            self.refusals.append((s.reason, s.value, s.limit, s.unit))
        if event:
            self.states.append(self.session.state)
            self.reasons.append(self.session.reason)
        return event

    def total(self, i, begin, end):
        """Sum of column i over samples begin to end; IndexError off the windows' ends."""
        if begin % self.WINDOW or end % self.WINDOW:
            raise IndexError("%d to %d are not ends of windows" % (begin, end))
        return self.totals[i][end // self.WINDOW] - self.totals[i][begin // self.WINDOW]


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
            self.assertEqual((move.late, move.saturated, move.largest_gap_us),
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
        resume(session, before.placements, before.samples)
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
        resume(session, before.placements, before.samples, before.moves + [before._log.open])
        hands.six_faces(order=(2, 3, 4, 5))
        self.assertEqual(session.state, "done")
        self.assertEqual([has_gap(m) for m in session.moves], [False] * 4 + [True] + [False] * 7)
        self.assertEqual([m.before for m in session.moves], list(range(-1, 11)))


if __name__ == "__main__":
    unittest.main()
