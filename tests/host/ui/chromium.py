"""A headless Chromium for the tests: Debian's, installed when missing, driven by selenium."""

import os
import shutil
import subprocess
import tempfile

import pytest

PACKAGES = ("chromium", "chromium-driver")
TOOLS = ("chromium", "chromedriver")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1200,1500")


class Unavailable(Exception):
    """No browser can be had on this machine; the text is the line for the user."""


def install():
    """Browser and driver from Debian; as root they are installed when missing."""
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if not missing:
        return
    line = "no %s: apt-get install %s" % (", ".join(missing), " ".join(PACKAGES))
    if not shutil.which("apt-get") or os.geteuid() != 0:
        raise Unavailable(line)
    for words in (["update"], ["install", "-y", "--no-install-recommends", *PACKAGES]):
        answer = subprocess.run(["apt-get", "-q", *words], stdin=subprocess.DEVNULL,
                                capture_output=True, text=True, timeout=1200,
                                env=dict(os.environ, DEBIAN_FRONTEND="noninteractive"))
    if answer.returncode or any(not shutil.which(tool) for tool in TOOLS):
        raise Unavailable(line + " (tried, failed: %s)" % answer.stderr.strip()[-200:])


def require():
    """For a user a missing browser is a skip, in CI (CI=true) a failure."""
    try:
        install()
    except Unavailable as error:
        pytest.skip(str(error))


class Browser:
    """Context manager -> selenium's driver with a profile of its own."""

    def __enter__(self):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        self.profile = tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True)
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for flag in (*FLAGS, "--user-data-dir=" + self.profile.name):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options,
                                       service=Service(shutil.which("chromedriver")))
        return self.driver

    def __exit__(self, *error):
        self.driver.quit()
        self.profile.cleanup()
