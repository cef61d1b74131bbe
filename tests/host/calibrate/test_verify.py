"""verify: an honest board passes, one wrong number does not."""

import json
import struct
from binascii import crc32

import pytest

from sixflip.record import correction_record
from sixflip_host.cli import main
from tests.worlds.board_session import leave_files, unlabelled


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    """(folder, Record) of an honest board."""
    folder = tmp_path_factory.mktemp("board")
    return folder, leave_files(folder, unlabelled())


def verify(folder, capsys):
    """Exit code and the checks that failed."""
    code = main(["verify", "--json", str(folder)])
    answer = json.loads(capsys.readouterr().out)
    assert answer["ok"] == (code == 0)
    return code, [check["name"] for check in answer["checks"] if not check["ok"]]


def spoil(pulled, tmp_path, change):
    """A copy of the folder in which change(record) was applied and the CRC is right."""
    folder, _ = pulled
    record = correction_record.decode((folder / "record_a.bin").read_bytes())
    change(record)
    (tmp_path / "capture.bin").write_bytes((folder / "capture.bin").read_bytes())
    (tmp_path / "record_a.bin").write_bytes(correction_record.encode(record))
    return tmp_path


def test_honest_board(pulled, capsys):
    assert verify(pulled[0], capsys) == (0, [])


def test_words_of_an_honest_board(pulled, capsys):
    assert main(["verify", str(pulled[0])]) == 0
    assert "the board's arithmetic is right" in capsys.readouterr().out


@pytest.mark.parametrize("row", range(4))
@pytest.mark.parametrize("column", range(3))
@pytest.mark.parametrize("bits,change", [(64, 3e-9), (32, 2e-5)])
def test_one_changed_number_is_caught(pulled, tmp_path, capsys, row, column, bits, change):
    def one(record):
        record.float_bits = bits
        size = abs(record.accel["P"][row][column]) if bits == 64 else 1 + 8.80665 * (row == 3)
        record.accel["P"][row][column] += change * size
    code, names = verify(spoil(pulled, tmp_path, one), capsys)
    assert code == 1
    assert "P[%d][%d]" % (row, column) in names


def test_a_single_precision_board_may_be_off_by_less(pulled, tmp_path, capsys):
    def all_numbers(record):
        record.float_bits = 32
        P = record.accel["P"]
        record.accel["P"] = [list(struct.unpack("<4f", struct.pack("<4f", *row))) for row in P]
    assert verify(spoil(pulled, tmp_path, all_numbers), capsys) == (0, [])


@pytest.mark.parametrize("axis", range(3))
def test_a_changed_gyro_bias_is_caught(pulled, tmp_path, capsys, axis):
    def bias(record):
        record.gyro_bias["bias_dps"][axis] += 1e-6
    code, names = verify(spoil(pulled, tmp_path, bias), capsys)
    assert (code, names) == (1, ["gyro bias %s, deg/s" % "xyz"[axis]])


@pytest.mark.parametrize("key,value,name", [
    ("tilt_deg", 1.5, "table tilt, deg"), ("tilt_spread_deg", 0.5, "its spread, deg"),
    ("residual_rms_g", 0.0, "residual, g rms"), ("noise_g", 0.01, "noise, g"),
    ("verdict", "doubtful", "verdict")])
def test_a_changed_diagnosis_is_caught(pulled, tmp_path, capsys, key, value, name):
    code, names = verify(spoil(pulled, tmp_path, lambda r: r.accel.update({key: value})), capsys)
    assert (code, names) == (1, [name])


def test_a_changed_sigma_is_caught(pulled, tmp_path, capsys):
    def sigma(record):
        record.accel["sigma_P"][1][2] *= 1.01
    assert verify(spoil(pulled, tmp_path, sigma), capsys) == (1, ["sigma P[1][2]"])


def test_record_of_another_session(pulled, tmp_path, capsys):
    def other(record):
        record.session = 7
    assert verify(spoil(pulled, tmp_path, other), capsys) == (1, ["session"])


def test_changed_sums_are_caught(pulled, tmp_path, capsys):
    folder, record = pulled
    data = bytearray((folder / "capture.bin").read_bytes())
    place = _first_pose_block(data)
    # sums follow type, length (4 bytes), pose u16, first u32, n u32, duration u64
    (ax,) = struct.unpack_from("<q", data, place + 4 + 18)
    struct.pack_into("<q", data, place + 4 + 18, ax + 1)
    (length,) = struct.unpack_from("<H", data, place + 2)
    struct.pack_into("<I", data, place + 4 + length, crc32(bytes(data[place:place + 4 + length])))
    (tmp_path / "capture.bin").write_bytes(data)
    (tmp_path / "record_a.bin").write_bytes(correction_record.encode(record))
    code, names = verify(tmp_path, capsys)
    assert code == 1
    assert "Z+a sums" in names


def _first_pose_block(data):
    """Offset of the first block of type POSE (2)."""
    at = 8 + struct.unpack_from("<H", data, 6)[0] + 4
    while data[at] != 2:
        at += 4 + struct.unpack_from("<H", data, at + 2)[0] + 4
    return at


def test_sums_only_vouches_for_the_solve_alone(tmp_path, capsys):
    leave_files(tmp_path, unlabelled(), sums_only=True)
    assert main(["verify", str(tmp_path)]) == 0
    assert "vouches for the solve alone" in capsys.readouterr().out


def test_both_slots_damaged(pulled, tmp_path, capsys):
    data = bytearray((pulled[0] / "record_a.bin").read_bytes())
    data[40] ^= 1
    for name in ("record_a.bin", "record_b.bin"):
        (tmp_path / name).write_bytes(data)
    (tmp_path / "capture.bin").write_bytes((pulled[0] / "capture.bin").read_bytes())
    assert main(["verify", str(tmp_path)]) == 4
    error = capsys.readouterr().err
    assert error.count("CRC") == 2 and error.count("\n") == 1


def test_the_record_of_the_capture_is_taken_not_the_newest(pulled, tmp_path, capsys):
    folder, _ = pulled
    spoil(pulled, tmp_path, lambda record: None)
    later = correction_record.decode((folder / "record_a.bin").read_bytes())
    later.session, later.sequence = 9, 2
    (tmp_path / "record_b.bin").write_bytes(correction_record.encode(later))
    assert verify(tmp_path, capsys) == (0, [])
