"""Code that is sent to a board: kept as files in on_board/, so that it is linted and tested."""

from pathlib import Path

ON_BOARD = Path(__file__).resolve().parent / "on_board"
UPDATE = "sixflip_update.py"  # put_in_place.py on the board's flash, as main.py calls it
# Where new files wait for it. Not beside the old ones: a folder of the new firmware would hide an
# old module of the same name, and the old one could not start any more.
STAGED = "sixflip_new/"


def script(name, /, **values):
    """Source of a file of on_board/ with values assigned in front of it."""
    head = "".join("%s = %r\n" % item for item in sorted(values.items()))
    return head + (ON_BOARD / (name + ".py")).read_text(encoding="utf-8")
