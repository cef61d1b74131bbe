"""Poses found by the host itself, against sessions whose poses are known."""

import numpy as np
import pytest

from sixflip.poses.faces import pose_name
from sixflip_host.capture import capture_file
from sixflip_host.capture.attitude import heading_change
from sixflip_host.capture.find_poses import find_poses
from sixflip_host.capture.rests import rest
from sixflip_host.experiment import blocks
from tests.worlds.board_session import unlabelled
from tests.worlds.hand_session import Rotation, Sensor, face_attitude, session, six_faces

LEVEL = Rotation.identity()


def names(found):
    return [pose_name(rest.code) for rest in found.rests]


def session_of(*places, gyro=True, seed=4):
    """An unlabelled capture: (face, heading in degrees) or a Rotation for each rest."""
    poses = [("L%d" % (k + 1), place if isinstance(place, Rotation) else face_attitude(
        place[0], np.radians(place[1]), LEVEL)) for k, place in enumerate(places)]
    return session(Sensor(seed), poses, seed, labels=False, gyro=gyro, wobble_deg=5)


def test_the_papers_session():
    capture = unlabelled(3)
    found = find_poses(capture)
    assert names(found) == [label for label, _ in six_faces(3)]
    assert found.noise.sd[:3] == pytest.approx([49] * 3, rel=0.25)      # 3 mg
    assert capture.pose is None


def test_poses_that_were_found_stay_a_guess_in_a_file(tmp_path):
    """The first of a face is called a: were b the first, the table would lean the other way."""
    capture = unlabelled(3)
    before = blocks.session_of("s", capture)
    find_poses(capture).label(capture)
    capture_file.write(tmp_path / "c.csv", capture)
    after = blocks.session_of("s", capture_file.read(tmp_path / "c.csv"))
    assert not before.labelled and not after.labelled
    assert (after.face == -1).all() and np.array_equal(after.code, before.code)
    del capture.meta["poses"]
    assert blocks.session_of("s", capture).labelled


@pytest.mark.parametrize("seconds, leans, letters", [
    (0.2, 0.6, {"Z+a"}), (2.0, 0.6, {"Z+a", "Z+b"}), (2.0, 0.0, {"Z+a"})])
def test_a_touch_turns_nothing_where_no_gyro_tells(seconds, leans, letters):
    """A fifth of a second that is no rest: nobody turns a box half round in it, nor where it lies
    as before on a table that leans."""
    rng = np.random.default_rng(5)
    accel = [900.0, 0.0, 16384.0] + rng.normal(0.0, 40.0, (3000, 3))
    accel[1500:, 0] += np.radians(leans) * 16384.0
    touched = slice(1500, 1500 + int(100 * seconds))
    accel[touched] += rng.normal(0.0, 900.0, accel[touched].shape)
    capture = capture_file.Capture({"sensor": "adxl345", "rate_hz": 100, "accel_lsb_per_g": 16384},
                                   np.arange(3000) * 10000, np.rint(accel).astype(np.int16))
    found = find_poses(capture)
    assert len(found.rests) == 2 and set(names(found)) == letters


def test_a_and_b_by_the_gyro_whatever_came_between():
    found = find_poses(session_of((0, 10), (2, 0), (0, 195), (0, 15), (2, 5)))
    assert names(found) == ["Z+a", "X+a", "Z+b", "Z+a", "X+a"]


def test_neither_a_half_turn_nor_none_is_no_pose_of_that_face():
    found = find_poses(session_of((0, 0), (0, 90), (0, 180)))
    assert names(found) == ["Z+a", "L1", "Z+b"]
    assert "neither a half turn nor none" in found.rests[1].why


def test_leaning_is_leaning():
    leaning = Rotation.from_euler("xy", [40, 10], degrees=True)
    assert names(find_poses(session_of((0, 0), leaning, (1, 0)))) == ["Z+a", "L1", "Z-a"]


def test_without_a_gyro_only_what_can_be_known_is_named():
    """A table that is level tells nothing; who sets a box on all of its faces turns it."""
    places = [(0, 0), (0, 180), (2, 0), (0, 0)]
    every = session_of(*places, (1, 0), (3, 0), (4, 0), (5, 0), gyro=False)
    assert names(find_poses(every)) == ["Z+a", "Z+b", "X+a", "L1", "Z-a", "X-a", "Y+a", "Y-a"]
    assert names(find_poses(session_of(*places, gyro=False))) == ["Z+a", "Z+a", "X+a", "Z+a"]


def test_a_table_that_leans_tells_a_from_b_without_a_gyro():
    """By a degree: turned by half it leans the other way in the box."""
    table = Rotation.from_euler("xy", [1.0, 0.3], degrees=True)
    poses = [("L%d" % (k + 1), face_attitude(face, np.radians(heading), table)) for k, (
        face, heading) in enumerate([(0, 0), (0, 180), (2, 0), (0, 180), (0, 0)])]
    capture = session(Sensor(4), poses, 4, labels=False, gyro=False, wobble_deg=5)
    assert names(find_poses(capture)) == ["Z+a", "Z+b", "X+a", "Z+b", "Z+a"]


def test_noise_comes_from_the_quietest_part_not_the_first():
    capture = session_of((0, 0), (2, 0), (4, 0))
    shake = np.random.default_rng(1).normal(0, 900, (400, 3))
    capture.accel[:400] += shake.astype(np.int16)       # the first rest is shaken by 55 mg
    found = find_poses(capture)
    assert names(found) == ["X+a", "Y+a"]
    assert found.noise.sd[0] < 70


def test_nothing_still_at_all():
    capture = session_of((0, 0))
    capture.accel += np.random.default_rng(1).normal(0, 2000, capture.accel.shape).astype(
        np.int16)
    found = find_poses(capture)
    assert found.rests == () and not found.pose.any()
    assert found.remarks() == ["no rest found: nowhere a second without motion"]


@pytest.mark.parametrize("face", range(6))
@pytest.mark.parametrize("turn", [-170, -60, 0, 90, 175])
def test_heading_change(face, turn):
    capture = session_of((face, 20), ((face + 2) % 6, 0), (face, 20 + turn))
    rests = [rest(capture, first, first + 400) for first in (0, 650, 1300)]
    from sixflip.poses.faces import AXIS, SIGN
    found = heading_change(capture, rests, capture.gyro[:400].mean(axis=0), AXIS[face],
                           SIGN[face])
    assert (found - turn + 180) % 360 - 180 == pytest.approx(0, abs=8)


def test_a_saturated_gyro_cannot_tell():
    capture = session_of((0, 0), (0, 180))
    capture.gyro[500] = 32767
    assert names(find_poses(capture)) == ["Z+a", "L1"]
