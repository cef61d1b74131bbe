"""What recordings suffer: bytes put together wrongly, values that are held, scales that are not
the header's. One is put in and exactly that is found; the sound recording has none."""
import copy
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sixflip.poses import faces
from sixflip_host.capture import registers
from sixflip_host.capture.capture_file import Capture
from sixflip_host.diagnosis import samples_judged, stray_turns
from sixflip_host.diagnosis.detect import (
    byte_faults,
    codes,
    held_values,
    wrong_scale,
)
from sixflip_host.experiment import attitude_fit, blocks
from sixflip_host.simulation import scenario, simulated_session
from tests.studies.blind.generator.case import Case, Specification


@pytest.fixture(scope="module")
def sound():
    return simulated_session.session(scenario.from_dict(
        {"sensor": "mpu6050", "scene": "paper", "seed": 3}), 0)


def damaged(capture):
    """[(kind, sensor, axes)] of all damages, and the recording as it is looked at further."""
    mended, found = byte_faults.repaired([("one", capture)])
    session = blocks.session_of(*mended[0])
    found = [*found, *held_values.findings([session]), *wrong_scale.findings([session])]
    return [(d.kind, d.sensor, d.axes) for d in found], session


def changed(capture, sensor, axis, rule):
    """The capture with a rule applied to an axis of a sensor."""
    out = copy.copy(capture)
    counts = np.array(getattr(capture, sensor))
    counts[:, axis] = rule(counts[:, axis].astype(np.int64)).astype(np.int16)
    setattr(out, sensor, counts)
    return out


def low_or(x):
    return np.where(x & 255 >= 128, (x & 255) - 256, x)


def test_what_an_import_scaled_has_no_bytes():
    """What a file of decimals in g becomes: counts that no register had. Jumps of 256 of them,
    which a byte with a sign of its own made, are the sensor's."""
    rng = np.random.default_rng(9)
    level = np.round(6000.0 + 700.0 * np.sin(np.arange(900) / 25.0) + rng.normal(0.0, 9.0, 900))
    true = np.column_stack([rng.normal(0.0, 9.0, (900, 2)), level]).astype(np.int64)
    accel = np.where(true & 255 >= 128, true - 256, true).astype(np.int16)
    told = {}
    for kind in ("counts", "float"):
        capture = SimpleNamespace(accel=accel, gyro=None, meta={"accel_values": kind})
        (_, mended), = byte_faults.repaired([("one", capture)])[0]
        told[kind] = [(d.kind, d.axes) for d in byte_faults.repaired([("one", capture)])[1]]
        assert (mended.accel == accel).all() == (kind == "float")
    assert told["float"] == [] and ("sign_extension", ("x", "y", "z")) in told["counts"]


RULES = {
    "15 bits without their sign": ("gyro", 0, lambda x: x % 32768, "sign_extension"),
    "15 bits cut": ("accel", 2, lambda x: (x + 16384) % 32768 - 16384, "sign_extension"),
    "low byte signed and added": ("gyro", 1, lambda x: x - 256 * (x & 255 >= 128),
                                  "sign_extension"),
    "low byte signed and or-ed": ("accel", 1, low_or, "sign_extension"),
    "sign and magnitude": ("gyro", 2, lambda x: np.where(x < 0, -32768 - x, x),
                           "sign_extension"),
    "bytes exchanged": ("accel", 1, lambda x: ((x << 8 & 0xff00 | x >> 8 & 0xff) + 32768)
                        % 65536 - 32768, "byte_order"),
}


def test_a_sound_recording_has_no_damage(sound):
    assert damaged(sound)[0] == []


@pytest.mark.parametrize("name", RULES)
def test_bytes_put_together_wrongly_are_named_and_put_right(sound, name):
    sensor, axis, rule, kind = RULES[name]
    found, session = damaged(changed(sound, sensor, axis, rule))
    assert found == [(kind, sensor, ("xyz"[axis],))]
    again = getattr(session.capture, sensor)[:, axis].astype(int)
    true = getattr(sound, sensor)[:, axis].astype(int)
    assert (again == true).mean() > (0.9 if "or-ed" in name else 0.9999)
    assert samples_judged.judge([session]).findings == ()


WIDE = {"white": lambda g: 300 * g.standard_normal(2000),
        "a hand's motion between rests": lambda g: np.repeat([5, 1500], 1000) * np.sin(
            np.arange(2000) / 40) + np.repeat([3, 90], 1000) * g.standard_normal(2000),
        "a walk": lambda g: (3000 * np.sin(np.arange(2000) / 60)
                             + np.cumsum(60 * g.standard_normal(2000)))}
WIDE_RULES = ("15 bits without their sign", "low byte signed and added", "sign and magnitude")


@pytest.mark.parametrize("name", WIDE_RULES)
@pytest.mark.parametrize("course", WIDE)
def test_bytes_are_put_right_in_noise_that_is_wider_than_a_page(name, course):
    column = np.rint(WIDE[course](np.random.default_rng(2))).astype(np.int64)
    assert byte_faults.column_fault(column) is None
    rule, kind = RULES[name][2:]
    read = rule(column)
    found = byte_faults.column_fault(read)
    assert found is not None and found[0] == kind
    assert (found[2](read) == column).all()


@pytest.mark.parametrize("noise, level, right", [(30, 5000, 0.99), (40, 5050, 0.97)])
def test_a_wiped_high_byte_is_the_one_of_the_level_around(noise, level, right):
    column = np.rint(level + noise * np.random.default_rng(3).standard_normal(3000)).astype(int)
    read = low_or(column)
    found = byte_faults.column_fault(read)
    assert "wipes" in found[1] and "wrong by 256 where they leave it open" in found[1]
    assert (found[2](read) == column).mean() > right


def trembling(seed):
    """(n,) counts of a gyro's axis that lies still at 75 counts and is now and then turned by a
    hand which trembles at some hertz, 100 rows a second."""
    generator, parts = np.random.default_rng(seed), []
    for _ in range(8):
        t = np.arange(375) / 100.0
        hand = generator.uniform(-2.0, 2.0) + sum(
            size * np.sin(2.0 * np.pi * hz * t + phase) for size, hz, phase in generator.uniform(
                [0.2, 5.0, 0.0], [1.0, 7.0, 6.0], (2, 3)))
        parts += [np.zeros(2500), 2500.0 * np.sin(np.pi * t / t[-1]) * hand]
    course = np.concatenate(parts)
    return np.rint(75.0 + course + generator.normal(0.0, 1.5, len(course))).astype(np.int64)


@pytest.mark.parametrize("seed", [2, 6, 8])
def test_a_hand_that_trembles_puts_no_byte_together_wrongly(seed):
    """What a rule changes is judged by what foretells that best: counts taken back on the way
    were held against a foresight that suits the rests; one such column in three had a fault."""
    column = trembling(seed)
    assert byte_faults.column_fault(column) is None
    read = RULES["low byte signed and added"][2](column)
    assert byte_faults.column_fault(read)[0] == "sign_extension"


@pytest.mark.parametrize("seed", [1, 8, 13])
def test_a_coarse_gyro_that_waggles_puts_no_byte_together_wrongly(seed):
    """Steps of 16 counts, fifty rows a second. Of what a rule makes more samples leap, and a share
    of leaps that suits those was better for the samples that it changes, at the others' cost: it
    suits the counts as they were read as well."""
    generator, parts, t = np.random.default_rng(seed), [], np.arange(0.0, 4.0, 0.02)
    for _ in range(11):
        hand = np.sin(np.pi * t / 4.0)
        turn = generator.uniform(-4500.0, 4500.0) * hand ** 2
        waggle = sum(generator.uniform(240.0, 800.0) * np.sin(
            2.0 * np.pi * hz * t + generator.uniform(0.0, 6.0))
            for hz in generator.uniform(4.0, 11.0, 3))
        parts += [np.zeros(1500), turn + hand * waggle]
    course = np.concatenate(parts) - 19.0
    column = 16 * np.rint((course + generator.normal(0.0, 4.0, len(course))) / 16) + 5
    assert byte_faults.column_fault(column.astype(np.int64)) is None


def test_rests_whose_moves_were_cut_out_have_no_fault():
    """From one face to the opposite one in a sample is a step of 2 g: 2^15 counts."""
    faces = np.repeat([1, -1, 0, 0, 1, -1, 1, 0, -1], 100)
    column = np.rint(8150 * faces + 20 * np.random.default_rng(4).standard_normal(900))
    assert byte_faults.column_fault(column.astype(np.int64)) is None


@pytest.mark.parametrize("times", [2, 3])
@pytest.mark.parametrize("sensor", ["accel", "gyro"])
def test_values_of_one_sensor_that_are_held(sound, sensor, times):
    held = copy.copy(sound)
    counts = getattr(sound, sensor)
    setattr(held, sensor, np.repeat(counts[::times], times, axis=0)[:len(counts)])
    found, session = damaged(held)
    assert found == [("repeats", sensor, ())]
    assert held_values.findings([session])[0].value["times"] == pytest.approx(times, rel=0.02)


@pytest.mark.parametrize("factor", [0.5, 2.0, 4.0])
@pytest.mark.parametrize("sensor, key", [("accel", "accel_lsb_per_g"),
                                         ("gyro", "gyro_lsb_per_dps")])
def test_a_range_that_is_not_the_headers(sound, sensor, key, factor):
    other = copy.copy(sound)
    other.meta = dict(sound.meta, **{key: sound.meta[key] / factor})
    found, session = damaged(other)
    assert found == [("full_scale", sensor, ())]
    size = wrong_scale.findings([session])[0].value["factor"]
    assert size == pytest.approx(factor, rel=0.05)


@pytest.mark.parametrize("circles", [1, 2])
@pytest.mark.parametrize("factor, said", [(1.0, []), (2.0, [("full_scale", "gyro", ())])])
def test_half_turns_with_whole_circles_more_are_no_wrong_range(sound, circles, factor, said):
    """A person who turned the box by 540 degrees had a gyro of twice the range."""
    lsb = sound.meta["gyro_lsb_per_dps"] / 8.0
    spun = copy.copy(sound)
    counts = sound.gyro / 8.0
    session = blocks.session_of("one", sound)
    for before, after in zip(session.runs, session.runs[1:]):
        face = faces.face_of_code(before.code)
        if face != faces.face_of_code(after.code):
            continue
        move, axis = slice(before.end, after.first), faces.AXIS[face]
        way = np.sign(counts[move, axis].sum())
        counts[move, axis] += way * 360.0 * circles * lsb / (
            session.t_s[after.first] - session.t_s[before.end])
    spun.gyro = np.rint(counts).astype(np.int16)
    spun.meta = dict(sound.meta, gyro_lsb_per_dps=lsb / factor)
    session = blocks.session_of("one", spun)
    assert [(d.kind, d.sensor, d.axes) for d in wrong_scale.findings([session])] == said


@pytest.mark.parametrize("factor", [0.25, 0.5, 2.0, 4.0])
def test_a_wrong_range_of_the_gyro_is_no_other_order_of_its_axes(sound, factor):
    other = copy.copy(sound)
    other.meta = dict(sound.meta, gyro_lsb_per_dps=sound.meta["gyro_lsb_per_dps"] / factor)
    session = blocks.session_of("one", other)
    assert stray_turns.swapped([session], [attitude_fit.fit(session)]) is None


def test_flips_alone_tell_the_gyros_range(sound):
    """Two poses of one face and the half turn between them: gravity does not turn."""
    rows = np.flatnonzero(sound.pose > 0)
    first = sound.pose[rows[0]]
    codes = list(dict.fromkeys(sound.pose[rows].tolist()))
    end = int(np.flatnonzero(sound.pose == codes[1]).max()) + 1
    assert first == codes[0]
    two = copy.copy(sound)
    for name in ("t_us", "accel", "gyro", "temp", "pose"):
        setattr(two, name, getattr(sound, name)[:end])
    assert damaged(two)[0] == []
    two.meta = dict(sound.meta, gyro_lsb_per_dps=2.0 * sound.meta["gyro_lsb_per_dps"])
    assert damaged(two)[0] == [("full_scale", "gyro", ())]


def unlabelled(attitudes, force, rate_hz=100.0, gyro=1.0, seed=3):
    """Session of a log whose poses nobody named: force (n, 3) in g in the body, and the rates of
    rotations (n,) of it, which the gyro reads so many times."""
    rng, n = np.random.default_rng(seed), len(force)
    rates = np.degrees((attitudes[:-1].inv() * attitudes[1:]).as_rotvec()) * rate_hz
    rates = gyro * np.vstack([rates, rates[-1:]]) + rng.normal(0.0, 0.1, (n, 3))
    meta = {"sensor": "other", "rate_hz": rate_hz, "accel_lsb_per_g": 8192.0,
            "gyro_lsb_per_dps": 32.8}
    return blocks.session_of("log", Capture(
        meta, np.rint(np.arange(n) * 1e6 / rate_hz).astype(np.int64),
        np.rint(8192.0 * (force + rng.normal(0.0, 0.004, (n, 3)))).astype(np.int16),
        np.rint(32.8 * rates).astype(np.int16)))


@pytest.mark.parametrize("gyro, said", [(1.0, []), (3.0, [("gravity tells", 3.0)])])
def test_a_pendulums_string_is_no_gravity(gyro, said):
    """Its force points along the string: 0.3 m of 0.45 m, so that a third of gravity's turning
    shows, and the gyro turned three times as far."""
    t, length, arm = np.arange(6000) / 100.0, 0.45, 0.30
    hz = np.sqrt(9.80665 / length)
    sway = np.column_stack([np.radians(32.0) * np.sin(hz * t), np.radians(21.0) * np.sin(
        1.04 * hz * t + 0.8), 0.0 * t]) * np.exp(-t / 60.0)[:, None]
    turned = Rotation.from_rotvec(sway)
    at = turned.apply([0.0, 0.0, -arm])
    pull = np.gradient(np.gradient(at, t, axis=0), t, axis=0) / 9.80665 + [0.0, 0.0, 1.0]
    session = unlabelled(turned[50:-50], turned[50:-50].inv().apply(pull[50:-50]), gyro=gyro)
    found = wrong_scale.findings([session])
    assert [("gravity tells" if "gravity tells" in d.words else d.words, pytest.approx(
        d.value["factor"], rel=0.15)) for d in found] == said


@pytest.mark.parametrize("gyro, said", [(1.0, []), (0.45, [("full_scale", "gyro")])])
def test_pauses_tell_the_gyros_scale_whatever_shakes_it_in_between(gyro, said):
    """A hand turns it from one attitude to another, and jerks it on the way: 0.45 of the scale
    was nothing that is said."""
    rng, rotations = np.random.default_rng(7), [Rotation.identity()]
    for _ in range(14):
        axis = rng.normal(0.0, 1.0, 3)
        turn = axis / np.linalg.norm(axis) * np.radians(rng.uniform(60.0, 150.0))
        share = np.concatenate([0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 150)), np.ones(150)])
        rotations += [rotations[-1] * Rotation.from_rotvec(part * turn) for part in share]
    turned = Rotation.concatenate(rotations)
    moves = (np.arange(len(turned)) - 1) % 300 < 150
    jerks = rng.normal(0.0, 0.25, (len(turned), 3)) * moves[:, None]
    session = unlabelled(turned, turned.inv().apply([0.0, 0.0, 1.0]) + jerks, gyro=gyro)
    found = wrong_scale.findings([session])
    assert [(d.kind, d.sensor) for d in found] == said
    assert not found or found[0].value["factor"] == pytest.approx(gyro, rel=0.01)


def test_gravity_that_no_range_explains(sound):
    other = copy.copy(sound)
    other.meta = dict(sound.meta, accel_lsb_per_g=sound.meta["accel_lsb_per_g"] / 1.5)
    assert damaged(other)[0] == [("gravity", "accel", ())]


def test_gravity_that_was_taken_off(sound):
    """A phone's linear acceleration had a scale that was not the header's."""
    other = copy.copy(sound)
    session = blocks.session_of("one", other)
    other.accel = np.array(sound.accel)
    for _, first, end in session.runs:
        other.accel[first:end] -= np.rint(sound.accel[first:end].mean(axis=0)).astype(np.int16)
    found, = wrong_scale.findings([blocks.session_of("one", other)])
    assert found.kind == "gravity" and "gravity has been taken off" in found.words


def band_of(values):
    return registers.dead_band(np.repeat(np.rint(values)[:, None], 3, axis=1).astype(int))[0]


@pytest.mark.parametrize("counted, band", [
    (lambda x: np.where(np.abs(x) < 2, 0, x), 2), (lambda x: np.where(np.abs(x) < 3, 0, x), 3),
    (lambda x: x, 0), (lambda x: np.rint(np.rint(x / 1.6) * 1.6), 0),
    (lambda x: np.where(np.abs(x) == 1, 2 * x, x), 0)])
def test_a_dead_band_of_one_code_to_either_side_is_one(counted, band):
    """An ADXL345 at rest near 0: the codes beside 0 are read as 0, and not only never read."""
    generator = np.random.default_rng(8)
    x = np.rint(np.repeat(generator.uniform(-9.0, 9.0, 60), 300)
                + 1.1 * generator.standard_normal(18000))
    assert registers.dead_band(counted(x).astype(np.int64)[:, None]).tolist() == [band]


def test_a_scale_that_was_rounded_has_no_dead_band():
    """At rest 0 is read far more often than the codes beside it, of which one is left out; so are
    others that the moves go through."""
    generator = np.random.default_rng(8)
    k = np.concatenate([0.5 * generator.standard_normal(9000), 40.0 * np.sin(
        np.arange(4000) / 300.0) + 0.5 * generator.standard_normal(4000)])
    assert band_of(1.5 * np.rint(k)) == 0


def test_a_dead_band_is_wider_than_the_spacing_elsewhere():
    """A rate printed with one decimal and taken as counts of 131 per deg/s: 0, 13, 26, 39 … is
    how it is spaced, and a band of five such steps is one."""
    rate = 0.4 * np.random.default_rng(4).standard_normal(4000)
    printed = np.round(rate, 1) * 131.0
    assert band_of(printed) == 0 and codes.band_nats(np.rint(printed)[:, None])[0] <= 0.0
    banded = np.where(np.abs(printed) < 40.0, 0.0, printed)
    assert band_of(banded) == 52
    assert codes.band_nats(np.rint(banded)[:, None])[0] > 20.0


@pytest.mark.parametrize("level", [-84.0, 8.0])
def test_bytes_are_told_by_the_steps_that_a_rule_changes_not_by_how_quiet_the_rests_are(level):
    """A gyro that rests most of the time: what suits the rests better is no matter of bytes."""
    generator, u, parts = np.random.default_rng(1), (np.arange(250) + 0.5) / 250, []
    for _ in range(8):
        swings = sum(3000.0 * generator.normal() * np.sin(4.0 * np.pi * f * u + f)
                     for f in generator.uniform(0.4, 3.0, 3))
        parts += [np.full(1500, level), level + np.sin(np.pi * u) ** 2 * swings]
    rates = np.concatenate(parts)
    sound = np.rint(rates + 1.6 * generator.standard_normal(len(rates))).astype(np.int64)
    assert byte_faults.column_fault(sound) is None
    kind, words, back, _ = byte_faults.column_fault(
        np.where(sound & 255 >= 128, sound - 256, sound))
    assert kind == "sign_extension" and words.startswith("the low byte has a sign of its own")
    assert np.array_equal(back(np.where(sound & 255 >= 128, sound - 256, sound)), sound)


@pytest.mark.parametrize("seed, session", [(477873858, 0), (1279343444, 1)])
def test_a_hands_turns_mirrored_are_no_sign_with_a_magnitude(seed, session):
    """A gyro of the blind generator that rests below zero: most of its course is as likely the
    other way up, so that it tells nothing of bytes."""
    rates = Case(Specification(seed)).counts(session).counts[:, 4].astype(np.int64)
    assert byte_faults.column_fault(rates) is None
    told = np.where(rates < 0, -32768 - rates, rates)
    _, words, back, _ = byte_faults.column_fault(told)
    assert words.startswith("negative readings are a sign and a magnitude")
    assert np.array_equal(back(told), rates)


def test_rows_that_are_not_read_anew_are_no_samples(sound):
    """A logger that misses reads and writes the last sample once more: about ten such rows were
    found, and what they do to turns was a stranger in motion."""
    generator, lost = np.random.default_rng(4), np.zeros(len(sound), bool)
    for start in np.flatnonzero(generator.random(len(sound)) < 0.008):
        lost[start + 1:start + 1 + generator.integers(1, 6)] = True
    last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(sound))))
    held = copy.copy(sound)
    held.accel, held.gyro = sound.accel[last], sound.gyro[last]
    (_, plain), = held_values.as_read([("one", held)])[0]
    damage, = held_values.as_read([("one", held)])[1]
    assert (damage.sensor, damage.domain) == ("device", "timing")
    assert damage.value["rows"] == lost.sum()
    assert np.array_equal(plain.t_us, sound.t_us[~lost])
    assert np.array_equal(plain.pose, sound.pose[~lost])
    judged = samples_judged.judge([blocks.session_of("one", plain)], damages=[damage])
    assert not judged.findings and any("not read" in remark for remark in judged.remarks)


def test_a_sensor_read_faster_than_it_measures_misses_nothing(sound):
    """Every tenth row of both is the row before: at regular times."""
    last = np.maximum.accumulate(np.where(np.arange(len(sound)) % 10 == 9, 0,
                                          np.arange(len(sound))))
    held = copy.copy(sound)
    held.accel, held.gyro = sound.accel[last], sound.gyro[last]
    assert held_values.as_read([("one", held), ("two", sound)])[1] == []
