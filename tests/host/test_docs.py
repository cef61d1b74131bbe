"""Every command in the README and in docs/ does what the page says: it is run, page by page,
in an empty folder, against a virtual board where one is needed. Links lead somewhere."""

import contextlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sixflip.record import correction_record
from sixflip_host import cli
from sixflip_host.board import firmware_update
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.virtual.jig_hand import WAYS, JigHand
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.dds_loopback import LOOPBACK
from tests.worlds.micropython_tier import SESSION
from tests.worlds.written_records import of_a_gy85

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").glob("*.md"))
NEEDS_A_BOARD = {"first-calibration.md"}
NEEDS_A_TRAY = {"tray.md"}
PATIENCE = 4.0      # times as long as a person's, of boards that share a core with other tests
NEEDS_A_RECORD = {"robot-localization.md", "slam-toolbox.md"}


def commands(page):
    """Lines of the page's sh blocks."""
    blocks = re.findall(r"^```sh\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.strip()]


def run(line, folder, port=None):
    """Run a line as a shell does; its exit code must be 0."""
    env = dict(os.environ, PATH="%s:%s" % (Path(sys.executable).parent, os.environ["PATH"]),
               SIXFLIP_HISTORY=str(folder / "history.sqlite"), COLUMNS="100",
               SIXFLIP_PATIENCE="%g" % PATIENCE)
    if port:
        env["SIXFLIP_PORT"] = port
    done = subprocess.run(["bash", "-c", line], cwd=folder, env=env, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, "%s\n%s\n%s" % (line, done.stdout[-2000:], done.stderr[-2000:])
    return done.stdout


@pytest.mark.long
@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.name)
def test_the_commands_of_a_page(page, micropython, tmp_path, monkeypatch):
    monkeypatch.setenv("SIXFLIP_MICROPYTHON", micropython)
    if page.name in NEEDS_A_RECORD:
        monkeypatch.setenv("CYCLONEDDS_URI", LOOPBACK)
        with VirtualBoard({"sensor": "gy85", "order": []}, tmp_path / "flash.img",
                          micropython=micropython) as board:
            with MpremoteLink(board.port) as link:
                firmware_update.copy(link, {"sensor": "gy85", "rest_s": 1}, lambda text: None)
                link.put("record_a.bin", correction_record.encode(of_a_gy85()))
            board.power_cycle()
            for line in commands(page):
                run(line, tmp_path, board.port)
        return
    if page.name in NEEDS_A_TRAY:
        hand = JigHand({name: WAYS[number] for number, name in enumerate(("one", "two"))},
                       patience=PATIENCE)
        with contextlib.ExitStack() as jig:
            boards = [jig.enter_context(VirtualBoard(
                dict(SESSION, **hand.first(name)), tmp_path / (name + ".img"),
                micropython=micropython, speed=50, hand=hand.hand_for(name)))
                for name in hand.mountings]
            for line in commands(page):
                run(line, tmp_path, " ".join(board.port for board in boards))
        return
    if page.name not in NEEDS_A_BOARD:
        for line in commands(page):
            run(line, tmp_path)
        return
    folder = tmp_path / "bench"
    folder.mkdir()
    with VirtualBoard(SESSION, tmp_path / "flash.img", micropython=micropython) as board:
        for line in commands(page):
            run(line, folder, board.port)


def readme_commands():
    """Indented lines of the README that call sixflip or make, comments left off."""
    found = []
    for line in (ROOT / "README.md").read_text().splitlines():
        words = re.match(r"    (?:\.venv/bin/)?((?:sixflip|make)\b[^#]*)", line)
        if words:
            found.append(words[1].strip())
    return found


def mentioned():
    """(page, verb, the words behind it) of every sixflip command in backticks."""
    found = []
    for page in [ROOT / "README.md", *PAGES]:
        for words in re.findall(r"`(?:\.venv/bin/)?sixflip ([a-z][^`]*)`", page.read_text()):
            found.append((page.name, *words.replace("\n", " ").partition(" ")[::2]))
    return found


def test_the_verbs_and_options_mentioned_exist():
    assert len(mentioned()) > 20
    for page, verb, rest in mentioned():
        assert verb in cli.VERBS, (page, verb)
        known = cli.parser_for(verb).format_help()
        for option in re.findall(r"(?<![\w-])--[a-z][a-z-]*", rest):
            assert option in known, (page, verb, option)


def test_the_make_targets_mentioned_exist():
    text = "\n".join(p.read_text() for p in [ROOT / "README.md", *PAGES])
    targets = set(re.findall(r"(?:`|    )make ([a-z][a-z-]*)", text))
    assert {"demo", "test", "bench", "blind"} <= targets
    for target in sorted(targets):
        done = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, (target, done.stderr)


def test_the_studies_mentioned_exist():
    text = "\n".join(p.read_text() for p in [ROOT / "README.md", *PAGES])
    modules = set(re.findall(r"python -m (tests\.[\w.]+\w)", text))
    assert len(modules) > 5
    for module in sorted(modules):
        assert (ROOT / module.replace(".", "/")).with_suffix(".py").is_file(), module


def test_the_readme_leads_to_a_calibrated_board(micropython, tmp_path):
    lines = [line for line in readme_commands() if line.startswith("sixflip")]
    assert [line.split()[1] for line in lines[:3]] == ["provision", "calibrate", "pull"]
    with VirtualBoard(dict(SESSION, sensor="gy85"), tmp_path / "flash.img",
                      micropython=micropython) as board:
        for line in lines[:3]:
            run(line, tmp_path, board.port)


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda p: p.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), target


def test_pictures_are_those_that_the_script_draws():
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        import draw
    finally:
        sys.path.pop(0)
    for name, svg in draw.pictures().items():
        assert (draw.HERE / name).read_text() == svg


def test_the_files_of_the_map_are_there():
    named = re.findall(r"`((?:host|shared|device|tests)/[\w/]+\.py)`",
                       (ROOT / "docs" / "architecture.md").read_text())
    assert len(named) > 15
    assert [path for path in named if not (ROOT / path).exists()] == []
