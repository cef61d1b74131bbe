"""Forms in which other programs keep a log: read where that is plain, else refused in one line
that says what was expected."""

import struct
import zipfile
from functools import reduce

import numpy as np
import pytest

from sixflip_host.capture import capture_file
from sixflip_host.cli import main
from tests.worlds.imported_text import COUNTS, GYRO, SECONDS, G, imported, lines, refused

FORCE, RATES = COUNTS / 16384, np.radians(GYRO / 16.4)
ROWS = ["%.2f,%s" % row for row in zip(SECONDS, lines(np.hstack([FORCE, GYRO / 16.4]), "%.6f"))]
NAMES = "t,ax [g],ay [g],az [g],gx [dps],gy [dps],gz [dps]"


def _of_file(tmp_path, capsys, name):
    """(exit code, what was said on stderr) of the import of a file in tmp_path."""
    code = main(["import", str(tmp_path / name), "-o", str(tmp_path / "out.csv"), "--no-poses"])
    return code, capsys.readouterr().err


def _has_them(capture):
    accel = capture.accel / capture.meta["accel_lsb_per_g"]
    gyro = capture.gyro / capture.meta["gyro_lsb_per_dps"]
    assert accel.mean(axis=0) == pytest.approx(FORCE.mean(axis=0), abs=1e-3)
    assert gyro.mean(axis=0) == pytest.approx((GYRO / 16.4).mean(axis=0), abs=1e-2)


@pytest.mark.parametrize("head, end, words", [
    (NAMES, ",", ()), (NAMES + ",", "", ()), (NAMES + ",", ",", ()),
    (None, ",", ("--columns", "t,ax,ay,az,gx,gy,gz", "--units", "g,dps"))])
def test_a_delimiter_at_the_end_of_each_row(tmp_path, capsys, head, end, words):
    text = "\n".join(([head] if head else []) + [row + end for row in ROWS]) + "\n"
    _has_them(imported(tmp_path, capsys, text, *words)[0])


def test_a_row_of_another_width_is_refused_still(tmp_path, capsys):
    text = "\n".join([NAMES, *[row + "," for row in ROWS[:50]], ROWS[50] + ",1,2"]) + "\n"
    assert "line 52: 9 values, expected 8" in refused(tmp_path, capsys, text)


def test_the_checksum_of_a_sentence_is_no_part_of_its_last_number(tmp_path, capsys):
    rows = ["VNACC,%s" % row for row in ROWS]
    text = "".join("$%s*%02X\r\n" % (row, reduce(lambda a, b: a ^ b, row.encode()))
                   for row in rows)
    capture, said = imported(tmp_path, capsys, text, "--columns", "-,t,ax,ay,az,gx,gy,gz",
                             "--units", "g,dps")
    _has_them(capture)
    assert "passed over: a checksum at the end (%d lines)" % len(rows) in said


def test_rows_of_another_sensor_in_between_are_passed_over(tmp_path, capsys):
    """A recorder of channels writes a row for each packet, with blanks for those of others."""
    text = NAMES + ",pitch,roll\n" + "".join(
        "%s,,\n%.3f,,,,,,,1.25,-0.5\n" % (row, t + 0.004) for row, t in zip(ROWS, SECONDS))
    capture, said = imported(tmp_path, capsys, text)
    _has_them(capture)
    assert len(capture) == len(ROWS)
    assert "passed over: rows without a reading (%d lines)" % len(ROWS) in said


def test_accelerometer_and_gyro_in_turn_are_refused_with_what_to_do(tmp_path, capsys):
    text = NAMES + "\n" + "".join("%.2f,0,0,1,,,\n%.3f,,,,0.1,0.2,0.3\n" % (t, t + 0.004)
                                  for t in SECONDS)
    assert "gx [dps] is missing, expected a number in each row, or a file for each sensor" in \
        refused(tmp_path, capsys, text)


def test_a_spreadsheet_says_that_it_is_one(tmp_path, capsys):
    with zipfile.ZipFile(tmp_path / "log.xlsx", "w") as file:
        file.writestr("[Content_Types].xml", "<Types/>")
        file.writestr("xl/workbook.xml", "<workbook/>")
    code, said = _of_file(tmp_path, capsys, "log.xlsx")
    assert code == 4 and said.count("\n") == 1
    assert "a spreadsheet, expected one of its sheets saved as CSV" in said


def test_the_fields_of_a_structure_are_read(tmp_path, capsys):
    """NaveGo keeps an IMU as a structure with t, fb and wb."""
    from scipy.io import savemat
    savemat(tmp_path / "imu.mat", {"imu1": {
        "t": SECONDS[:, None], "fb": FORCE * G, "wb": RATES, "name": "an IMU",
        "ini": {"align": [0.0, 0.0, 1.0]}}})
    code, said = _of_file(tmp_path, capsys, "imu.mat")
    assert code == 0, said
    _has_them(capture_file.read(tmp_path / "out.csv"))


def _element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


def test_a_timetable_says_how_to_write_it(tmp_path, capsys):
    """MATLAB keeps its numbers in a part of the file that no manual describes."""
    opaque = _element(14, _element(6, struct.pack("<II", 17, 0)) + _element(1, b"Acceleration")
                      + _element(1, b"MCOS") + _element(1, b"timetable") + _element(
                          14, _element(6, struct.pack("<II", 13, 0)) + _element(
                              5, struct.pack("<ii", 6, 1)) + _element(1, b"")
                          + _element(6, struct.pack("<6I", 0xDD000000, 2, 1, 1, 1, 1))))
    own = _element(14, _element(6, struct.pack("<II", 9, 0)) + _element(
        5, struct.pack("<ii", 1, 400)) + _element(1, b"") + _element(2, bytes(400)))
    (tmp_path / "phone.mat").write_bytes(
        b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + opaque + own)
    code, said = _of_file(tmp_path, capsys, "phone.mat")
    assert code == 4 and said.count("\n") == 1
    assert "timetable" in said and "writetimetable(NAME, 'FILE.csv')" in said
