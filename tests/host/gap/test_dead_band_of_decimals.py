"""Dead bands in files of decimals, whose counts are none of a chip's: a step that is wider than
those leaves counts out near 0 as everywhere."""

import numpy as np
import pytest

from sixflip_host.capture import open_recording
from sixflip_host.cli import main
from sixflip_host.diagnosis import answer, samples_judged
from sixflip_host.diagnosis.detect import dead_band, lattice
from sixflip_host.diagnosis.detect.detection import Finding, present
from sixflip_host.experiment import blocks
from sixflip_host.present import gap_sentence, gap_words
from tests.worlds.imported_text import table

ROWS = 6000


def moving(seed, noise):
    """(n, 3) that rests and swings about 0 by turns, and bool (n,) where it rests; the third axis
    rests nearest to 0."""
    rng = np.random.default_rng(seed)
    still = np.arange(ROWS) % 3000 < 1500
    swing = np.sin(2 * np.pi * np.arange(ROWS) / 700.0)[:, None] * [1.0, -0.8, 1.2] * (
        ~still[:, None])
    return 200.0 * noise * swing + rng.normal(0, noise, (ROWS, 3)) + noise * np.array(
        [4.0, -3.0, 0.2]), still


def found_in(tmp_path, accel=None, gyro=None):
    """{effect: Finding} in the registers of a file of decimals, 100 rows a second."""
    if accel is None:
        accel = [0.0, 0.0, 1.0] + np.random.default_rng(5).normal(0, 0.003, (ROWS, 3))
    if gyro is None:
        gyro = np.random.default_rng(6).normal(0, 0.07, (ROWS, 3))
    (tmp_path / "in.csv").write_text(table(["%.2f" % (k / 100) for k in range(len(gyro))],
                                           accel=accel, gyro=gyro, form="%.7f"))
    assert main(["import", str(tmp_path / "in.csv"), "-o", str(tmp_path / "out.csv"),
                 "--units", "g,dps", "--no-poses"]) == 0
    session = blocks.session_of("out.csv", open_recording.read_samples(tmp_path / "out.csv"))
    return {f.effect: f for found_by in samples_judged.FOUND_BY[:2] for f in found_by([session])}


def test_steps_that_are_rounded_towards_0_in_finer_ones_are_no_dead_band(tmp_path):
    """3.8 mg, multiplied and cut off to steps of 1/2048 g: 7, 15, 23 ... and 0."""
    tilt, _ = moving(2, 0.004)
    codes = np.trunc(7.8 * np.rint((tilt + [0.0, 0.0, 1.0]) / 0.0038))
    # to the last digits it was scaled, as by somebody's calibration
    accel = codes / 2048 * 1.00113
    assert "dead_band" not in found_in(tmp_path, accel=accel)


def test_a_chips_steps_about_a_bias_that_was_taken_off_are_no_dead_band(tmp_path):
    """0.061 deg/s beside a largest reading of 375 deg/s: 5.3 counts of the import's."""
    turn, _ = moving(3, 0.11)
    steps = np.rint(turn * [1.0, 1.0, 0.6] / 0.061)
    gyro = steps * 0.061 * [1.007, 0.983, 1.0] + [0.027, -0.022, 0.006]
    gyro[5000] = [375.0, 100.0, -200.0]
    assert "dead_band" not in found_in(tmp_path, gyro=gyro)


@pytest.mark.parametrize("decimals, step", [(False, 1.0), (True, 4.345)])
def test_a_log_whose_bias_was_taken_off_and_that_shakes_as_it_turns_has_no_dead_band(decimals,
                                                                                     step):
    """An arm's: 0.7 steps of noise about 0 in each rest, three times as much in each turn; what
    is quiet away from 0 is no rest, whose noise would tell how often one about 0 reads 0."""
    rng = np.random.default_rng(11)
    still = np.arange(ROWS) % 300 < 200
    turn = np.where(still, 0.0, np.sign(np.sin(2 * np.pi * np.arange(ROWS) / 600.0)) * 40.0)
    noise = rng.normal(0, 0.7, (ROWS, 3)) + rng.normal(0, 2.0, (ROWS, 3)) * ~still[:, None]
    codes = np.rint(turn[:, None] * [1.0, -0.8, 1.2] + noise + [0.13, -0.05, 0.02])
    counts = np.rint(step * codes + (0.4 if decimals else 0.0)).astype(np.int16)
    assert dead_band.findings("gyro", [counts], [still]) == []


def test_steps_of_little_more_than_two_counts_are_no_dead_band():
    """1/2048 rad/s beside a largest reading of 400 deg/s: of those next to 0 none is one count,
    on the axis that turns most and on one that turns little."""
    rng = np.random.default_rng(12)
    t = np.arange(ROWS)
    swing = np.sin(2 * np.pi * t / 160.0)[:, None] * [9.0, -7.0, 90.0]
    codes = np.rint(swing + rng.normal(0, [0.8, 0.8, 2.0], (ROWS, 3)))
    counts = np.rint(2.3946 * codes).astype(np.int16)
    assert dead_band.findings("gyro", [counts], [t < 0]) == []
    assert [one.spacing for one in lattice.of_columns(counts.astype(int))] == pytest.approx(
        [2.3946] * 3, rel=0.01)


@pytest.mark.parametrize("noise", [8.0, 40.0])
def test_an_axis_that_rounds_its_noise_towards_0_has_no_dead_band(noise):
    """0 is read twice as often as the codes beside it, on the quietest axis that rests there."""
    x, still = moving(4, noise)
    x = (x - x[still].mean(axis=0) + [4.0 * noise, 3.0 * noise, 0.0]) * [1.2, 1.7, 1.0]
    counts = np.trunc(x).astype(np.int16)
    nats, _ = dead_band.nats_of_rests([counts], [still])
    assert not present(nats.max())


def test_a_band_in_a_file_of_decimals_is_found_in_its_values():
    """Four of its own steps to either side read 0."""
    x, still = moving(7, 12.0)
    codes = np.rint(x / 5.346)
    codes[np.abs(codes) <= 4] = 0
    counts = np.rint(5.346 * codes).astype(np.int16)
    found = lattice.of_column(counts[:, 0].astype(int))
    assert found.spacing == pytest.approx(5.346, rel=0.01)
    said, = dead_band.findings("gyro", [counts], [still])
    assert "z" in said.axes
    assert all(value == pytest.approx(5 * 5.346, abs=6) for value in said.value.values())


def test_a_band_in_a_file_of_decimals_has_a_width_in_units(tmp_path):
    turn, _ = moving(3, 0.11)
    gyro = np.where(np.abs(turn) < 0.4, 0.0, turn)
    cause = answer.of_finding(found_in(tmp_path, gyro=gyro)["dead_band"])
    assert cause["value_in_unit"] == "°/s"
    # the import makes 32000 counts of the largest reading
    for axis, counts in cause["value"].items():
        assert cause["value_in"][axis] == pytest.approx(
            counts * np.abs(gyro).max() / 32000, rel=0.01)
        assert 0.3 < cause["value_in"][axis] < 0.8
    said = {"verdict": "explained", "causes": [cause], "damage": [], "gap": {}}
    assert gap_sentence.sentence(said).endswith("°/s.")
    assert gap_words.row(cause)[-1].endswith("°/s)")


def test_a_band_whose_upper_end_the_rests_do_not_show_is_so_much_or_more():
    finding = Finding("dead_band", "gyro", ["z"], {"z": 2}, "counts", 30.0, "amplitude", "",
                      {"z": (2, 18300.0)}, share=1.0)
    assert gap_words.row(answer.of_finding(finding))[-1] == "z 2 or more counts"


def test_wide_steps_of_whole_counts_less_a_bias_are_steps_and_no_dead_band(tmp_path):
    """1/256 g by a maker's scale, less a bias, in a file of 1/2048 g: ... -11, -3, 4 or 5, 12."""
    rng = np.random.default_rng(9)
    lean, turn = 1.5 * np.sin(np.arange(ROWS) / 300), np.arange(ROWS) / 170
    down = np.stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)], 1)
    codes = np.rint(257.8 * (down + rng.normal(0, 0.03, (ROWS, 3))))
    found = found_in(tmp_path, accel=np.rint(7.945 * codes + [3.9, 0.26, -1.95]) / 2048)
    assert "dead_band" not in found
    assert found["quantisation"].value == {"x": 8, "y": 8, "z": 8}


def test_a_chips_steps_in_decimals_of_a_short_log_are_no_dead_band(tmp_path):
    """Ten seconds of a chip at rest whose bias was taken off: 6 steps of noise are all it reads,
    and the values next to 0 are a step of 0.061 deg/s apart as all others."""
    rng = np.random.default_rng(10)
    bias = np.array([0.030, 0.020, 0.0020])
    gyro = np.rint(rng.normal(0.0, 0.09, (499, 3)) / 0.061) * 0.061 - bias
    gyro[:60] += np.rint(np.linspace(0, 2600, 60))[:, None] * 0.061
    assert "dead_band" not in found_in(
        tmp_path, gyro=gyro, accel=[0.0, 0.0, 1.0] + rng.normal(0, 0.003, (499, 3)))


def test_a_chips_own_step_beside_finer_ones_of_a_file_is_no_coarse_one():
    """1/2048 g in m/s2 of four decimals, of which import made counts of 1/10780.7 g."""
    codes = np.rint(np.random.default_rng(14).normal(0.0, 60.0, (ROWS, 3)))
    counts = np.rint(10780.7 / 2048 * codes).astype(int)
    assert lattice.steps(counts, "accel", 10780.7).tolist() == [1, 1, 1]
    assert lattice.steps(counts, "accel", 9000.0).tolist() == [5, 5, 5]
