"""What import tells by itself from names and values: sensors, units, steps, temperatures."""

import numpy as np
import pytest

from sixflip_host.capture import capture_file, open_recording
from sixflip_host.capture.imports import column_names
from sixflip_host.cli import main
from sixflip_host.diagnosis import samples_judged
from sixflip_host.experiment import blocks
from tests.worlds.imported_text import (
    COUNTS,
    GYRO,
    NAMES,
    ROWS,
    SECONDS,
    G,
    imported,
    lines,
    refused,
    table,
)


@pytest.mark.parametrize("name, sensor, unit", [
    ("gyr_x_mdps", column_names.GYRO, "mdps"), ("ax_g", column_names.ACCEL, "g"),
    ("acc_x_ms2", column_names.ACCEL, "m/s2"), ("ax_m_s2", column_names.ACCEL, "m/s2"),
    ("w_x_deg_s", column_names.GYRO, "dps"), ("gx_dps", column_names.GYRO, "dps"),
    ("gyro_g_x", column_names.GYRO, ""), ("gx", column_names.GYRO, "")])
def test_a_unit_among_the_words_of_a_name(name, sensor, unit):
    found = column_names.column(name)
    assert (found.sensor, found.axis, found.unit) == (sensor, "x", unit)


def test_a_rest_is_found_in_decimals_whose_counts_are_finer_than_their_noise(tmp_path):
    """Scaled to 16 bits by the largest rate there is, noise alone spans a thousand counts."""
    noise = np.random.default_rng(3).standard_normal((3000, 6))
    values = np.array([0, 0, G, 0.01, -0.005, 0.002]) + noise * ([0.02] * 3 + [0.001] * 3)
    (tmp_path / "in.csv").write_text(table(["%.2f" % (k / 100) for k in range(3000)],
                                           accel=values[:, :3], gyro=values[:, 3:], form="%.9f"))
    assert main(["import", str(tmp_path / "in.csv"), "-o", str(tmp_path / "out.csv")]) == 0
    capture = capture_file.read(tmp_path / "out.csv")
    assert capture.meta["gyro_values"] == "float"
    assert (capture.pose > 0).sum() > 2500


@pytest.mark.parametrize("scale, unit, form", [
    (1 / 16384, "g", "%.9g"), (G / 16384, "m/s2", "%.9g"), (1000 / 16384, "mg", "%.9g"),
    (1, "counts", "%d")])
def test_units_are_told_from_gravity_at_rest(tmp_path, capsys, scale, unit, form):
    text = table(["%.2f" % t for t in SECONDS], accel=COUNTS * scale, form=form)
    capture, said = imported(tmp_path, capsys, text)
    assert "the accelerometer is in %s: |a| is" % unit in said
    assert (capture.accel == COUNTS).all()
    assert capture.meta["accel_lsb_per_g"] == pytest.approx(16384, rel=1e-6)
    assert "accel_values" not in capture.meta


@pytest.mark.parametrize("words, looks", [
    (("--units", "g"), "--units g makes |a| at rest 9.8"), (("--units", "mg"), "makes |a|"),
    (("--units", "g", "--accel-lsb", "1000"), "expected --units m/s2")])
def test_a_unit_that_gravity_contradicts_is_refused(tmp_path, capsys, words, looks):
    text = table(["%.2f" % t for t in SECONDS], accel=COUNTS / 16384 * G, form="%.9g")
    assert looks in refused(tmp_path, capsys, text, *words)


def test_an_lsb_that_gravity_contradicts_is_refused(tmp_path, capsys):
    said = refused(tmp_path, capsys, table(["%.2f" % t for t in SECONDS]), "--accel-lsb", "2048")
    assert "--accel-lsb 2048 makes |a| at rest 8" in said and "--accel-lsb 16384" in said


def turning(per_dps):
    """1,000 rows that turn by 90° about x, accelerometer in m/s², gyro in some unit."""
    t = np.arange(1000) / 100
    angle = np.clip(t - 2, 0, 5) * np.radians(18)
    rate = np.degrees(np.gradient(angle, t))
    noise = np.random.default_rng(9).normal(size=(1000, 6))
    accel = G * np.c_[0 * t, np.sin(angle), np.cos(angle)] + 0.02 * noise[:, :3]
    gyro = (np.c_[rate, 0 * t, 0 * t] + 0.1 * noise[:, 3:]) * per_dps
    return table(["%.2f" % x for x in t], accel=accel, gyro=gyro, form="%.9f")


def test_the_gyros_unit_is_told_from_how_gravity_turns(tmp_path, capsys):
    capture, said = imported(tmp_path, capsys, turning(1.0))
    assert "the gyro is in dps: so it turns as gravity does" in said
    turned = (capture.gyro[:, 0] / capture.meta["gyro_lsb_per_dps"]).sum() / 100
    assert turned == pytest.approx(90, abs=1)
    _, said = imported(tmp_path, capsys, turning(np.pi / 180))
    assert "the gyro is in rad/s, as goes with m/s2" in said
    (tmp_path / "out.csv").unlink()
    assert "expected --units ,dps" in refused(tmp_path, capsys, turning(1.0), "--units", "si")


@pytest.mark.parametrize("unit, per_dps", [("dps", 1.0), ("rad/s", np.pi / 180)])
@pytest.mark.parametrize("size", [250 / 32768, 500 / 32768, 1 / 131, 1 / 16.4, 0.07])
def test_a_chips_step_tells_the_gyros_unit(tmp_path, capsys, unit, per_dps, size):
    """In m/s² or in g beside it: at rest nothing else tells."""
    for accel, others in ((G, "m/s2"), (1.0, "g")):
        values = np.c_[COUNTS / 16384 * accel, GYRO * size * per_dps]
        rows = ["%.2f,%s" % pair for pair in zip(SECONDS, lines(values, "%.9g"))]
        capture, said = imported(tmp_path, capsys, "t,%s\n" % NAMES + "\n".join(rows) + "\n")
        assert "the accelerometer is in %s: |a|" % others in said
        assert "the gyro is in %s: its step of" % unit in said
        assert capture.meta["gyro_lsb_per_dps"] == pytest.approx(1 / size, rel=1e-4)


def test_a_chips_step_tells_an_accelerometer_whose_scale_is_off(tmp_path, capsys):
    text = table(["%.2f" % t for t in SECONDS], accel=1.4 * COUNTS / 16384 * G, form="%.9g")
    assert "no gravity in g, m/s2" in refused(tmp_path, capsys, text)
    counts = np.rint(1.4 * COUNTS)
    text = table(["%.2f" % t for t in SECONDS], accel=counts / 16384 * 9.81, form="%.9g")
    capture, said = imported(tmp_path, capsys, text)
    assert "the accelerometer is in m/s2: its step of 0.000598755 is a chip's" in said
    assert (capture.accel == counts).all()


WHOLE = np.c_[np.rint(COUNTS / 16.384), np.rint(2.0 * GYRO)]    # mg, and counts below 100


@pytest.mark.parametrize("words", [(), ("--units", "mg")])
def test_whole_numbers_of_many_sizes_are_counts_of_a_gyro(tmp_path, capsys, words):
    text = "%s\n%s\n" % (NAMES, "\n".join(lines(WHOLE)))
    words = "--rate", "100", *words
    said = refused(tmp_path, capsys, text, *words)
    assert "the gyro is in counts, so its LSB must be given (--gyro-lsb, counts per deg/s)" in said
    said = refused(tmp_path, capsys, text, *words, "--sensor", "mpu6050")
    assert "131 or 65.5 or 32.8 or 16.4 of a mpu6050" in said


def test_a_chip_with_one_range_tells_the_scale_of_its_counts(tmp_path, capsys):
    text = "%s\n%s\n" % (NAMES, "\n".join(lines(np.c_[np.rint(COUNTS / 64), GYRO])))
    capture, said = imported(tmp_path, capsys, text, "--rate", "100", "--sensor", "gy85")
    assert "the gyro has 14.375 counts per deg/s, as a gy85" in said
    assert (capture.gyro == GYRO).all() and capture.meta["gyro_lsb_per_dps"] == 14.375


def test_a_gyro_alone_without_a_unit_says_that_no_accelerometer_was_recognised(tmp_path, capsys):
    values = np.random.default_rng(17).normal(0, 0.1, (ROWS, 6))
    rows = "\n".join("%.2f,%s" % pair for pair in zip(SECONDS, lines(values, "%.9f")))
    said = refused(tmp_path, capsys, "t,tx,ty,tz,wx,wy,wz\n%s\n" % rows)
    assert "no accelerometer was recognised" in said and "--map ax=NAME" in said


@pytest.mark.parametrize("scale, words, said", [
    (1.49, ("--units", "si"), "gravity is 1.49 g in the rests"), (1.1, ("--units", "si"), ""),
    (0.7, ("--units", "si"), "gravity is 0.7 g in the rests"),
    (1.49, (), "gravity is 1.49 g in the rests")])
def test_rests_that_read_far_from_1_g_are_said(tmp_path, capsys, scale, words, said):
    text = table(["%.2f" % t for t in SECONDS], form="%.9g",
                 accel=np.rint(scale * COUNTS) / 16384 * G)
    found = imported(tmp_path, capsys, text, *words)[1]
    assert said in found and ("gravity is" in found) == bool(said)


FACES = [5, 5, 5, 5, 5, 4, 0, 5, 5, 1, 3, 5, 5, 2, 3, 5, 5, 1, 4, 5]


@pytest.mark.parametrize("scale, offset, faces, said", [
    (1.0, 0.48, FACES, "it has an offset of 0.00, 0.00, 0.48 g, about which gravity is 1"),
    (1.34, 0.02, FACES, "g, about which gravity is 1.34 g; its scale is off"),
    (1.34, 0.0, FACES, "file: its scale is off, or its unit"),
    (1.0, 0.34, [5, 5], "file: its scale or its offset is off, or its unit")])
def test_gravity_that_differs_from_face_to_face_is_an_offset(tmp_path, capsys, scale, offset,
                                                            faces, said):
    """Most of the time on the face whose offset adds to gravity."""
    face = np.r_[-np.eye(3), np.eye(3)][np.repeat(faces, 120)]
    noise = np.random.default_rng(23).normal(0, 0.003, face.shape)
    text = table(["%.2f" % (k / 100) for k in range(len(face))], form="%.9g",
                 accel=(scale * face + [0.0, 0.0, offset] + noise) * G)
    assert said in imported(tmp_path, capsys, text, "--units", "si", "--no-poses")[1]


def test_the_lowest_count_of_all_is_a_whole_step(tmp_path, capsys):
    gyro = GYRO.copy()
    gyro[5, 0] = -32768
    capture, _ = imported(tmp_path, capsys, table(
        ["%.2f" % t for t in SECONDS], accel=COUNTS / 16384, gyro=gyro / 131, form="%.6f"))
    assert "gyro_values" not in capture.meta and (capture.gyro == gyro).all()


def test_values_without_steps_keep_their_means_and_get_no_step(tmp_path, capsys):
    values = np.random.default_rng(10).normal((0.1, 0.2, G), 1e-5, (ROWS, 3))
    values[7] = 900.0       # a knock sets the range that 16 bits have to hold
    text = table(["%.2f" % t for t in SECONDS], accel=values, form="%.17g")
    capture, said = imported(tmp_path, capsys, text)
    assert capture.meta["accel_values"] == "float" and "no whole steps" in said
    back = capture.accel[20:] / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back.mean(axis=0) - values[20:].mean(axis=0)).max() < 900 / 32000 / 300


@pytest.mark.parametrize("times", [2, 3])
def test_values_that_repeat_become_counts_that_repeat(tmp_path, capsys, times):
    """A log that is read twice as fast as its sensor measures says so once it is imported."""
    generator = np.random.default_rng(13)
    values = generator.normal((0.1, 0.2, G), 0.05, (ROWS, 3)).repeat(times, axis=0)
    text = table(["%.3f" % (k / 200) for k in range(times * ROWS)], accel=values, form="%.9g")
    capture, said = imported(tmp_path, capsys, text, "--units", "si")
    assert "kept as floats" in said and "m/s2" in said and "SI units" not in said
    assert (capture.accel[::times] == capture.accel[times - 1::times]).all()
    back = capture.accel.mean(axis=0) / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back - values.mean(axis=0)).max() < values.max() / 32000 / 50


def test_a_value_that_stays_keeps_its_mean(tmp_path, capsys):
    values = np.tile((0.1234567, -0.7654321, G), (20 * ROWS, 1))
    values[:ROWS] += np.random.default_rng(14).normal(0, 0.1, (ROWS, 3))
    text = table(["%.2f" % (k / 100) for k in range(20 * ROWS)], accel=values, form="%.9g")
    capture, _ = imported(tmp_path, capsys, text)
    back = capture.accel[ROWS:].mean(axis=0) / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back - values[-1]).max() < G / 32000 / 50
    assert ((np.diff(capture.accel[ROWS:], axis=0) != 0).sum(axis=0) < 20 * ROWS / 50).all()


def test_printed_decimals_are_no_steps_of_the_sensor(tmp_path, capsys):
    values = np.random.default_rng(11).normal((0, 0, G), 0.05, (ROWS, 3))
    capture, said = imported(tmp_path, capsys, table(
        ["%.2f" % t for t in SECONDS], accel=values, form="%.3f"))
    assert capture.meta["accel_values"] == "float" and "printed to 0.001 m/s2" in said
    back = capture.accel / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back - np.round(values, 3)).max() < 1e-6


@pytest.mark.parametrize("step, form, told", [
    (G / 1024, "%.3f", 1024), (G / 2048, "%.3f", 2048), (0.0177, "%.2f", None)])
def test_steps_that_decimals_hide(tmp_path, capsys, step, form, told):
    """A log at rest, whose steps are ten of its last decimals, was cut into 75 rests where one of
    a quiet axis' steps was a shake; five tell one as well, and two none."""
    rng = np.random.default_rng(14)
    level = rng.normal([0.1, -3.1, 9.3], [0.3 * step, 2.0 * step, 1.5 * step], (4 * ROWS, 3))
    level[ROWS:ROWS + 60] += np.linspace(0.0, 1.0, 60)[:, None] * step * 25
    text = table(["%.2f" % (k / 100) for k in range(len(level))],
                 accel=step * np.rint(level / step), form=form)
    capture, said = imported(tmp_path, capsys, text)
    if told:
        assert "whole steps of 1/%d" % told in said
        assert capture.meta["accel_lsb_per_g"] == pytest.approx(told, rel=1e-4)
    else:
        assert "whole steps" not in said and capture.meta["accel_values"] == "float"


def test_a_gyro_alone_and_an_accelerometer_alone(tmp_path, capsys):
    rows = zip(["%.2f" % t for t in SECONDS], lines(GYRO / 131 * np.pi / 180, "%.9g"))
    text = "t,wx [rad/s],wy [rad/s],wz [rad/s]\n" + "".join("%s,%s\n" % pair for pair in rows)
    capture, _ = imported(tmp_path, capsys, text)
    assert capture.accel is None and (capture.gyro == GYRO).all()
    assert main(["show", str(tmp_path / "out.csv")]) == 0
    assert main(["solve", str(tmp_path / "out.csv")]) == 4
    assert "holds a gyro alone, expected ax ay az" in capsys.readouterr().err
    assert main(["diagnose", str(tmp_path / "in.csv")]) == 0
    capture, _ = imported(tmp_path, capsys, table(["%.2f" % t for t in SECONDS]))
    assert capture.gyro is None


def test_a_temperature_in_degrees_for_any_sensor(tmp_path, capsys):
    text = "t,ax,ay,az,Temperature\n" + "".join(
        "%.2f,%s,%.2f\n" % (t, row, 20 + t) for t, row in zip(SECONDS, lines(COUNTS)))
    capture, said = imported(tmp_path, capsys, text)
    celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
    assert np.abs(celsius - 20 - SECONDS).max() < 0.006 and "Temperature is in °C" in said


def test_one_value_on_the_rail_is_clipped_and_said(tmp_path, capsys):
    accel = COUNTS.copy()
    accel[5, 2] = 32768
    capture, said = imported(tmp_path, capsys, table(["%.2f" % t for t in SECONDS], accel=accel))
    assert capture.accel[5, 2] == 32767 and "1 value of the accelerometer at 32768" in said
    capture, said = imported(tmp_path, capsys, table(
        ["%.2f" % t for t in SECONDS], accel=accel / 16384, form="%.9g"), "--units", "g",
        "--accel-lsb", "16384")
    assert capture.accel[5, 2] == 32767 and "1 value of the accelerometer at 32768" in said


def test_a_capture_needs_no_import(tmp_path, capsys):
    imported(tmp_path, capsys, table(["%.2f" % t for t in SECONDS]))
    assert main(["import", str(tmp_path / "out.csv"), "-o", str(tmp_path / "again.csv")]) == 4
    assert "is a capture already" in capsys.readouterr().err


@pytest.mark.parametrize("encode, words", [
    (lambda counts: counts % 65536, "two's complement"),
    (lambda counts: counts + 32768, "offset")])
def test_counts_without_a_sign(tmp_path, capsys, encode, words):
    capture, said = imported(tmp_path, capsys, table(
        ["%.2f" % t for t in SECONDS], accel=encode(COUNTS)), "--accel-lsb", "16384", "--units",
        "counts")
    assert (capture.accel == COUNTS).all() and words in said


@pytest.mark.parametrize("name, sensor, axis, unit", [
    ("field.linear_acceleration.x", "a", "x", ""), ("gyro_rad[2]", "g", "2", "rad/s"),
    ("accelerometer_m_s2[0]", "a", "0", "m/s2"), ("AccX", "a", "x", ""),
    ("Acceleration x (m/s^2)", "a", "x", "m/s2"), ("accSmooth[1]", "a", "1", ""),
    ("w_RS_S_z [rad s^-1]", "g", "z", "rad/s"), ("gyro_y_dps", "g", "y", "dps"),
    ("accelReadings_3", "a", "3", ""), ("mag_z", "m", "z", ""), ("ang_vel_x", "g", "x", "")])
def test_a_columns_name(name, sensor, axis, unit):
    assert column_names.column(name)[:3] == (sensor, axis, unit)


@pytest.mark.parametrize("name", [
    "field.orientation.x", "linear_acceleration_covariance[0]", "linear_acceleration_covariance2",
    "accel_mag", "pos_x", "loop_us",
    "motionUserAccelerationX(G)", "axisP[0]", "debug[0]", "status", "max"])
def test_a_name_that_is_no_reading(name):
    assert column_names.column(name) is None


WARMING = 0.01 * np.arange(ROWS)


@pytest.mark.parametrize("name,values", [
    ("temp_F", 77.0 + 1.8 * WARMING), ("Temperature (°F)", 77.0 + 1.8 * WARMING),
    ("temperature_K", 298.15 + WARMING), ("temp_c", 25.0 + WARMING)])
def test_a_temperature_in_the_unit_that_its_name_says(tmp_path, capsys, name, values):
    rows = ["%d,%s,%.3f" % (10 * k, *one) for k, one in enumerate(zip(lines(COUNTS), values))]
    capture, _ = imported(tmp_path, capsys, "t_ms,ax,ay,az,%s\n" % name + "\n".join(rows) + "\n")
    celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
    assert celsius == pytest.approx(25.0 + WARMING, abs=0.02)


def test_an_axis_alone_is_of_the_sensor_whose_unit_it_has():
    names = ["Time[s]", "x[mg]", "y[mg]", "z[mg]", "gx[mdps]", "gy[mdps]", "gz[mdps]"]
    found, units, _ = column_names.readings(names)
    assert [found[key] for key in ("ax", "ay", "az", "gz")] == [*names[1:4], "gz[mdps]"]
    assert units == {"a": "mg", "g": "mdps"}
    assert column_names.column("x-axis (g)")[:3] == ("a", "x", "g")


@pytest.mark.parametrize("names", [("p", "q", "r"), ("P", "Q", "R")])
def test_p_q_r_are_the_rates_of_roll_pitch_and_yaw(tmp_path, capsys, names):
    rates = np.random.default_rng(12).normal(0.02, 0.004, (ROWS, 3))
    rows = "\n".join("%.2f,%s" % pair for pair in zip(SECONDS, lines(
        np.c_[COUNTS / 16384 * G, rates], "%.9f")))
    capture, said = imported(tmp_path, capsys, "t,Ax,Ay,Az,%s\n%s\n" % (",".join(names), rows))
    assert "columns %s are taken as the gyro's: the rates of roll" % " ".join(names) in said
    assert "the gyro is in rad/s, as goes with m/s2" in said
    read = np.radians(capture.gyro / capture.meta["gyro_lsb_per_dps"])
    assert np.abs(read.mean(axis=0) - rates.mean(axis=0)).max() < 1e-3
    other = "t,Ax,Ay,Az,p,q,s\n" + rows + "\n"
    (tmp_path / "out.csv").unlink()
    assert imported(tmp_path, capsys, other)[0].gyro is None


@pytest.mark.parametrize("scale, unit", [(1.0, "g"), (9.80665, "m/s2")])
@pytest.mark.parametrize("named", [False, True])
def test_free_flight_is_not_taken_for_gravity(tmp_path, capsys, scale, unit, named):
    """A rocket lies on its pad, burns, coasts and comes down under a parachute: while it coasts
    it is stiller than on the pad."""
    rng = np.random.default_rng(5)
    pad = rng.normal([0.1, 0.0, 1.0], 0.008, (1000, 3))
    burn = rng.normal([0.5, 0.0, 9.0], 1.0, (300, 3))
    coast = rng.normal([0.1, 0.0, 0.1], 0.002, (1100, 3))
    chute = rng.normal([0.0, 0.0, 1.0], 0.5, (2000, 3))
    accel = scale * np.vstack([pad, burn, coast, chute])
    text = table(np.arange(len(accel)) / 100, accel=accel, form="%.7f")
    capture, said = imported(tmp_path, capsys, text, *(["--units", unit + ","] if named else []))
    size = np.linalg.norm(capture.accel[:1000].mean(axis=0)) / capture.meta["accel_lsb_per_g"]
    assert abs(size - 1.0) < 0.02
    assert named or "the accelerometer is in %s: |a| is" % unit in said


@pytest.mark.parametrize("names, scale, units, unit", [
    ("#time,accel_x,accel_y,accel_z", 9806.65, [], "mm/s2"),       # as Klipper writes it
    ("#time,accel_x,accel_y,accel_z", 9806.65, ["--units", "mm/s2"], None),
    ("t,acce_x,acce_y,acce_z", 9.80665, [], "m/s2"),               # as RIDI and RoNIN do
    ("t,x (in G's),y (in G's),z (in G's)", 1.0, [], None)])        # as MetaWear's app does
def test_columns_as_loggers_of_accelerometers_name_them(tmp_path, capsys, names, scale, units,
                                                        unit):
    accel = np.random.default_rng(6).normal([0.02, 0.0, 1.0], 0.003, (1000, 3))
    text = table(np.arange(1000) / 100, accel=scale * accel, form="%.6f")
    text = "\n".join([names, *text.splitlines()[1:]]) + "\n"
    capture, said = imported(tmp_path, capsys, text, *units)
    size = np.linalg.norm(capture.accel.mean(axis=0)) / capture.meta["accel_lsb_per_g"]
    assert size == pytest.approx(np.linalg.norm(accel.mean(axis=0)), abs=1e-3)
    assert unit is None or "the accelerometer is in %s: |a| is" % unit in said


def test_a_chips_steps_that_an_offset_was_taken_off_are_no_coarser_ones(tmp_path, capsys):
    """Of 1/16.384 deg/s, less an offset of so many 64ths of one on each axis."""
    rng = np.random.default_rng(7)
    steps = np.rint(rng.normal([30.0, -12.0, 5.0], 40.0, (6000, 3)))
    gyro = (steps - np.array([20, 44, 21]) / 64) / 16.384
    accel = rng.normal([0.0, 0.0, 1.0], 0.01, (6000, 3))
    capture, said = imported(tmp_path, capsys, table(
        ["%.2f" % (k / 100) for k in range(6000)], accel=accel, gyro=gyro, form="%.9f"),
        "--units", "g,dps")
    assert "its own step is 1/16.384 deg/s, and an offset was taken off" in said
    mean = capture.gyro.mean(axis=0) / capture.meta["gyro_lsb_per_dps"]
    assert mean == pytest.approx(gyro.mean(axis=0), abs=1e-6)
    session = blocks.session_of("out.csv", open_recording.read_samples(tmp_path / "out.csv"))
    found = [f for found_by in samples_judged.FOUND_BY[:2] for f in found_by([session])]
    assert [f.effect for f in found if f.effect == "quantisation"] == []
    del session.capture.meta["gyro_own_step"]
    assert "quantisation" in {f.effect for f in samples_judged.FOUND_BY[1]([session])}
