"""The text of an imported table: what is passed over, read all the same, or refused."""

import numpy as np
import pytest

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


@pytest.mark.parametrize("rows", [ROWS, 60 * ROWS])
def test_quoted_cells_with_an_end_of_a_line_in_them(tmp_path, capsys, rows):
    """A device's own line, kept whole behind the readings; a fault has the file's own line."""
    read = lines(COUNTS)
    body = ['%.2f,%s,"$IMU,%d\r\n"' % (k / 100, read[k % ROWS], k) for k in range(rows)]
    text = "t,ax,ay,az,raw\r\n" + "\r\n".join(body) + "\r\n"
    capture, _ = imported(tmp_path, capsys, text)
    assert len(capture) == rows and (capture.accel[:ROWS] == COUNTS).all()
    (tmp_path / "out.csv").unlink()
    assert "line 8:" in refused(tmp_path, capsys, text.replace("0.03,", "0.03,x", 1))


def test_a_quote_that_nothing_closes_is_a_letter(tmp_path, capsys):
    rows = ['%.2f,%s,5" pipe' % pair for pair in zip(SECONDS, lines(COUNTS))]
    rows[3] = rows[3].replace('5" pipe', '"5 pipe')
    capture, _ = imported(tmp_path, capsys, "t,ax,ay,az,note\n" + "\n".join(rows) + "\n")
    assert (capture.accel == COUNTS).all()


def test_a_column_to_leave_out_may_come_first(tmp_path, capsys):
    text = "".join("x,%s\n" % row for row in lines(COUNTS))
    capture, _ = imported(tmp_path, capsys, text, "--columns", "-,ax,ay,az", "--rate", "100")
    assert (capture.accel == COUNTS).all()


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


def test_latin_1_and_utf_16_are_read_and_said(tmp_path, capsys):
    text = "# Beschleunigung in °, µ\n" + table(["%.2f" % t for t in SECONDS])
    for encoding, words in (("latin-1", "Latin-1"), ("utf-16", "UTF-16")):
        capture, said = imported(tmp_path, capsys, text.encode(encoding))
        assert (capture.accel == COUNTS).all() and words in said
    assert "Latin-1" not in imported(tmp_path, capsys, text)[1]


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


@pytest.mark.parametrize("greeting", [
    "GPIO initialized.\ni2c bus opened with handle 0.\nDevice with address a0 found\n",
    "\nMPU6050, ready\n\n", "Calibrating: 1 2 3\nOffsets 12 -7 5\nDone!\n"])
@pytest.mark.parametrize("between", [",", ", ", ";", "\t", " "])
def test_what_a_board_says_when_it_starts_is_no_row(tmp_path, capsys, greeting, between):
    rows = [one.replace(",", between) for one in lines(np.c_[COUNTS, GYRO])]
    capture, said = imported(tmp_path, capsys, greeting + "\n".join(rows) + "\n", "--rate", "100",
                             "--gyro-lsb", "131", "--columns", NAMES)
    assert (capture.accel == COUNTS).all() and (capture.gyro == GYRO).all()
    assert "passed over: lines before the first row" in said


def test_a_comma_with_blanks_behind_it_is_the_delimiter(tmp_path, capsys):
    """Behind an empty line, and with more blanks in a row than commas."""
    rows = ["\n315964.%05d, 3,  %s ,  0.0\n  " % (1000 * k, one.replace(",", ",  "))
            for k, one in enumerate(lines(COUNTS[:60] / 16384 * G, "%.3f"))]
    capture, _ = imported(tmp_path, capsys, "\n".join(rows) + "\n", "--columns",
                          "t,-,ax,ay,az,-")
    assert len(capture) == 60 and capture.meta["rate_hz"] == pytest.approx(100.0)


def test_names_that_nobody_knows_behind_a_greeting(tmp_path, capsys):
    text = "logger 7\nt,p,q,r\n" + "".join(
        "%.2f,%s\n" % pair for pair in zip(SECONDS, lines(COUNTS)))
    assert "with one of t p q r" in refused(tmp_path, capsys, text)
    capture, _ = imported(tmp_path, capsys, text, "--map", "ax=p,ay=q,az=r")
    assert (capture.accel == COUNTS).all()


@pytest.mark.parametrize("above, names", [
    ("t,p,q,r\ns,m/s2,m/s2,m/s2\n", "t [s] p [m/s2] q [m/s2] r [m/s2]"),
    ("a,log,of,mine\nt,p,q,r\n", "t p q r")])
def test_names_that_nobody_knows_stand_above_their_units(tmp_path, capsys, above, names):
    rows = ["%.2f,%s" % one for one in zip(SECONDS, lines(COUNTS / 16384 * G, "%.6f"))]
    said = refused(tmp_path, capsys, above + "\n".join(rows) + "\n", "--map", "ax=b,ay=q,az=r")
    assert said.rstrip().endswith("expected one of " + names)


def test_a_step_that_is_a_chips_does_not_put_gravity_back(tmp_path, capsys):
    """A step of 1/256 is an ADXL345's in g, and one of m/s2 from which gravity was taken."""
    free = np.rint(np.random.default_rng(1).normal(0.0, 0.3, (ROWS, 3)) * 256)
    free[100:300] += np.rint(512 * np.sin(np.arange(200) / 9.0))[:, None]
    said = refused(tmp_path, capsys, table(["%.2f" % t for t in SECONDS], "t", free / 256,
                                           form="%.8f"))
    assert "gravity has been taken out of it" in said


def test_a_time_that_is_no_number_is_said_and_not_passed_over(tmp_path, capsys):
    """Arrivals were taken instead, without a word."""
    rows = ["%s,%.3f,%s" % ("nan" if k == 70 else "%d" % (10 * k), 1e-2 * k + 0.002 * (k % 3), one)
            for k, one in enumerate(lines(COUNTS))]
    said = refused(tmp_path, capsys, "t_ms,host_time,ax,ay,az\n" + "\n".join(rows) + "\n",
                   "--accel-lsb", "16384")
    assert "t_ms" in said or "72" in said
