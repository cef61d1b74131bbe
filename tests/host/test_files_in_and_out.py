"""What a verb reads it never overwrites, and what it finds in its place it replaces only if that
is of its own kind: one rule for every output of every verb."""

import json
import os

import pytest

from sixflip_host import cli, file_arguments
from sixflip_host.board import pulled_files
from sixflip_host.board.local_link import LocalLink
from sixflip_host.capture import capture_file
from sixflip_host.errors import UsageError
from sixflip_host.verbs.export import FORMATS
from tests.worlds.board_session import leave_files, unlabelled

PICTURE = b"\x89PNG\r\n\x1a\nof a cat"
NOTES = b"# what I did on Sunday\n"
# every output of every verb: a command line that reads READ and writes WRITTEN, or into FOLDER
OUTPUTS = {
    ("refine", "--output"): "refine READ -o WRITTEN",
    ("mount", "--output"): "mount rest.csv --record READ -o WRITTEN",
    ("import", "--output"): "import READ -o WRITTEN --rate 100",
    ("export", "--output"): "export READ -o WRITTEN --format csv",
    ("apply", "--output"): "apply record.bin READ -o WRITTEN",
    ("report", "--output"): "report READ -o WRITTEN.html",
    ("simulate", "--output"): "simulate READ -o WRITTEN b.csv",
    ("simulate", "--worlds"): "simulate READ -o a.csv --worlds WRITTEN",
    ("diagnose", "--scenario"): "diagnose READ --scenario WRITTEN",
    ("diagnose", "--output"): "diagnose a.csv --record READ -o WRITTEN",
    ("diagnose", "--report"): "diagnose READ --report FOLDER",
    ("diagnose", "--junit"): "diagnose READ --junit WRITTEN",
    ("fleet", "--output"): "fleet READ -o FOLDER",
    ("plan", "--plot"): "plan --protocol READ --plot WRITTEN",
    ("plan", "--save"): "plan --protocol READ --save WRITTEN",
    ("history", "--plot"): "history e66 --plot WRITTEN",
    ("stream", "--output"): "stream --port local:READ -o WRITTEN",
    ("record", "--output"): "record --port local:READ -o WRITTEN",
    ("calibrate", "--output"): "calibrate --port local:x --plan READ -o WRITTEN",
    ("virtual-board", "--flash"): "virtual-board --world READ --flash WRITTEN",
}
# of folders, whose files a verb looks at when it knows their names: tests of their own
FOLDERS = {("pull", "--output"), ("ui", "--output"), ("demo", "--keep"), ("reproduce", "--keep")}
READS_NO_FILE = {("history", "--plot"), ("stream", "--output"), ("record", "--output")}
# what looks like a name and is no file
WORDS = {"--port", "--pins", "--axes", "--time-column", "--columns", "--map", "--delimiter",
         "--units", "--topic", "--label-column", "--label", "--add", "--without", "--fail-on",
         "board", "--range", "--spi", "--frame-id", "--domain"}


def actions():
    for verb in cli.VERBS:
        for action in cli.parser_for(verb)._actions:
            yield verb, (action.option_strings or [action.dest])[-1], action


def words(case, read, written, folder):
    """The command line, .html for the report that insists on it."""
    return [one.replace("READ", str(read)).replace("WRITTEN", str(written)).replace(
        "FOLDER", str(folder)) for one in OUTPUTS[case].split()]


def place_of(case, tmp_path):
    """The file that a case writes to."""
    if case == ("diagnose", "--report"):
        return tmp_path / "index.html"
    if case == ("fleet", "--output"):
        return tmp_path / "fleet.json"
    return tmp_path / ("taken.html" if case == ("report", "--output") else "taken")


def test_every_argument_that_may_be_a_file_says_whether_it_is_read_or_written():
    open_ones = [(verb, name) for verb, name, action in actions()
                 if action.nargs != 0 and not action.choices and action.type not in (int, float)
                 and not hasattr(action, "reads") and not hasattr(action, "writes")]
    assert open_ones
    assert [one for one in open_ones if one[1] not in WORDS] == []


def test_every_output_of_every_verb_is_tried_here():
    written = {(verb, name) for verb, name, action in actions() if hasattr(action, "writes")}
    assert written == set(OUTPUTS) | FOLDERS


def test_a_record_is_read_by_the_same_option_everywhere_and_written_by_o():
    assert {verb for verb, name, action in actions() if name == "--record"
            and hasattr(action, "reads")} >= {"refine", "check", "mount", "diagnose"}
    assert not [verb for verb, name, action in actions() if name == "--record"
                and hasattr(action, "writes")]


@pytest.mark.parametrize("link", (None, os.symlink, os.link))
@pytest.mark.parametrize("case", sorted(set(OUTPUTS) - READS_NO_FILE), ids=" ".join)
def test_what_is_read_is_not_overwritten(case, link, tmp_path, capsys):
    taken = place_of(case, tmp_path)
    read = taken if link is None else tmp_path / "read"
    read.write_bytes(NOTES)
    if link:
        link(read, taken)
    command = words(case, read, taken.with_suffix(""), tmp_path)
    assert cli.main([*command, "--force"]) == 2
    assert "is read and would be overwritten" in capsys.readouterr().err
    assert read.read_bytes() == NOTES


@pytest.mark.parametrize("case, content", [
    (case, content) for case in OUTPUTS for content in (PICTURE, NOTES, b'{"mine": 1}\n')
    if case[1] != "--plot" or content != PICTURE])      # a picture may be replaced by a picture
def test_a_file_of_another_kind_is_replaced_by_force_only(case, content, tmp_path, capsys):
    taken = place_of(case, tmp_path)
    taken.write_bytes(content)
    command = words(case, tmp_path / "read", taken.with_suffix(""), tmp_path)
    assert cli.main(command) == 2
    assert "is there already" in capsys.readouterr().err
    assert taken.read_bytes() == content
    parser = cli.parser_for(case[0])
    file_arguments.check(parser, parser.parse_args([*command[1:], "--force"]))


@pytest.fixture(scope="module")
def pulled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("board")
    leave_files(folder, unlabelled(), gyro=True)
    rows = capture_file.read(folder / "capture.bin")
    capture_file.write(folder / "capture.csv", rows)
    (folder / "log.csv").write_text("ax,ay,az,gx,gy,gz\n" + "".join(
        "%d,%d,%d,%d,%d,%d\n" % (*a, *g) for a, g in zip(rows.accel, rows.gyro)))
    (folder / "scene.toml").write_text('sensor = "mpu6050"\nscene = "paper"\n')
    return folder


OWN = {"export to " + name: "export %s --format %s -o OUT" % (
    "record_a.bin" if made_from == "record" else "capture.csv", name)
    for name, (made_from, *_) in FORMATS.items()}
OWN.update({"apply to " + ending: "apply record_a.bin capture.csv -o OUT" + ending
            for ending in (".csv", ".npz", ".parquet", ".mcap")})
OWN.update({
    "import": "import log.csv --rate 100 --accel-lsb 16384 --gyro-lsb 131 -o OUT",
    "mount": "mount --vector 0 0 1 --record record_a.bin -o OUT",
    "refine": "refine capture.csv -o OUT", "report": "report capture.csv -o OUT.html",
    "simulate": "simulate scene.toml -o OUT.csv --worlds OUT.json",
    "plan": "plan --protocol paper --plot OUT.png --save OUT.json",
    "diagnose": "diagnose capture.csv --scenario OUT.toml --report OUT --junit OUT.xml"})


@pytest.mark.parametrize("name", OWN)
def test_an_older_output_of_the_same_kind_is_replaced(name, pulled, tmp_path, monkeypatch):
    monkeypatch.chdir(pulled)
    command = OWN[name].replace("OUT", str(tmp_path / "out")).split()
    assert cli.main(command) in (0, 1)
    assert list(tmp_path.iterdir())
    parser = cli.parser_for(command[0])
    file_arguments.check(parser, parser.parse_args(command[1:]))


def test_two_outputs_are_two_files(pulled, tmp_path, capsys):
    (tmp_path / "x.json").symlink_to(tmp_path / "x.csv")
    assert cli.main(["simulate", str(pulled / "scene.toml"), "-o", str(tmp_path / "x.csv"),
                     "--worlds", str(tmp_path / "x.json")]) == 2
    assert "would be written twice" in capsys.readouterr().err
    assert not (tmp_path / "x.csv").exists()


def test_pull_replaces_what_it_pulled_and_nothing_else(pulled, tmp_path):
    (tmp_path / "flash").mkdir()
    (tmp_path / "flash" / "capture.bin").write_bytes((pulled / "capture.bin").read_bytes())
    with LocalLink(tmp_path / "flash") as link:
        folder = pulled_files.fetch(link, tmp_path)
        assert pulled_files.fetch(link, tmp_path) == folder
        (folder / "capture.csv").write_bytes(NOTES)
        with pytest.raises(UsageError, match="capture.csv: is there already"):
            pulled_files.fetch(link, tmp_path)
        assert (folder / "capture.csv").read_bytes() == NOTES


def test_pull_keeps_the_captures_of_earlier_sessions(tmp_path, capsys):
    (flash := tmp_path / "flash").mkdir()
    leave_files(flash, earlier := unlabelled())
    (flash / "unsaved.bin").write_bytes(kept := (flash / "capture.bin").read_bytes())
    pulled = ["pull", "--port", "local:%s" % flash, "-o", str(tmp_path)]
    assert cli.main(pulled) == cli.main(pulled) == 0
    (flash / "unsaved.bin").unlink()
    earlier.meta["session"] = 7
    leave_files(flash, earlier, sums_only=True)
    capsys.readouterr()
    assert cli.main(pulled) == 0
    (aside,) = tmp_path.glob("*/capture-00005eed.bin")
    folder = aside.parent
    assert aside.read_bytes() == (folder / "unsaved-00005eed.bin").read_bytes() == kept
    assert capture_file.read(folder / "capture-00005eed.csv").meta["session"] == 0x5EED
    assert not list(folder.glob("unsaved.*")) and not (folder / "capture.csv").exists()
    assert "the capture of an earlier session" in capsys.readouterr().out


def test_a_demo_erases_no_folder_but_that_of_a_demo(tmp_path, capsys):
    (tmp_path / "flash").mkdir()
    (tmp_path / "flash" / "photo.png").write_bytes(PICTURE)
    assert cli.main(["demo", "--board", "local", "--keep", str(tmp_path)]) == 2
    assert "not those of a demo" in capsys.readouterr().err
    assert (tmp_path / "flash" / "photo.png").read_bytes() == PICTURE


SUMS_ONLY = ["diagnose SUMS", "diagnose capture.csv --reference SUMS",
             "diagnose capture.csv --sim SUMS", "refine SUMS", "refine SUMS --free",
             "check SUMS --record record_a.bin",
             "mount SUMS", "calibrate --replay SUMS", "report SUMS --gap -o OUT.html",
             *("apply record_a.bin SUMS -o OUT" + ending for ending in (".csv", ".npz", ".parquet",
                                                                       ".mcap")),
             *("export SUMS --format %s -o OUT" % name
               for name, (made_from, *_) in FORMATS.items() if made_from == "capture")]


@pytest.mark.parametrize("command", SUMS_ONLY)
def test_a_capture_of_sums_alone_is_one_sentence_with_what_can_still_be_done(
        command, pulled, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(pulled)
    (tmp_path / "sums").mkdir()
    leave_files(tmp_path / "sums", unlabelled(), sums_only=True)
    sums = str(tmp_path / "sums" / "capture.bin")
    command = command.replace("SUMS", sums).replace("OUT", str(tmp_path / "out"))
    assert cli.main(command.split()) == 4
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "sixflip solve works with the sums" in said
    assert [path.name for path in tmp_path.iterdir()] == ["sums"]
    assert cli.main(["solve", sums]) == 0


def test_show_of_a_board_is_one_document(pulled, tmp_path, capsys):
    (tmp_path / "record_a.bin").write_bytes((pulled / "record_a.bin").read_bytes())
    (tmp_path / "record_b.bin").write_bytes(b"6FLP and then nothing")
    assert cli.main(["show", "--port", "local:%s" % tmp_path, "--json"]) == 0
    records = json.loads(capsys.readouterr().out)["records"]
    assert records["record_a.bin"]["kind"] == "sixflip correction record"
    assert "record_b.bin" in records["record_b.bin"]["error"]
