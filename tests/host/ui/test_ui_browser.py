"""The page in a real browser: a replayed session, many clicks, a reload, a second tab, malice."""
import contextlib
import os
import re
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import chromium
import pytest
from selenium.common.exceptions import NoSuchElementException, StaleElementReferenceException
from served import ScriptedLink, Served, until

from sixflip.poses.faces import FACES
from sixflip_host.capture import capture_file
from sixflip_host.errors import NoBoard
from sixflip_host.guide import box_drawings
from sixflip_host.guide.replay_link import ReplayLink
from sixflip_host.guide.session_state import SIX
from sixflip_host.ui.bench import Bench
from tests.worlds.board_session import unlabelled

MALICE = "<img src=x onerror='document.title=9'>"
REPORT = ("import sys; open(sys.argv[1], 'w').write('<h1>the gap</h1><script>"
          "parent.document.title = \"taken over\"</script>')")


@pytest.fixture(scope="module")
def chrome():
    chromium.require()
    with chromium.Browser() as driver:
        yield driver


@pytest.fixture
def browser(chrome):
    """The browser without what the page of the test before complained of."""
    chrome.get("about:blank")
    chrome.get_log("browser")
    return chrome


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    """A whole session of a board that calls itself something nasty."""
    found = unlabelled()
    found.meta["device_id"] = MALICE
    path = tmp_path_factory.mktemp("capture") / "capture.csv"
    capture_file.write(path, found)
    return path


def text(browser, name):
    """What an element shows; the page may draw it anew between two looks."""
    while True:
        with contextlib.suppress(StaleElementReferenceException):
            return browser.find_element("id", name).text


def page_text(browser):
    """What the whole page shows, nothing while another takes its place."""
    with contextlib.suppress(NoSuchElementException, StaleElementReferenceException):
        return browser.find_element("tag name", "body").text
    return ""


def click(browser, name, often=1):
    """Clicks as fast as a script can; a button that is disabled swallows them."""
    browser.execute_script("for (let k = 0; k < arguments[1]; k++) "
                           "document.getElementById(arguments[0]).click()", name, often)


WATCH = """window.shown = new Set();
const watch = () => { for (const id of ["head", "capture", "faces"])
  window.shown.add(document.getElementById(id).textContent); };
new MutationObserver(watch).observe(document.body, {subtree: true, childList: true,
                                                    characterData: true});"""


def shown(browser, pattern):
    """Whether the page has shown it at some moment: a replay is quicker than a look at it."""
    return any(re.search(pattern, found)
               for found in browser.execute_script("return [...window.shown]"))


def shot(browser, name):
    """A picture to look at, where SIXFLIP_SCREENSHOTS says."""
    if os.environ.get("SIXFLIP_SCREENSHOTS"):
        folder = Path(os.environ["SIXFLIP_SCREENSHOTS"])
        folder.mkdir(parents=True, exist_ok=True)
        browser.save_screenshot(str(folder / (name + ".png")))


def marks(browser):
    """{face: (first, turned)} of the table."""
    rows = browser.execute_script("return [...document.querySelectorAll('#faces tr')].map("
                                  "row => [...row.cells].slice(0, 3).map(c => c.textContent))")
    return {face: (first, turned) for face, first, turned in rows}


def painted(browser, name):
    """How many different colours a canvas shows."""
    return browser.execute_script(
        "const c = document.getElementById(arguments[0]), seen = new Set();"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "for (let k = 0; k < d.length; k += 4) if (d[k + 3] > 200) "
        "seen.add((d[k] >> 5) * 64 + (d[k + 1] >> 5) * 8 + (d[k + 2] >> 5)); return seen.size",
        name)


def quiet(browser):
    """No error of the page's in the browser's console."""
    return [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []


def test_a_session_from_start_to_report(browser, capture, tmp_path):
    links = []

    def link():
        links.append(ReplayLink(capture, 4.0))
        return links[-1]
    with Served(lambda told: Bench(link, tmp_path, told, keep=False,
                                   capture=str(capture))) as served:
        browser.get(served.server.url)
        until(lambda: text(browser, "head") == "ready to begin")
        until(lambda: "#" not in browser.current_url)   # the key is not left in the address
        browser.execute_script(WATCH)
        click(browser, "start", 20)
        until(lambda: shown(browser, r"half a turn, Z\+ stays up"))
        shot(browser, "flip")
        until(lambda: shown(browser, "keep still ") and shown(browser, r"Z\+.*✓\d+ %"))
        until(lambda: painted(browser, "now") > 3 and painted(browser, "accel") > 2)
        until(lambda: marks(browser)["Z+"] == ("✓", "✓"))
        until(lambda: browser.find_element("id", "now").get_dom_attribute("data-face") in FACES)

        browser.refresh()                                           # nothing is lost
        until(lambda: marks(browser) and marks(browser)["Z+"] == ("✓", "✓"))
        until(lambda: painted(browser, "accel") > 2)                # the trail came with it
        first = browser.current_window_handle
        browser.switch_to.new_window("tab")                         # nor by a second tab
        browser.get("http://127.0.0.1:%d/" % served.server.port)
        until(lambda: marks(browser) and marks(browser)["Z+"] == ("✓", "✓"))
        click(browser, "start", 5)                                  # under way already
        click(browser, "redoZ+", 5)
        until(lambda: marks(browser)["Z+"] == ("·", "·"))
        browser.close()
        browser.switch_to.window(first)
        until(lambda: marks(browser)["Z+"] == ("·", "·"))
        click(browser, "stop", 5)
        until(lambda: text(browser, "verdict") == "refused")
        until(lambda: "stopped by the host" in text(browser, "reason"))
        until(lambda: marks(browser)["Z+"] == ("·", "·"))
        assert len(links) == 1 and served.server.bench.number == 1
        until(lambda: MALICE in text(browser, "board"))

        links[0].speed = 40.0
        click(browser, "start")
        until(lambda: text(browser, "verdict") == "good")
        until(lambda: "scale x y z" in text(browser, "numbers"))
        until(lambda: painted(browser, "residuals") > 2)
        shot(browser, "result")
        served.server.bench.report_command = lambda what, path: [
            sys.executable, "-c", REPORT, str(path)]
        click(browser, "report", 3)
        until(lambda: browser.find_element("id", "reportframe").is_displayed())
        browser.switch_to.frame("reportframe")
        until(lambda: "the gap" in page_text(browser))
        browser.switch_to.default_content()
        assert browser.title == "Sixflip"
        refused = [e["message"] for e in browser.get_log("browser") if e["level"] == "SEVERE"]
        assert all(re.search("sandbox|Blocked script", line) for line in refused), refused


SIZES = ((1280, 800), (390, 844))
SEEN = """const [id] = arguments, e = document.getElementById(id), r = e.getBoundingClientRect();
return r.width > 0 && r.height > 0 && r.top >= 0 && r.left >= 0 && r.bottom <= innerHeight &&
  r.right <= innerWidth ? e.innerText || e.id : "";"""


def resized(browser, width, height):
    """The viewport itself, not the window around it, has that many points."""
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})


def seen(browser, name):
    """What stands in an element that is wholly within the window, without scrolling."""
    return browser.execute_script(SEEN, name)


def fits(browser):
    """Nothing sticks out to the side."""
    return browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")


@pytest.fixture
def window(browser):
    yield browser
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.mark.long
@pytest.mark.parametrize("size", SIZES)
def test_what_counts_is_seen_without_scrolling(window, tmp_path, size):
    link = ScriptedLink()
    boards = []

    def plugged():
        if not boards:
            raise NoBoard("no board is plugged in")
        return link
    with Served(lambda told: Bench(plugged, tmp_path, told, keep=False)) as served:
        resized(window, *size)
        window.get(served.server.url)
        until(lambda: "Plug the board into this computer" in seen(window, "detail"))
        until(lambda: seen(window, "start") == "Start" and not seen(window, "continue"))
        shot(window, "begin-%d" % size[0])
        boards.append(link)
        until(lambda: "board found at scripted" in text(window, "link"))
        until(lambda: "Plug" not in seen(window, "detail"))
        click(window, "start")
        until(lambda: link.resets)
        link.say("calibrating", missing=list(SIX), plan=False)
        link.say("state", state="moving", reason="moving", value=9, limit=2, unit="x noise",
                 live=[20, 0, 1001, 5, 4, 12])
        until(lambda: "lay the box down with Z+ up" in seen(window, "head"))
        until(lambda: "not at rest yet" in seen(window, "waits"))
        for name in ("next", "capture", "stop"):
            until(lambda name=name: seen(window, name))
        until(lambda: fits(window))
        shot(window, "during-%d" % size[0])
        for k, pose in enumerate(SIX):
            link.say("pose", pose=pose, n=400, missing=list(SIX[k + 1:]))
        link.say("solved", verdict="doubtful", reason="the faces disagree in the tilt by 0.9 "
                 "degrees", v=[0.551, 0.01, 9.80665e-3], scale=[1.0, 1.0, 1.0], tilt_deg=2.0,
                 tilt_spread_deg=0.9, residual_mg_rms=3.1)
        link.say("saved", slot="a", sequence=3)
        until(lambda: seen(window, "verdict") == "doubtful")
        until(lambda: "the faces disagree" in seen(window, "reason"))
        until(lambda: "Next: take the face" in seen(window, "next-do") and seen(window, "pull"))
        until(lambda: "-56.19 -1.02 -1.00 mg" in text(window, "numbers") and fits(window))
        assert window.execute_script("return scrollY") == 0
        shot(window, "end-%d" % size[0])


def test_continue_is_there_only_where_something_is_unfinished(browser, tmp_path):
    link = ScriptedLink()
    with Served(lambda told: Bench(lambda: link, tmp_path, told, keep=False)) as served:
        browser.get(served.server.url)
        until(lambda: link.asked("info"))
        link.say("info", unfinished=True)
        until(lambda: browser.find_element("id", "continue").is_displayed())
        click(browser, "start")
        until(lambda: link.resets)
        until(lambda: not browser.find_element("id", "continue").is_displayed())
        link.say("calibrating", missing=list(SIX), plan=False)
        link.say("ready")                               # stopped with nothing taken
        until(lambda: "start again" in text(browser, "next-do"))
        until(lambda: not browser.find_element("id", "continue").is_displayed())
        click(browser, "start")
        until(lambda: link.resets == 2)
        link.say("calibrating", missing=list(SIX), plan=False)
        link.say("pose", pose="Z+a", n=400, missing=list(SIX[1:]))
        link.say("ready")
        until(lambda: browser.find_element("id", "continue").is_displayed())
        until(lambda: "Next: continue the unfinished" in text(browser, "next-do"))


def test_what_a_board_says_is_text_and_nothing_else(browser, tmp_path):
    link = ScriptedLink()
    with Served(lambda told: Bench(lambda: link, tmp_path, told, keep=False)) as served:
        browser.get(served.server.url)
        until(lambda: text(browser, "head") == "ready to begin")
        click(browser, "start")
        until(lambda: link.resets)
        link.say("hello", id=MALICE, chip="<b>chip</b>")
        link.say("calibrating", missing=["Z+a"], plan=False)
        link.say("calibrating", missing=["Z+a", MALICE, 7], plan=MALICE)    # of no use
        link.say("state", state="moving", reason=MALICE, value=1e308, limit=-1,
                 unit="\u202e\x1b", live=[1, 2, 1000])
        link.say("error", what=MALICE, expected="<script>document.title='taken over'</script>")
        link.say("saved", slot=MALICE, sequence=[MALICE])
        link.say("solved", verdict="good", reason=MALICE, scale=[1.0, 1.0, 1.0],
                 residual_mg={"Z+a": [1, 2, 3]})
        link.say("saved", slot="a", sequence=2)
        until(lambda: text(browser, "verdict") == "good")
        until(lambda: MALICE in text(browser, "log"))
        until(lambda: text(browser, "chip") == "<b>chip</b>" and MALICE in text(browser, "reason"))
        assert not browser.find_elements("css selector", "img, b, i, script:not([src])")
        assert browser.title == "Sixflip" and quiet(browser)


@pytest.mark.long
def test_a_dozen_tabs_share_one_board(browser, tmp_path):
    """A browser keeps six connections to a server; a tab that nobody sees holds none."""
    link = ScriptedLink()
    with Served(lambda told: Bench(lambda: link, tmp_path, told, keep=False)) as served:
        first = browser.current_window_handle
        browser.get(served.server.url)
        for _ in range(11):
            browser.switch_to.new_window("tab")
            browser.get("http://127.0.0.1:%d/" % served.server.port)
        until(lambda: text(browser, "head") == "ready to begin")
        click(browser, "start")
        until(lambda: link.resets == 1)
        link.say("calibrating", missing=["Z+a"], plan=False)
        link.say("state", state="moving", live=[0, 0, 1000, 0, 0, 0])
        for handle in browser.window_handles:
            browser.switch_to.window(handle)
            until(lambda: "Z+ up" in text(browser, "head"))
            if handle != first:
                browser.close()
        browser.switch_to.window(first)


def test_the_box_follows_gravity_and_the_gyro(browser, tmp_path):
    """Against the drawings of the terminal, which are right-handed by their own test."""
    with Served(lambda told: Bench(ScriptedLink, tmp_path, told, keep=False)) as served:
        browser.get(served.server.url)
        found = browser.execute_async_script(GEOMETRY)
    for face, (front, right) in box_drawings.SEEN.items():
        assert found["lying"][face] == [front, right, face]
        assert found["turned"][face] == [*box_drawings.turned((front, right)), face]
        assert found["followed"][face] == face
    assert found["yaw"] == pytest.approx(180, abs=2)    # the gyro's bias is left out


GEOMETRY = """const done = arguments[0];
import("/box.js").then(({ Attitude, AXES, lying, times }) => {
  const names = Object.keys(AXES);
  const along = (m, world) => names.find(name => times(m, AXES[name]).every(
    (v, k) => Math.abs(v - world[k]) < 1e-9));
  const seen = m => [along(m, [0, -1, 0]), along(m, [1, 0, 0]), along(m, [0, 0, 1])];
  const found = { lying: {}, turned: {}, followed: {} };
  for (const face of names) {
    found.lying[face] = seen(lying(face));
    found.turned[face] = seen(lying(face, 1));
    const box = new Attitude();
    box.heard(AXES[face].map(v => 1.02 * v + 0.05), null, false);
    for (let k = 0; k < 300; k++) box.step(1 / 60);
    found.followed[face] = box.face();
  }
  const box = new Attitude();
  for (let k = 0; k < 40; k++) box.heard([0, 0, 1], [2, 1, -2], true);
  box.heard([0, 0, 1], [2, 1, 88], false);
  for (let k = 0; k < 120; k++) box.step(1 / 60);
  const x = times(box.m, [1, 0, 0]);
  found.yaw = Math.abs(Math.atan2(x[1], x[0])) * 180 / Math.PI;
  done(found);
});"""


def test_without_the_key_the_page_says_what_to_do(browser, tmp_path):
    with Served(lambda told: Bench(ScriptedLink, tmp_path, told, keep=False)) as served:
        browser.get("http://127.0.0.1:%d/" % served.server.port)
        until(lambda: "open the address that sixflip ui printed" in text(browser, "problem"))


class Stranger(BaseHTTPRequestHandler):
    """Another site: a page with no rules of its own."""

    def do_GET(self):  # noqa: N802  the name http.server calls
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<title>stranger</title>")

    def log_message(self, *words):
        """Nothing on stderr."""


@pytest.fixture
def stranger():
    server = ThreadingHTTPServer(("127.0.0.1", 0), Stranger)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield "http://127.0.0.1:%d/" % server.server_port
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("mode, token", [("no-cors", False), ("cors", True)])
def test_a_page_of_another_site_gets_nothing(browser, tmp_path, stranger, mode, token):
    """Not even with the token, which it cannot know: a browser does not let it send one."""
    with Served(lambda told: Bench(ScriptedLink, tmp_path, told, keep=False)) as served:
        browser.get(stranger)
        got = browser.execute_async_script(
            "const [url, mode, headers, done] = arguments; fetch(url, {method: 'POST', mode, "
            "headers, body: JSON.stringify({action: 'start', number: 0})}).then("
            "answer => done(answer.type + ' ' + answer.status), error => done('refused'))",
            "http://127.0.0.1:%d/api/do" % served.server.port, mode,
            {"X-Sixflip-Token": served.server.token} if token else {})
        assert got in ("refused", "opaque 0")
        frame = browser.execute_async_script(
            "const [url, done] = arguments, frame = document.createElement('iframe');"
            "frame.src = url; frame.onload = () => { try { done(frame.contentDocument.title) } "
            "catch { done('refused') } }; document.body.append(frame)", served.server.url)
        assert frame in ("refused", "")
        assert served.server.bench.asked.empty() and served.server.bench.number == 0
