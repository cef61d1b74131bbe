"""Which file a session's capture ends in, once it is known what became of the session.

    capture.bin   of the session whose record is active
    unsaved.bin   of a good session after it, whose record was not written: it said nothing new
    refused.bin   of a session after both that was refused, stopped or cut short

So of the captures that are there refused.bin is the newest and capture.bin the oldest. What a
power cut leaves is capture.new; the next power-up files it.
"""

import os

from sixflip.capture.blocks import COMPLETE, END

from ..flash_files import GOOD, NEW, REFUSED, UNSAVED, remove, size

END_BYTES = 13  # type, 0, length, samples u32, flags, CRC


def move(source, target):
    """Renames a file, and removes one of that name before: FAT does not rename onto a file."""
    remove(target)
    os.rename(source, target)


def keep(root):
    """The session's record is saved: its capture takes the place of all that were before."""
    remove(root + REFUSED)
    remove(root + UNSAVED)
    move(root + NEW, root + GOOD)  # last: until then finish_interrupted() does it all again


def keep_unsaved(root):
    """A good session, whose record was not written."""
    remove(root + REFUSED)
    move(root + NEW, root + UNSAVED)


def refuse(root):
    """A session that was refused, stopped or cut short."""
    move(root + NEW, root + REFUSED)


def refuse_first(root):
    """A session that a Ctrl-C ended: where there is another one's capture already, the next
    power-up decides between the two (file_cut_short), there is no room for it now."""
    if not size(root + REFUSED):
        refuse(root)


def finish_interrupted(root, session):
    """A power cut after the record was saved may have left its capture unnamed."""
    try:
        with open(root + NEW, "rb") as f:
            head = f.read(1200)
        name = '"session": %d' % session
        if (name + ",").encode() in head or (name + "}").encode() in head:
            keep(root)
    except OSError:
        pass


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
    poses, samples, by_request = _look(root + NEW)
    before = _look(root + REFUSED)[0]
    if poses + samples <= 0 or poses < (min(before, 1) if by_request else before):
        remove(root + NEW)
    else:
        refuse(root)
