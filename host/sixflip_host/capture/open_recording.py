"""A recording to work with, whatever it is: a capture of ours, or a file of somebody else's that
tells by its content what it is. What every verb that takes recordings calls, and scripts may.

What a foreign file does not say is assumed where it can be told from its names and values, and
stands in `capture.assumed`; where it cannot, BadFile names the `sixflip import` line that would
do.
"""

import os
import re
import shlex

from ..errors import BadFile, UsageError
from . import capture_file

# What stands behind an option in the line that is proposed.
FILLED = {"--rate": "HZ", "--gyro-lsb": "N", "--accel-lsb": "N", "--units": "g,dps",
          "--columns": "ax,ay,az,gx,gy,gz", "--map": "ax=NAME", "--time-unit": "ms",
          "--time-column": "NAME", "--topic": "NAME", "--sort": ""}
MAGIC = (b"# sixflip-capture", b"\xef\xbb\xbf# sixflip-capture", capture_file.BOARD_MAGIC)


def read(path, gravity=True, gyro_alone=False):
    """The Capture in a file of ours or somebody else's; `assumed` says what nobody said.

    gyro_alone  one without an accelerometer will do
    gravity     False: the file may leave gravity out, as simulators do; it is read in m/s²
    Raises BadFile for a file that is missing, damaged, or that no reader can make sense of.
    """
    path = os.fspath(path)
    if _is_ours(path):
        return capture_file.read(path, gyro_alone)
    from .imports import presets
    try:
        converted = presets.convert(presets.Options(path, gravity=gravity))
    except (BadFile, UsageError) as error:
        raise BadFile("%s; or make a capture of it: %s" % (error, _line(path, str(error)))) \
            from None
    capture = converted.capture
    capture.assumed = ["%s: imported: %s" % (path, sentence) for sentence in converted.assumed]
    return capture if gyro_alone else capture_file.with_accelerometer(path, capture)


def read_samples(path, gravity=True, gyro_alone=False):
    """read() for what needs every sample: BadFile where the board kept the poses' sums only."""
    return capture_file.with_samples(path, read(path, gravity, gyro_alone))


def _is_ours(path):
    """True for a capture, and for what only its reader has a sentence for: a file that is missing
    or empty, or a pipe, of which nobody can look at the beginning and leave it there."""
    if not os.path.isfile(path):
        return not os.path.isdir(path)
    from ..file_kinds import head_of
    head = head_of(path)
    return head is None or not head.strip() or head.startswith(MAGIC)


def _line(path, why):
    """The import line that would do: with the options that a reader asked for."""
    wanted = dict.fromkeys(re.findall(r"--[a-z-]+(?= |,|$)", why))
    if "--rate" in wanted:      # instead of times, which were not to be found
        wanted.pop("--time-column", None)
    return " ".join(["sixflip import", shlex.quote(path), "-o capture.csv", *(
        "%s %s" % (option, FILLED[option]) for option in wanted if option in FILLED)])
