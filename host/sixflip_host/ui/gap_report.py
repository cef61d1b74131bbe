"""The page of a gap report for the browser, made by a process of its own since it takes long."""

import subprocess
import sys

from ..errors import internal_error
from ..terminal import plain

REPORT_S = 1800
NAME = "gap-report.html"


def command(what, path):
    """The command line that writes the report of a capture or folder to a path."""
    return [sys.executable, "-m", "sixflip_host", "report", str(what), "--gap", "-o", str(path)]


def page(command_of, what, folder):
    """(the bytes of the page, "") once it is written to a folder, or (None, why not).

    command_of   as command() above
    """
    path = folder / NAME
    try:
        folder.mkdir(parents=True, exist_ok=True)
        answer = subprocess.run(command_of(what, path), capture_output=True, text=True,
                                timeout=REPORT_S, stdin=subprocess.DEVNULL)
        if answer.returncode:
            return None, plain(answer.stderr.strip())[:400] or "no report came of it"
        return path.read_bytes(), ""
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, plain(str(error))[:400]
    except Exception as error:      # noqa: BLE001  shown on the page, as everything is
        return None, plain(internal_error(error))[:400]
