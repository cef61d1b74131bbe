"""A board that answers with malice: names that leave the folder, values of the wrong kind."""

import io
import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sixflip.capture.blocks import ACCEL
from sixflip.capture.writer import BlockWriter
from sixflip_host.board import board_events, pulled_files
from sixflip_host.board.board_link import safe_name
from sixflip_host.board.console import Console

NAMES = ("../../x", "/etc/x", "..", ".", "", "a/../../x", "x\0y", "\\..\\x", "C:x", "a" * 5000,
         "CAPTURE.BIN", "capture.bin/../../x", "\x1b[2J.bin", "capture.bin\n", "~/x")


class HostileLink:
    """Claims to hold any names, calls itself anything, sends any bytes."""

    port = "hostile"

    def __init__(self, names, board_id, data=b"6CAP nonsense"):
        self.names, self.id, self.data = names, board_id, data
        self.asked = []

    def files(self, hashed=None):
        return {name: (len(self.data), None) for name in self.names}

    def get(self, name, progress=None, size=None):
        self.asked.append(name)
        return self.data

    def board_id(self):
        return self.id


@pytest.mark.parametrize("board_id", NAMES)
def test_nothing_of_the_boards_leaves_the_folder(tmp_path, board_id, capsys):
    output = tmp_path / "in" / "here"
    output.mkdir(parents=True)
    link = HostileLink([*NAMES, *pulled_files.WANTED], board_id)
    folder = pulled_files.fetch(link, output)
    assert set(link.asked) == set(pulled_files.WANTED)
    written = {path for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {folder / name for name in pulled_files.WANTED}
    assert Path(folder).resolve().parent == output.resolve()
    assert all(c.isprintable() or c == "\n" for c in capsys.readouterr().out)


def test_a_capture_that_is_none_is_one_line(tmp_path):
    folder = pulled_files.fetch(HostileLink(pulled_files.WANTED, "x"), tmp_path,
                                say=lambda line: None)
    assert [str(error).split(":")[0] for error in pulled_files.convert(folder)] == [
        str(folder / name) for name in pulled_files.CAPTURES]


def test_a_session_that_ended_before_anything_was_captured(tmp_path, capsys):
    data = bytearray()
    meta = b'{"sensor": "mpu6050", "rate_hz": 100, "accel_lsb_per_g": 16384}'
    BlockWriter(data.extend, meta, ACCEL).end(False)
    (tmp_path / "refused.bin").write_bytes(data)
    for cut in (0, 3):
        (tmp_path / "refused.bin").write_bytes(data[:len(data) - cut])
        assert pulled_files.convert(tmp_path) == []
        assert "is empty" in capsys.readouterr().out
        assert [path.name for path in tmp_path.iterdir()] == ["refused.bin"]


@pytest.mark.parametrize("name", [name for name in NAMES if name not in (
    "CAPTURE.BIN", "a" * 5000, "\x1b[2J.bin", "~/x")])
def test_unsafe_names(name):
    assert not safe_name(name)


JSON = st.recursive(st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9),
                    lambda inner: st.lists(inner, max_size=3)
                    | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=6)
KEYS = st.sampled_from(("missing", "pose", "face", "reason", "limit", "value", "unit", "verdict",
                        "tilt_deg", "ms", "left_s", "progress", "total", "state", "what", "chip"))
KINDS = st.sampled_from(("hello", "grace", "no_record", "record", "calibrating", "pose", "redo",
                         "refused", "solved", "saved", "capture", "bus_error", "error", "state"))


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(KINDS, st.dictionaries(KEYS, JSON, max_size=4)), max_size=4),
       st.booleans())
def test_any_event_is_shown_and_nothing_of_it_steers_the_terminal(events, live):
    out = io.StringIO()
    out.isatty = lambda: live
    console = Console(out)
    for kind, values in events:
        event = board_events.parse(json.dumps(dict({"event": kind}, **values)))
        if event:       # an infinity is no JSON
            console.show(event)
    console.clear()
    shown = out.getvalue().replace("\r", "") if live else out.getvalue()
    assert all(c.isprintable() or c == "\n" for c in shown), shown


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=200))
def test_any_line_is_an_event_or_none(line):
    for text in (line, '{"event"' + line, line + '{"event": "x"}'):
        event = board_events.parse(text)
        assert event is None or isinstance(event["event"], str)
