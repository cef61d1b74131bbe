"""A power cut in mid-session left its capture without a name: it is filed away at the next
power-up, before a new session takes its place."""

from .capture_names import refuse_longer
from .flash_files import NEW, remove


def _holds_a_pose(name):
    from sixflip.capture_scan import Scan
    try:
        with open(name, "rb") as f:
            scan = Scan(f)
            for _ in scan.each():
                if scan.blocks.placements:
                    return True
    except (OSError, ValueError):
        pass
    return False


def file_away(root):
    """As the capture of a session that was stopped; one without a pose is cleared away."""
    if not _holds_a_pose(root + NEW):
        remove(root + NEW)
        return
    try:  # noqa: SIM105 - MicroPython has no contextlib
        refuse_longer(root)
    except OSError:
        pass
