"""The command line: one line and one exit code for every error, never a traceback."""

import contextlib
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from sixflip.record import correction_record
from sixflip_host import cli, terminal
from sixflip_host.cli import VERBS, main
from sixflip_host.errors import SixflipError
from tests.worlds.written_records import of_a_gy85

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_and_an_example(verb, capsys):
    assert main([verb, "--help"]) == 0
    out = capsys.readouterr().out
    assert "usage: sixflip %s" % verb in out
    assert "example: sixflip %s" % verb in out
    assert "\n" not in VERBS[verb][1]


def test_overview_names_every_verb(capsys):
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all("\n  %s " % verb in out for verb in VERBS)


@pytest.mark.parametrize("argv,code,words", [
    (["fly"], 2, "there is no verb 'fly', expected one of boards"),
    (["diagnoze"], 2, "'diagnoze', did you mean diagnose? expected one of"),
    (["solve", "x", "--flip", "180"], 2, "--flip 180, did you mean --flips?"),
    (["export", "x", "-o", "y", "--format", "parket"], 2, "did you mean parquet?"),
    (["plan", "--protocol", "recomended"], 2, "did you mean recommended?"),
    (["calibrate", "--plan", "recomended"], 2, "did you mean recommended?"),
    (["--verson"], 2, "no option '--verson', did you mean --version?"),
    (["diagnose", "x", "--without", "thermal_bais"], 2, "did you mean thermal_bias?"),
    (["diagnose", "x", "--fail-on", "unexplaned"], 2, "did you mean unexplained?"),
    (["solve"], 2, "required"), (["solve", "x", "--level", "best"], 2, "invalid choice"),
    (["solve", "x", "--lat", "91"], 2, "expected -90 to 90"),
    (["solve", "x", "--height", "3"], 2, "--height needs --lat"),
    (["solve", "x", "--g", "1"], 2, "between 9 and 11"),
    (["solve", "no such file"], 4, "no such file: cannot be read"),
    (["show", "no such file"], 4, "cannot be read"),
    (["verify", "a", "b", "c"], 2, "expected DIR or CAPTURE RECORD"),
    (["verify", "a"], 2, "expected a folder"),
    (["export", "a", "-o", "b.xyz"], 2, "does not say the format")])
def test_errors_are_one_line(argv, code, words, capsys):
    assert main(argv) == code
    error = capsys.readouterr().err
    assert words in error and error.startswith("sixflip: ") and error.count("\n") == 1


@pytest.mark.parametrize("words", [[], ["diagnose"], ["mount"], ["calibrate"]])
def test_piped_help_is_80_wide_and_keeps_every_word(words, capsys, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    assert main([*words, "--help"]) == 0
    narrow = capsys.readouterr().out
    assert max(map(len, narrow.splitlines())) <= 80
    monkeypatch.setenv("COLUMNS", "2000")
    assert main([*words, "--help"]) == 0
    assert sorted(narrow.split()) == sorted(capsys.readouterr().out.split())


def test_a_bug_is_one_line_too(monkeypatch, capsys):
    def broken(args):
        raise RuntimeError("boom\x1b[2J")
    monkeypatch.setattr("sixflip_host.verbs.solve.run", broken)
    assert main(["solve", "x"]) == cli.INTERNAL_ERROR
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "boom\\x1b[2J" in error
    assert main(["solve", "x", "--debug"]) == cli.INTERNAL_ERROR
    assert "Traceback" in capsys.readouterr().err


def test_ctrl_c(monkeypatch, capsys):
    def interrupted(args):
        raise KeyboardInterrupt
    monkeypatch.setattr("sixflip_host.verbs.solve.run", interrupted)
    assert main(["solve", "x"]) == cli.INTERRUPTED
    assert capsys.readouterr().err == "sixflip: stopped\n"


def pressed_while(makes):
    """The run() of a verb that is interrupted, and what it makes of that."""
    def run(args):
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        makes()
    return run


def fails_to_import():
    raise ImportError("the C-extensions failed")


def seems_not_installed():
    try:
        fails_to_import()
    except ImportError as error:
        raise SixflipError("a library is not installed") from error


@pytest.mark.parametrize("makes", [fails_to_import, seems_not_installed])
def test_ctrl_c_of_which_an_import_makes_another_error(makes, monkeypatch, capsys):
    monkeypatch.setattr("sixflip_host.verbs.solve.run", pressed_while(makes))
    assert main(["solve", "x"]) == cli.INTERRUPTED
    assert capsys.readouterr().err == "sixflip: stopped\n"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_import_that_fails_by_itself_is_not_stopped(monkeypatch, capsys):
    monkeypatch.setattr("sixflip_host.verbs.solve.run", lambda args: fails_to_import())
    assert main(["solve", "x"]) == cli.INTERNAL_ERROR
    assert "the C-extensions failed" in capsys.readouterr().err


def test_a_bug_after_a_ctrl_c_that_was_obeyed_is_a_bug(monkeypatch, capsys):
    monkeypatch.setattr("sixflip_host.verbs.solve.run", pressed_while(lambda: 1 / 0))
    assert main(["solve", "x"]) == cli.INTERNAL_ERROR
    assert "ZeroDivisionError" in capsys.readouterr().err


PRESSED = """
import runpy, sys
class Press:
    def find_spec(self, name, path=None, target=None):
        if name == %r:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Press())
sys.argv[1:] = ["solve", "x"]
runpy.run_module("sixflip_host", run_name="__main__")
"""


@pytest.mark.parametrize("module", ["sixflip_host.cli", "sixflip_host.narration", "argparse",
                                    "sixflip_host.verbs.solve", "numpy"])
def test_ctrl_c_while_modules_are_imported(module):
    done = subprocess.run([sys.executable, "-c", PRESSED % module], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (cli.INTERRUPTED, "sixflip: stopped\n")


LOADED = """
import sys
from sixflip.record import correction_record
from sixflip_host import cli
assert cli.main(["--help"]) == 0
assert "numpy" not in sys.modules and "argparse" in sys.modules
for words in %r:
    assert cli.main(words) in (0, 3), words
print("loaded:", *{"scipy", "matplotlib", "mujoco", "rosbags"} & set(sys.modules))
"""


def test_help_and_verbs_without_arithmetic_load_neither_scipy_nor_matplotlib(tmp_path):
    record = tmp_path / "record.bin"
    record.write_bytes(correction_record.encode(of_a_gy85()))
    words = [["boards"], ["history"], ["show", str(record)], ["completion", "bash"],
             ["export", str(record), "--to", "json", "-o", str(tmp_path / "record.json")],
             ["stream", "--port", "/dev/none"], ["pull", "--port", "/dev/none"]]
    words += [[verb, "--help"] for verb in VERBS]
    done = subprocess.run([sys.executable, "-c", LOADED % words], capture_output=True, text=True)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "loaded:"), done.stderr


def test_the_command_begins_where_ctrl_c_is_caught():
    project = (ROOT / "pyproject.toml").read_text()
    assert '\nsixflip = "sixflip_host.__main__:main"\n' in project


def test_help_says_what_to_send_with_an_internal_error(capsys):
    assert main(["--help"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "130 stopped" in out and "70 an error of sixflip's own" in out and "--debug" in out


def test_a_closed_pipe_is_no_error():
    command = "%s -m sixflip_host --help | true" % sys.executable
    done = subprocess.run(["bash", "-o", "pipefail", "-c", command], capture_output=True,
                          text=True, env={"PYTHONPATH": "%s:%s:%s" % (
                              ROOT / "shared", ROOT / "host", ROOT / "device"),
                              "PATH": "/usr/bin:/bin"})
    assert "Traceback" not in done.stderr and "Error" not in done.stderr


@pytest.mark.parametrize("nasty", ["\x1b[2J", "a\nb", "\u202e", "\x00", "\udc80", "\x9b"])
def test_text_from_files_cannot_steer_the_terminal(nasty):
    shown = terminal.plain(nasty)
    assert shown.isprintable() and shown != nasty


def test_plain_leaves_words_alone():
    assert terminal.plain("±2 g, 0.3° µT") == "±2 g, 0.3° µT"
