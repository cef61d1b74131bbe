"""Other people's CSV: real recordings against the numbers in their READMEs, and every fault."""

import json

import numpy as np
import pytest

from sixflip.poses.faces import pose_name
from sixflip_host.calibrate import solution
from sixflip_host.capture import capture_file
from sixflip_host.capture.imports import value_steps
from sixflip_host.cli import main


def imported(tmp_path, capsys, *words):
    """(Capture, what was printed) of an import that must succeed."""
    assert main(["import", *map(str, words), "-o", str(tmp_path / "out.csv")]) == 0
    return capture_file.read(tmp_path / "out.csv"), capsys.readouterr().out


def refused(tmp_path, capsys, *words):
    """(exit code, the line) of an import that must fail and leave nothing."""
    code = main(["import", *map(str, words), "-o", str(tmp_path / "out.csv")])
    assert not (tmp_path / "out.csv").exists()
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return code, error


IMUCAL = "imucal_ferraris/example_ferraris_session"


def test_imucal_example_with_its_sections(recordings, tmp_path, capsys):
    capture, words = imported(
        tmp_path, capsys, recordings / (IMUCAL + ".csv.gz"), "--units", "si,dps",
        "--rate", 102.4, "--sections", recordings / (IMUCAL + "_list.json"))
    assert len(capture) == 10376
    assert 9.80665 / capture.meta["accel_lsb_per_g"] == pytest.approx(0.00479, abs=5e-6)
    assert 1 / capture.meta["gyro_lsb_per_dps"] == pytest.approx(0.0610, abs=5e-5)
    assert "taken as moving: x_rot y_rot z_rot" in words
    assert [(pose_name(one.pose), one.first, one.n) for one in capture.placements()][:2] == [
        ("X+a", 540, 731), ("X-a", 1620, 741)]
    found = solution.solve(capture)
    assert found.verdict == "doubtful" and "no flips" in found.reason
    assert 0.4 < crooked_deg(found.reason) < 0.8


def crooked_deg(reason):
    return float(reason.split("crooked by about ")[1].split()[0])


def test_imucal_example_without_labels(recordings, tmp_path, capsys):
    capture, _ = imported(tmp_path, capsys, recordings / (IMUCAL + ".csv.gz"),
                          "--units", "si,dps", "--rate", 102.4)
    sections = json.loads((recordings / (IMUCAL + "_list.json")).read_text())
    for name, at in sections.items():
        if not name.endswith("_rot"):
            pose = name[0].upper() + "+-"[name[2] == "a"] + "a"
            middle = (at["start"] + at["end"]) // 2
            assert pose_name(int(capture.pose[middle])) == pose
        else:
            assert not capture.pose[(at["start"] + at["end"]) // 2]
    found = solution.solve(capture)
    assert found.verdict == "doubtful" and "no flips" in found.reason
    assert 0.4 < crooked_deg(found.reason) < 0.8


def test_imucal_annotated(recordings, tmp_path, capsys):
    capture, words = imported(
        tmp_path, capsys, recordings / "imucal_ferraris" / "annotated_session.csv.gz",
        "--accel-lsb", 2048, "--gyro-lsb", 16.4, "--rate", 204.8, "--time-column", "samples",
        "--time-unit", "samples", "--sort", "--label-column", "part")
    assert len(capture) == 9414
    assert {pose_name(one.pose): one.n for one in capture.placements()} == {
        "X+a": 1028, "X-a": 1061, "Y+a": 734, "Y-a": 848, "Z+a": 881, "Z-a": 1044}
    assert "rows moved to put samples in order" in words
    found = solution.solve(capture)
    assert found.verdict == "doubtful" and "no flips" in found.reason


STILL = ((50, 3700), (4200, 4440), (4760, 5070), (5440, 5800), (6100, 6480), (6900, 7170),
         (7520, 7880), (8200, 8570), (9060, 9280), (9640, 10190))


def test_suarez_ten_poses_with_six_near_faces(recordings, tmp_path, capsys):
    capture, words = imported(
        tmp_path, capsys,
        recordings / "suarez_mpu6050_multiposition" / "example_data_calibration.csv.gz",
        "--accel-lsb", 16384, "--gyro-lsb", 131, "--rate", 100, "--sensor", "mpu6050")
    assert "every accelerometer count is a multiple of 4" in words
    assert capture.accel[0].tolist() == [-12, -812, 15032]
    names = [pose_name(int(capture.pose[(first + end) // 2])) for first, end in STILL]
    assert names[:6] == ["Z+a", "Z-a", "X-a", "X+a", "Y-a", "Y+a"]
    assert all(name.startswith("L") for name in names[6:])
    for (_, end), (later, _) in zip(STILL, STILL[1:]):
        assert not capture.pose[end:later].all()        # they moved in between
    assert "held by hand" in words
    found = solution.solve(capture)
    assert found.verdict == "doubtful" and "no flips" in found.reason
    middle = solution.middles_mg(found.placements, 16384)[2]
    assert middle == pytest.approx(-112, abs=1)


def test_solve_says_what_it_sees_in_suarez(recordings, tmp_path, capsys):
    imported(tmp_path, capsys,
             recordings / "suarez_mpu6050_multiposition" / "example_data_calibration.csv.gz",
             "--accel-lsb", 16384, "--gyro-lsb", 131, "--rate", 100, "--no-poses")
    assert main(["solve", str(tmp_path / "out.csv")]) == 0
    words = capsys.readouterr().out
    assert "multiple of 4" in words and "held by hand" in words and "no flips" in words


TABLE = "time;acc_x;acc_y;acc_z;note\n0;0.0;0.5;9.5;a\n0.01;0.5;-1.0;10.0;b\n"


def test_mapping_units_and_delimiter(tmp_path, capsys):
    source = tmp_path / "in.csv"
    source.write_text("logger 7\n" + TABLE)
    capture, words = imported(tmp_path, capsys, source, "--units", "si", "--time-column", "time",
                              "--time-unit", "s", "--no-poses", "--g", 9.8)
    assert "steps of 1/19.6 g" in words
    assert capture.meta["accel_lsb_per_g"] == pytest.approx(19.6)
    assert capture.accel.tolist() == [[0, 1, 19], [1, -2, 20]]
    assert capture.t_us.tolist() == [0, 10000]
    capture, _ = imported(tmp_path, capsys, source, "--units", "g", "--rate", 50, "--no-poses",
                          "--accel-lsb", 100, "--map", "ax=acc_z,az=acc_x")
    assert capture.accel[0].tolist() == [950, 50, 0]


def test_a_head_is_no_sample_of_the_limit(tmp_path, capsys):
    source = tmp_path / "in.csv"
    words = source, "--units", "si", "--time-column", "time", "--time-unit", "s", "--no-poses"
    source.write_text(TABLE)
    assert len(imported(tmp_path, capsys, *words, "--limit", 2)[0]) == 2
    (tmp_path / "out.csv").unlink()
    source.write_text(TABLE + "0.02;0.5;-1.0;10.0;c\n")
    code, line = refused(tmp_path, capsys, *words, "--limit", 2)
    assert code == 4 and "more than 2 rows" in line


@pytest.mark.parametrize("change,words,code,line", [
    (("0.5;9.5", "x;9.5"), (), 4, 'line 2: acc_y is "x", expected a number'),
    (("0.5;9.5", "nan;9.5"), (), 4, 'line 2: acc_y is "nan", expected a finite number'),
    ((";a\n", "\n"), (), 4, "line 2: 4 values, expected 5"),
    (("acc_y", "b_y"), (), 4, "no column for ay, expected --map"),
    (("", ""), ("--map", "ax=nose"), 4, 'no column "nose"'),
    (("", ""), ("--map", "bx=acc_x"), 2, "expected one of ax"),
    (("", ""), ("--units", "furlong"), 2, "--units furlong"),
    (("", ""), ("--units", "counts"), 4, "its LSB must be given"),
    (("", ""), ("--units", "counts", "--accel-lsb", "256"), 4, "expected whole counts"),
    (("", ""), ("--accel-lsb", "100000"), 4, "expected at most 32767"),
    (("", ""), ("--label-column", "note"), 4, "no label is a pose, expected --label"),
    (("", ""), ("--label-column", "note", "--label", "a=Q"), 2, "expected a pose such as Z+a"),
    (("0.01;", "-1;"), (), 4, "line 3: time runs backwards"),
    (("0.01;", "inf;"), (), 4, "a finite number")])
def test_faults(tmp_path, capsys, change, words, code, line):
    source = tmp_path / "in.csv"
    source.write_text(TABLE.replace(*change) if change[0] else TABLE)
    given = ["--units", "g", "--time-column", "time", "--time-unit", "s", *words]
    found = refused(tmp_path, capsys, source, *given)
    assert found[0] == code and line in found[1]


def test_needs_a_rate(tmp_path, capsys):
    source = tmp_path / "in.csv"
    source.write_text(TABLE.replace("time", "number"))
    code, line = refused(tmp_path, capsys, source, "--units", "g")
    assert code == 2 and "--rate" in line


@pytest.mark.parametrize("content", ["[1]", "{", '{"z_p": {"start": 5, "end": 2}}',
                                     '{"z_p": {"start": 0, "end": 3}}', "\x00"])
def test_bad_sections(tmp_path, capsys, content):
    (tmp_path / "in.csv").write_text(TABLE)
    (tmp_path / "in.json").write_text(content)
    code, _ = refused(tmp_path, capsys, tmp_path / "in.csv", "--units", "g", "--rate", 100,
                      "--sections", tmp_path / "in.json")
    assert code == 4


def step_of(values):
    sizes = value_steps.Sizes()
    sizes.add(values)
    return sizes.step()


@pytest.mark.parametrize("digits", ["%.5g", "%.6g", "%.7g"])
@pytest.mark.parametrize("step", [9.80665 / 8192, 1 / 131, 9.80665 / 256, np.radians(1 / 65.5)])
def test_finds_a_step_behind_so_many_digits_of_each_value(step, digits):
    """Values of 10 m/s2 and more have a decimal less than the others: it was "no whole steps", and
    the counts that a file then gets were said to have a dead band."""
    counts = np.random.default_rng(1).normal(0.0, 2000.0, (3000, 3)).round() * [1, 1, 0.5]
    values = [float(digits % x) for x in np.ravel(counts.round() * step)]
    assert step_of(np.array(values)) == pytest.approx(step, rel=1e-4)


@pytest.mark.parametrize("step", [0.00479, 1 / 16384, 0.061, 3.9])
def test_finds_the_step_of_values(step):
    counts = np.random.default_rng(1).integers(-2000, 2000, (500, 3))
    assert step_of(counts * step) == pytest.approx(step, rel=1e-6)


@pytest.mark.parametrize("most", [90, 9000])
def test_finds_the_step_of_values_that_single_precision_was_calculated_in(most):
    """A flight controller's: no two of one count were alike, and there was no step."""
    rng, step = np.random.default_rng(1), np.float32(np.radians(500.0 / 32768.0))
    single = rng.integers(-most, most, (2000, 3)).astype(np.float32) * step
    seconds = rng.uniform(0.003, 0.005, (2000, 1)).astype(np.float32)
    single = (single * seconds + np.float32(0.01)) / seconds - np.float32(0.01) / seconds
    assert len(np.unique(single)) > len(np.unique(np.rint(single / step)))
    assert step_of(single.astype(float)) == pytest.approx(float(step), rel=1e-4)


def test_noise_has_no_step():
    noise = np.random.default_rng(1).normal(size=(500, 3))
    assert step_of(noise) is None
    assert step_of((0.03 * noise + [0.0, 0.0, 9.8]).astype(np.float32).astype(float)) is None


@pytest.mark.parametrize("value, words, line", [
    ("1e308", ("--units", "si"), "the accelerometer reaches 1e+308, expected less than 1e+09"),
    ("1e308", ("--units", "si", "--accel-lsb", "16384"), "the accelerometer reaches 1e+308"),
    ("-1e300", ("--accel-lsb", "1"), "the accelerometer reaches 1e+300")])
def test_values_of_no_sensor(tmp_path, capsys, value, words, line):
    (tmp_path / "in.csv").write_text("ax,ay,az\n1,2,3\n%s,0,0\n" % value)
    code, said = refused(tmp_path, capsys, tmp_path / "in.csv", "--rate", 100, *words)
    assert code == 4 and line in said


@pytest.mark.parametrize("step, line", [
    (0, "all 200 samples have the time 0 us, expected times that run"),
    (100, "its samples are 100 us apart, expected about 1e+04: rate_hz is 100"),
    (1000000, "its samples are 1e+06 us apart, expected about 1e+04")])
def test_times_that_no_rate_explains(tmp_path, capsys, step, line):
    (tmp_path / "in.csv").write_text("t,ax,ay,az\n" + "".join(
        "%d,0,0,%d\n" % (k * step, 256 + k % 2) for k in range(200)))
    given = [tmp_path / "in.csv", "--accel-lsb", 256, "--time-column", "t", "--time-unit", "us"]
    code, said = refused(tmp_path, capsys, *given, "--rate", 100)
    assert code == 4 and line in said
    path = tmp_path / "walk.csv"
    path.write_text("# sixflip-capture 1\n# " + json.dumps({
        "sensor": "adxl345", "rate_hz": 100, "accel_lsb_per_g": 256}) + "\nt_us,ax,ay,az\n"
        + (tmp_path / "in.csv").read_text().split("\n", 1)[1])
    for verb in ("show", "solve", "diagnose"):
        assert main([verb, str(path)]) == 4
        assert line in capsys.readouterr().err
