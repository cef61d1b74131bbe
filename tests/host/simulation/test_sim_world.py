"""The simulated world obeys physics, and its operator does what was asked."""

import numpy as np
import pytest

from sixflip_sim import rotation, worlds
from sixflip_sim.operator import FACES, PAPER_ORDER, Operator, face_axis
from sixflip_sim.scene import BUMP, REST, TURN

AXES = {face: np.array(face_axis(face)) for face in FACES}


def matrix(nine):
    return np.array(nine).reshape(3, 3)


def attitude(world, t_us):
    return matrix(world.scene.attitude(t_us))


def rate_from_attitude(world, t_us, h=50):
    """Body rate by differences of the attitude: R^T dR/dt."""
    change = (attitude(world, t_us + h) - attitude(world, t_us - h)) / (2e-6 * h)
    w = attitude(world, t_us).T @ change
    return np.array([w[2, 1] - w[1, 2], w[0, 2] - w[2, 0], w[1, 0] - w[0, 1]]) / 2


@pytest.fixture(scope="module")
def world():
    return worlds.make({"tilt_deg": 3.0, "flip_error_deg": 2.0, "seed": 4})


def middle(placement):
    return (placement[1] + placement[2]) // 2


def test_the_axis_that_points_up_reads_plus_g(world):
    for placement in world.truth.placements:
        f = np.array(world.scene.specific_force(middle(placement)))
        assert np.linalg.norm(f) == pytest.approx(9.80665, rel=1e-12)
        assert f @ AXES[placement[0][:2]] == pytest.approx(9.80665 * np.cos(np.radians(3.0)))


def test_paper_session(world):
    assert [p[0] for p in world.truth.placements] == list(PAPER_ORDER)
    first, second = world.truth.placements[:2]
    assert first[2] - first[1] == 14_500_000
    assert second[2] - second[1] == 6_500_000
    assert second[1] - first[2] == 2_500_000
    assert world.end_us == world.truth.placements[-1][2]


def test_rate_is_the_derivative_of_attitude(world):
    for segment in world.scene.segments:
        if segment.kind == TURN:
            for part in (0.1, 0.37, 0.5, 0.9):
                t = int(segment.t0 + part * (segment.t1 - segment.t0))
                assert np.allclose(world.scene.rate(t), rate_from_attitude(world, t), atol=1e-5)


def test_angular_acceleration_is_the_derivative_of_rate(world):
    segment = [s for s in world.scene.segments if s.kind == TURN][3]
    for part in (0.2, 0.6):
        t = int(segment.t0 + part * (segment.t1 - segment.t0))
        slope = (np.array(world.scene.rate(t + 50)) - world.scene.rate(t - 50)) / 1e-4
        assert np.allclose(world.scene.motion(t)[3], slope, atol=1e-4)


def test_moves_begin_and_end_without_a_jump(world):
    for segment in world.scene.segments[1:]:
        before, after = world.scene.motion(segment.t0 - 1), world.scene.motion(segment.t0 + 1)
        for a, b in zip(before, after):
            assert np.allclose(a, b, atol=2e-3)


def test_a_flip_turns_about_the_face_axis_by_the_angle_stated(world):
    """The integral of the body rate over a flip is the turn times the face's axis, as the
    table is the same under both placements."""
    log = world.truth.placements
    assert set(world.truth.flips_deg) == set(FACES)
    for a, b in zip(log[::2], log[1::2]):
        t = np.linspace(a[2], b[1], 4001)
        w = np.array([world.scene.rate(int(x)) for x in t])
        turned = np.degrees(np.trapezoid(w, t * 1e-6, axis=0) if hasattr(np, "trapezoid")
                            else np.trapz(w, t * 1e-6, axis=0))
        axis = matrix(world.scene.attitude(middle(a))).T @ world.operator.normal
        angle = world.truth.flips_deg[a[0][:2]]
        assert np.allclose(turned, angle * axis, atol=0.01)
        assert np.allclose(axis, AXES[a[0][:2]], atol=1e-9)
        assert 170 < abs(angle) < 190


def test_flips_alternate_or_go_one_way():
    def signs(turn):
        flips = worlds.make({"turn": turn}).truth.flips_deg
        return [np.sign(flips[face]) for face in FACES]

    assert signs("alternate") == [1, -1, 1, -1, 1, -1]
    assert signs("left") == [1] * 6
    assert signs("right") == [-1] * 6
    with pytest.raises(ValueError):
        signs("both")


def test_gravity_turns_the_other_way_in_the_body():
    """METHOD 1: h = (I - R(-psi))^-1 d for the in-plane part of a, from the difference d."""
    world = worlds.make({"tilt_deg": 2.0, "flip_error_deg": 5.0, "seed": 9})
    log = world.truth.placements
    for a, b in zip(log[::2], log[1::2]):
        face = a[0][:2]
        up = AXES[face]
        f = [np.array(world.scene.specific_force(middle(p))) for p in (a, b)]
        psi = np.radians(world.truth.flips_deg[face])
        r = matrix(rotation.about(tuple(up), -psi))
        plane = np.eye(3) - np.outer(up, up)
        assert np.allclose(plane @ f[1], r @ plane @ f[0], atol=1e-9)
        h = np.linalg.lstsq((np.eye(3) - r) + np.outer(up, up), plane @ (f[0] - f[1]),
                            rcond=None)[0]
        assert np.allclose(h, plane @ f[0], atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_any_order_keeps_the_pairs_half_a_turn_apart(seed):
    world = worlds.make({"order": "random", "seed": seed, "flip_error_deg": 0, "tilt_deg": 4})
    log = world.truth.placements
    assert sorted(p[0] for p in log) == sorted(PAPER_ORDER)
    r = {p[0]: attitude(world, middle(p)) for p in log}
    for face in FACES:
        turn = r[face + "b"] @ r[face + "a"].T
        n = np.array(world.operator.normal)
        assert np.allclose(turn, 2 * np.outer(n, n) - np.eye(3), atol=1e-9)


def test_first_visits_turn_over_about_a_horizontal_axis(world):
    log = world.truth.placements
    for before, after in zip(log[1:-1:2], log[2::2]):
        turn = attitude(world, middle(after)) @ attitude(world, middle(before)).T
        axis, angle = rotation.axis_angle(tuple(turn.ravel()))
        assert abs(np.array(axis) @ world.operator.normal) < 0.02
        assert np.degrees(angle) == pytest.approx(90, abs=0.1) or np.degrees(
            angle) == pytest.approx(180, abs=0.1)


def test_placement_scatter_has_its_size():
    leans = []
    for seed in range(30):
        world = worlds.make({"placement_scatter_deg": 0.05, "seed": seed})
        for p in world.truth.placements:
            f = np.array(world.scene.specific_force(middle(p))) / 9.80665
            leans.append(np.degrees(f - AXES[p[0][:2]] * (f @ AXES[p[0][:2]])))
    rms = np.sqrt(np.mean(np.sum(np.square(leans), axis=1)) / 2)
    assert rms == pytest.approx(0.05, rel=0.1)


def off_axis(world, pose, t_us):
    f = np.array(world.scene.specific_force(t_us)) / 9.80665
    return np.degrees(np.arccos(np.clip(f @ AXES[pose[:2]], -1, 1)))


def test_mishaps():
    def log_of(*mishaps, **more):
        world = worlds.make({"mishaps": list(mishaps), "flip_error_deg": 0, **more})
        log = {}
        for p in world.truth.placements:
            log.setdefault(p[0], p)
        return world, log

    world, log = log_of({"kind": "crooked", "pose": "Y-", "deg": 8})
    for name, p in log.items():
        wanted = 8.0 if name[:2] == "Y-" else 0.0
        assert off_axis(world, name, middle(p)) == pytest.approx(wanted, abs=1e-5)
    _, log = log_of({"kind": "missing", "pose": "X+b"}, {"kind": "missing", "pose": "Z-"})
    assert set(PAPER_ORDER) - set(log) == {"X+b", "Z-a", "Z-b"}
    world, _ = log_of({"kind": "quarter", "pose": "X-b"})
    assert abs(world.truth.flips_deg["X-"]) == pytest.approx(90)
    world, log = log_of({"kind": "moved", "pose": "X+a", "deg": 20, "at_s": 2})
    start = log["X+a"][1]
    assert off_axis(world, "X+a", start + 1_900_000) < 1e-5
    assert off_axis(world, "X+a", start + 3_100_000) == pytest.approx(20)
    assert off_axis(world, "X+b", middle(log["X+b"])) < 1e-5
    world, log = log_of({"kind": "touched", "pose": "Z+b", "deg": 0.5, "at_s": 2})
    assert off_axis(world, "Z+b", log["Z+b"][1] + 2_150_000) == pytest.approx(0.5, abs=1e-3)
    assert off_axis(world, "Z+b", log["Z+b"][1] + 3_000_000) < 1e-5
    assert [p[0] for p in world.truth.placements].count("Z+b") == 2
    _, log = log_of({"kind": "long", "pose": "Z-a", "dwell_s": 30})
    assert log["Z-a"][2] - log["Z-a"][1] == 30_000_000
    world, _ = log_of({"kind": "swapped", "pose": "Z+b", "with": "Y-a"})
    names = [p[0] for p in world.truth.placements]
    assert names.index("Z+b") == PAPER_ORDER.index("Y-a")


def test_leaning_poses_are_still_and_lean():
    world = worlds.make({"order": ["Z+a", "L1", "L2", "Z+b"]})
    log = world.truth.placements
    assert [p[0] for p in log] == ["Z+a", "L1", "L2", "Z+b"]
    for p in log[1:3]:
        f = np.array(world.scene.specific_force(middle(p))) / 9.80665
        assert np.abs(f).max() < 0.99
    again = worlds.make({"order": ["Z+a", "L1", "L2", "Z+b"]})
    assert again.scene.attitude(middle(log[1])) == world.scene.attitude(middle(log[1]))


def test_lever_arm():
    spec = {"order": ["Z+a", "Z+b"], "lever_arm_m": [0.05, 0.0, 0.0], "flip_error_deg": 0}
    world = worlds.make(spec)
    plain = worlds.make({**spec, "lever_arm_m": None})
    t = world.truth.placements[0][2] + 1_250_000       # fastest moment of the flip
    extra = np.subtract(world.scene.specific_force(t), plain.scene.specific_force(t))
    rate = np.linalg.norm(world.scene.rate(t))
    assert np.allclose(extra, [-rate**2 * 0.05, 0, 0], atol=1e-3)
    assert rate == pytest.approx(1.875 * np.pi / 2.5, rel=1e-6)


def test_an_operator_who_reacts():
    """Poses can be added while the world runs; what was before does not change."""
    operator = Operator()
    operator.rest_until(3_000_000)
    before = operator.scene.attitude(1_000_000)
    operator.place("X+a")
    operator.rest_until(8_000_000)
    operator.flip()
    operator.touch()
    operator.rest(2)
    assert operator.scene.attitude(1_000_000) == before
    assert [p[0] for p in operator.log] == ["Z+a", "X+a", "X+b"]
    kinds = [s.kind for s in operator.scene.segments]
    assert kinds == [REST, TURN, REST, TURN, REST, BUMP, REST]
    assert operator.scene.specific_force(10**9)[0] == pytest.approx(9.80665)


def test_warming():
    world = worlds.make({"temperature_c": 30.0, "warm_c": 8.0, "warm_tau_s": 100.0})
    assert world.scene.temperature(0) == pytest.approx(22.0)
    assert world.scene.temperature(100_000_000) == pytest.approx(30 - 8 / np.e)
    assert world.scene.temperature_rate(0) == pytest.approx(0.08)


def test_truth_is_drawn_within_its_sizes_and_reproducible():
    for seed in range(50):
        truth = worlds.make({"seed": seed, "order": []}).truth
        for m, scale in ((truth.accel_matrix, 0.025), (truth.gyro_matrix, 0.03)):
            m = np.array(m)
            assert np.abs(np.diag(m) - 1).max() <= scale
            assert np.abs(np.degrees(m - np.diag(np.diag(m)))).max() <= 1.5
        assert np.abs(truth.accel_bias).max() <= 0.065 * 9.80665
        assert np.abs(np.degrees(truth.gyro_bias)).max() <= 2.0
    assert worlds.make({"seed": 3}).truth.accel_matrix == worlds.make(
        {"seed": 3}).truth.accel_matrix


def test_an_order_may_say_how_long_which_way_and_how_it_leans():
    """As in a plan file: dwell, move and turn of each pose, the raised axis of a leaning one."""
    up = [0.6, 0.0, 0.8]
    world = worlds.make({"tilt_deg": 0, "flip_error_deg": 0, "first_rest_s": 1.0, "order": [
        "Z+a", {"pose": "Z+b", "turn": "right", "dwell_s": 3.0, "move_s": 4.0},
        {"pose": "L1", "up": up}, "X+a", {"pose": "X+b", "turn": "left"}]})
    log = world.operator.log
    assert [entry[0] for entry in log] == ["Z+a", "Z+b", "L1", "X+a", "X+b"]
    assert log[1][1] - log[0][2] == 4000000 and log[1][2] - log[1][1] == 3000000
    assert world.truth.flips_deg == {"Z+": -180.0, "X+": 180.0}
    f = world.scene.specific_force((log[2][1] + log[2][2]) // 2)
    assert np.allclose(np.array(f) / world.scene.g, up, atol=1e-9)


@pytest.mark.parametrize("order, line", [
    ([3], "order holds 3"), ([{"dwell_s": 3}], "expected a pose's name"),
    ([{"pose": "Z+a", "dwell": 3}], "unknown key 'dwell'")])
def test_an_order_that_makes_no_sense(order, line):
    with pytest.raises(ValueError, match=line):
        worlds.make({"order": order})
