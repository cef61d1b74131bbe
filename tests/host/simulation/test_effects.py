"""Every canonical effect does what it says, in its unit, on a part without other errors.

Each test simulates noise-free counts with and without one effect and looks at the difference.
"""
import math

import numpy as np
import pytest

from sixflip_host.simulation import simulator
from sixflip_sim import worlds
from sixflip_sim.effects import make, typical
from sixflip_sim.effects.effect import BadEffect
from sixflip_sim.effects.library import CLASSES, EFFECTS, NAMES
from sixflip_sim.effects.library import make as make_one
from sixflip_sim.effects.moment import Moment

CANONICAL = """thermal_bias thermal_scale warm_up thermal_rate quadratic cross_quadratic cubic
asymmetry g_sensitivity drift quantisation dead_band saturation vibration
vibration_rectification sample_rate dropped_samples filter_lag hysteresis creep lever_arm box_tilt
table_tilt local_gravity torn_reads supply axis_swap earth_rate""".split()
MG = 16.384  # counts a mg at 2 g
WORLD = {"ideal": True, "accel_noise_mg": 0, "gyro_noise_dps": 0, "flip_error_deg": 0.0,
         "dwell_s": 5.0, "move_s": 2.5, "first_rest_s": 5.0, "temperature_c": 35.0,
         "warm_c": 10.0, "warm_tau_s": 60.0}
ACCEL = simulator.Output("accel", 5_000_000, 16384.0, 32767)
GYRO = simulator.Output("gyro", 5_000_000, 131.0, 32767)


def counts(specs, output=ACCEL, **world):
    """Counts (3, n) of a paper session, and the world."""
    made = worlds.make(dict(WORLD, **world))
    made.model.effects = make(specs, 1) if specs else []
    simulator.vectorise(made.model)
    k = np.arange(made.end_us * 1000 // output.period_ns)
    return simulator.counts(made.model, output, k), made


def change(spec, output=ACCEL, **world):
    """What one effect adds to every sample, (3, n) counts, and t, and the world."""
    base, made = counts([], output, **world)
    with_it = counts([spec], output, **world)[0]
    return with_it - base, np.arange(base.shape[1]) * output.period_ns * 1e-9, made


def still(made, name, t):
    """Mask of the placement of a pose, without its first and last half second."""
    t0, t1 = next((a, b) for pose, a, b in made.operator.log if pose == name)
    return (t > t0 * 1e-6 + 0.5) & (t < t1 * 1e-6 - 0.5)


def mean(spec, pose, output=ACCEL, per=MG, **world):
    """Mean change in a pose, in mg (or with per=131 in deg/s)."""
    difference, t, made = change(spec, output, **world)
    return difference[:, still(made, pose, t)].mean(axis=1) / per


def test_the_library_is_the_canonical_list_with_units_and_sources():
    assert sorted(NAMES) == sorted(CANONICAL) and len(set(NAMES)) == 28
    for name, cls in EFFECTS.items():
        assert cls.units and cls.__doc__ and cls.largest.keys() == cls.units.keys()
        for chip, (size, source) in typical.SIZES[name].items():
            assert chip in typical.NOISE and source and size, (name, chip)
        for alias in cls.aliases:
            assert alias.split()[0] in list(EFFECTS) + ["isotropic"], (name, alias)


def test_thermal_bias_with_square():
    found = mean({"effect": "thermal_bias", "z": -2.0, "reference_c": 25}, "Y-b", warm_c=0.0)
    assert found == pytest.approx([0, 0, -20], abs=0.05)
    found = mean({"effect": "thermal_bias", "x2": 0.1, "reference_c": 25}, "Y-b", warm_c=0.0)
    assert found == pytest.approx([10, 0, 0], abs=0.05)


def test_thermal_scale_of_accelerometer_and_gyro():
    found = mean({"effect": "thermal_scale", "x": 0.02}, "X-a", warm_c=0.0)
    assert found == pytest.approx([-2.0, 0, 0], abs=0.05)
    difference, _, _ = change({"effect": "thermal_scale", "sensor": "gyro", "z": 1.0}, GYRO,
                              warm_c=0.0)
    base = counts([], GYRO, warm_c=0.0)[0]
    assert np.polyfit(base[2], difference[2], 1)[0] == pytest.approx(0.10, rel=0.01)


def test_warm_up_and_thermal_rate_fade():
    difference, t, _ = change({"effect": "warm_up", "x": 100.0, "tau_s": 40.0})
    rows = np.abs(difference[1:]).max() == 0
    assert rows and difference[0] / MG == pytest.approx(100 * np.exp(-t / 40), abs=0.07)
    difference, t, _ = change({"effect": "thermal_rate", "y": 2.0})
    rate = 10.0 / 60.0 * np.exp(-t / 60) * 60.0  # degC/min
    assert difference[1] / MG == pytest.approx(2.0 * rate, abs=0.07)


@pytest.mark.parametrize("spec, up, down", [
    ({"effect": "quadratic", "z": 5.0}, 5.0, 5.0), ({"effect": "cubic", "z": 5.0}, 5.0, -5.0),
    ({"effect": "asymmetry", "z": 3.0}, 3.0, 3.0),
    ({"effect": "cross_quadratic", "zzz": 1.0}, None, None),
    ({"effect": "saturation", "z": 1.0, "level": 0.95}, -50.0, 50.0),
    ({"effect": "saturation", "z": 0.5, "level": 0.95}, -25.0, 25.0),
    ({"effect": "local_gravity", "g": 2.6}, 2.6, -2.6),
    ({"effect": "vibration_rectification", "z": 5.0, "vibration_mg": 1000}, 5.0, 5.0)])
def test_bends_on_the_two_faces(spec, up, down):
    if up is None:
        with pytest.raises(BadEffect, match="cross_quadratic has no 'zzz'"):
            make_one(spec)
        return
    assert mean(spec, "Z+a") == pytest.approx([0, 0, up], abs=0.05)
    assert mean(spec, "Z-b") == pytest.approx([0, 0, down], abs=0.05)


def test_cross_quadratic_couples_axes():
    assert mean({"effect": "cross_quadratic", "xzz": 4.0}, "Z-a") == pytest.approx(
        [4, 0, 0], abs=0.05)
    assert mean({"effect": "cross_quadratic", "xyz": 4.0}, "Z-a") == pytest.approx(
        [0, 0, 0], abs=0.05)


def test_g_sensitivity_and_earth_rate():
    found = mean({"effect": "g_sensitivity", "xz": 0.5}, "Z-a", GYRO, 131.0)
    assert found == pytest.approx([-0.5, 0, 0], abs=0.01)
    found = mean({"effect": "earth_rate", "up": 0.0042}, "Z-a", GYRO, 131.0)
    assert found[2] == pytest.approx(-0.0042, abs=0.008) and found[2] <= 0


def test_hysteresis_remembers_the_pose_before_and_creep_forgets_it():
    # the paper's order: X+b comes after X+a, X-a after X+b
    assert mean({"effect": "hysteresis", "x": 10.0}, "X+b") == pytest.approx([10, 0, 0], abs=.1)
    assert mean({"effect": "hysteresis", "x": 10.0}, "X-a") == pytest.approx([10, 0, 0], abs=.1)
    difference, t, made = change({"effect": "creep", "x": 10.0, "tau_s": 2.0})
    mask = still(made, "X-a", t)
    since = t[mask] - [a for pose, a, _ in made.operator.log if pose == "X-a"][0] * 1e-6
    assert difference[0, mask] / MG == pytest.approx(20 * np.exp(-since / 2), abs=0.1)


def test_lever_arm_of_3_cm_at_90_deg_s_is_7_5_mg():
    m = Moment()
    m.w = (0.0, 0.0, 90.0)
    out = [0.0, 0.0, 0.0]
    make_one({"effect": "lever_arm", "x": 3.0}).add(m, out)
    assert out == pytest.approx([-7.55, 0, 0], abs=0.01)
    m.w, m.w_rate, out = (0.0, 0.0, 0.0), (0.0, 0.0, 100.0), [0.0, 0.0, 0.0]
    make_one({"effect": "lever_arm", "x": 3.0}).add(m, out)  # alpha x r: z x x = +y
    assert out == pytest.approx([0, math.radians(100) * 0.03 / 9.80665e-3, 0])


def test_box_and_table():
    found = mean({"effect": "box_tilt", "Z-x": 0.1}, "Z-b")
    assert found == pytest.approx([1.745, 0, 0], abs=0.05)
    assert mean({"effect": "box_tilt", "Z-x": 0.1}, "Z+b") == pytest.approx([0] * 3, abs=0.05)
    a = mean({"effect": "table_tilt", "table_x": 0.5}, "Z+a")
    b = mean({"effect": "table_tilt", "table_x": 0.5}, "Z+b")
    assert np.linalg.norm(a) == pytest.approx(8.73, abs=0.05)
    assert a == pytest.approx(-b, abs=0.1)


def test_vibration_is_a_line_and_folds():
    for frequency, seen in ((30.0, 30.0), (170.0, 30.0)):  # sampled at 200 Hz
        difference, _, _ = change({"effect": "vibration", "x": 20.0, "frequency_hz": frequency})
        spectrum = np.abs(np.fft.rfft(difference[0])) * 2 / difference.shape[1] / MG
        peak = spectrum[1:].argmax() + 1
        assert peak * 200.0 / difference.shape[1] == pytest.approx(seen, abs=0.05)
        assert 12.0 < spectrum[peak] <= 20.1


def test_drift_has_the_allan_floor_asked_for():
    from sixflip_host.experiment import noise_arrays
    floors = []
    for seed in range(8):
        m = noise_arrays.moment()
        m.t = np.arange(0, 20000.0, 1.0)
        x = [0.0, 0.0, 0.0]
        make_one({"effect": "drift", "x": 0.4, "seed": seed}).add(m, x)
        means = x[0].reshape(-1, 100).mean(axis=1)  # 100 s
        floors.append(np.mean(np.diff(means) ** 2) / 2)
    assert math.sqrt(np.mean(floors)) == pytest.approx(0.4, rel=0.1)


def test_registers():
    plain = counts([], accel_noise_mg=3.0)[0]
    stepped = counts([{"effect": "quantisation", "x": 4}], accel_noise_mg=3.0)[0]
    assert np.gcd.reduce(stepped[0]) == 4 and np.gcd.reduce(stepped[1]) == 1
    assert np.abs(stepped[0] - plain[0]).max() <= 2
    band = counts([{"effect": "dead_band", "x": 8}], accel_noise_mg=0.5)[0]
    quiet = counts([], accel_noise_mg=0.5)[0]
    assert (band[0] == np.where(np.abs(quiet[0]) < 8, 0, quiet[0])).all()
    assert (band[0] != quiet[0]).any()
    swapped = counts([{"effect": "axis_swap", "x": -2, "y": 1}], accel_noise_mg=3.0)[0]
    assert (swapped[0] == -plain[1]).all() and (swapped[1] == plain[0]).all()


def test_torn_reads_jump_by_256():
    plain = counts([], accel_noise_mg=30.0)[0]
    torn = counts([{"effect": "torn_reads", "chance": 20}], accel_noise_mg=30.0)[0] - plain
    jumps = torn[torn != 0]
    assert len(jumps) > 100 and (jumps % 256 == 0).all()
    assert (torn != 0).any(axis=0).mean() < 0.2


def test_timing():
    rate = make_one({"effect": "sample_rate", "rate": -0.7})
    assert rate.period_us(10000.0) == pytest.approx(10070.5, abs=0.1)
    base, made = counts([], GYRO)
    late = counts([{"effect": "filter_lag", "sensor": "device", "tau": 10.0}], GYRO)[0]
    assert (late[:, 2:] == base[:, :-2]).mean() > 0.98  # 10 ms are two samples
    first = counts([{"effect": "filter_lag", "sensor": "gyro", "tau": 2.0}], GYRO)[0]
    slope = np.gradient(base[2].astype(float)) * 200.0
    assert np.polyfit(slope, (first - base)[2], 1)[0] == pytest.approx(-0.002, rel=0.05)
    felt = counts([], ACCEL)[0].astype(float)
    behind = counts([{"effect": "filter_lag", "sensor": "accel", "tau": 2.0}], ACCEL)[0] - felt
    assert np.polyfit((np.gradient(felt, axis=1) * 200.0).ravel(), behind.ravel(), 1)[
        0] == pytest.approx(-0.002, rel=0.05)
    slow = counts([{"effect": "sample_rate", "rate": 1.0, "stamped": 0}], GYRO)[0]
    turned, true = slow[2].sum(), base[2].sum()
    assert np.abs(slow - base).max() > 100 and abs(turned) > 0 and abs(true) > 0
    dropped = make_one({"effect": "dropped_samples", "chance": 5})
    assert dropped.lost(np.array([0.01, 0.049, 0.051, 0.9])).tolist() == [True, True, False,
                                                                          False]


def test_supply():
    found = mean({"effect": "supply", "x": 50.0, "volts": 3.4}, "Z+a")
    assert found == pytest.approx([5.0, 0, 0], abs=0.05)


@pytest.mark.parametrize("spec, expected", [
    ({"effect": "thermal_bia"}, "unknown effect 'thermal_bia', expected one of: thermal_bias"),
    ({"effect": ["creep"]}, "unknown effect ['creep']"), ({}, "an effect needs its name"),
    ("drift", "an effect needs its name"),
    ({"effect": "drift", "x": -1}, "expected a number from 0 to 100 mg"),
    ({"effect": "thermal_bias", "x": 1e9}, "expected a number from -100 to 100 mg/degC"),
    ({"effect": "thermal_bias", "x": float("nan")}, "x is nan"),
    ({"effect": "thermal_bias", "x": "big"}, "x is 'big'"),
    ({"effect": "thermal_bias", "x": True}, "x is True"),
    ({"effect": "thermal_bias", "w": 1}, "has no 'w', expected x y z"),
    ({"effect": "creep", "z": 1, "tau_s": 0}, "tau_s is 0, expected a number from 0.5"),
    ({"effect": "quantisation", "x": 2.5}, "expected a whole number"),
    ({"effect": "g_sensitivity", "sensor": "accel", "xx": 1}, "expected one of gyro"),
    ({"effect": "dropped_samples", "chance": 101}, "from 0 to 90 %")])
def test_bad_effects_say_what_was_expected(spec, expected):
    with pytest.raises(BadEffect) as caught:
        make_one(spec)
    assert expected in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.name)
def test_forward_form_is_the_sum_of_the_regressor_form(cls):
    m = Moment()
    m.t, m.temperature, m.temperature_rate, m.since_move = 33.0, 31.0, 0.01, 2.0
    m.f, m.w, m.w_rate, m.before = (0.3, -0.5, 0.8), (10.0, -20.0, 30.0), (1.0, 2, 3), (1.0, 0, 0)
    m.vibration_mg, m.volts, m.face = 100.0, 3.5, 0
    for sensor in cls.units:
        keys = cls.keys
        top = cls.largest[sensor]
        sizes = {key: (int(top) if cls.whole else top) * (0.3 if not cls.whole else 1)
                 for key in keys}
        effect = cls(sensor, sizes)
        terms = list(effect.terms(m))
        if not terms:
            continue
        forward, summed = [0.0] * 3, [0.0] * 3
        effect.add(m, forward)
        for key, axis, value in terms:
            summed[axis] += sizes[key] * value
        assert forward == pytest.approx(summed)
        assert any(forward) or cls.name == "saturation"
