"""mount: the paper's example, every quadrant, any axes, and what is refused."""

import json
import math

import numpy as np
import pytest

from sixflip.record import correction_record, mounting
from sixflip_host import cli
from sixflip_host.capture import capture_file
from sixflip_host.errors import CheckFailed, UsageError
from sixflip_host.mounting import mounting_angles, robot_axes
from tests.worlds.board_session import leave_files, unlabelled
from tests.worlds.resting import rest

PAPER = (-0.2235, 0.4937, 0.8330)
STRAIGHT = robot_axes.parse("rep103")


def run(capsys, *words):
    """(exit code, what was printed, what was said on stderr)."""
    code = cli.main(["mount", *map(str, words)])
    said = capsys.readouterr()
    return code, said.out, said.err


def gravity(roll_deg, pitch_deg, order="xyz"):
    """What a sensor mounted so reads, g: R (0, 0, 1)."""
    R = mounting.rotation(math.radians(roll_deg), math.radians(pitch_deg), order)
    return [row[2] for row in R]


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """(capture of a calibration, path of its record)."""
    folder = tmp_path_factory.mktemp("board")
    session = unlabelled(1)
    leave_files(folder, session)
    return session, folder / "record_a.bin"


def written(tmp_path, capture):
    path = tmp_path / "rest.csv"
    capture_file.write(path, capture)
    return path


# -- the paper's worked example (Promrit, V)


def test_every_number_the_paper_prints(capsys):
    code, out, _ = run(capsys, "--vector", *PAPER, "--both", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["order"] == found["rule"]["order"] == "xyz"
    # 30.6532 and 12.9997 are printed; from the G that is printed they come out as below.
    assert abs(found["roll_deg"] - 30.6532) < 0.003
    assert abs(found["pitch_deg"] - 12.9997) < 0.003
    assert abs(found["roll_deg"] - 30.6543) < 5e-5
    assert abs(found["pitch_deg"] - 12.9971) < 5e-5
    # Left sides: 0.03168771 is right; 0.197543 squared -0.2235 to a negative number.
    assert abs(found["rule"]["left"] - 0.03168771) < 5e-7
    assert abs(found["rule"]["right"] - 0.1375) < 5e-5
    slip = abs(math.sqrt(-(0.2235 ** 2) + 0.8330 ** 2) - 1)
    assert abs(slip - 0.197543) < 5e-7
    # The wedge was 30 and 15 degrees: 97.8 and 86.7 %; the paper prints 99.978 for the first.
    assert abs(100 * (1 - abs(found["roll_deg"] - 30) / 30) - 97.8) < 0.05
    assert abs(100 * (1 - abs(found["pitch_deg"] - 15) / 15) - 86.66) < 0.05
    # The other order is nearer to the wedge.
    other = found["both"]["yxz"]
    assert (round(other["roll_deg"], 2), round(other["pitch_deg"], 2)) == (29.79, 15.02)


def test_words_name_the_order_and_the_rule(capsys):
    _, out, _ = run(capsys, "--vector", *PAPER)
    assert "order R_xyz: roll 30.6543 deg, pitch 12.9971 deg" in out
    assert "0.0317 < " in out
    assert "R_yxz" not in out
    _, both, _ = run(capsys, "--vector", *PAPER, "--both")
    assert "order R_yxz: roll 29.7882 deg, pitch 15.0191 deg" in both
    _, forced, _ = run(capsys, "--vector", *PAPER, "--order", "yxz")
    assert "order R_yxz: roll 29.7882 deg" in forced


def test_the_chains_differ_by_10_6_mg():
    E = np.diag([0.02, 0.005, -0.01])
    R = mounting.rotation(math.radians(30), math.radians(15), "xyz")
    assert abs(mounting_angles.chain_difference_mg(E, R) - 10.6) < 0.05
    # one scale for all commutes
    assert mounting_angles.chain_difference_mg(0.01 * np.eye(3), R) < 1e-9


# -- all quadrants


@pytest.mark.parametrize("order", ["xyz", "yxz"])
@pytest.mark.parametrize("roll", [-170, -100, -45, 0, 45, 100, 170])
@pytest.mark.parametrize("pitch", [-60, -20, 0, 20, 60])
def test_quadrants(order, roll, pitch):
    if order == "yxz":
        roll, pitch = pitch, roll       # in this order pitch goes all the way round
    G = gravity(roll, pitch, order)
    found = mounting_angles.answer(G, STRAIGHT, order)
    assert abs(found["roll_deg"] - roll) < 1e-9
    assert abs(found["pitch_deg"] - pitch) < 1e-9
    assert np.allclose(found["G_robot"], [0, 0, 1], atol=1e-12)


SIDES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]


@pytest.mark.parametrize("G", SIDES)
def test_every_side_down(G):
    C = np.array(mounting_angles.answer(list(G), STRAIGHT)["compensation"])
    assert np.allclose(C @ G, [0, 0, 1], atol=1e-12)
    assert np.allclose(C @ C.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(C) > 0


# -- the robot's axes


def test_axes_named_by_hand():
    axes = robot_axes.parse("x=-y, y=x, z=z")
    assert (axes.axes, axes.frame, axes.left_handed) == ("-y x z", "rep103", False)
    found = mounting_angles.answer([0.0, 0.0, 1.0], axes)
    # What the sensor feels along its -y the robot feels forward.
    assert np.allclose(np.array(found["compensation"]) @ [0, -1, 0], [1, 0, 0])
    assert (found["roll_deg"], found["pitch_deg"]) == (0.0, 0.0)


def test_ned_is_forward_right_down():
    C = np.array(mounting_angles.answer([0.0, 0.0, 1.0], robot_axes.parse("NED"))["compensation"])
    assert np.array_equal(C, np.diag([1.0, -1.0, -1.0]))


def test_left_handed_axes_are_named_and_rates_turn_their_sign(capsys, tmp_path, calibrated):
    found = mounting_angles.answer([0.0, 0.0, 1.0], robot_axes.parse("x=y,y=x,z=z"))
    C, W = np.array(found["compensation"]), np.array(found["gyro_compensation"])
    assert np.array_equal(C, [[0, 1, 0], [1, 0, 0], [0, 0, 1]])
    # Seen in a mirror a left turn is a right one.
    assert np.array_equal(W, -C)
    code, out, _ = run(capsys, "--vector", *PAPER, "--axes", "x=y,y=x,z=z")
    assert code == 0
    assert "left-handed" in out
    code, _, err = run(capsys, written(tmp_path, rest(calibrated[0].meta)), "--record",
                       calibrated[1], "--axes", "x=y,y=x,z=z", "-o", tmp_path / "out.bin")
    assert code == 2
    assert "left-handed" in err
    assert not (tmp_path / "out.bin").exists()


@pytest.mark.parametrize("text", ["", "enu", "x=y", "x=y,y=y,z=z", "x=x,x=y,z=z", "x=--x,y=y,z=z",
                                  "x=x,y=y,w=z", "x=x;y=y;z=z", "x=xy,y=y,z=z", "=,=,="])
def test_axes_that_are_none(text):
    with pytest.raises(UsageError, match="expected rep103, ned, or"):
        robot_axes.parse(text)


def test_all_48_signed_permutations_bring_gravity_up():
    from itertools import permutations, product
    left = 0
    for order in permutations("xyz"):
        for signs in product(("", "-"), repeat=3):
            named = [sign + axis for sign, axis in zip(signs, order)]
            axes = robot_axes.parse("x=%s,y=%s,z=%s" % tuple(named))
            B = np.zeros((3, 3))
            for row, name in enumerate(named):
                B[row, "xyz".index(name[-1])] = -1 if name[0] == "-" else 1
            assert axes.left_handed == (np.linalg.det(B) < 0)
            left += axes.left_handed
            # Mounted just as named: nothing but the permutation is left to do.
            found = mounting_angles.answer((B.T @ [0, 0, 1]).tolist(), axes)
            assert np.allclose(found["compensation"], B)
            assert abs(found["roll_deg"]) < 1e-12
    assert left == 24


# -- captures


def test_a_rest_gives_the_angles_and_a_record_that_applies_them(tmp_path, capsys, calibrated):
    session, record = calibrated
    path = written(tmp_path, rest(session.meta, gravity(-12.0, 7.5)))
    out = tmp_path / "mounted.bin"
    code, text, _ = run(capsys, path, "--record", record, "-o", out, "--json")
    found = json.loads(text)
    assert code == 0
    assert found["calibrated"]
    assert abs(found["roll_deg"] + 12.0) < 0.05
    assert abs(found["pitch_deg"] - 7.5) < 0.05
    made, before = (correction_record.decode(p.read_bytes()) for p in (out, record))
    assert made.mounting["order"] == found["order"]
    assert made.sequence == before.sequence + 1
    assert made.accel == before.accel
    # Measured again with the record that holds a mounting already: the same answer.
    code, again, _ = run(capsys, path, "--record", out, "--json")
    assert json.loads(again)["roll_deg"] == found["roll_deg"]


def test_without_a_record_it_says_that_the_bias_is_in_the_angles(tmp_path, capsys, calibrated):
    code, out, _ = run(capsys, written(tmp_path, rest(calibrated[0].meta)))
    assert code == 0
    assert "not calibrated" in out
    assert "10 mg are 0.6 deg" in out


@pytest.mark.parametrize("what, reason", [
    ({"rate_dps": (0, 0, 20)}, "turns"),
    ({"shake_mg": 25}, "shakes"),
    ({"shake_mg": 120}, "not at rest"),
    ({"sway_mg": 60}, "not at rest"),
    ({"n": 60}, "too short"),
    ({"force": (0.3, 0.0, 1.0)}, "gravity reads"),
    ({"drives_off": True}, "not at rest"),
    ({"hangs": True}, "the readings do not change"),
    ({"force": (0.0, 0.0, 2.5)}, "full scale is touched"),
])
def test_a_vehicle_that_is_not_at_rest_is_refused(tmp_path, capsys, calibrated, what, reason):
    path = written(tmp_path, rest(calibrated[0].meta, **what))
    code, out, err = run(capsys, path, "--record", calibrated[1])
    assert code == 1
    assert reason in err
    assert out == ""


def test_the_engine_is_noticed_without_a_record_too(tmp_path, capsys, calibrated):
    path = written(tmp_path, rest(calibrated[0].meta, shake_mg=25))
    code, _, err = run(capsys, path)
    assert code == 1
    assert "stop the engine" in err


def test_a_record_of_another_range_is_refused(tmp_path, capsys, calibrated):
    meta = dict(calibrated[0].meta, accel_lsb_per_g=8192)
    code, _, err = run(capsys, written(tmp_path, rest(meta)), "--record", calibrated[1])
    assert code == 4
    assert "8192" in err


@pytest.mark.parametrize("words", [[], ["a.csv", "--vector", "0", "0", "1"],
                                   ["--vector", "0", "0", "1", "-o", "x.bin"]])
def test_wrong_command_lines(capsys, words):
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "expected" in err or "needs" in err


@pytest.mark.parametrize("G", [(0, 0, 0), (0, 0, 0.5), (9.8, 0, 0), (math.nan, 0, 1)])
def test_a_vector_that_is_not_gravity(G):
    with pytest.raises(CheckFailed, match="0.98 to 1.02 is the limit"):
        mounting_angles.answer(list(map(float, G)), STRAIGHT)
