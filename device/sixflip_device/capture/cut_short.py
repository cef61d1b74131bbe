"""The capture of a session that did not come to its end: where it goes, and whether there is one.

Apart from capture_files.py, for a session that ends well needs none of it in its heap.
"""

from sixflip.capture.blocks import COMPLETE, END

from ..flash_files import NEW, REFUSED, remove
from .files import refuse

END_BYTES = 13  # type, 0, length, samples u32, flags, CRC


def unfinished(root):
    """Whether there is a capture of a session that did not come to its end: the last block of a
    whole one says COMPLETE."""
    try:
        with open(root + REFUSED, "rb") as f:
            f.seek(-END_BYTES, 2)
            tail = f.read(END_BYTES)
            return tail[0] != END or not tail[8] & COMPLETE
    except OSError:
        return False


def _look(name):
    """(poses a capture holds, its samples, whether somebody asked for it); -1 poses when there
    is none."""
    from sixflip.capture.scan import Scan  # long, and not needed for unfinished()
    try:
        with open(name, "rb") as f:
            scan = Scan(f)
            for _ in scan.each():
                pass
            blocks = scan.blocks
            return len(blocks.placements), blocks.samples, b'"unasked"' not in blocks.meta_bytes
    except (OSError, ValueError):
        return -1, 0, False


def file_cut_short(root):
    """A session that did not come to its end; after a power cut or a Ctrl-C at the next power-up.

    capture.new becomes refused.bin. One without a pose replaces none that has one, and one
    that nobody asked for (a board without a record begins a session at each power-up) none that
    has more; one without a sample is nothing. OSError when it cannot be renamed.
    """
    poses, samples, asked = _look(root + NEW)
    before = _look(root + REFUSED)[0]
    if poses + samples <= 0 or poses < (min(before, 1) if asked else before):
        remove(root + NEW)
    else:
        refuse(root)
