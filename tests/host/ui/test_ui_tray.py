"""The page of several boards in one jig: its bench, and the page in a real browser."""

import contextlib
import os
import time
from pathlib import Path

import chromium
import pytest
from served import Served, until

from sixflip_host.board import firmware_update
from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.board.event_words import GUIDED_ORDER
from sixflip_host.errors import NoBoard
from sixflip_host.tray import leading
from sixflip_host.ui import tray_bench
from sixflip_host.ui.tray_bench import TrayBench
from sixflip_host.virtual.jig_hand import WAYS, JigHand
from sixflip_host.virtual.virtual_board import VirtualBoard
from tests.worlds.tray_rig import Rig, ScriptedBoard

WORLD = {"sensor": "mpu6050", "tilt_deg": 2.0, "order": [], "seed": 5}
# 100 samples leave the verdict to chance. A board's time goes twenty times as fast as that of the
# browser that it waits for: its 300 s are 15 there, which a busy computer may take.
QUICK = {"sensor": "mpu6050", "pose_samples": 300, "timeout_s": 3600}


class Session:
    """In place of a TraySession: a Rig that the test lays."""

    def __init__(self, ports, request=None):
        self.rig = Rig({port: ScriptedBoard() for port in ports})
        self.request = request
        self.passed, self.kept = {"c": "c: no such port"}, {}
        self.undone, self.ended = [], 0

    tray = property(lambda self: self.rig.tray)

    def find(self):
        pass

    def pump(self, wait_s):
        time.sleep(0.01)

    def redo(self, face):
        self.rig.take(leading.redo(self.tray, face, self.rig.now))

    def undo(self):
        self.undone.append(self.tray.face)
        self.rig.take(leading.undo(self.tray, self.rig.now))

    def end(self):
        self.ended += 1
        if not self.tray.over:
            self.kept = {"a": "stopped; the 700 samples so far stay on the board"}


@pytest.fixture
def bench(monkeypatch):
    monkeypatch.setattr(tray_bench, "TraySession", Session)
    made = TrayBench(lambda: ["a", "b"])
    made.thread.start()
    yield made
    if not made.over.is_set():
        made.close()


def settled(bench):
    bench.ask("nothing", -1)
    until(bench.asked.empty)
    time.sleep(0.05)


def begun(bench, placements):
    for _ in range(5):
        bench.ask("start", 0)
    until(lambda: bench.view()["live"])
    for pose in GUIDED_ORDER[:placements]:
        bench.session.rig.lay(pose)
    return bench.view()


def test_before_a_session_and_in_it(bench):
    assert bench.view()["head"].startswith("lay the jig on a table") and not bench.view()["live"]
    view = begun(bench, 3)
    assert view["number"] == 1 and view["problem"] == "c: no such port"
    assert view["head"] == "half a turn, flat on the table, X+ stays up"
    assert view["step"] == {"kind": "flip", "face": "X+", "letter": "b"}
    assert [board["faces"][:3] for board in view["boards"]] == [["✓✓", "✓·", "··"]] * 2
    assert view["reference"] == 1 and view["log"]


def test_an_undo_clicked_twice_takes_one_face_back(bench):
    view = begun(bench, 5)
    for _ in range(4):
        bench.ask("undo", 1, view["undo"])
    settled(bench)
    assert bench.session.undone == ["Y+"]
    assert bench.view()["undo"] != view["undo"]
    told = len(bench.session.rig.told)
    for _ in range(4):
        bench.ask("redo", 1, "Z+")
    settled(bench)
    assert len(bench.session.rig.told) == told + 2     # each board once


def test_what_a_stale_tab_asks_for_changes_nothing(bench):
    begun(bench, 2)
    bench.ask("stop", 0)
    settled(bench)
    assert bench.session and bench.view()["live"]
    bench.ask("stop", 1)
    until(lambda: bench.view()["number"] == 2)
    assert "700 samples so far stay" in bench.view()["problem"] and not bench.view()["live"]
    bench.ask("continue", 2)
    until(lambda: bench.view()["live"])
    assert bench.session.request == {"continue": True}
    assert "700 samples" in bench.close()


def test_no_board_is_said_on_the_page(bench):
    def none():
        raise NoBoard("no board is plugged in")
    bench.ports = none
    bench.ask("start", 0)
    until(lambda: bench.view()["problem"] == "no board is plugged in")
    assert not bench.view()["busy"]


def shot(browser, name):
    """A picture to look at, where SIXFLIP_SCREENSHOTS says."""
    if os.environ.get("SIXFLIP_SCREENSHOTS"):
        folder = Path(os.environ["SIXFLIP_SCREENSHOTS"])
        folder.mkdir(parents=True, exist_ok=True)
        browser.save_screenshot(str(folder / (name + ".png")))


@pytest.mark.long
def test_two_boards_in_a_browser(micropython, tmp_path):
    chromium.require()
    hand = JigHand({"one": WAYS[0], "two": WAYS[1]})
    with VirtualBoard(WORLD, tmp_path / "one", micropython=micropython) as board, \
            MpremoteLink(board.port) as link:
        firmware_update.copy(link, QUICK, lambda line: None)
    (tmp_path / "two").write_bytes((tmp_path / "one").read_bytes())
    with contextlib.ExitStack() as stack:
        boards = [stack.enter_context(VirtualBoard(
            dict(WORLD, **hand.first(name)), tmp_path / name, micropython=micropython, speed=20,
            hand=hand.hand_for(name))) for name in hand.mountings]
        served = stack.enter_context(Served(
            lambda told: TrayBench(lambda: [board.port for board in boards], told),
            page="tray.html"))
        browser = stack.enter_context(chromium.Browser())
        browser.get(served.server.url)

        def text(name):
            return browser.find_element("id", name).text

        until(lambda: text("head").startswith("lay the jig on a table"))
        browser.find_element("id", "start").click()
        until(lambda: "✓✓" in text("boards"))
        until(lambda: browser.find_element("id", "next").get_attribute("data-face"))
        shot(browser, "tray")
        until(lambda: text("head") == "done: the jig may be opened",
              lambda: (served.server.bench.view(), hand.tray, hand.lies))
        shot(browser, "tray-over")
        assert text("boards").count("✓✓") == 12
        assert text("boards").count("; saved in slot a") == 2, text("boards")
        assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
