"""verify on the gyro's section: an honest board passes, one changed number does not."""

import json
import struct

import numpy as np
import pytest

from sixflip.record import correction_record
from sixflip_host.calibrate import reference_gyro
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.cli import main
from tests.worlds.board_session import leave_files, unlabelled

SESSION = dict(seed=4, wobble_deg=0.5)


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    """(folder, Record with a gyro) of an honest board."""
    folder = tmp_path_factory.mktemp("board")
    return folder, leave_files(folder, unlabelled(**SESSION))


def verify(folder, capsys):
    """Exit code and the checks that failed."""
    code = main(["verify", "--json", str(folder)])
    answer = json.loads(capsys.readouterr().out)
    return code, [check["name"] for check in answer["checks"] if not check["ok"]]


def spoil(pulled, tmp_path, change):
    """A copy of the folder in which change(record) was applied and the CRC is right."""
    record = correction_record.decode((pulled[0] / "record_a.bin").read_bytes())
    change(record)
    (tmp_path / "capture.bin").write_bytes((pulled[0] / "capture.bin").read_bytes())
    (tmp_path / "record_a.bin").write_bytes(correction_record.encode(record))
    return tmp_path


def test_honest_board(pulled, capsys):
    assert verify(pulled[0], capsys) == (0, [])
    assert main(["verify", str(pulled[0])]) == 0
    assert "the board's arithmetic is right" in capsys.readouterr().out


def test_the_reference_finds_the_sensor(pulled):
    """Not only the same as the board: right."""
    from tests.worlds.hand_session import Sensor
    capture = capture_binary.decode((pulled[0] / "capture.bin").read_bytes())
    host = reference_gyro.solve(capture, capture.board_placements, pulled[1].accel["P"])
    sensor = Sensor(SESSION["seed"])
    assert host.P[:3].T @ sensor.Kw == pytest.approx(np.eye(3), abs=0.004)
    bias = -np.linalg.solve(host.P[:3].T, host.P[3])
    assert np.degrees(bias) == pytest.approx(sensor.bw, abs=0.01)
    assert len(host.used) == 6 and host.missing == []


@pytest.mark.parametrize("row", range(4))
@pytest.mark.parametrize("column", range(3))
@pytest.mark.parametrize("bits", [64, 32])
def test_one_changed_number_is_caught(pulled, tmp_path, capsys, row, column, bits):
    def one(record):
        record.float_bits = bits
        x = record.gyro["P"][row][column]
        record.gyro["P"][row][column] = x * (1 + 3e-9) + 2e-12 if bits == 64 else x + 2e-5
    assert verify(spoil(pulled, tmp_path, one), capsys) == (1, ["gyro P[%d][%d]" % (row, column)])


def test_a_single_precision_board_may_be_off_by_less(pulled, tmp_path, capsys):
    def single(record):
        record.float_bits = 32
        for section in (record.accel, record.gyro):
            section["P"] = [[struct.unpack("<f", struct.pack("<f", x))[0] for x in row]
                            for row in section["P"]]
    assert verify(spoil(pulled, tmp_path, single), capsys) == (0, [])


@pytest.mark.parametrize("row", range(4))
@pytest.mark.parametrize("column", range(3))
def test_a_changed_sigma_is_caught(pulled, tmp_path, capsys, row, column):
    def sigma(record):
        record.gyro["sigma_P"][row][column] *= 1.01
    assert verify(spoil(pulled, tmp_path, sigma), capsys) == (
        1, ["gyro sigma P[%d][%d]" % (row, column)])


@pytest.mark.parametrize("key,value,name", [
    ("missing", [1], "gyro, axes without a flip"), ("verdict", "doubtful", "gyro verdict")])
def test_a_changed_diagnosis_is_caught(pulled, tmp_path, capsys, key, value, name):
    code, names = verify(spoil(pulled, tmp_path, lambda r: r.gyro.update({key: value})), capsys)
    assert (code, names) == (1, [name])


def test_a_changed_sample_of_a_flip_is_caught(pulled, tmp_path, capsys):
    """The sums of the moves stand nowhere else: only P can tell."""
    folder, _ = pulled
    capture = capture_file.read(folder / "capture.bin")
    first, second = capture.board_placements[:2]
    capture.gyro[(first.first + first.n + second.first) // 2, 2] += 40
    (tmp_path / "capture.bin").write_bytes(capture_binary.encode(capture))
    (tmp_path / "record_a.bin").write_bytes((folder / "record_a.bin").read_bytes())
    code, names = verify(tmp_path, capsys)
    assert code == 1 and "gyro P[2][2]" in names and "P[0][0]" not in names


def test_sums_only_does_not_vouch_for_the_gyro(tmp_path, capsys):
    leave_files(tmp_path, unlabelled(**SESSION), sums_only=True)
    assert main(["verify", str(tmp_path)]) == 0
    assert "the gyro's section is not checked" in capsys.readouterr().out


def test_an_axis_kept_from_the_record_before(tmp_path, capsys):
    """No good flip about x: its values are those of the older record, and are looked up there."""
    from sixflip.gyro import solver as gyroscope
    from tests.worlds.board_session import make_record, run_board
    capture = unlabelled(**SESSION)
    data, placements, moves = run_board(capture)
    old = [[1.01, 0.002, 0.0], [0.0, 0.99, 0.001], [0.003, 0.0, 1.02], [0.01, 0.02, -0.01]]
    for move in moves:
        before = placements[move.before].pose if move.before >= 0 else 0
        if before in (5, 7):        # the flips of X+ and X- hit the rail
            middle = move.first + move.n // 2
            capture.gyro[middle] = 32767
    data, placements, moves = run_board(capture)
    record = make_record(capture, placements, moves=moves)
    record.sequence = 2
    gyro = gyroscope.solve(placements, moves, 65.5, record.accel["P"], old)
    record.gyro.update(P=gyro.P, sigma_P=gyro.sigma, missing=gyro.missing, verdict=gyro.verdict)
    assert gyro.missing == [0]
    before = correction_record.decode(correction_record.encode(record))
    before.sequence, before.session, before.gyro["P"] = 1, 1, old
    (tmp_path / "capture.bin").write_bytes(data)
    (tmp_path / "record_b.bin").write_bytes(correction_record.encode(record))
    assert main(["verify", str(tmp_path)]) == 1
    capsys.readouterr()
    (tmp_path / "record_a.bin").write_bytes(correction_record.encode(before))
    assert main(["verify", str(tmp_path)]) == 0
    assert "the gyro's x was not flipped" in capsys.readouterr().out.replace("\n", " ")
