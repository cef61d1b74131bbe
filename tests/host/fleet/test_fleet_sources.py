"""Which boards there are in a folder, a manifest or a history, and what is said of the others."""
import random
import sqlite3

import pytest

from sixflip.record import correction_record
from sixflip_host.errors import BadFile, UsageError
from sixflip_host.fleet import analysis, manifest, sources
from sixflip_host.history import store
from tests.worlds.written_records import of_a_gy85

HEAD = b"board,capture,batch\n"


def test_a_folder_of_boards_in_batches(tmp_path):
    for name in ("lot 1/a/s.csv", "lot 1/b/s.csv", "lot 2/c/s.csv.gz", "d/t.csv", "e.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    (tmp_path / "empty").mkdir()
    found = sources.find_boards(tmp_path)
    assert [(b.batch, b.board) for b in found.boards] == [
        ("", "d"), ("", "e"), ("lot 1", "a"), ("lot 1", "b"), ("lot 2", "c")]
    assert [what for what, _ in found.failures] == ["empty"]
    assert "no session" in found.failures[0][1]


def test_an_id_that_stands_twice_is_taken_once_and_said(tmp_path):
    for name in ("lot 1/a/s.csv", "lot 2/a/s.csv"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("x")
    found = sources.find_boards(tmp_path)
    assert [b.batch for b in found.boards] == ["lot 1"]
    assert "twice" in found.failures[0][1]


def test_a_board_as_pull_left_it_is_one_session(tmp_path):
    (tmp_path / "a").mkdir()
    for name in ("capture.bin", "capture.csv", "record_a.bin"):
        (tmp_path / "a" / name).write_bytes(b"x")
    assert [p[-11:] for p in sources.find_boards(tmp_path).boards[0].captures] == ["capture.csv"]


def test_what_is_no_fleet_is_one_sentence(tmp_path):
    with pytest.raises(BadFile, match="not there"):
        sources.find_boards(tmp_path / "none")
    with pytest.raises(BadFile, match="no board in it"):
        sources.find_boards(tmp_path)
    one = tmp_path / "s.csv"
    one.write_text("# sixflip-capture 1\n# {}\n")
    with pytest.raises(UsageError, match="is one capture"):
        sources.find_boards(one)


def test_a_manifest_and_its_wrong_lines():
    found, wrong = manifest.parse("/m/boards.csv", HEAD + b"a,x/1.csv,lot 1\n\na,x/2.csv,lot 1\n"
                                  b",y.csv,\nb,,\nc,x/1.csv,\nd,z.csv,lot 2,more\ne,w.csv\n")
    assert [(one.board, one.capture, one.batch) for one in found] == [
        ("a", "/m/x/1.csv", "lot 1"), ("a", "/m/x/2.csv", "lot 1"), ("e", "/m/w.csv", "")]
    assert [what for what, _ in wrong] == ["boards.csv line %d" % n for n in (5, 6, 7, 8)]
    assert "for board a" in wrong[2][1] and "4 cells" in wrong[3][1]


@pytest.mark.parametrize("data, said", [
    (b"", "no column 'board'"), (b"board,file\na,b\n", "no column 'capture'"),
    (b"board,board,capture\n", "more than one column 'board'"), (b"\xff\xfe\0a", "no UTF-8"),
    (b"board,capture\0\n", "NUL")])
def test_what_is_no_manifest_is_one_sentence(data, said):
    with pytest.raises(BadFile, match=said):
        manifest.parse("m.csv", data)


def test_any_bytes_are_lines_sentences_or_one_sentence():
    rng, seen = random.Random(7), set()
    good = HEAD + b'"a, b",one.csv,lot\nb,"two\n.csv",\n' * 3
    for _ in range(400):
        data = bytearray(good)
        for _ in range(rng.randrange(1, 6)):
            where = rng.randrange(len(data))
            data[where:where + rng.randrange(3)] = bytes(
                rng.choice(b'",\n\r\0\xff\x80abc;\t\'') for _ in range(rng.randrange(4)))
        try:
            found, wrong = manifest.parse("m.csv", bytes(data))
        except BadFile as error:
            assert "\n" not in str(error)
            seen.add("refused")
            continue
        seen.update(["lines"] * bool(found) + ["wrong"] * bool(wrong))
        assert all(one.board and "\n" not in one.board for one in found)
    assert seen == {"refused", "lines", "wrong"}


def test_a_history_gives_its_calibrations(tmp_path):
    record = of_a_gy85()
    data = correction_record.encode(record)
    file = tmp_path / "history.sqlite"
    store.add(file, [store.Happened("b1", "calibration", "pull", 10.0 * k, "good", chip="gy85",
                                    session=k, sequence=k, record=data) for k in (1, 2)]
              + [store.Happened("b2", "check", "check", 1.0, "holds")])
    found = sources.find_boards(file)
    assert [(b.board, len(b.calibrations)) for b in found.boards] == [("b1", 2)]
    assert "no calibration" in found.failures[0][1]
    row = analysis.row(found.boards[0])
    assert row["failure"] == "" and row["chip"] == "gy85" and len(row["values"]) == 2
    one = analysis.estimates(row)[0]
    place = analysis.parameters.PLACE["accel_scale_x"]
    assert one.value[place] == pytest.approx(record.accel["P"][0][0])


def test_the_database_of_another_program_is_one_sentence(tmp_path):
    file = tmp_path / "x.sqlite"
    sqlite3.connect(file).execute("CREATE TABLE t (a)").connection.commit()
    with pytest.raises(BadFile, match="another program"):
        sources.find_boards(file)
