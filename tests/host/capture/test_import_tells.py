"""What import tells by itself from names and values, what it passes over, and what it refuses."""

import datetime

import numpy as np
import pytest

from sixflip_host.capture import capture_file, open_recording
from sixflip_host.capture.imports import column_names
from sixflip_host.cli import main

G = 9.80665
ROWS = 400
COUNTS = np.rint(np.random.default_rng(7).normal((100, -200, 16384), 40, (ROWS, 3)))
GYRO = np.rint(np.random.default_rng(8).normal((30, -50, 10), 9, (ROWS, 3)))
NAMES = "ax,ay,az,gx,gy,gz"
ENDS = ("--no-poses",)


def lines(values, form="%d"):
    return [",".join(form % value for value in row) for row in values]


def imported(tmp_path, capsys, text, *words, name="in.csv"):
    """(Capture, what was said) of a text."""
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), "-o", str(tmp_path / "out.csv"), *ENDS, *words]) == 0, \
        capsys.readouterr().err
    return capture_file.read(tmp_path / "out.csv", gyro_alone=True), capsys.readouterr().out


def refused(tmp_path, capsys, text, *words, code=4):
    path = tmp_path / "in.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert main(["import", str(path), "-o", str(tmp_path / "out.csv"), *ENDS, *words]) == code
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and not (tmp_path / "out.csv").exists()
    return said


def table(times, head="t", accel=COUNTS, gyro=None, form="%d"):
    """A CSV with a column of times and the accelerometer's, and perhaps the gyro's."""
    values = accel if gyro is None else np.c_[accel, gyro]
    names = NAMES if gyro is not None else "ax,ay,az"
    return "%s,%s\n" % (head, names) + "".join(
        "%s,%s\n" % pair for pair in zip(times, lines(values, form)))


SECONDS = np.arange(ROWS) / 100


def test_matlabs_writetable_has_the_months_name_in_its_times(tmp_path, capsys):
    texts = [table(["31-%s-2024 12:00:%06.3f" % (month, t) for t in SECONDS], "Timestamp")
             for month in ("Feb", "May")]
    assert "31-Feb-2024" in refused(tmp_path, capsys, texts[0], "--accel-lsb", "16384")
    capture, _ = imported(tmp_path, capsys, texts[1], "--accel-lsb", "16384")
    assert capture.t_us[-1] - capture.t_us[0] == pytest.approx(3_990_000, abs=1)


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


@pytest.mark.parametrize("head, times", [
    ("t", ["%.3f" % t for t in SECONDS]), ("time", ["%d" % round(1e3 * t) for t in SECONDS]),
    ("timestamp", ["%d" % round(1e6 * t) for t in SECONDS]),
    ("%time", ["%d" % (1.6e18 + 1e9 * t) for t in SECONDS]),
    ("timestamp_ms", ["%d" % round(1e3 * t) for t in SECONDS]),
    ("header.stamp", ["%.2f" % (1.6e9 + t) for t in SECONDS]),
    ("Time (s)", ["%.4e" % t for t in SECONDS]),
    ("micros", ["%d" % round(1e6 * t) for t in SECONDS])])
def test_times_by_name_and_value(tmp_path, capsys, head, times):
    capture, said = imported(tmp_path, capsys, table(times, head))
    assert capture.meta["rate_hz"] == pytest.approx(100, rel=1e-3)
    assert capture.meta["rate"] == "measured" and "times are in the column " + head in said
    assert np.abs(np.diff(capture.t_us) - 10000).max() < 2


def test_times_that_two_units_would_do_for_are_asked_for(tmp_path, capsys):
    said = refused(tmp_path, capsys, table([200 * k for k in range(ROWS)]))
    assert "expected --time-unit with one of us (5000 Hz), ms (5 Hz)" in said
    said = refused(tmp_path, capsys, table(range(ROWS)))
    assert "t counts by 1, which may be samples" in said


def test_the_rate_that_was_set_is_stated_and_not_measured(tmp_path, capsys):
    capture, _ = imported(tmp_path, capsys, table(["%.3f" % t for t in SECONDS]), "--rate", "99",
                          "--time-unit", "s")
    assert (capture.meta["rate_hz"], capture.meta["rate"]) == (99, "stated")


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


def test_values_without_steps_keep_their_means_and_get_no_step(tmp_path, capsys):
    values = np.random.default_rng(10).normal((0.1, 0.2, G), 1e-5, (ROWS, 3))
    values[7] = 900.0       # a knock sets the range that 16 bits have to hold
    text = table(["%.2f" % t for t in SECONDS], accel=values, form="%.17g")
    capture, said = imported(tmp_path, capsys, text)
    assert capture.meta["accel_values"] == "float" and "no whole steps" in said
    back = capture.accel[20:] / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back.mean(axis=0) - values[20:].mean(axis=0)).max() < 900 / 32000 / 300


def test_printed_decimals_are_no_steps_of_the_sensor(tmp_path, capsys):
    values = np.random.default_rng(11).normal((0, 0, G), 0.05, (ROWS, 3))
    capture, said = imported(tmp_path, capsys, table(
        ["%.2f" % t for t in SECONDS], accel=values, form="%.3f"))
    assert capture.meta["accel_values"] == "float" and "printed to 0.001 m/s2" in said
    back = capture.accel / capture.meta["accel_lsb_per_g"] * G
    assert np.abs(back - np.round(values, 3)).max() < 1e-6


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


def messy():
    rows = lines(np.c_[COUNTS, GYRO])
    body = ["0.%03d,%s" % (10 * k, row) for k, row in enumerate(rows[:60])]
    head = "t," + NAMES
    body.insert(20, head)
    body.insert(40, "# a comment, with a comma")
    return ("# logger 7\n#%s\n" % head + "\n".join(body)).encode().replace(b"0.100", b"0.1\x0000")


def test_what_means_nothing_is_passed_over_and_said(tmp_path, capsys):
    capture, said = imported(tmp_path, capsys, messy(), "--accel-lsb", "16384", "--gyro-lsb",
                             "131")
    assert len(capture) == 60 and (capture.accel == COUNTS[:60]).all()
    for words in ("column names once more (1", "comments (1", "NUL bytes", "missing newline"):
        assert words in said


def test_a_last_row_cut_short_is_left_out(tmp_path, capsys):
    text = table(["%.2f" % t for t in SECONDS]) + "4.00,10"
    capture, said = imported(tmp_path, capsys, text)
    assert len(capture) == ROWS and "passed over: a last row that is cut short (1 line)" in said


def test_quoted_cells_that_hold_the_delimiter(tmp_path, capsys):
    rows = ['"%.2f",%s,"up, left"' % pair for pair in zip(SECONDS, lines(COUNTS))]
    text = 't,ax,ay,az,"note, of the day"\n' + "\n".join(rows) + "\n"
    capture, _ = imported(tmp_path, capsys, text)
    assert (capture.accel == COUNTS).all()


def test_a_column_to_leave_out_may_come_first(tmp_path, capsys):
    text = "".join("x,%s\n" % row for row in lines(COUNTS))
    capture, _ = imported(tmp_path, capsys, text, "--columns", "-,ax,ay,az", "--rate", "100")
    assert (capture.accel == COUNTS).all()


def test_a_rate_that_stands_before_the_names(tmp_path, capsys):
    text = "Fs,104\nMode,2\nax,ay,az\n" + "\n".join(lines(COUNTS)) + "\n"
    capture, said = imported(tmp_path, capsys, text)
    assert (capture.meta["rate_hz"], capture.meta["rate"]) == (104, "stated")
    assert "104 Hz, as the file says" in said


def test_sort_says_what_it_moved(tmp_path, capsys):
    times = ["%.2f" % t for t in SECONDS]
    times[50], times[53] = times[53], times[50]
    assert "line 53: t runs backwards" in refused(tmp_path, capsys, table(times))
    _, said = imported(tmp_path, capsys, table(times), "--sort")
    assert "3 rows moved to put t in order, the farthest by 3 rows" in said


@pytest.mark.parametrize("row", [0, 200, ROWS - 1])
def test_a_stamp_that_stretches_the_log_is_refused(tmp_path, capsys, row):
    times = ["%.2f" % t for t in SECONDS]
    times[row] = "86400.00" if row else "-86400.00"
    said = refused(tmp_path, capsys, table(times), "--sort", "--time-unit", "s")
    assert "in.csv line %d: t is" % (row + 2) in said and "which stretches 3.9" in said


def test_acceleration_without_gravity_asks_for_its_unit(tmp_path, capsys):
    values = np.random.default_rng(12).normal(0, 0.05, (ROWS, 3))
    text = table(["%.2f" % t for t in SECONDS], accel=values, form="%.9f")
    assert "gravity has been taken out" in refused(tmp_path, capsys, text)
    found = open_recording.read(tmp_path / "in.csv", gravity=False)
    assert "m/s2: gravity does not tell" in " ".join(found.assumed)


@pytest.mark.parametrize("text, words, line", [
    ("t,ax,ay,az\n0,1,2\n", (), 'line 2: 3 values, expected 4'),
    ("t,ax,ay,az\n0,1,2,\n", (), "line 2: az is missing, expected a number"),
    ("t,ax,ay,az\n", (), "no rows behind the column names"),
    ("1 2 3\n4 5 6\n", ("--rate", "9"), "no column names in it, expected --columns"),
    ("t,ax,ay\n0,1,2\n", (), "no column for az, expected --map az=NAME"),
    (b"t,ax,ay,az\n0,\x81,2,3\n", (), "line 2: bytes that are neither UTF-8"),
    ("t,ax,ay,az\n0,5,5,5\n0,5,5,5\n", (), "t stands still")])
def test_bad_files_are_refused_with_their_line(tmp_path, capsys, text, words, line):
    assert line in refused(tmp_path, capsys, text, *words)


def clock(t, form):
    """The time t seconds behind 23:59:58.5 on the last of February, in a form."""
    day = datetime.datetime(2024, 2, 29, 23, 59, 58, 500000) + datetime.timedelta(seconds=t)
    return day.strftime(form)


@pytest.mark.parametrize("head, form", [
    ("timestamp", "%Y-%m-%dT%H:%M:%S.%f"), ("time", "%Y-%m-%d %H:%M:%S.%fZ"),
    ("datetime", "%Y-%m-%dT%H:%M:%S.%f+05:30"), ("timestamp", '"%Y-%m-%d %H:%M:%S,%f"')])
def test_dates_and_times_of_day_are_times(tmp_path, capsys, head, form):
    capture, said = imported(tmp_path, capsys, table([clock(t, form) for t in SECONDS], head))
    assert "dates and times of day in the column %s" % head in said
    assert capture.meta["rate_hz"] == pytest.approx(100.0, rel=1e-6)
    assert capture.t_us[-1] == 10_000 * (ROWS - 1)


def test_times_of_day_alone_and_a_date_beside_them(tmp_path, capsys):
    times = ["2024-05-31,%s" % clock(t - 9e3, "%H:%M:%S.%f") for t in SECONDS]
    capture, _ = imported(tmp_path, capsys, table(times, "date,time"))
    assert capture.t_us[-1] == 10_000 * (ROWS - 1)


@pytest.mark.parametrize("times, line", [
    (["05/06/2024 10:00:0%d.%d" % divmod(k, 10) for k in range(50)], "day and month"),
    (["2024-02-30T10:00:0%d.%d" % divmod(k, 10) for k in range(50)], "expected a number")])
def test_dates_that_say_nothing_sure_are_refused(tmp_path, capsys, times, line):
    assert line in refused(tmp_path, capsys, table(times, "t"), "--time-column", "t")


def test_latin_1_and_utf_16_are_read_and_said(tmp_path, capsys):
    text = "# Beschleunigung in °, µ\n" + table(["%.2f" % t for t in SECONDS])
    for encoding, words in (("latin-1", "Latin-1"), ("utf-16", "UTF-16")):
        capture, said = imported(tmp_path, capsys, text.encode(encoding))
        assert (capture.accel == COUNTS).all() and words in said
    assert "Latin-1" not in imported(tmp_path, capsys, text)[1]


@pytest.mark.parametrize("name, sensor, axis, unit", [
    ("field.linear_acceleration.x", "a", "x", ""), ("gyro_rad[2]", "g", "2", "rad/s"),
    ("accelerometer_m_s2[0]", "a", "0", "m/s2"), ("AccX", "a", "x", ""),
    ("Acceleration x (m/s^2)", "a", "x", "m/s2"), ("accSmooth[1]", "a", "1", ""),
    ("w_RS_S_z [rad s^-1]", "g", "z", "rad/s"), ("gyro_y_dps", "g", "y", "dps"),
    ("accelReadings_3", "a", "3", ""), ("mag_z", "m", "z", ""), ("ang_vel_x", "g", "x", "")])
def test_a_columns_name(name, sensor, axis, unit):
    assert column_names.column(name)[:3] == (sensor, axis, unit)


@pytest.mark.parametrize("name", [
    "field.orientation.x", "linear_acceleration_covariance[0]", "accel_mag", "pos_x", "loop_us",
    "motionUserAccelerationX(G)", "axisP[0]", "debug[0]", "status", "max"])
def test_a_name_that_is_no_reading(name):
    assert column_names.column(name) is None


def of_day(k):
    return "12:00:%02d.%03d -> " % divmod(10 * k, 1000)


@pytest.mark.parametrize("label,between", [
    ("%s:%d", ","), ("%s=%d", " "), ("%s: %d", "\t"), ('"%s": %d', ", ")])
def test_values_with_their_names_before_them_as_a_plotter_wants_them(
        tmp_path, capsys, label, between):
    rows = [between.join(label % pair for pair in zip(NAMES.split(","), (*a, *w)))
            for a, w in zip(COUNTS, GYRO)]
    capture, said = imported(tmp_path, capsys, "MPU6050 found\n" + "\n".join(rows) + "\n",
                             "--rate", "100", "--gyro-lsb", "131")
    assert (capture.accel == COUNTS).all() and (capture.gyro == GYRO).all()
    assert "each value has its name before it" in said


@pytest.mark.parametrize("form", ["%s -> ", "[%s] "])
@pytest.mark.parametrize("head", ["", NAMES])
def test_the_time_of_day_of_a_serial_monitor_is_the_time(tmp_path, capsys, head, form):
    rows = lines(np.hstack([COUNTS, GYRO]))
    rows = [form % of_day(k)[:12] + one for k, one in enumerate([head] * bool(head) + rows)]
    capture, said = imported(tmp_path, capsys, "\n".join(rows) + "\n",
                             "--gyro-lsb", "131", *(() if head else ("--columns", NAMES)))
    assert (capture.accel == COUNTS).all()
    assert capture.meta["rate_hz"] == pytest.approx(100.0)
    assert "each line begins with the time of day" in said


def test_the_boards_own_time_is_better_than_when_its_line_came(tmp_path, capsys):
    rows = [of_day(k // 50 * 50) + "t_ms:%d ax:%d ay:%d az:%d" % (20 * k, *a)
            for k, a in enumerate(COUNTS)]
    capture, _ = imported(tmp_path, capsys, "\n".join(rows) + "\n")
    assert capture.meta["rate_hz"] == pytest.approx(50.0)


def test_a_line_of_labels_that_is_not_like_the_others_is_refused(tmp_path, capsys):
    rows = ["ax:%d,ay:%d,az:%d" % tuple(a) for a in COUNTS]
    rows[300] = "ax:5,az:7"
    said = refused(tmp_path, capsys, "\n".join(rows), "--rate", "100")
    assert "in.csv line 301: 2 values, expected 3" in said


def test_a_time_that_is_none_is_refused_with_what_was_expected(tmp_path, capsys):
    rows = ["12h%03d,%s" % (k, one) for k, one in enumerate(lines(COUNTS))]
    said = refused(tmp_path, capsys, "time,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert "the column time begins with \"12h000\", expected a number or ISO 8601" in said


WARMING = 0.01 * np.arange(ROWS)


@pytest.mark.parametrize("name,values", [
    ("temp_F", 77.0 + 1.8 * WARMING), ("Temperature (°F)", 77.0 + 1.8 * WARMING),
    ("temperature_K", 298.15 + WARMING), ("temp_c", 25.0 + WARMING)])
def test_a_temperature_in_the_unit_that_its_name_says(tmp_path, capsys, name, values):
    rows = ["%d,%s,%.3f" % (10 * k, *one) for k, one in enumerate(zip(lines(COUNTS), values))]
    capture, _ = imported(tmp_path, capsys, "t_ms,ax,ay,az,%s\n" % name + "\n".join(rows) + "\n")
    celsius = capture.temp / capture.meta["temp_lsb_per_c"] + capture.meta["temp_offset_c"]
    assert celsius == pytest.approx(25.0 + WARMING, abs=0.02)


@pytest.mark.parametrize("name,size,step", [
    ("micros", 2 ** 32, 10_000), ("millis", 2 ** 32, 10), ("t_ms", 2 ** 16, 10),
    ("utc_ns", 10 ** 9, 10_000_000)])
@pytest.mark.parametrize("sort", [(), ("--sort",)])
def test_a_clock_that_begins_anew_goes_on(tmp_path, capsys, name, size, step, sort):
    rows = ["%d,%s" % ((size + (k - 150) * step) % size, one)
            for k, one in enumerate(lines(COUNTS))]
    capture, said = imported(tmp_path, capsys, name + ",ax,ay,az\n" + "\n".join(rows) + "\n",
                             *sort)
    assert (np.diff(capture.t_us) == 10_000).all() and (capture.accel == COUNTS).all()
    assert "%s begins anew at %.10g, first in line" % (name, size) in said


def test_a_counter_with_a_sign_begins_anew_below_0(tmp_path, capsys):
    rows = ["%d,%s" % ((2 ** 31 + (k - 150) * 10_000 + 2 ** 31) % 2 ** 32 - 2 ** 31, one)
            for k, one in enumerate(lines(COUNTS))]
    capture, _ = imported(tmp_path, capsys, "micros,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert (np.diff(capture.t_us) == 10_000).all()


@pytest.mark.parametrize("name,seconds", [("time (min)", 60.0), ("time_h", 3600.0)])
def test_minutes_and_hours_by_their_name(tmp_path, capsys, name, seconds):
    rows = ["%.9f,%s" % (0.01 * k / seconds, one) for k, one in enumerate(lines(COUNTS))]
    capture, _ = imported(tmp_path, capsys, name + ",ax,ay,az\n" + "\n".join(rows) + "\n")
    assert capture.meta["rate_hz"] == pytest.approx(100.0, rel=1e-3)


def test_an_axis_alone_is_of_the_sensor_whose_unit_it_has():
    names = ["Time[s]", "x[mg]", "y[mg]", "z[mg]", "gx[mdps]", "gy[mdps]", "gz[mdps]"]
    found, units, _ = column_names.readings(names)
    assert [found[key] for key in ("ax", "ay", "az", "gz")] == [*names[1:4], "gz[mdps]"]
    assert units == {"a": "mg", "g": "mdps"}
    assert column_names.column("x-axis (g)")[:3] == ("a", "x", "g")


def test_a_log_goes_on_over_midnight(tmp_path, capsys):
    day = ["%02d:%02d:%05.2f" % (23 if k < 200 else 0, 59 if k < 200 else 0,
                                 58.0 + k / 100 if k < 200 else k / 100 - 2.0)
           for k in range(ROWS)]
    capture, _ = imported(tmp_path, capsys, "time,ax,ay,az\n" + "\n".join(
        "%s,%s" % pair for pair in zip(day, lines(COUNTS))) + "\n")
    assert np.diff(capture.t_us) == pytest.approx(10_000, abs=1)


def test_a_board_that_began_again_is_no_clock_that_does(tmp_path, capsys):
    rows = ["%d,%s" % (10 * (k % 200) + 5000, one) for k, one in enumerate(lines(COUNTS))]
    said = refused(tmp_path, capsys, "t_ms,ax,ay,az\n" + "\n".join(rows) + "\n")
    assert "line 202: t_ms runs backwards, from 6990 to 5000" in said


def test_units_in_the_line_below_the_names(tmp_path, capsys):
    rows = ["%.1f\t%.5f\t%.5f\t%.5f" % (1.7e12 + 10 * k, *one)
            for k, one in enumerate(COUNTS / 16384.0 * G)]
    capture, _ = imported(tmp_path, capsys, "Time_CAL\tAccel_X_CAL\tAccel_Y_CAL\tAccel_Z_CAL\n"
                          "ms\tm/(s^2)\tm/(s^2)\tm/(s^2)\n" + "\n".join(rows) + "\n")
    assert capture.meta["rate_hz"] == pytest.approx(100.0)
    assert capture.accel.mean(axis=0) / capture.meta["accel_lsb_per_g"] == pytest.approx(
        COUNTS.mean(axis=0) / 16384.0, abs=1e-5)


def test_names_behind_a_comment_with_another_delimiter(tmp_path, capsys):
    rows = ["%d\t%s" % (10 * k, one.replace(",", "\t")) for k, one in enumerate(lines(COUNTS))]
    text = "// Update Rate: 100.0Hz\nt_ms\tAcc_X\tAcc_Y\tAcc_Z\n" + "\n".join(rows) + "\n"
    assert (imported(tmp_path, capsys, text)[0].accel == COUNTS).all()


def test_times_that_fit_the_stated_rate_in_no_unit_are_refused(tmp_path, capsys):
    """Ticks of 100 µs, as one maker's stamps are, are a tenth of that rate in ms."""
    rows = ["%d,%s" % (100 * k, one) for k, one in enumerate(lines(COUNTS))]
    text = "// Update Rate: 100.0Hz\nSampleTimeFine,Acc_X,Acc_Y,Acc_Z\n" + "\n".join(rows) + "\n"
    said = refused(tmp_path, capsys, text)
    assert "SampleTimeFine taken as ms: 10 Hz, but the file says 100 Hz" in said
    capture, _ = imported(tmp_path, capsys, text, "--rate", "100")
    assert capture.meta["rate_hz"] == 100.0
