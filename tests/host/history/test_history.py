"""The history of boards: what the verbs leave in it, what is asked of it, what can go wrong."""

import json
import multiprocessing
import sqlite3
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sixflip.record import correction_record
from sixflip_host.capture import capture_binary, capture_file
from sixflip_host.cli import main
from sixflip_host.history import drift, logbook, parameters, store
from sixflip_host.verbs import calibrate
from tests.worlds.board_session import leave_files, make_record, unlabelled

BOARD = "e6614c311b4c5a2f"
DAY = 86400.0


@pytest.fixture
def file(tmp_path, monkeypatch):
    """An empty place for a history."""
    path = tmp_path / "some where" / "history.sqlite"
    monkeypatch.setenv(store.VARIABLE, str(path))
    return path


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    """(folder as `pull` leaves it, the record in it) of a board that says its id."""
    folder = tmp_path_factory.mktemp("board")
    capture = unlabelled()
    capture.meta["device_id"] = BOARD
    return folder, leave_files(folder, capture, gyro=True)


def answer(capsys, *words):
    capsys.readouterr()
    assert main(["history", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_nothing_yet(file, capsys):
    assert main(["history"]) == 0
    assert "nothing in the history yet" in capsys.readouterr().out
    assert answer(capsys)["boards"] == [] and not file.exists()


def test_pull_verify_and_refine(file, pulled, capsys):
    folder, record = pulled
    logbook.pulled(folder, "not this one")
    logbook.pulled(folder, "not this one")     # the same record: one calibration
    assert main(["verify", str(folder)]) == 0
    assert main(["refine", str(folder / "capture.bin")]) == 0
    found = answer(capsys, BOARD[:5])
    assert [(one["kind"], one["verb"]) for one in found["happened"]] == [
        ("calibration", "pull"), ("verification", "verify"), ("calibration", "refine")]
    first = found["happened"][0]
    assert first["sequence"] == 1 and first["time_is"] == "seen"
    assert first["temp_c"] == pytest.approx(record.temp_c, abs=1e-4)
    scale = first["parameters"]["accel_scale_y"]
    assert scale["value"] == record.accel["P"][1][1]
    assert scale["sigma"] == pytest.approx(record.accel["sigma_P"][1][1], rel=1e-6)
    # measured = A^-1 (g - o): what the sensor reads at a true 0 is its bias
    P = np.array(record.accel["P"])
    bias = np.linalg.solve(P[:3, :3].T, -P[3, :3]) * 1e3 / record.g
    assert first["parameters"]["accel_bias_z_mg"]["value"] == pytest.approx(bias[2], rel=1e-9)
    refined = found["happened"][2]["parameters"]["accel_bias_z_mg"]["value"]
    assert refined == pytest.approx(bias[2], abs=1.0)
    assert found["happened"][1]["verdict"] == "holds"
    one, = answer(capsys)["boards"]
    assert (one["board"], one["calibrations"], one["checks"]) == (BOARD, 2, 1)


def test_a_verification_that_fails(file, pulled, tmp_path, capsys):
    folder, record = pulled
    wrong = correction_record.decode((folder / "record_a.bin").read_bytes())
    wrong.accel["P"][0][0] += 1e-3
    (tmp_path / "r.bin").write_bytes(correction_record.encode(wrong))
    assert main(["verify", str(folder / "capture.bin"), str(tmp_path / "r.bin")]) == 1
    only, = answer(capsys, BOARD)["happened"]
    assert only["verdict"] == "fails" and "differ: " in only["reason"]
    assert main(["history", BOARD]) == 0
    assert "fails" in capsys.readouterr().out


def test_check_of_a_rest(file, pulled, tmp_path, capsys):
    capture = capture_binary.decode((pulled[0] / "capture.bin").read_bytes())
    rest = capture_file.Capture(dict(capture.meta), *(
        block[:500] for block in (capture.t_us, capture.accel, capture.gyro, capture.temp)))
    rest.meta.pop("board_capture", None)
    capture_file.write(tmp_path / "rest.csv", rest)
    assert main(["check", str(tmp_path / "rest.csv"), "--record",
                 str(pulled[0] / "record_a.bin")]) == 0
    only, = answer(capsys, BOARD)["happened"]
    assert (only["kind"], only["verdict"]) == ("check", "holds")
    assert abs(only["answer"]["a_error_mg"]) < 5


class Said:
    """A link on which a board calibrates: its events, one after the other."""

    port = "said"

    def __init__(self, *events):
        self.events = events

    def lines(self, timeout):
        return iter([json.dumps(one) for one in self.events])


def told(verdict="good", **saved):
    return [{"event": "hello", "id": BOARD, "chip": "MPU6050 (0x68)"},
            {"event": "solved", "verdict": verdict, "reason": "so", "scale": [1.01, 0.99, 1.0],
             "v": [0.1, 0.0, -0.3], "tilt_deg": 2.0},
            *([{"event": "saved", **saved}] if saved else [{"event": "ready"}])]


def test_a_calibration_is_completed_by_its_record(file, pulled, capsys):
    calibrate.follow(Said(*told(slot="a", sequence=1, written=True)), lambda event: None)
    first, = answer(capsys, BOARD)["happened"]
    assert first["verb"] == "calibrate" and first["session"] is None
    assert first["parameters"]["accel_bias_z_mg"]["value"] == pytest.approx(300 / 9.80665)
    logbook.pulled(pulled[0], BOARD)
    only, = answer(capsys, BOARD)["happened"]
    assert only["unix_time"] == first["unix_time"] and only["time_is"] == "made"
    assert only["session"] == pulled[1].session and only["answer"]["tilt_deg"] == 2.0
    assert only["parameters"]["accel_scale_x"]["sigma"] is not None
    # the flash erased, calibrated anew: another number 1
    calibrate.follow(Said(*told(slot="a", sequence=1, written=True)), lambda event: None)
    assert len(answer(capsys, BOARD)["happened"]) == 2


def test_refused_and_unchanged_calibrations_are_kept_too(file, capsys):
    calibrate.follow(Said(*told("refused")), lambda event: None)
    calibrate.follow(Said(*told(slot="a", sequence=1, written=False)), lambda event: None)
    happened = answer(capsys, BOARD)["happened"]
    assert [one["verdict"] for one in happened] == ["refused", "good"]
    assert [one["sequence"] for one in happened] == [None, None]


def test_a_board_whose_first_words_were_lost(file, capsys):
    calibrate.follow(Said(*told(slot="a", sequence=1, written=True)[1:]), lambda event: None,
                     board=BOARD)
    assert answer(capsys, BOARD)["happened"][0]["verb"] == "calibrate"


def test_an_id_cannot_steer_the_terminal(file, capsys):
    hostile = [dict(told()[0], id="\x1b[2Jab\u202ec"), *told()[1:]]
    calibrate.follow(Said(*hostile), lambda event: None)
    assert [one["board"] for one in answer(capsys)["boards"]] == ["2Jabc"]


# -- drift


def calibrations(n, per_c=0.0, per_day=0.0, celsius=None, noise=0.05, seed=1):
    """Rows of a board whose bias moves as said: mg per °C, mg per day."""
    rng = np.random.default_rng(seed)
    out = []
    for k in range(n):
        c = 25.0 + (k % 4) * 5.0 if celsius is None else celsius
        bias = 10.0 + per_c * (c - 25.0) + per_day * k + rng.normal(0, noise)
        row = store.Happened(BOARD, "calibration", "pull", 1.8e9 + k * DAY, "good", temp_c=c)
        out.append((row, {"accel_bias_x_mg": (bias, noise)}))
    return out


def test_drift_with_temperature_and_time():
    one, = drift.drifts(calibrations(12, per_c=0.8, per_day=-0.2))
    assert one.per_c[0] == pytest.approx(0.8, abs=4 * one.per_c[1]) and one.per_c[2]
    assert one.per_30_days[0] == pytest.approx(-6.0, abs=4 * one.per_30_days[1])
    assert one.per_30_days[2] and one.per_c[1] < 0.01


def test_no_drift_is_not_called_one():
    seen = [one.per_c[2] or one.per_30_days[2] for seed in range(200)
            for one in drift.drifts(calibrations(8, seed=seed))]
    assert len(seen) == 200 and sum(seen) < 35      # two tests at 95 %, widened


def test_drift_that_cannot_be_told():
    together = [(row, found) for row, found in calibrations(6)]
    for k, (row, _) in enumerate(together):
        row.temp_c = 20.0 + 3.0 * k
    assert "cannot be told apart" in drift.drifts(together)[0].note
    assert "3 calibrations, 4 are needed" in drift.drifts(calibrations(3))[0].note
    close = calibrations(2, celsius=25.0)
    close[1][0].at = close[0][0].at + 60
    assert "less than 2 °C" in drift.drifts(close)[0].note
    assert drift.drifts(calibrations(1)) == []


def test_refused_calibrations_do_not_drift():
    rows = calibrations(6, per_c=0.5)
    rows[-1][0].verdict = "refused"
    rows[-1][1]["accel_bias_x_mg"] = (9e9, 1.0)
    assert drift.drifts(rows)[0].change < 100


@pytest.fixture
def warmed(file, pulled):
    """A history of eight calibrations at four temperatures; the bias of x moves by 0.5 mg/°C."""
    capture = capture_file.read(pulled[0] / "capture.bin")
    rng = np.random.default_rng(3)
    rows = []
    for k in range(8):
        record = make_record(capture, capture.board_placements, moves=capture.moves())
        record.sequence, record.temp_c = k + 1, 20.0 + 5.0 * (k % 4)
        record.time = 1800000000 + int(k * DAY)
        moved = 0.5e-3 * (record.temp_c - 20.0) + rng.normal(0, 1e-4)
        for j in range(3):      # true = A (measured - what it reads more)
            record.accel["P"][3][j] -= moved * record.g * record.accel["P"][0][j]
        rows.append(logbook._of_record(BOARD, "pull", record, correction_record.encode(record)))
    store.add(file, rows)
    return file


def test_history_in_words_and_as_a_picture(warmed, tmp_path, capsys):
    assert main(["history", BOARD[:3], "--plot", str(tmp_path / "drift.png")]) == 0
    out = capsys.readouterr().out
    line = next(line for line in out.splitlines() if line.lstrip().startswith("accel_bias_x_mg"))
    assert "+0.497 ± 0.011 *" in line
    assert "~" not in out       # records with a time of their own
    with Image.open(tmp_path / "drift.png") as picture:
        assert picture.size == (1100, 825)
        assert len(picture.convert("RGB").getcolors(1 << 16)) > 50


def test_drift_as_json(warmed, capsys):
    moved = {one["parameter"]: one for one in answer(capsys, BOARD)["drift"]}
    assert moved["accel_bias_x_mg"]["per_c"]["beyond_doubt"]
    assert moved["accel_bias_x_mg"]["per_c"]["value"] == pytest.approx(0.5, abs=0.05)
    assert not moved["gyro_bias_z_dps"]["per_c"]["beyond_doubt"]


# -- what can go wrong


def test_unknown_and_doubtful_boards(file, capsys):
    store.add(file, [store.Happened(name, "check", "check", 1.0, "holds")
                     for name in ("ab1", "ab2")])
    for words, said in ((["x"], "no such board in the history, expected one of ab1 ab2"),
                        (["ab"], "2 boards begin so"), (["--plot", "x.png"], "expected a BOARD")):
        assert main(["history", *words]) == 2
        assert said in capsys.readouterr().err
    assert main(["history", "ab1", "--plot", "x.png"]) == 1
    assert "no calibration" in capsys.readouterr().err and not Path("x.png").exists()


def damaged(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2:] = b"\x55" * (len(data) - len(data) // 2)
    path.write_bytes(bytes(data))


def of_later_layout(path):
    with sqlite3.connect(path) as connection:
        connection.execute("PRAGMA user_version = 2")
    connection.close()


def of_another_program(path):
    path.unlink()
    with sqlite3.connect(path) as connection:
        connection.execute("CREATE TABLE tunes (title TEXT)")
    connection.close()


def row_by_hand(path):
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE happened SET answer = 'nonsense'")
    connection.close()


@pytest.mark.parametrize("harm,words", [
    (damaged, "damaged"), (lambda path: path.write_text("not a database, surely\n" * 40),
                           "is no history or a damaged one"),
    (of_later_layout, "layout 2, expected 1"), (of_another_program, "of another program"),
    (row_by_hand, "damaged")])
def test_a_file_that_is_no_history(file, pulled, capsys, harm, words):
    store.add(file, [store.Happened("ab%d" % k, "check", "check", 1.0, "holds",
                                    answer={"x": "y" * 200}) for k in range(60)])
    harm(file)
    before = file.read_bytes()
    assert main(["history"]) == 4
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1 and error.startswith("sixflip: ")
    assert main(["verify", str(pulled[0])]) == 0    # goes on, with a warning at most
    error = capsys.readouterr().err
    if harm not in (row_by_hand, damaged):          # those take one more row
        assert error.startswith("sixflip: not kept in the history: ") and error.count("\n") == 1
        assert file.read_bytes() == before


def test_a_place_that_cannot_be_written(pulled, tmp_path, monkeypatch, capsys):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(store.VARIABLE, str(tmp_path / "file" / "history.sqlite"))
    assert main(["verify", str(pulled[0])]) == 0
    error = capsys.readouterr().err
    assert error.startswith("sixflip: not kept in the history: ") and error.count("\n") == 1
    monkeypatch.setenv(store.VARIABLE, str(tmp_path))      # a folder
    assert main(["verify", str(pulled[0])]) == 0
    assert "cannot be used as history" in capsys.readouterr().err


def test_no_history_at_all(pulled, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv(store.VARIABLE, "")
    assert main(["verify", str(pulled[0])]) == 0
    assert capsys.readouterr().err == ""
    assert main(["history"]) == 0
    assert "none is kept" in capsys.readouterr().out


def write_some(file, name):
    for _ in range(10):
        store.add(file, [store.Happened(name, "check", "check", 1.0, "holds")])


def test_writers_at_the_same_time(file):
    context = multiprocessing.get_context("fork")
    writers = [context.Process(target=write_some, args=(file, "board%d" % k)) for k in range(4)]
    for one in writers:
        one.start()
    for one in writers:
        one.join()
    assert [one.exitcode for one in writers] == [0] * 4
    assert len(store.read(file)) == 40


def test_all_rows_or_none(file):
    good = store.Happened("ab", "check", "check", 1.0, "holds")
    bad = store.Happened("ab", "check", "check", None, "holds")
    with pytest.raises(Exception, match="at is nothing"):
        store.add(file, [good, bad])
    assert store.read(file) == []


def test_the_bias_of_a_gyros_matrix_is_what_it_maps_to_zero():
    matrix = np.array([[0.98, 0.01, 0.0], [0.0, 1.02, -0.01], [0.02, 0.0, 1.0],
                       [0.01, -0.02, 0.005]])
    bias = np.radians(parameters.gyro_bias_dps(matrix.tolist()))
    assert bias @ matrix[:3] + matrix[3] == pytest.approx(np.zeros(3), abs=1e-12)
    with pytest.raises(ValueError):
        parameters.gyro_bias_dps([[0.0] * 3] * 4)
