import math
import unittest

import flipped_box as box

from sixflip.accelerometer import solver as accelerometer
from sixflip.accelerometer.verdict import judge_accelerometer

SCATTER = math.radians(0.05)


def session(tilt=2.0, seed=1, noise=0.003, across=SCATTER, flip_deg=None, crooked=None, **part):
    """Placements with a hand's scatter; crooked {pose code: (axis, deg)}."""
    poses = box.gravities(tilt, flip_deg)
    for code in crooked or {}:
        axis, deg = crooked[code]
        poses[code] = box.turned(poses[code], axis, math.radians(deg))
    return box.placements(poses, noise_g=noise, seed=seed, across=across, **part)


def judge(placements, lsb=box.LSB, **more):
    try:
        result, failure = accelerometer.solve(placements, lsb), ""
    except ValueError as error:
        result, failure = None, str(error)
    return judge_accelerometer(result, placements, lsb, failure=failure, **more)


class Refused(unittest.TestCase):
    def check(self, placements, *words, **more):
        verdict, reason = judge(placements, **more)
        self.assertEqual(verdict, "refused", reason)
        for word in words:
            self.assertIn(word, reason)

    def test_a_missing_face(self):
        self.check([p for p in session() if p.pose not in (7, 8)], "face X- is missing")

    def test_a_session_not_finished(self):
        self.check(session()[:11], "Y-b missing", missing=[12])

    def test_a_moved_pose_by_its_noise(self):
        poses = session()
        poses[4].noise[1] *= 8
        self.check(poses, "X+a moved", "axis y", "limit")

    def test_a_moved_pose_by_its_halves(self):
        poses = session()
        halves = [[0.5, -1.0, 2.0] for _ in poses]
        self.assertEqual(judge(poses, halves=halves)[0], "good")
        halves[7][2] = 300.0
        self.check(poses, "X-b moved", "halves", halves=halves)

    def test_a_saturated_pose(self):
        self.check(session(), "saturated", rail=16384)

    def test_a_sensor_that_hangs(self):
        for k in (0, 3):
            poses = session()
            poses[2].noise[k:k + 3] = [0.0] * 3
            self.check(poses, "Z-a is stale", "gyro" if k else "accelerometer")

    def test_a_sensor_without_gyro_is_no_stale_one(self):
        poses = session()
        for p in poses:
            p.sums[3:6] = [0] * 3
            p.noise[3:6] = [0.0] * 3
        self.assertEqual(judge(poses)[0], "good")

    def test_too_few_samples(self):
        poses = session()
        poses[0].n = 3
        self.check(poses, "Z+a has 3 samples")

    def test_a_wrong_scale(self):
        self.check(session(M=((1, 0, 0), (0, 1.3, 0), (0, 0, 1))), "scale of axis y", "limit")

    def test_an_inverted_axis(self):
        self.check(session(M=((-1, 0, 0), (0, 1, 0), (0, 0, 1))), "negative scale", "axis x")

    def test_exchanged_axes(self):
        self.check(session(M=((0, 1, 0), (1, 0, 0), (0, 0, 1))), "X+a shows Y+", "exchanged")

    def test_exchanged_poses(self):
        for i, j, words in ((0, 2, "Z+a shows Z-"), (0, 5, "X+b shows Z+"), (1, 11, "Y-b shows")):
            poses = session()
            poses[i].pose, poses[j].pose = poses[j].pose, poses[i].pose
            self.check(poses, words)

    def test_one_wrong_label(self):
        poses = session()
        poses[6].pose = 1
        self.check(poses, "Z+a shows X-")

    def test_a_face_8_degrees_crooked_is_named(self):
        for face, axis in ((2, (0, 1, 0)), (3, (0, 0, 1)), (0, (1, 0, 0)), (5, (0.6, 0, 0.8))):
            for codes in ((2 * face + 1,), (2 * face + 1, 2 * face + 2)):
                poses = session(1.0, crooked=dict.fromkeys(codes, (axis, 8.0)))
                self.check(poses, "face " + ("Z+", "Z-", "X+", "X-", "Y+", "Y-")[face])

    def test_a_box_on_its_edge(self):
        self.check(session(1.0, crooked={1: ((1, 0, 0), 40.0)}), "Z+a leans 4")

    def test_numbers_that_are_none(self):
        poses = session()
        poses[3].noise[0] = float("nan")
        self.check(poses, "Z-b")
        r = accelerometer.solve(session(), box.LSB)
        r.P[3][0] = float("nan")
        self.assertEqual(judge_accelerometer(r, session(), box.LSB)[0], "refused")

    def test_no_result_is_no_pass(self):
        self.assertEqual(judge_accelerometer(None, session(), box.LSB, failure="singular"),
                         ("refused", "singular"))


class Doubtful(unittest.TestCase):
    def check(self, placements, *words):
        verdict, reason = judge(placements)
        self.assertEqual(verdict, "doubtful", reason)
        for word in words:
            self.assertIn(word, reason)

    def test_no_flips(self):
        for tilt in (0.0, 0.4):
            self.check([p for p in session(tilt, across=0.0) if p.pose % 2],
                       "no flips, the table's tilt is in the result")

    def test_a_crooked_face_without_flips(self):
        poses = session(0.0, crooked={5: ((0, 1, 0), 0.7)}, across=0.0)
        self.check([p for p in poses if p.pose % 2], "no flips", "X+", "0.7")

    def test_a_face_not_square(self):
        crooked = {5: ((0, 1, 0), 0.3), 6: ((0, 1, 0), 0.3)}
        self.check(session(crooked=crooked, across=0.0), "X+", "0.29 degrees", "not square")

    def test_one_capture_not_flat(self):
        self.check(session(0.0, crooked={9: ((1, 0, 0), 0.5)}, across=0.0), "Y+")

    def test_the_paper_on_a_tilted_table(self):
        poses = session(3.0)
        r = accelerometer.solve(poses, box.LSB, level="flip average")
        verdict, reason = judge_accelerometer(r, poses, box.LSB)
        self.assertEqual(verdict, "doubtful")
        self.assertIn("3.0 degrees", reason)

    def test_a_and_b_that_differ_along_gravity(self):
        poses = session(across=0.0)
        poses[8].sums[1] += int(0.003 * box.LSB * 400)
        self.check(poses, "Y+")


class Good(unittest.TestCase):
    def test_hands_that_place_to_a_twentieth_of_a_degree(self):
        for tilt in (0.0, 2.0, 5.0):
            for seed in range(12):
                verdict, reason = judge(session(tilt, seed))
                self.assertEqual(verdict, "good", reason)
                self.assertIn("tilt", reason)

    def test_a_and_b_exchanged_on_one_face(self):
        poses = session()
        poses[2].pose, poses[3].pose = 4, 3
        self.assertEqual(judge(poses)[0], "good")

    def test_a_chip_that_sits_askew_in_its_box(self):
        M = [box.turned(row, (0.6, 0.0, 0.8), 0.1) for row in box.IDEAL]
        self.assertEqual(judge(session(M=M))[0], "good")


if __name__ == "__main__":
    unittest.main()
