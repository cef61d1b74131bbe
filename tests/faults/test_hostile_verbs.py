"""Every verb at boards that answer with malice: the bench hostile_board runs thousands."""

import ast
import json
from pathlib import Path

import pytest

from sixflip_host.board import board_schema
from tests.faults import hostile_board
from tests.faults.hostile_port import Dripping, HostileBoard, Instead, run
from tests.faults.real_dialogue import dialogue

DEVICE = Path(__file__).resolve().parents[2] / "device" / "sixflip_device"
SEEDS = {"provision": 4, "provision --json": 2, "pull": 12}
SAMPLE = b'{"event": "sample", "t_us": 5, "a": [0, 0, 9.8]}\r\n'
NESTED = b"[" * 3000 + b"]" * 3000


@pytest.mark.parametrize("verb", hostile_board.VERBS)
def test_no_attack_gets_an_internal_error_or_more_than_its_time(verb):
    hits = 0
    for seed in range(SEEDS.get(verb, 25)):
        result = hostile_board.attacked(verb, seed)
        assert result.wrong == "", (seed, result.attack.kind)
        hits += result.attack.hits > 0
    assert hits


@pytest.mark.parametrize("verb", hostile_board.VERBS)
def test_at_an_honest_board_every_verb_does_its_work(verb, tmp_path):
    words = hostile_board.VERBS[verb][0] + (("-o", tmp_path) if verb == "pull" else ())
    code, _, error = run(HostileBoard(), *words)
    assert code == 0, error


@pytest.mark.parametrize("verb, name, said, expected", [
    ("provision", "version", b"['v1', 'pico', 3]", "a list of 2"),
    ("provision", "version", b"12", "a list of 2"),
    ("provision", "files", b"('main.py', 12)\n", "a list of 3"),
    ("pull", "files", b"('main.py', 'x', None)\n", "a whole number"),
    ("pull", "files", b"('main.py', None, None)\n", "a whole number"),
    ("pull", "files", b"('main.py', 1e999, None)\n", "a whole number"),
    ("doctor", "bus", b"('settings', 'pico', 'auto', 400, [])\n", "a text"),
    ("provision", "selftest", b'{"event": "selftest", "ok": 1}\n', "true or false"),
    ("check", "check", b'{"event": "check", "still": true, "verdict": []}\n', "good, doubtful"),
    ("check", "check", b'{"event": "check", "still": true, "verdict": "good", "bias_dps": [1]}\n',
     "a list of 3"),
    ("mount", "mounted", b'{"event": "mounted", "roll_deg": 1e999}\n', "a number"),
    ("stream", "stream", b'{"event": "stream", "hz": "fast"}\n', "a number from 0 to 500"),
    ("calibrate", "solved", b'{"event": "solved", "verdict": {}}\n', "one of good, doubtful"),
    ("calibrate", "solved", b'{"event": "solved", "verdict": "good", "tilt_deg": 1%s}\n'
     % (b"0" * 400), "a number"),
])
def test_an_answer_of_another_form_is_said_with_what_was_expected(verb, name, said, expected):
    code, out, error = run(HostileBoard(Instead(**{name: said})), *hostile_board.VERBS[verb][0])
    assert code == (0 if verb == "doctor" and not error else 3) or code == 1, error
    assert expected in out + error


@pytest.mark.parametrize("text", [NESTED, b'{"board": %s}' % NESTED, b"\xff", b"[1, 2]",
                                  b'{"board": "pico", "x": ' + b"[" * 40 + b"]" * 40 + b"}"])
def test_provision_repairs_a_settings_file_that_is_none(text):
    board = HostileBoard()
    board.files["sixflip.json"] = text
    code, _, error = run(board, "provision", "--sensor", "gy85")
    assert code == 0, error
    assert json.loads(board.files["sixflip.json"]) == {"board": "pico", "sensor": "gy85"}


@pytest.mark.parametrize("verb, attack, limit_s", [
    ("pull", Dripping("files", [b"x"], 9.0), 80),
    ("pull", Dripping("capture.bin", [b"QUJD"], 5.0), 200),
    ("doctor", Dripping("bus", [b"x"], 9.0), 100),
    ("calibrate", Dripping("state", [b"\xff\x00\xfe\r\n"], 0.01), 60),
    ("calibrate", Dripping("state", [b"noise"], 0.01), 60),
    ("calibrate", Dripping("state", [b'{"event": "bus_error", "errno": 5}\r\n'], 1.0), 200),
    ("check", Dripping("check", [SAMPLE], 0.1), 200),
    ("stream", Instead(stream=b'{"event": "stream", "hz": 1e-12}\r\n'), 60),
    ("stream", Dripping("sample", [SAMPLE], 0.1), 60)])
def test_a_board_without_end_has_an_end(verb, attack, limit_s):
    board = HostileBoard(attack)
    code, out, error = run(board, *hostile_board.VERBS[verb][0])
    assert code in (1, 3) and (out if verb == "doctor" else error).strip()
    assert board.now < limit_s, error


@pytest.mark.parametrize("verb", ["restore", "check", "mount"])
def test_a_board_that_talks_on_while_it_is_reset_is_given_up(verb):
    board = HostileBoard(Dripping("paste", [b"x" * 100], 0.25))
    code, _, error = run(board, *hostile_board.VERBS[verb][0])
    assert code == 3 and "did not come to an end" in error
    assert board.now < 70


def waiting(left_s):
    return {"event": "state", "state": "moving", "reason": "moving", "left_s": left_s}


def test_states_for_ever_end_a_minute_after_the_board_should_have_given_up():
    state = json.dumps(waiting(200)).encode() + b"\r\n"
    board = HostileBoard(Dripping("state", [state], 0.25), recorded=False)
    code, _, error = run(board, "calibrate", "--plain")
    assert code == 3 and "the session does not go on" in error
    assert 200 < board.now < 300


class SlowPerson(HostileBoard):
    """Nobody touches the box for 290 s before every pose; the board would wait for 300."""

    def says(self, events):
        for event, after in events:
            if event["event"] == "pose":
                yield from ((waiting(300 - 5 * k), 5.0) for k in range(58))
            yield dict(event, left_s=300) if event["event"] == "state" else event, after
        yield from super().says([])


def test_a_person_may_take_as_long_as_the_board_waits():
    board = SlowPerson(recorded=False)
    code, _, error = run(board, "calibrate", "--plain")
    assert code == 0, error
    assert board.now > 12 * 290


def fields_emitted():
    """{event: names of fields} of every emit() in the firmware's source."""
    found = {}
    for path in DEVICE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "emit" \
                    and node.args and isinstance(node.args[0], ast.Constant):
                names = {word.arg for word in node.keywords if word.arg}
                found.setdefault(node.args[0].value, set()).update(names)
    return found


def test_every_field_the_firmware_emits_is_in_the_table():
    found = fields_emitted()
    assert len(found) > 20
    for event, names in found.items():
        assert names <= set(board_schema.EVENTS[event].kinds) | {"cmd"}, event


def test_what_the_firmware_says_fits_the_table_and_nothing_is_left_out():
    known = dialogue()
    said = [*known.calibrated, *known.started, *known.answers.values(),
            *known.samples["raw"], *known.samples["heading"]]
    for event in said:
        told = {name: value for name, value in event.items() if name != "at_s"}
        assert board_schema.event(json.loads(json.dumps(told))) == told
