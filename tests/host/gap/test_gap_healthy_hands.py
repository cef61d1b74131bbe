"""What hands do, and how far noise is known, is in the model with levels of its own: no gap."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from sixflip_host.diagnosis import (
    diagnosis,
    discrepancy,
    hypotheses,
    localisation,
    rest_model,
    stray_turns,
    turn_model,
)
from sixflip_host.diagnosis.detect import (
    line_across_rests,
    sample_neighbours,
    spectral_lines,
    torn_reads,
)
from sixflip_host.diagnosis.detect.detection import present
from sixflip_host.diagnosis.settings import Conditions
from sixflip_host.experiment import attitude_fit, block_measures, blocks, nominal_rows
from sixflip_host.experiment.attitude_fit import face_axes
from sixflip_host.experiment.projection import lateral_basis
from sixflip_host.simulation import scenario, simulated_session
from tests.worlds.still_session import at_rest, flicker

KNOWN_DEG = 0.03


def ends(number, seed, lost=(), tails=np.inf):
    """stray_turns.Ends of a session whose turns are off by 0.05 deg, those lost by 12."""
    generator = np.random.default_rng(seed)
    columns = generator.standard_normal((number, 2, 12))
    columns[0] *= 30.0  # one turn that the unknown bend to as they like
    off = 0.05 * generator.standard_normal((number, 2))
    if np.isfinite(tails):
        off = 0.05 * generator.standard_t(tails, (number, 1)) * np.sign(off)
    off[list(lost)] += 12.0
    return stray_turns.Ends(off + columns @ generator.normal(0.0, 0.2, 12), columns,
                            np.full((number, 2), KNOWN_DEG ** 2))


@pytest.mark.parametrize("seed", range(4))
def test_few_turns_that_much_is_fitted_to_are_none_that_end_far_off(seed):
    """Judged by what a fit leaves, the turns that decide it are near 0 and one other is not."""
    assert not present(stray_turns.nats([ends(11, seed)])[0])
    assert not present(stray_turns.nats([ends(40, seed, tails=4.0)])[0])


def test_turns_that_samples_were_lost_in_end_far_off():
    nats, number = stray_turns.nats([ends(40, 1, lost=(5, 11, 30)), ends(38, 2)])
    assert present(nats) and number == pytest.approx(3.0, abs=0.1)


def turned_by(off_deg):
    """SensorGap of the turns of a hand whose half turns are off by so much."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 4,
                               "world": {"flip_error_deg": off_deg}})
    session = blocks.session_of("s", simulated_session.session(plan, 0))
    return turn_model.TurnModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        [session], [attitude_fit.fit(session)])


@pytest.mark.parametrize("off_deg", [1.6, 10.0])
def test_a_hand_that_turns_by_half_a_circle_carelessly_is_no_gap_of_the_gyro(off_deg):
    gap = turned_by(off_deg)
    assert gap.adequacy.ok and not gap.posterior.best.forms
    assert gap.units[0].grid[gap.adequacy.index[0]][1] >= 0.5 * off_deg


@pytest.mark.long
def test_a_board_without_a_box_that_lies_anyhow_is_no_gap():
    """Five degrees off its faces, with no level of placement as large: unexplained."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "recommended", "seed": 2,
                               "world": {"placement_scatter_deg": 5.0, "tilt_deg": 1.0}})
    found = diagnosis.diagnose_sessions([
        blocks.session_of(str(k), simulated_session.session(plan, k)) for k in range(2)],
        diagnosis.Settings(jobs=1))
    assert found.verdict == "no gap" and found.gaps["accel"].adequacy.ok


def test_what_is_left_of_turns_and_nowhere_more_than_elsewhere_is_said_in_motion(monkeypatch):
    """With levels of a hand that end below this one's, no test of a domain finds where."""
    monkeypatch.setattr(turn_model, "FLIPS_DEG", (0.2, 0.4, 0.8, 1.6, 3.2))
    gap = turned_by(10.0)
    assert not gap.adequacy.ok
    place, = localisation.places(gap)
    assert (place.sensor, place.axis, place.domain) == ("gyro", None, "motion")
    assert place.p == gap.adequacy.p < 1e-6


def test_what_a_test_of_a_domain_finds_by_chance_is_no_place_of_a_quiet_sensor(monkeypatch):
    """Where everything passes as a discovery: of what is noise nothing is where a gap lies, of
    what is not all of it."""
    monkeypatch.setattr(localisation, "FALSE_DISCOVERIES", 1e6)
    monkeypatch.setattr(localisation, "LEAST_SHARE", 0.0)
    gap = turned_by(1.6)
    assert localisation.places(gap) == []
    left = replace(gap, adequacy=replace(gap.adequacy, ok=False))
    assert len(localisation.places(left)) > 3


def test_noise_near_the_edge_of_a_page_is_no_torn_read():
    """A page of four standard deviations, its edge 1.8 off the level: a level known by six
    samples only made twice as many samples look torn as can be."""
    generator = np.random.default_rng(3)
    column = np.rint(16384 + 149.0 + 59.0 * generator.standard_normal(38000)).astype(np.int64)
    assert not present(torn_reads.competed(sample_neighbours.tabled(column, False))[0])


def test_white_noise_is_known_as_well_as_its_degrees_of_freedom_say():
    generator = np.random.default_rng(5)
    first = np.arange(0, 20000, 250)
    found = np.array([block_measures.white(generator.standard_normal((20000, 3)), first,
                                           first + 250, 100.0) for _ in range(60)])
    scatter = (100.0 * found ** 2).mean(axis=1).var()
    assert 2.0 / scatter == pytest.approx(
        block_measures.freedom(first, first + 250, 100.0), rel=0.5)


def test_an_axis_that_never_changes_says_nothing_of_how_the_others_wander():
    """Counted as an axis without any noise it made that of the others unusual."""
    generator = np.random.default_rng(6)
    placement = np.repeat(np.arange(30), 2)
    session = SimpleNamespace(placement=placement, seconds=np.full(60, 2.5))
    values = 0.1 * generator.standard_normal((60, 3))
    values[:, 2] = 0.0
    shares = nominal_rows.axis_shares(session, values, np.full(3, 0.01))
    assert shares[:2] == pytest.approx(1.0, abs=0.5) and shares[:2].mean() == pytest.approx(
        1.0, abs=0.05) and shares[2] < 1e-3


def test_what_only_falls_with_frequency_is_drift_and_no_line():
    for seed in range(3):
        assert spectral_lines.findings([at_rest(flicker(seed))]) == []
    sine = 20.0 * np.sin(2.0 * np.pi * 0.014 * np.arange(20000))[:, None]
    line = spectral_lines.findings([at_rest(flicker(0) + sine)])[0].lines[0]
    assert line.hz == pytest.approx(1.4, abs=0.01) and line.steady


def test_another_form_of_an_effect_may_look_like_one_of_the_same_variable_only():
    def form(effect, axes):
        return hypotheses.Form(effect, axes=axes)
    bias = form("thermal_bias", (0, 1))
    assert discrepancy.alike(form("thermal_rate", (1,)), bias)
    assert not discrepancy.alike(form("thermal_rate", (2,)), bias)
    assert not discrepancy.alike(form("g_sensitivity", (1,)), bias)
    assert discrepancy.alike(form("dead_band", (1,)), form("asymmetry", (1,)))


def carried(seed, rest=500, move=400):
    """(counts, whether at rest) of noise of a fifth of a page where a hand that trembles carries
    the box from rest to rest, every other time onto another face."""
    generator, level, parts = np.random.default_rng(seed), 1000.0, []
    u = (np.arange(move) + 0.5) / move
    for number in range(24):
        parts.append(np.full(rest, level))
        way = number % 2 * (generator.choice([-16384, 0, 16384]) + 400.0 * generator.normal())
        trembling = sum(250.0 * generator.normal() * np.sin(8.0 * np.pi * hz * u)
                        for hz in generator.uniform(2.0, 9.0, 4))
        parts.append(level + way * u ** 3 * (10.0 - 15.0 * u + 6.0 * u ** 2)
                     + trembling * np.sin(np.pi * u) ** 2)
        level += way
    counts = np.concatenate(parts)
    return (np.rint(counts + 47.0 * generator.standard_normal(len(counts))).astype(np.int64),
            np.tile(np.arange(rest + move) < rest, 24))


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_a_hand_that_trembles_between_the_rests_is_no_torn_read(seed):
    """A sample and the one before it are carried together, so the page of one tells of the
    other: 10 to 30 nats for torn reads where all samples were judged alike."""
    counts, at_rest = carried(seed)
    samples = torn_reads.tabled(counts, False, at_rest)
    assert 11000 < len(samples) <= at_rest.sum()
    assert not present(torn_reads.competed(samples)[0])


def test_the_angles_of_the_accelerometer_that_reads_the_ends_are_no_gap_of_the_gyro():
    """Faces of a crooked box are read as angles between its axes, alike in every session."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "paper", "seed": 9})
    plan.worlds.append(dict(plan.worlds[0], seed=10))
    sessions = [blocks.session_of("s", simulated_session.session(plan, k)) for k in range(2)]
    nominal = [attitude_fit.fit(session) for session in sessions]
    skewed = np.eye(3) + np.radians(0.15) * np.array([[0, 1, -1], [1, 0, 1], [-1, 1, 0]])
    read = [one.up @ skewed for one in nominal]
    nominal = [replace(one, up=up / np.linalg.norm(up, axis=1)[:, None])
               for one, up in zip(nominal, read)]
    gap = turn_model.TurnModel("gyro", "mpu6050", diagnosis.Settings(jobs=1)).fit(
        sessions, nominal)
    assert gap.adequacy.ok and not gap.posterior.best.forms


def test_the_earth_turns_round_with_a_box_that_is_turned_on_a_face():
    """A bias that followed orientation was seen in healthy gyros whose box always stood in the
    same heading: the Earth's horizontal rate, which changes sign with the flip."""
    plan = scenario.from_dict({"sensor": "mpu6050", "scene": "paper", "seed": 4})
    session = blocks.session_of("s", simulated_session.session(plan, 0))
    nominal = attitude_fit.fit(session)
    up = nominal.up[session.placement]
    heading = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 6)
    earth = np.zeros((session.n, 3))
    for k, (face, code) in enumerate(zip(session.face, session.code)):
        # From a heading in the room, the same for each visit of a face; b is half a turn from a.
        first, second = lateral_basis(up[k])
        axis = lateral_basis(face_axes(np.array([face]))[0])[0]
        start = np.arctan2(axis @ second, axis @ first) + heading[face]
        turn = start + (0.0 if code % 2 else np.pi)
        earth[k] = 0.0042 * (np.cos(0.8) * (np.cos(turn) * first + np.sin(turn) * second)
                             + np.sin(0.8) * up[k])
    common = nominal_rows.rows("gyro", session, nominal).common
    size, *_ = np.linalg.lstsq(common, earth.reshape(-1), rcond=None)
    left = earth.reshape(-1) - common @ size
    assert np.abs(left).max() < 0.0003 < 0.002 < np.abs(
        earth.reshape(-1) - common[:, :1] @ size[:1]).max()
    assert np.abs(size).max() < 1.2


def short_rests(added, seconds=1.7, n=4000, longer_s=()):
    """Session of rests of less than two seconds; added: counts of (t in the rest, its start);
    longer_s: seconds of further rests at the end, to which nothing is added."""
    generator = np.random.default_rng(3)
    accel = [0.0, 0.0, 16384.0] + 46.0 * generator.standard_normal((n, 3))
    pose, each = np.zeros(n, np.int16), int(100 * seconds)
    last = n - int(100 * sum(longer_s)) - 80 * len(longer_s)
    for number, start in enumerate(range(0, last - each, each + 80)):
        pose[start:start + each] = 1 + number % 12
        accel[start:start + each] += added(np.arange(each) / 100.0, start / 100.0)[:, None]
    for number, longer in enumerate(longer_s):
        start, last = last + 80, last + 80 + int(100 * longer)
        pose[start:last] = 1 + number
    still = at_rest(flicker(5, n)).capture
    still.accel, still.pose = np.rint(accel).astype(np.int16), pose
    return blocks.session_of("s", still)


def test_a_line_shows_in_rests_of_less_than_two_seconds():
    """11 mg at 31 Hz were "no gap" where no rest held two seconds."""
    found, = spectral_lines.findings([short_rests(
        lambda t, start: 180.0 * np.sin(2.0 * np.pi * 31.0 * (start + t)))])
    assert found.effect == "vibration" and found.sensor == "accel"
    assert found.value["x"] == pytest.approx(11.0, rel=0.05)
    assert found.hz["x"] == pytest.approx(31.0, abs=0.2)


def test_a_line_shows_in_the_rests_of_a_protocol_beside_a_few_long_ones():
    """15 mg while the box was handled were "no gap" beside two long rests without them."""
    found, = spectral_lines.findings([short_rests(
        lambda t, start: 250.0 * np.sin(2.0 * np.pi * 31.0 * (start + t)),
        seconds=4.0, n=17600, longer_s=(30.0, 30.0))])
    assert found.effect == "vibration" and found.sensor == "accel"
    assert [line.letter for line in found.lines] == ["x", "y", "z"]
    assert [line.hz for line in found.lines] == pytest.approx([31.0] * 3, abs=0.2)


@pytest.mark.parametrize("hz,tau", [(4.0, 0.3), (7.0, 0.15), (11.0, 0.4)])
def test_what_rings_out_after_a_box_is_put_down_is_no_line(hz, tau):
    assert spectral_lines.findings([short_rests(
        lambda t, start: 500.0 * np.exp(-t / tau) * np.sin(2.0 * np.pi * hz * t))]) == []


@pytest.mark.parametrize("step", [1, 64])  # counts
def test_a_line_is_smaller_than_the_steps_that_the_noise_covers(step):
    """1.6 mg at 14 Hz were "no gap" where a count is 3.9 mg, and the noise 0.6 of that."""
    session = short_rests(
        lambda t, start: 26.0 * np.sin(2.0 * np.pi * 31.0 * (start + t)), n=12000)
    session.capture.accel = (session.capture.accel // step * step).astype(np.int16)
    found, = spectral_lines.findings([session])
    assert found.effect == "vibration" and found.sensor == "accel"
    assert found.value["x"] == pytest.approx(26.0 / 16.384, rel=0.15)
    assert found.hz["x"] == pytest.approx(31.0, abs=0.2)


def test_a_slow_line_shows_in_many_short_rests_together():
    """8 mg at 1 Hz were "no gap" where no rest held two periods."""
    found, = spectral_lines.findings([short_rests(
        lambda t, start: 131.0 * np.sin(2.0 * np.pi * 1.0 * (start + t)), n=12000)])
    assert found.hz["x"] == pytest.approx(1.0, abs=0.005)
    assert found.value["x"] == pytest.approx(8.0, rel=0.1)


def test_what_each_rest_does_for_itself_is_no_slow_line():
    """A course since the box was put down, the same in every rest, comes as often as they do; a
    sway of the bench keeps no phase."""
    generator = np.random.default_rng(7)

    def sways(t, start):
        phase = generator.uniform(0.0, 2.0 * np.pi)
        return 200.0 * np.exp(-t / 0.6) + 100.0 * np.sin(2.0 * np.pi * 0.9 * t + phase)
    assert spectral_lines.findings([short_rests(sways, n=12000)]) == []


@pytest.mark.parametrize("seed", range(12))
def test_a_dozen_rests_that_settle_each_in_its_own_way_are_no_slow_line(seed):
    """The bends of twelve rests come close to the sine of some frequency, whatever they are."""
    generator = np.random.default_rng(seed)
    capture = short_rests(
        lambda t, start: 600.0 * generator.standard_normal() * np.exp(-t / 2.5), 5.0, 580 * 12)
    assert len(capture.runs) == 12
    assert line_across_rests.strongest(capture, "accel", 0, 1.0) is None


@pytest.mark.parametrize("seed", [0, 152, 343])  # of 400, those that had a line
def test_what_wanders_by_itself_is_no_slow_line(seed):
    """The floor that a peak is held against is known by a few dozen powers, no better."""
    generator, n = np.random.default_rng(seed), 600 * 18
    course = np.zeros(n)
    for tau in (1.0, 4.0, 16.0, 64.0, 256.0):
        stays = np.exp(-0.01 / tau)
        steps = generator.normal(0.0, 1.0, n) * 19.1 * np.sqrt(1.0 - stays ** 2)
        steps[0] = generator.normal(0.0, 19.1)
        course += signal.lfilter([1.0], [1.0, -stays], steps)
    capture = short_rests(
        lambda t, start: course[np.rint(100.0 * (start + t)).astype(int)], 6.0, n)
    assert line_across_rests.strongest(capture, "accel", 0, 1.0) is None


@pytest.mark.parametrize("banded, found", [({}, ["g_sensitivity"]), ({"gyro": [0]}, [])])
def test_an_axis_that_rests_in_its_dead_band_says_nothing_of_the_earths_rate(banded, found):
    """The others turn with the Earth and it does not, which is a sensitivity to gravity of its
    own only where nothing is known of the band."""
    plan = scenario.from_dict({
        "sensor": "mpu6050", "scene": "recommended", "seed": 3, "world": {"gyro_noise_dps": 0.005},
        "effects": [{"effect": "earth_rate", "up": 0.0042}]})
    captures = [simulated_session.session(plan, k) for k in range(2)]
    for capture in captures:
        off = capture.gyro[:, 0] - np.median(capture.gyro[capture.pose > 0, 0])
        capture.gyro[:, 0] = np.where(np.abs(off) < 40, 0, off)
    sessions = [blocks.session_of(str(k), capture) for k, capture in enumerate(captures)]
    gap = rest_model.RestModel(
        "gyro", "mpu6050", diagnosis.Settings(jobs=1), Conditions(banded=banded)).fit(
            sessions, [attitude_fit.fit(session) for session in sessions])
    assert [form.effect for form in gap.posterior.best.forms] == found
