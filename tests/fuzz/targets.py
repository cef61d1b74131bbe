"""One function for every reader of bytes that somebody else wrote: a file, a board, a person.

A target takes bytes and returns; what it raises is a bug. Inside, a reader may refuse with the
one exception it is allowed; what it does accept is used as the product would use it, so that
the parser's leftovers cannot hurt what comes behind it.
"""

import base64
import binascii
import contextlib
import io
import json
import os
import struct
import tempfile
from dataclasses import replace

import numpy as np

from sixflip.capture import blocks as capture_blocks
from sixflip.capture import reader as capture_reader
from sixflip.record import correction_record
from sixflip.record.correction import correction_of
from sixflip_device import settings as device_settings
from sixflip_device.events import HostLine
from sixflip_host import cli, json_numbers
from sixflip_host.board import board_answers, board_events, console
from sixflip_host.board.board_schema import ANSWERS
from sixflip_host.board.recording import Recording
from sixflip_host.calibrate import solution, solution_json
from sixflip_host.capture import capture_binary, capture_file, open_recording
from sixflip_host.errors import SixflipError
from sixflip_host.fleet import fleet_prior, manifest, summary_file
from sixflip_host.planning import plan_file
from sixflip_host.simulation import scenario

FOLDER = tempfile.mkdtemp(prefix="sixflip-fuzz-")
BUG = cli.INTERNAL_ERROR


def said_plainly(text):
    """No escape sequence, no bidirectional override: only what a terminal prints."""
    odd = [c for c in text if not c.isprintable() and c != "\n"]
    assert not odd, "a terminal would obey %r" % odd[:5]


def verb(*words):
    """Run the tool in this process: any exit code but that of a bug, nothing unescaped."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main([str(word) for word in words])
    assert code != BUG, err.getvalue()
    said_plainly(out.getvalue())
    said_plainly(err.getvalue())
    assert err.getvalue().count("\n") <= 1, err.getvalue()
    return code


def kept(name, data):
    """A file of this process with the bytes in it."""
    path = os.path.join(FOLDER, name)
    with open(path, "wb") as file:
        file.write(data)
    return path


def use(capture):
    """What solve does with a capture, and a round trip through both formats."""
    answer = json_numbers.finite(solution_json.to_json(solution.solve(capture)))
    json.dumps(answer, allow_nan=False)


def capture_text(data):
    """A text capture: read, solved, written, read again."""
    try:
        capture = capture_file.parse("fuzz.csv", data)
    except SixflipError:
        return
    again = capture_file.text(capture)
    use(capture)
    assert capture_file.text(capture_file.parse("again.csv", again)) == again


def repaired_capture(data):
    """The bytes with every CRC of a board's file put right, as far as blocks go."""
    data = bytearray(data)
    head = struct.calcsize(capture_blocks.HEAD)
    if len(data) < head:
        return bytes(data)
    data[:5] = capture_blocks.MAGIC + bytes([capture_blocks.VERSION])
    at, end = 0, head + struct.unpack(capture_blocks.HEAD, data[:head])[-1]
    while end + 4 <= len(data):
        data[end:end + 4] = struct.pack("<I", binascii.crc32(data[at:end]))
        at = end + 4
        if at + 4 > len(data):
            break
        end = at + 4 + struct.unpack(capture_blocks.BLOCK, data[at:at + 4])[-1]
    return bytes(data)


def capture_of_a_board(data):
    """A binary capture with right CRCs: read, shown, solved."""
    data = repaired_capture(data)
    with contextlib.suppress(ValueError):
        capture_reader.read(data)
    try:
        capture = capture_binary.decode(data, "fuzz.bin")
    except SixflipError:
        return
    path = kept("capture.bin", data)
    verb("show", path)
    verb("solve", path, "--json")
    if len(capture):
        verb("export", path, "-o", os.path.join(FOLDER, "out.csv"), "--force")


def recorded_pieces(data):
    """What a board sends of its capture while it is recorded: pieces with a length before each
    and right CRCs. The file is there, it is read as any other, and it never holds more."""
    path = os.path.join(FOLDER, "recorded.bin")
    recording = Recording(path)
    taken = 0
    while len(data) > 2:
        length = int.from_bytes(data[:2], "little")
        body, data = data[2:2 + length], data[2 + length:]
        line = b"\xa5" + base64.b64encode(body + struct.pack("<I", binascii.crc32(body)))
        taken += len(body) if recording.take(line) else 0
    recording.close()
    assert all(isinstance(line, str) for line in recording.words())
    recording.slow_link()
    if recording.header is not None:
        assert os.path.getsize(path) <= 4 * taken + 1024
        with contextlib.suppress(SixflipError):
            use(capture_file.read(path))


def stream(correction):
    """What a board does with a correction it took: a rest, and samples at any temperature."""
    correction.set_rest([1, -2, 16384, 3, -4, 5, -3700])
    for temp in (-32768, -3700, 0, 32767):
        correction.apply([32767, -32768, 1, 0, -1, 32767, temp], [0.0] * 6)


def record(data):
    """A record with its length and CRC put right: decoded, encoded, shown, exported."""
    size = correction_record.HEAD_SIZE
    if len(data) >= size + 4:
        body = bytearray(data[:-4])
        body[:4] = b"6FLP"
        struct.pack_into("<HH", body, 4, 1, len(data))
        data = bytes(body) + struct.pack("<I", binascii.crc32(body))
    try:
        found = correction_record.decode(data)
    except ValueError:
        return
    with contextlib.suppress(ValueError):
        stream(correction_of(found))
    path = kept("record_a.bin", data)
    verb("show", path)
    verb("show", path, "--json")
    for form in ("json", "imu_calib", "imufusion", "imucal"):
        verb("export", path, "--format", form, "-o", os.path.join(FOLDER, "out"), "--force")


def lines_of_a_board(data):
    """Serial lines: events for a person, and answers of the board's Python."""
    out = io.StringIO()
    shown = console.Console(out)
    for line in data.decode("utf-8", "replace").split("\n"):
        event = board_events.parse(line)
        if event:
            shown.show(event)
            out.isatty = lambda: True
            shown.live = not shown.live
    shown.clear()
    said_plainly(out.getvalue().replace("\r", ""))
    with contextlib.suppress(SixflipError):
        board_answers.parse("port", data, ANSWERS["file"])


def settings(data):
    """sixflip.json on the board: always complete settings, and sentences."""
    with open(os.path.join(FOLDER, device_settings.FILE), "wb") as file:
        file.write(data)
    values, problems = device_settings.load(FOLDER + os.sep)
    assert set(values) == set(device_settings.KNOWN)
    json.dumps(values)
    assert all(isinstance(problem, str) for problem in problems)
    for name, (default, kind, low, high) in device_settings.KNOWN.items():
        if kind in ("int", "float"):
            assert values[name] is default or low <= values[name] <= high


class _Board:
    def __init__(self, line):
        self.line = line

    def read_line(self):
        return self.line


class _Events:
    def error(self, what, expected):
        json.dumps([what, expected])


def host_line(data):
    """A line from the host to the firmware."""
    command = HostLine(_Board(data.decode("utf-8", "replace")), _Events()).poll()
    assert command is None or isinstance(command["cmd"], str)


def somebodys_csv(data):
    """import: the first byte chooses the options."""
    options = (("--rate", "100", "--units", "si"), ("--rate", "100", "--accel-lsb", "16384"),
               ("--time-column", "1", "--time-unit", "ms", "--accel-lsb", "256", "--sort"),
               ("--columns", "ax,ay,az,-,gx,gy,gz", "--accel-lsb", "16384", "--gyro-lsb", "131",
                "--time-column", "4", "--time-unit", "s"))
    chosen = options[data[0] % len(options)] if data else options[0]
    verb("import", kept("in.csv", data[1:]), "-o", os.path.join(FOLDER, "out.csv"), *chosen)


def foreign_file(data):
    """A file whose reader is told by its content: by import, and by a verb that opens it."""
    path = kept("foreign", data)
    verb("import", path, "-o", os.path.join(FOLDER, "out.csv"), "--no-poses")
    try:
        use(open_recording.read(path, gravity=False))
    except SixflipError as error:
        said_plainly(cli.plain(str(error)))


def sections(data):
    """The JSON of somebody's still sections."""
    rows = b"".join(b"%d,0,1000\n" % (k % 3) for k in range(300))
    verb("import", kept("in.csv", rows), "-o", os.path.join(FOLDER, "out.csv"), "--rate", "100",
         "--columns", "ax,ay,az", "--accel-lsb", "1000", "--sections", kept("s.json", data))


def scenario_file(data):
    """A scenario of simulate, as far as the description of its worlds."""
    path = kept("scenario.toml", data)
    with contextlib.suppress(SixflipError):
        json.dumps(list(scenario.read(path).worlds))


def plan(data):
    """A plan file: read, written, read again."""
    try:
        protocol = plan_file.read(kept("plan.json", data))
    except SixflipError:
        return
    plan_file.from_plan(json.loads(json.dumps(plan_file.to_plan(protocol), allow_nan=False)))


def fleet_manifest(data):
    """A manifest of a fleet: boards, and sentences on its wrong lines."""
    try:
        found, wrong = manifest.parse("fuzz.csv", data)
    except SixflipError as error:
        said_plainly(cli.plain(str(error)))
        return
    assert all(one.board and one.capture and said_plainly(one.board) is None for one in found
               if one.board.isprintable())
    assert all(why for _, why in wrong)


def fleet_summary(data):
    """A summary's JSON, its arrays those of a good one: taken and solved, or one sentence."""
    try:
        about = json.loads(data)
    except (ValueError, RecursionError):
        return
    from tests.worlds import simulated_fleet
    rng = np.random.default_rng(1)
    good = simulated_fleet.summary_of(simulated_fleet.drawn(rng), simulated_fleet.THERMAL[0], rng,
                                      "s")
    try:
        encoded = summary_file.encode(replace(good, about=about))
        one = summary_file.decode("fuzz.npz", encoded)
    except (SixflipError, ValueError):
        return
    one.solved()


def fleet_population(data):
    """A fleet.json as prior of plan and diagnose."""
    try:
        found = fleet_prior.read(kept("fleet.json", data), "mpu6050")
    except SixflipError as error:
        said_plainly(cli.plain(str(error)))
        return
    assert all(found.deviation(*at, 1.0) >= 0.0 for at in found.second)


TARGETS = {one.__name__: one for one in (
    capture_text, capture_of_a_board, recorded_pieces, record, lines_of_a_board, settings,
    host_line, somebodys_csv, foreign_file, sections, scenario_file, plan,
    fleet_manifest, fleet_summary, fleet_population)}
