"""A record with every term in it, in the heap of a small board: loaded, streamed by and kept
through a new session. Without terms none of their code is in the heap."""


import pytest
from test_term_correction import ALL, fields_of

from sixflip.record import correction_record
from sixflip_host import record_terms

from .test_firmware_memory import HEAP, bare, flash, only, power_up


def with_terms(record):
    """A board's record, now with all five terms."""
    record.terms = []
    for name in ALL:
        fields = fields_of(name)
        if record.chip == "gy85" and "temp_lsb_per_c" in fields:
            fields.update(temp_lsb_per_c=280.0, temp_offset_c=82.142857)
        record_terms.put(record, name, fields)
    return record


def give_terms(path):
    """All five terms into the file of a board's record."""
    record = correction_record.decode(path.read_bytes())
    path.write_bytes(correction_record.encode(with_terms(record)))


@pytest.mark.parametrize("sensor", ["mpu6050", "gy85"])
def test_terms_in_force_and_kept_through_a_session(micropython, tmp_path, sensor):
    flash(tmp_path, sensor)
    events, harness = power_up(micropython, tmp_path, 1 << 20, "live")
    plain = only(events, "ready")["live"]
    give_terms(tmp_path / "record_a.bin")
    events, _ = power_up(micropython, tmp_path, 1 << 20, "live")
    assert only(events, "record")["terms"] == [16, 17, 18, 19, 20]
    print("\n%s: in use while streaming %d bytes, with five terms %d" % (
        sensor, plain, only(events, "ready")["live"]))

    heap = HEAP + harness - bare(micropython, tmp_path)
    events, _ = power_up(micropython, tmp_path, heap)
    assert only(events, "record")["terms"] == [16, 17, 18, 19, 20]
    assert only(events, "ready")["corrected"] and not [e for e in events if e["event"] == "error"]

    (tmp_path / "calibrate.flag").write_text("")
    events, _ = power_up(micropython, tmp_path, heap)
    assert not [e for e in events if e["event"] == "error"]
    assert len([e for e in events if e["event"] == "pose"]) == 12
    assert only(events, "solved")["verdict"] == "good", only(events, "solved")["reason"]
    assert only(events, "saved")
    assert only(events, "ready")["corrected"]
    newest = max((correction_record.decode(one.read_bytes())
                  for one in tmp_path.glob("record_?.bin")), key=lambda one: one.sequence)
    assert record_terms.names_of(newest) == ALL


def test_without_terms_their_code_is_not_loaded(micropython, tmp_path):
    script = tmp_path / "loaded.py"
    script.write_text("""
import sys
from sixflip.record.correction_record import decode
from sixflip.record.correction import correction_of
for name in sys.argv[1:]:
    with open(name, "rb") as f:
        correction_of(decode(f.read()))
    print("sixflip.record.term_correction" in sys.modules)
""")
    flash(tmp_path, "mpu6050")
    power_up(micropython, tmp_path, 1 << 20)
    plain = tmp_path / "record_a.bin"
    terms = tmp_path / "terms.bin"
    terms.write_bytes(plain.read_bytes())
    give_terms(terms)
    done = micropython(str(script), str(plain), str(terms), path=tmp_path)
    assert done.stdout.split() == ["False", "True"], done.stderr
