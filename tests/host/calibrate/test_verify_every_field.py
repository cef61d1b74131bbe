"""Every field: one that was changed is caught by verify, or listed as unverifiable."""

import copy

import pytest

from sixflip.record import correction_record
from sixflip.record.correction_record import FIELDS
from sixflip_host import record_terms
from sixflip_host.calibrate import verification
from sixflip_host.calibrate.verification import verify
from sixflip_host.capture import capture_binary
from sixflip_host.cli import main
from tests.worlds.board_session import make_record, run_board, unlabelled

HEADER = {"who_am_i": [0x68, 0], "accel_range_g": 2, "gyro_range_dps": 500, "float_bits": 64}
HEAD = {"sequence": 9, "session": 1, "time": 5, "float_bits": 32, "chip": "other",
        "who_am_i": (0x70, 0), "accel_range_g": 4, "gyro_range_dps": 250,
        "accel_lsb_per_g": 16383.0, "gyro_lsb_per_dps": 65.4, "temp_c": 30.0, "g": 9.81}
FLIPS = {"excess": [0.0] * 6, "scale_sigma": None, "sequence": None}
MOUNTING = {"roll_deg": 90.0, "pitch_deg": 0.0, "order": "xyz", "axes": "x y z", "frame": "ned"}
TERM = {"k1": [9.0] * 3, "k2": [0.0] * 3, "t0_c": 25.0, "low_c": 10.0, "high_c": 40.0,
        "temp_lsb_per_c": 340.0, "temp_offset_c": 36.53, "sigma_k1": [0.1] * 3,
        "sigma_k2": [0.1] * 3, "axes": [0, 1, 2], "origin": "refinement", "source": "",
        "before": 1.0, "after": 0.5, "floor": 0.1}


@pytest.fixture(scope="module")
def board():
    """(Capture, honest Record with a gyro)."""
    session = unlabelled(seed=4, wobble_deg=0.5)
    session.meta.update(HEADER)
    data, placements, moves = run_board(session)
    return capture_binary.decode(data), make_record(session, placements, moves=moves)


def other(value):
    """Another value of the same kind."""
    if isinstance(value, str):
        words = [kind for _, kind, *_ in FIELDS["accel"] if isinstance(kind, tuple)]
        return next((word for kind in words if value in kind for word in kind if word != value),
                    value + " indeed")
    if isinstance(value, list) and value and isinstance(value[0], int):
        return value[1:]
    return [2] if isinstance(value, list) else 1.001 * value + 1e-3


def changes(record):
    """(name, change(record)) for every field and every single number of the matrices."""
    for name, value in HEAD.items():
        yield name, lambda r, name=name, value=value: setattr(r, name, value)
    for section in ("accel", "gyro", "gyro_bias"):
        yield section, lambda r, section=section: setattr(r, section, None)
        for field, value in getattr(record, section).items():
            if field in ("P", "sigma_P", "bias_dps"):
                rows = value if field != "bias_dps" else [value]
                for i, row in enumerate(rows):
                    for j in range(3):
                        yield "%s.%s[%d][%d]" % (section, field, i, j), \
                            lambda r, s=section, f=field, i=i, j=j, row=row: _number(r, s, f, i, j)
            else:
                yield "%s.%s" % (section, field), lambda r, s=section, f=field, value=value: \
                    getattr(r, s).update({f: other(value)})
    yield "flips", lambda r: setattr(r, "flips", copy.deepcopy(FLIPS))
    for face in range(6):
        yield "flips.excess", lambda r, face=face: setattr(r, "flips", dict(
            FLIPS, excess=[0.1 * (k == face) for k in range(6)]))
    yield "mounting", lambda r: setattr(r, "mounting", dict(MOUNTING))
    yield "accel_thermal_bias", lambda r: record_terms.put(r, "accel_thermal_bias", TERM)
    yield "section 99", lambda r: r.unknown.append((99, b"x"))


def _number(record, section, field, i, j):
    matrix = getattr(record, section)[field]
    row = matrix if field == "bias_dps" else matrix[i]
    row[j] = 1.001 * row[j] + 1e-6


def test_an_honest_record_has_no_other_unverifiable_fields(board):
    capture, record = board
    assert [check.name for check in verify(capture, record)[0] if not check.ok] == []
    others = verification.not_verifiable(capture, record, None)
    assert [name for name, _ in others] == ["sequence", "time"]


def test_every_changed_field_is_caught_or_listed(board):
    capture, honest = board
    seen = 0
    for name, change in changes(honest):
        record = correction_record.decode(correction_record.encode(honest))
        change(record)
        caught = [check.name for check in verify(capture, record)[0] if not check.ok]
        listed = [field for field, _ in verification.not_verifiable(capture, record, None)]
        listed = [one for one in listed if one == name or one.startswith((name + ".", name + ","))]
        assert caught or listed, name
        seen += 1
    assert seen > 80


def test_a_capture_without_a_placement_is_one_line(board, tmp_path, capsys):
    data = run_board(unlabelled(seed=4, wobble_deg=0.5))[0][:1500]
    (tmp_path / "capture.bin").write_bytes(data)
    (tmp_path / "record_a.bin").write_bytes(correction_record.encode(board[1]))
    assert main(["verify", str(tmp_path)]) == 4
    assert "no placement in it" in capsys.readouterr().err


def test_a_sequence_that_is_no_number(board):
    record = copy.deepcopy(board[1])
    record.flips = dict(FLIPS)
    remarks = verify(board[0], record)[1]
    assert any("record number nan" in one for one in remarks)
