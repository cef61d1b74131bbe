"""What a log says of its own sensor: by rests that are some, by windows that are none, and how it
is told; the heading of a task."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip_host.capture.attitude import carried, rotations
from sixflip_host.diagnosis.simulator import (
    comparison,
    gravity_directions,
    own_calibration,
    own_rests,
    remaining_gap,
)
from sixflip_host.present import simulator_words
from tests.worlds import guided

G = 9.80665
MATRIX = np.array([[1.02, 0.004, 0.0], [0.004, 0.99, -0.006], [0.0, -0.006, 1.01]])
OFFSET = np.array([0.2, -0.1, 0.3])


def means_of(directions, sizes):
    """Readings of a sensor with MATRIX and OFFSET where so much (n,) acts along directions."""
    ups = directions / np.linalg.norm(directions, axis=1)[:, None]
    return (ups * sizes[:, None]) @ MATRIX.T + OFFSET


@pytest.mark.parametrize("seed", range(6))
def test_windows_of_a_flight_are_no_rests(seed):
    """Seven windows of a racing drone in which |force| is other than g by some percent: its own
    scale was -129000 %, its misalignment 213 +- 2 degrees."""
    generator = np.random.default_rng(seed)
    directions = np.array([0.0, 0.0, 1.0]) + 0.5 * generator.standard_normal((7, 3))
    sizes = G * (1.0 + 0.04 * generator.standard_normal(7))
    at_rest = own_rests.by_norm(means_of(directions, sizes), G)
    (matrix, bias), (sigma, bias_sigma) = own_rests.matrix_of(at_rest.p), at_rest.sigma
    off = matrix @ MATRIX - np.eye(3)
    assert np.abs(off).max() < 0.1
    assert (np.abs(off) < 3.0 * sigma).all() and (np.abs(bias - OFFSET) < 3.0 * bias_sigma).all()


@pytest.mark.parametrize("astray", [0, 1])
def test_rests_that_are_some_say_what_the_sensor_is(astray):
    """Even with one among them in which it was moved."""
    generator = np.random.default_rng(3)
    sizes = G + 0.003 * generator.standard_normal(24)
    sizes[:astray] += 0.5
    at_rest = own_rests.by_norm(means_of(generator.standard_normal((24, 3)), sizes), G)
    (matrix, bias), (sigma, bias_sigma) = own_rests.matrix_of(at_rest.p), at_rest.sigma
    assert np.abs(matrix @ MATRIX - np.eye(3)).max() < 0.002 and sigma.max() < 0.002
    assert np.abs(bias - OFFSET).max() < 0.01 and bias_sigma.max() < 0.01


def test_the_rests_fit_never_makes_them_less_likely():
    generator = np.random.default_rng(5)
    means = means_of(np.array([0.0, 0.0, 1.0]) + 0.4 * generator.standard_normal((7, 3)),
                     G * (1.0 + 0.04 * generator.standard_normal(7)))
    for scale in (0.005, 0.05, 0.5):
        p, _, log = own_rests.likeliest(np.zeros(9), means, G, scale)
        off = (G - np.linalg.norm(means, axis=1)) / scale
        assert log >= -2.5 * np.log1p(off ** 2 / 4.0).sum() - 7 * np.log(scale)


@pytest.mark.parametrize("scattered, scale, known", [
    (0.0, 1.05, True), (0.0, 0.4, False), (0.3, 1.0, False)])
def test_a_gyro_whose_moves_make_no_sense_is_not_known(scattered, scale, known):
    """Rests between which gravity lies anywhere, or rates that no part reads so: of such a fit
    nothing is to be set."""
    generator = np.random.default_rng(7)
    t = np.arange(0.0, 120.0, 0.02)
    attitude, rate, ups, rests = Rotation.identity(), np.zeros((len(t), 3)), [], []
    for k in range(24):
        first = 250 * k
        rests.append((first, first + 100))
        ups.append(attitude.inv().apply([0.0, 0.0, 1.0]))
        step = generator.standard_normal(3)
        step *= 0.6 / np.linalg.norm(step)
        rate[first + 100:first + 200] = step / (100 * 0.02)
        attitude = attitude * Rotation.from_rotvec(step)
    off = generator.standard_normal((len(ups), 3))
    ups = np.array(ups) + scattered * off / np.linalg.norm(off, axis=1)[:, None]
    ups /= np.linalg.norm(ups, axis=1)[:, None]
    trace = SimpleNamespace(t=t, rests=tuple(rests), rate=rate * scale, noise={},
                            quantum=(0.0, 0.0))
    at_rest = own_rests.AtRest(G * ups, np.zeros(9), np.eye(9) * 1e-8)
    _, gyro, sigma = own_calibration.by_carry(trace, rate * scale, at_rest)
    if known:
        assert sigma.max() < 0.01
        assert (np.abs(gyro - np.eye(3) / scale) < 4.0 * sigma).all()
    else:
        assert np.abs(gyro - np.eye(3)).max() < 0.1 and sigma.min() > 0.02


@pytest.mark.parametrize("noise, counted", [(0.0, True), (0.001, False)])
def test_a_simulator_that_turns_at_one_speed_is_not_cut_off(noise, counted):
    """Without noise the same rate is read again and again; with noise, only at the range's end."""
    generator = np.random.default_rng(8)
    t, axes = np.arange(0.0, 120.0, 0.02), np.eye(3)
    attitude, rate, ups, rests = Rotation.identity(), np.zeros((len(t), 3)), [], []
    for k in range(24):
        first = 250 * k
        rests.append((first, first + 100))
        ups.append(attitude.inv().apply([0.0, 0.0, 1.0]))
        rate[first + 100:first + 200] = 0.4 * axes[k % 3]
        attitude = attitude * Rotation.from_rotvec(0.8 * axes[k % 3])
    rate = np.clip(rate + noise * generator.standard_normal(rate.shape), -0.4, 0.4)
    trace = SimpleNamespace(t=t, rests=tuple(rests), rate=rate, quantum=(0.01, 1e-4), noise={
        "gyro": SimpleNamespace(per_sample=np.full(3, noise))})
    at_rest = own_rests.AtRest(G * np.array(ups), np.zeros(9), np.eye(9) * 1e-8)
    sigma = own_calibration.by_carry(trace, rate, at_rest)[2]
    assert (sigma.max() < 0.01) == counted


def number(value, half, difference, apart):
    interval = [value - half, value + half]
    return {"accel": {"bias": {"x": {
        "unit": "mg", "real": value, "real_interval_90": interval, "simulator": value,
        "simulator_interval_90": interval, "difference": difference,
        "difference_interval_90": [difference - apart, difference + apart], "differs": True,
        "set": difference, "how": ""}}}}


@pytest.mark.parametrize("value, half, said", [
    (-1.7, 131.0, "-"), (12.0, 0.3, "12 (11.7 … 12.3)"), (0.1, 0.3, "0.1 (-0.2 … 0.4)"),
    (210.0, 131.0, "210 (79 … 341)")])
def test_what_a_log_alone_does_not_say_is_left_blank(value, half, said):
    """"real: -1.7 (-133 … 130)" beside a difference of 3.58 +- 0.4."""
    row, = simulator_words.parameter_rows({"parameters": number(value, half, 3.58, 0.4)})
    assert row[1:3] == (said, said) and row[3].startswith("3.58")


def test_a_heading_is_no_further_off_than_half_a_turn():
    """An accelerometer with its sign turned: "heading 8622.00 degrees"."""
    t = np.arange(0.0, 60.0, 0.02)
    turned = [Rotation.from_rotvec(np.outer(rate * t, [0, 0, 1])).as_matrix()
              for rate in (0.0, 2.5)]
    task = remaining_gap.task_from_errors("it", [
        remaining_gap.attitude_errors(turned[1], turned[0], t), (1.0, -181.0)])
    once = np.degrees(2.5 * (t[-1] - t[t > remaining_gap.SETTLE_S][0])) % 360.0
    assert task.heading["before"] == pytest.approx(min(once, 360.0 - once), abs=1e-6)
    assert task.heading["after"] == pytest.approx(179.0)


@pytest.mark.parametrize("way", ["half a turn", "there and back", "a flight of seven turns"])
def test_a_gyro_carries_gravity_as_well_as_its_matrix_is_known(way):
    """After a flight of 2600 degrees gravity was to be within 4 of where the gyro had it, and one
    that read 8 % too little had "twice the range"."""
    t = np.arange(0.0, 20.0, 0.04)
    steps = np.zeros((len(t), 3))
    if way == "half a turn":
        steps[:, 0] = np.pi / len(t)
    elif way == "there and back":
        steps[:, 0] = 0.1 * np.cos(2.0 * np.pi * t / 20.0)
    else:
        steps = np.radians(3.0) * np.stack([np.sin(f * t + f) for f in (1.3, 2.1, 3.4)], 1)
    up = np.array([0.0, 0.6, 0.8])
    there = carried(rotations(steps))[-1].T @ up
    generator, off = np.random.default_rng(1), []
    for _ in range(200):
        matrix = np.eye(3) + gravity_directions.GYRO * generator.standard_normal((3, 3))
        off.append(np.linalg.norm(carried(rotations(steps @ matrix.T))[-1].T @ up - there))
    told = gravity_directions.carries(gravity_directions.spread(
        steps, carried(rotations(steps)))[None], up[None])[0]
    gyro = np.sqrt(max(told ** 2 - gravity_directions.SIGMA ** 2, 0.0))
    assert gyro == pytest.approx(np.sqrt(np.mean(np.square(off)) / 2.0), rel=0.2, abs=0.002)


def test_a_sign_of_another_motion_is_that_of_gravity_or_of_all_the_force():
    """It was said to be gravity's; what else moves the box was another thing in either log."""
    turned, = comparison.compare([("real", guided.session(1))], "sim", guided.session(
        2, accel=-2.0 * np.eye(3))).conventions
    assert turned.sensor == "accel" and turned.one_of == ("force_sign", "gravity_sign")


def laid_down(seed, leans, rows=400):
    """(directions at the rests, ways) of a thing that is turned to and fro ten turns or so between
    rests, and comes to lie as leans (n, 3) rad say, by a gyro without an error."""
    rng = np.random.default_rng(seed)
    ends, ways = Rotation.from_rotvec(leans), []
    for k in range(len(leans) - 1):
        fade = np.sin(np.linspace(0.0, np.pi, rows))[:, None]
        course = np.cumsum(rng.standard_normal((rows, 3)), axis=0)
        along = np.linspace(0.0, 1.0, rows)[:, None]
        course = (course - along * course[-1]) * fade * 0.15
        between = ends[k] * Rotation.from_rotvec(along * (ends[k].inv() * ends[k + 1]).as_rotvec())
        held = Rotation.from_rotvec(course) * between
        ways.append((k, k + 1, (held[:-1].inv() * held[1:]).as_rotvec()))
    return ends.inv().apply([0.0, 0.0, 1.0]), ways


def test_a_thing_that_is_laid_down_as_it_lay_accuses_no_gyro():
    """Each time it was where it had been to a tenth of a degree, and by a gyro of 3 % it might
    have been anywhere within ten: "the simulator does something that no convention explains"."""
    ups, ways = laid_down(1, 0.002 * np.random.default_rng(5).standard_normal((8, 3)))
    sigmas = gravity_directions.carries(gravity_directions.carried_by(ways, np.eye(3)).spread,
                                        ups[:-1])
    assert (sigmas > 1.3 * gravity_directions.SIGMA).all()
    plain = gravity_directions.carried_log(ups, ways, np.eye(3))
    assert plain > gravity_directions.nameless_log(ups, ways)
    assert plain > gravity_directions.carried_log(ups, ways, -np.eye(3)) - 1e-9


def test_where_gravity_goes_elsewhere_the_gyro_has_to_say_where():
    leans = np.random.default_rng(6).uniform(-1.2, 1.2, (8, 3))
    ups, ways = laid_down(2, leans)
    plain, nameless = (gravity_directions.carried_log(ups, ways, np.eye(3)),
                       gravity_directions.nameless_log(ups, ways))
    assert plain > nameless + 8.0
    swapped = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert gravity_directions.carried_log(ups, ways, swapped) < nameless
