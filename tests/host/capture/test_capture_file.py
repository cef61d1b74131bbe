"""The capture format to the letter: round trips, and every fault with its line."""

import gzip
import os
import stat

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.capture.capture_file import Capture
from sixflip_host.capture.capture_rows import _fast, _slow
from sixflip_host.errors import BadFile

HEADER = ('{"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384, '
          '"gyro_lsb_per_dps": 65.5, "temp_lsb_per_c": 340, "temp_offset_c": 36.53%s}')
COLUMNS = "t_us,ax,ay,az,gx,gy,gz,temp,pose"
ROWS = ["0,-526,-518,15500,-76,8,87,-3731,Z+a", "10000,-511,-513,15400,-81,4,89,-3730,Z+a",
        "20000,1,2,3,4,5,6,7,", "30000,-32768,32767,0,0,0,0,0,L2000"]


def text(rows=ROWS, first="# sixflip-capture 1", header=None, columns=COLUMNS, end="\n"):
    header = "# " + HEADER % "" if header is None else header
    return ("\n".join([first, header, columns, *rows]) + end).encode()


def fault(data):
    """The one line a faulty file is refused with."""
    with pytest.raises(BadFile) as caught:
        capture_file.parse("walk.csv", data)
    assert caught.value.exit_code == 4
    assert "\n" not in str(caught.value)
    return str(caught.value)


def row(number, **change):
    """The rows, one of them (from 0) with other values."""
    rows = list(ROWS)
    fields = dict(zip(COLUMNS.split(","), rows[number].split(",")))
    fields.update(change)
    rows[number] = ",".join(fields.values())
    return text(rows)


def test_reads_what_is_there():
    capture = capture_file.parse("walk.csv", text())
    assert capture.t_us.tolist() == [0, 10000, 20000, 30000]
    assert capture.accel[3].tolist() == [-32768, 32767, 0]
    assert capture.temp.tolist() == [-3731, -3730, 7, 0]
    assert capture.pose.tolist() == [1, 1, 0, 2012]
    assert capture.g == 9.80665


def test_crlf_column_order_and_missing_columns():
    data = (b"# sixflip-capture 1\r\n"
            b'# {"sensor": "adxl345", "rate_hz": 50, "accel_lsb_per_g": 256}\r\n'
            b"az,t_us,ax,ay\r\n5,7,1,2\r\n6,8,3,4\r\n")
    capture = capture_file.parse("walk.csv", data)
    assert capture.accel.tolist() == [[1, 2, 5], [3, 4, 6]]
    assert capture.gyro is capture.temp is capture.mag is capture.pose is None


def test_sums_of_a_placement_are_exact():
    first = capture_file.parse("walk.csv", text()).placements()[0]
    assert (first.pose, first.first, first.n) == (1, 0, 2)
    assert first.sums == [-1037, -1031, 30900, -157, 12, 176, -7461]


def test_a_pose_that_comes_back_is_another_placement():
    rows = ["%d,0,0,100,0,0,0,0,%s" % (1000 * i, pose)
            for i, pose in enumerate(["Z+a", "Z+a", "", "X+a", "Z+a"])]
    assert [one.pose for one in capture_file.parse("x", text(rows)).placements()] == [1, 5, 1]


@pytest.mark.parametrize("change,line,words", [
    ({"ay": "1.5"}, 5, 'ay is "1.5", expected a whole number'),
    ({"ay": "NaN"}, 5, 'ay is "NaN"'), ({"gx": ""}, 5, "gx is missing"),
    ({"az": "32768"}, 5, "expected -32768 to 32767"), ({"ax": "1e3"}, 5, 'ax is "1e3"'),
    ({"az": "-32769"}, 5, "expected -32768 to 32767"), ({"temp": "--1"}, 5, 'temp is "--1"'),
    ({"t_us": "-1"}, 5, "runs backwards, from 0 to -1"),
    ({"t_us": "9" * 18}, 6, "runs backwards"), ({"t_us": "9" * 19}, 5, "t_us is"),
    ({"pose": "Q+a"}, 5, 'unknown pose "Q+a"'), ({"pose": "L0"}, 5, 'unknown pose "L0"'),
    ({"pose": "Z+a,"}, 5, "10 values, expected 9"), ({"gz": "٣"}, 5, 'gz is "٣"')])
def test_faults_in_a_row(change, line, words):
    found = fault(row(1, **change))
    assert found.startswith("walk.csv line %d: " % line) and words in found


@pytest.mark.parametrize("data,words", [
    (b"", "line 1: the file is empty"), (b"\x00\xff\xfe" * 50, "line 1: not a sixflip capture"),
    (b"PK\x03\x04", "line 1: not a sixflip capture"),
    (text(first="# sixflip-capture 2"), 'line 1: capture format version "2", expected 1'),
    (text()[:25], "line 2: "), (text(header="{}"), "line 2: no # at the start"),
    (text(header="# [1]"), "line 2: JSON, but not an object"),
    (text(header="# {"), "line 2: "), (text(header="# {\"a\": NaN}"), "line 2: NaN"),
    (text(header="# " + HEADER % ', "sensor": "gy85"'), 'line 2: the key "sensor" stands there'),
    (text(header='# {"sensor": "mpu6050"}'), 'line 2: the key "rate_hz" is missing'),
    (text(header="# " + HEADER.replace("100", "0") % ""), "line 2: rate_hz is"),
    (text(header="# " + HEADER.replace("mpu6050", "bno") % ""), 'line 2: sensor is'),
    (text(header="# " + HEADER % ', "g": 12'), "line 2: g is 12 m/s², expected 9.7 to 9.9"),
    (text(header="# " + HEADER % ', "accel_range_g": 16'), "at ±16 g, expected 2048"),
    (text(header="# " + HEADER % ', "gyro_range_dps": 2000'), "expected 16.4"),
    (text(header="# " + HEADER.replace("mpu6050", "adxl345") % ""), "it has no gyro"),
    (text(header="# " + HEADER.replace("mpu6050", "gy85") % ""), "16384 counts per g, expected"),
    (text(header="# " + HEADER.replace('"gyro_lsb_per_dps": 65.5, ', "") % ""),
     'line 2: the key "gyro_lsb_per_dps" is missing'),
    (text(columns=COLUMNS.replace("ax", "axe")), 'line 3: unknown column "axe"'),
    (text(columns=COLUMNS.replace("gy", "gx")), "line 3: column gx stands there twice"),
    (text(columns=COLUMNS.replace(",gy", "")), "line 3: column gy is missing"),
    (text(columns=COLUMNS.replace("t_us,", "")), "line 3: column t_us is missing"),
    (text([]), "line 4: no rows"), (text(end=""), "line 7: the last line has no newline"),
    (text(ROWS[:2] + ["20000,1,2"]), "line 6: 3 values, expected 9"),
    (text(ROWS + [""]), "line 8: 0 values"), (text(["0,1,2,3,4,5,6,7,\xff"]), "line 4: "),
    (text(header="# " + HEADER % ', "samples": 5'), "line 7: the file was cut short after 4"),
    (text(header="# " + HEADER % ', "samples": 3'), "line 7: the file goes on after 4 rows"),
    (text(header="# " + HEADER % ', "samples": 5', end="\n40000,1"), "cut short in its row 5")])
def test_faults_of_the_file(data, words):
    assert words in fault(data)


@pytest.mark.parametrize("cut", [1, 8, 20, 60])
def test_gzip_cut_short(tmp_path, cut):
    path = tmp_path / "walk.csv.gz"
    path.write_bytes(gzip.compress(text())[:-cut])
    with pytest.raises(BadFile, match="walk.csv.gz line [0-9]+: the gzip file was cut short"):
        capture_file.read(path)


def test_gzip_damaged(tmp_path):
    data = bytearray(gzip.compress(text()))
    data[-6] ^= 1       # its CRC
    (tmp_path / "walk.csv.gz").write_bytes(data)
    with pytest.raises(BadFile, match="damaged"):
        capture_file.read(tmp_path / "walk.csv.gz")


def test_folder_missing_file_and_no_permission(tmp_path):
    with pytest.raises(BadFile, match="Is a directory"):
        capture_file.read(tmp_path)
    with pytest.raises(BadFile, match="No such file"):
        capture_file.read(tmp_path / "nothing.csv")
    locked = tmp_path / "locked.csv"
    locked.write_bytes(text())
    locked.chmod(0)
    if os.access(locked, os.R_OK):      # root reads everything
        assert len(capture_file.read(locked)) == 4
    else:
        with pytest.raises(BadFile, match="Permission denied"):
            capture_file.read(locked)
    locked.chmod(stat.S_IRUSR)


counts = st.integers(-32768, 32767)


@st.composite
def captures(draw):
    n = draw(st.integers(1, 40))
    meta = {"sensor": draw(st.sampled_from(["mpu6050", "other"])), "rate_hz": 100,
            "accel_lsb_per_g": 256.5, "gyro_lsb_per_dps": 65.5, "temp_lsb_per_c": 340,
            "temp_offset_c": 36.53, "mag_lsb_per_ut": 3.0,
            "kept": draw(st.recursive(st.none() | st.booleans() | st.text() | st.floats(
                allow_nan=False, allow_infinity=False), st.lists, max_leaves=4))}
    steps = draw(st.lists(st.sampled_from([0, 1, 9999, 10000, 70000, 5 * 10 ** 9]),
                          min_size=n, max_size=n))

    def block(width):
        return np.array(draw(st.lists(counts, min_size=n * width, max_size=n * width)),
                        np.int16).reshape(n, width)
    poses = draw(st.lists(st.sampled_from([0, 0, 1, 2, 12, 13, 2012]), min_size=n, max_size=n))
    have = draw(st.tuples(*[st.booleans()] * 4))
    return Capture(meta, np.cumsum(np.array(steps, np.int64)), block(3),
                   block(3) if have[0] else None, block(1)[:, 0] if have[1] else None,
                   block(3) if have[2] else None, np.array(poses, np.int16) if have[3] else None)


def assert_same(a, b):
    for name in ("t_us", "accel", "gyro", "temp", "mag", "pose"):
        one, other = getattr(a, name), getattr(b, name)
        assert (one is None) == (other is None), name
        assert one is None or (one.dtype == other.dtype and (one == other).all()), name


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(captures())
def test_text_and_binary_lose_nothing(capture):
    written = capture_file.text(capture)
    again = capture_file.parse("x", written)
    assert_same(capture, again)
    assert again.meta == capture.meta
    from_board = capture_binary.decode(capture_binary.encode(again))
    assert_same(capture, from_board)
    assert capture_file.text(from_board) == written


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(captures())
def test_the_fast_way_and_the_slow_way_agree(capture):
    columns = capture.columns()
    body = capture_file.text(capture).split(b"\n", 3)[3]
    fast, slow = _fast(body, columns), _slow("x", body, columns, 4)
    for name in columns:
        assert fast[name].dtype == slow[name].dtype
        assert (fast[name] == slow[name]).all()


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=200), st.integers(0, 300))
def test_garbage_ends_in_one_line(garbage, place):
    data = bytearray(text())
    data[place:place + len(garbage)] = garbage
    for bad in (garbage, bytes(data)):
        try:
            capture_file.parse("walk.csv", bad)
        except BadFile as error:
            assert "expected" in str(error)


def test_writing_is_the_same_every_time_and_leaves_nothing_behind(tmp_path):
    capture = capture_file.parse("x", text())
    for name in ("a.csv", "b.csv.gz"):
        capture_file.write(tmp_path / name, capture)
        first = (tmp_path / name).read_bytes()
        capture_file.write(tmp_path / name, capture)
        assert (tmp_path / name).read_bytes() == first
    assert sorted(os.listdir(tmp_path)) == ["a.csv", "b.csv.gz"]
    with pytest.raises(BadFile):
        capture_file.write(tmp_path, capture)
    with pytest.raises(BadFile, match="cannot be written"):
        capture_file.write(tmp_path / "none" / "a.csv", capture)


def test_a_board_file_cut_anywhere_reads_up_to_the_last_whole_block():
    capture = capture_file.parse("x", text())
    capture.t_us = np.array([0, 1, 200000, 200001], np.int64)     # a gap starts another block
    data = capture_binary.encode(capture)
    lengths = set()
    for end in range(len(data)):
        try:
            part = capture_binary.decode(data[:end])
        except BadFile:
            continue
        assert part.truncated
        assert (part.accel == capture.accel[:len(part)]).all()
        lengths.add(len(part))
    assert lengths == {2, 4}
