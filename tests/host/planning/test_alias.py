"""The ranks and alias figures of the findings the planner is built on.

Ranks exactly; shares within 0.1 for 5 s rests, 10 s moves and 8-9 degC with tau = 300 s.
"""
import numpy as np
import pytest

from sixflip_host.experiment.projection import alias_index, alias_matrix, rank
from sixflip_host.planning import protocols
from sixflip_host.planning.alias import ACCEL, PlannedModel, even_contrasts
from sixflip_host.planning.protocols import rows_of


def design(protocol, blocks=1, certified_box=True, **options):
    if isinstance(protocol, str):
        protocol = protocols.named(protocol)
    return PlannedModel(rows_of(protocol, blocks), certified_box=certified_box, **options)


def index(of, by, *args, **options):
    found = design(*args, **options)
    return alias_index(found.signature(of), found.signature(by))


def there_and_back(states, dwell_s=5.0):
    return protocols.Protocol("x", [
        protocols.faces_session(protocols.order_of("fixed"), backward=True, state=state,
                                dwell_s=dwell_s) for state in states])


def test_twelve_poses_leave_24_degrees_of_freedom_of_which_6_are_even_contrasts():
    found = design("paper", tilt=False)
    assert 3 * found.rows.n == 36
    assert found.freedom == 24
    assert even_contrasts(found.rows) == 6
    tilted = design("paper")
    assert found.freedom - tilted.freedom == 2  # the table's tilt, of the 18 flip differences


@pytest.mark.parametrize("effect", ["cubic", "saturation", "local_gravity", "supply"])
@pytest.mark.parametrize("protocol", ["paper", "return", "random", "backward", "thermal"])
def test_silent_on_faces(effect, protocol):
    assert design(protocol).signature(effect) is None


def test_constant_rectification_is_silent_and_vertical_is_not():
    from sixflip_host.experiment.projection import without
    from sixflip_host.experiment.terms import columns_of
    from sixflip_sim.effects.library import make
    found = design("paper")
    for vertical, silent in ((0, True), (1, False)):
        effect = make({"effect": "vibration_rectification", "vibration_mg": 100,
                       "vertical": vertical})
        _, _, columns = columns_of(effect, found.rows.at, found.rows.n)
        left = np.abs(without(found.space, columns)).max()
        assert (left < 1e-12 * np.abs(columns).max()) == silent


def test_leaning_poses_show_what_was_silent():
    found = design("recommended", certified_box=False)
    for effect in ("cubic", "saturation", "quadratic"):
        assert rank(found.signature(effect), found.raw(effect)[1]) == 3
    assert found.signature("local_gravity") is None


def test_the_angles_of_leaning_poses_are_taken_off_pose_by_pose():
    """Many of them make no wide matrix, and leave what the whole space leaves."""
    from sixflip_host.experiment.projection import without
    widths = []
    for leaning in (6, 24):
        session = protocols.faces_session(protocols.order_of("fixed"), leaning)
        found = design(protocols.Protocol("x", [session]), 2, certified_box=False)
        widths.append(found._common.shape[1])
        assert np.allclose(found.space.T @ found.space, np.eye(found.space.shape[1]), atol=1e-9)
        columns = found.raw("hysteresis")[1]
        assert np.allclose(found.left(columns), without(found.space, columns), atol=1e-9)
    assert widths[0] == widths[1]


def test_quadratic_is_asymmetry_on_faces_and_a_crooked_box_takes_both():
    assert index("quadratic", "asymmetry", "paper") == pytest.approx(1.0, abs=1e-9)
    assert index("vibration_rectification", "quadratic", "paper") == pytest.approx(1, abs=1e-9)
    assert index("quadratic", "box_tilt", "paper") == pytest.approx(1.0, abs=1e-9)
    for effect in ("quadratic", "asymmetry", "cross_quadratic", "vibration_rectification"):
        assert design("paper", certified_box=False).signature(effect) is None


@pytest.mark.parametrize("protocol, share", [
    ("paper", 0.98), ("return", 0.50), ("random", 0.16), ("backward", 0.02)])
def test_share_of_a_thermal_drift_that_a_crooked_box_reproduces(protocol, share):
    assert index("thermal_bias", "box_tilt", protocol) == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize("states, share", [
    (["warming"], 0.99), (["warming", "warm"], 0.74), (["warming", "cooling"], 0.01)])
def test_temperature_against_warm_up(states, share):
    found = index("thermal_bias", "warm_up", there_and_back(states), 10, certified_box=False)
    assert found == pytest.approx(share, abs=0.1)


@pytest.mark.parametrize("dwell_s, blocks, share", [(5, 5, 1.00), (20, 10, 0.94), (60, 12, 0.67)])
def test_hysteresis_against_creep(dwell_s, blocks, share):
    found = index("hysteresis", "creep", there_and_back(["warming"], dwell_s), blocks,
                  certified_box=False)
    assert found == pytest.approx(share, abs=0.1)


def norm_only_rank(rows):
    """Rank and number of parameters of a calibration that knows |a| = g alone: the lower
    triangle of the matrix and three biases (turning the box changes no norm)."""
    f = np.stack(rows.at.f, 1)
    columns = [f[:, i] * f[:, j] for i in range(3) for j in range(i + 1)]
    columns += [f[:, i] for i in range(3)]
    jacobian = np.stack(columns, 1)
    return int(np.linalg.matrix_rank(jacobian, tol=1e-9)), jacobian.shape[1]


def test_norm_only_on_six_faces_has_rank_6_of_9():
    assert norm_only_rank(rows_of(protocols.named("paper"))) == (6, 9)
    assert norm_only_rank(rows_of(protocols.named("recommended"))) == (9, 9)


def test_isotropic_g_sensitivity_is_the_vertical_earth_rate():
    found = design("paper", sensor="gyro")
    keys, columns = found.raw("g_sensitivity")
    g = found.signature("g_sensitivity")
    isotropic = sum(g[:, keys.index(k)] for k in ("xx", "yy", "zz"))[:, None]
    assert alias_index(isotropic, found.signature("earth_rate")) == pytest.approx(1, abs=1e-9)
    assert alias_index(g, found.signature("earth_rate")) < 0.2


def test_indices_are_shares_and_an_effect_is_itself():
    found = design("random", certified_box=False)
    names, matrix = alias_matrix({name: found.signature(name) for name in ACCEL})
    assert "cubic" not in names and "thermal_bias" in names
    assert np.allclose(np.diag(matrix), 1.0)
    assert matrix.min() >= 0.0 and matrix.max() <= 1.0 + 1e-9
