"""Pictures of the guided screen, of the page in the browser and of the report.

    python docs/screenshots.py

A virtual board is provisioned and calibrates itself while somebody simulated handles its box; the
pictures are of what a person sees meanwhile. Needs the test extra (selenium) and Debian's chromium
and chromium-driver.
"""

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from PIL import Image
from rich.console import Console
from rich.text import Text
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from sixflip_host.board.board_link import MpremoteLink
from sixflip_host.guide import screen
from sixflip_host.guide.board_session import BoardSession
from sixflip_host.virtual.board_hands import AskedHand
from sixflip_host.virtual.virtual_board import VirtualBoard

PICTURES = Path(__file__).resolve().parent / "pictures"
WORLD = {"sensor": "gy85", "seed": 3, "tilt_deg": 2.0, "flip_error_deg": 0.4, "order": []}
SPEED = 8            # simulated seconds a second: a moment of it lasts long enough to be pictured
WAIT_S = 240
COLOURS = 64         # of a picture of a page
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")


def until(holds, what):
    """Wait for what another program does."""
    end = time.monotonic() + WAIT_S
    while not holds():
        if time.monotonic() > end:
            raise SystemExit("it never came: " + what)
        time.sleep(0.05)


def sixflip(folder, *argv):
    subprocess.run([sys.executable, "-m", "sixflip_host", *argv], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL, env=environment(folder))


def environment(folder):
    return dict(os.environ, SIXFLIP_HISTORY=str(Path(folder) / "history.sqlite"))


def guided(port):
    """A whole session on the board; the screen while a turned placement is captured, as SVG."""
    picture = ""
    link = MpremoteLink(port)
    try:
        link.reset()
        session = BoardSession(link, keep=False)
        while not session.ending.over:
            session.pump(0.05)
            state = session.state
            if not picture and state.pose == "X+b" and state.progress > 0.5 * state.total > 0:
                picture = svg(screen.screen(state, port))
    finally:
        link.close()
    return picture


def svg(lines):
    """Lines of the screen as rich draws a terminal, without fonts that are fetched."""
    console = Console(record=True, width=screen.WIDTH, file=io.StringIO(), force_terminal=True,
                      color_system="truecolor", legacy_windows=False)
    console.print(Text("\n").join(lines))
    drawn = console.export_svg(title="sixflip calibrate", unique_id="sixflip")
    drawn = re.sub(r"@font-face \{.*?\}", "", drawn, flags=re.DOTALL)
    return re.sub(r"[ \t]+\n", "\n", drawn.replace("Fira Code", "DejaVu Sans Mono"))


def browser(width, height):
    options = webdriver.ChromeOptions()
    for flag in (*FLAGS, "--window-size=%d,%d" % (width, height)):
        options.add_argument(flag)
    options.binary_location = shutil.which("chromium")
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


def keep(driver, name):
    """The page as a small PNG."""
    seen = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
    seen.quantize(COLOURS).save(PICTURES / name, optimize=True)


def page(folder, port):
    """The page of sixflip ui in the middle of a session."""
    served = subprocess.Popen([sys.executable, "-m", "sixflip_host", "ui", "--port", port],
                              cwd=folder, stdout=subprocess.PIPE, text=True,
                              env=environment(folder))
    driver = browser(1100, 820)
    try:
        driver.get(re.search(r"http\S+", served.stdout.readline())[0])
        until(lambda: "ready" in head(driver), "the page is ready")
        driver.find_element("id", "start").click()
        until(lambda: "half a turn, X+" in head(driver), "half a turn on X+")
        keep(driver, "browser.png")
    finally:
        driver.quit()
        served.terminate()
        served.wait()


def head(driver):
    return driver.find_element("id", "head").text


def report(folder):
    driver = browser(1000, 1250)
    try:
        driver.get((Path(folder) / "report.html").as_uri())
        keep(driver, "report.png")
    finally:
        driver.quit()


def main():
    with tempfile.TemporaryDirectory() as folder, VirtualBoard(
            WORLD, Path(folder) / "flash.img", speed=SPEED, hand=AskedHand()) as board:
        sixflip(folder, "provision", "--sensor", "gy85", "--port", board.port)
        (PICTURES / "terminal.svg").write_text(guided(board.port))
        sixflip(folder, "pull", "--port", board.port, "-o", "pulled")
        pulled, = (Path(folder) / "pulled").iterdir()
        sixflip(folder, "report", str(pulled), "-o", "report.html")
        report(folder)
        page(folder, board.port)
    for name in ("terminal.svg", "browser.png", "report.png"):
        print("%s: %d KB" % (PICTURES / name, (PICTURES / name).stat().st_size // 1024))


if __name__ == "__main__":
    main()
