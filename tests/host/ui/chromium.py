"""A headless Chromium for the tests: Debian's, installed when missing, driven by selenium."""

import shutil
import tempfile

from tests.debian_tier import Unavailable, install, without

PACKAGES = ("chromium", "chromium-driver")
TOOLS = ("chromium", "chromedriver")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--window-size=1200,1500")


def require():
    """Browser and driver; for a user a missing one is a skip, in CI (CI=true) a failure."""
    try:
        install(PACKAGES, lambda: [tool for tool in TOOLS if not shutil.which(tool)])
    except Unavailable as error:
        without("browser", error)


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
