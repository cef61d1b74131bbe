import unittest

from sixflip.poses import faces


class Names(unittest.TestCase):
    def test_every_code_has_its_name_and_back(self):
        names = [faces.pose_name(code) for code in range(1, 13)]
        self.assertEqual(names[:5], ["Z+a", "Z+b", "Z-a", "Z-b", "X+a"])
        self.assertEqual(names[11], "Y-b")
        for code in (0, 1, 2, 7, 12, 13, 14, 21, 22, 112, 2012):
            self.assertEqual(faces.pose_code(faces.pose_name(code)), code)
        self.assertEqual(faces.pose_name(13), "L1")

    def test_what_is_no_pose_is_refused_by_name(self):
        for wrong in ("Z+", "Z+c", "z+a", "L", "L0", "L01", "L2001", "L-1", "L1x", " ", "Q", "L²"):
            with self.assertRaises(ValueError) as caught:
                faces.pose_code(wrong)
            self.assertIn("no pose is called", str(caught.exception))

    def test_faces(self):
        self.assertEqual([faces.face_of_code(c) for c in (0, 1, 2, 3, 12, 13)],
                         [-1, 0, 0, 1, 5, -1])
        self.assertTrue(faces.is_b(2))
        self.assertFalse(faces.is_b(1))
        self.assertFalse(faces.is_b(14))


class NearestFace(unittest.TestCase):
    def test_each_face_is_found_with_its_angle(self):
        for face in range(6):
            m = [300.0, 300.0, 300.0]
            m[faces.AXIS[face]] = 16384.0 * faces.SIGN[face]
            found, off = faces.nearest_face(m[0], m[1], m[2])
            self.assertEqual(found, face)
            self.assertAlmostEqual(off, 1.4833, delta=1e-3)

    def test_twenty_degrees(self):
        found, off = faces.nearest_face(-939.693, 342.02, 0)
        self.assertEqual(found, 3)
        self.assertAlmostEqual(off, 20.0, delta=1e-3)

    def test_nothing_measured_is_on_no_face(self):
        self.assertEqual(faces.nearest_face(0, 0, 0)[1], 90.0)


if __name__ == "__main__":
    unittest.main()
