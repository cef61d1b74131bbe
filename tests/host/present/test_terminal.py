"""Tables and sentences at 80 columns and in a pipe: folded, broken between words, never cut."""

import io

from sixflip.poses.faces import FACES
from sixflip_host import terminal
from sixflip_host.board.console import Console
from sixflip_host.present import gap_sentence, gap_words

GAP = {
    "verdict": "explained", "remarks": [], "damage": [], "noise": {},
    "held_out": "each session by the others",
    "where": [{"sensor": "gyro", "axis": "x", "domain": "orientation", "share": 0.9, "p": 1e-9}],
    "causes": [{
        "sensor": "gyro_turns", "axes": ["x"], "effect": None, "plausible": False,
        "class": ["g_sensitivity", "vibration_rectification"], "score_nats": 41.27,
        "probability": 0.97,
        "class_probabilities": {"g_sensitivity": 0.9, "vibration_rectification": 0.07},
        "share": 0.83, "unit": "deg/s/g",
        "value": {i + j: 0.1234 for i in "xyz" for j in "xyz"},
        "interval_90": {i + j: [0.1111, 0.1357] for i in "xyz" for j in "xyz"}}],
    "gap": {}, "unseen": [], "next": []}
ROW = ("g_sensitivity 90 % or vibration_rectification 7 % (numerically helpful, physically "
       "implausible)", "gyro in motion", "97 %", "83 %",
       "xx 0.123 (0.111 … 0.136)", "zz 0.123 (0.111 … 0.136)")


class Screen(io.StringIO):
    def isatty(self):
        return True


def of_80_columns(monkeypatch):
    """What is printed from now on, on a terminal of 80 columns."""
    shown = Screen()
    monkeypatch.setattr("sys.stdout", shown)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERM", "dumb")
    return shown


def lines(text):
    return [line.rstrip() for line in text.splitlines()]


def test_the_gap_at_80_columns_has_every_cell_whole(monkeypatch):
    screen = of_80_columns(monkeypatch)
    gap_words.show(GAP)
    shown = lines(screen.getvalue())
    assert max(map(len, shown)) <= 80
    assert all(part in " ".join(" ".join(shown).split()) for part in ROW)


def test_what_a_capture_cannot_tell_is_said_of_what_it_names():
    """One name of a dead band was said with "cannot tell which"."""
    named = {"sensor": "gyro", "axes": ["x"], "effect": "dead_band", "class": ["dead_band"],
             "plausible": True, "share": 0.9, "unit": "counts", "value": {"x": 40.0}}
    either = {**named, "effect": None, "class": ["cubic", "hysteresis"]}
    closed = {"gyro": {"unit": "deg/s", "explained_share": 0.6}}

    def said(*causes, gap=None):
        return gap_sentence.sentence({**GAP, "verdict": "cannot tell", "causes": list(causes),
                                      "gap": gap or {}})
    assert said(named).endswith("This capture cannot tell how much of the gap goes with that.")
    assert "cannot tell which" in said(named, either)
    assert "cannot tell whether that is so. Adding" in said(named, gap=closed)


def test_a_pipe_is_a_hundred_wide_and_cuts_nothing(monkeypatch, capsys):
    monkeypatch.delenv("COLUMNS", raising=False)
    gap_words.show(GAP)
    shown = lines(capsys.readouterr().out)
    assert max(len(line) for line in shown if not line.startswith("The gyro")) <= 100
    assert all(part in " ".join(" ".join(shown).split()) for part in ROW)


def test_a_narrow_table_stays_a_table_and_a_wide_one_names_its_columns(monkeypatch):
    screen = of_80_columns(monkeypatch)
    out = terminal.console()
    out.print(terminal.table("poses", ("pose", "samples"), [("Z+a", "400")]))
    out.print(terminal.table("poses", ("pose", "samples", "why"), [("Z+b", "7", "w" * 70)]))
    shown = lines(screen.getvalue())
    assert shown[1:4] == ["pose   samples", "─" * 14, "Z+a        400"]
    assert shown[6:9] == ["  Z+b", "    samples: 7", "    why: " + "w" * 70]


def test_sentences_break_between_words_and_a_path_is_left_in_one_piece(monkeypatch):
    screen = of_80_columns(monkeypatch)
    path = "/" + "long/" * 20 + "capture.csv"
    terminal.console().print("  " + "word " * 30 + path)
    shown = lines(screen.getvalue())
    assert set(" ".join(shown).split()) == {"word", path}
    assert [line[:4].isspace() for line in shown] == [False] + [True] * (len(shown) - 1)


def test_a_sentence_in_a_pipe_is_one_line(capsys):
    terminal.console().print("word " * 50 + "end")
    assert capsys.readouterr().out == "word " * 50 + "end\n"


def test_what_a_board_says_breaks_between_words_and_the_live_line_is_left_alone(monkeypatch):
    screen = of_80_columns(monkeypatch)
    console = Console(screen)
    console.show({"event": "redo", "face": "Z+", "missing": [
        face + letter for face in FACES for letter in "ab"]})
    shown = lines(screen.getvalue())
    assert len(shown) == 2 and max(map(len, shown)) <= 80
    assert " ".join(" ".join(shown).split()).count("and its flip") == 6
