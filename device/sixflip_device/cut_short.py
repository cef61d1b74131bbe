"""The capture of a session that did not come to its end finds its name; after a power cut or a
Ctrl-C, which left it without one, at the next power-up."""

from .capture_names import refuse
from .flash_files import NEW, REFUSED, remove


def _look(name):
    """(poses a capture holds, whether somebody asked for it); -1 poses when there is none."""
    from sixflip.capture_scan import Scan
    try:
        with open(name, "rb") as f:
            scan = Scan(f)
            for _ in scan.each():
                pass
            blocks = scan.blocks
            return len(blocks.placements), b'"unasked"' not in blocks.meta_bytes
    except (OSError, ValueError):
        return -1, False


def file_away(root):
    """capture.new becomes refused.bin. One without a pose replaces none that has one, and one
    that nobody asked for (a board without a record begins a session at each power-up) none that
    has more. OSError when it cannot be renamed.
    """
    poses, asked = _look(root + NEW)
    before = _look(root + REFUSED)[0]
    if poses < 0 or poses < (min(before, 1) if asked else before):
        remove(root + NEW)
    else:
        refuse(root)
