"""Which of its files a session's capture ends in, once it is known what became of the session.

    capture.bin   of the session whose record is in force
    unsaved.bin   of a good session after it, whose record was not written: it said nothing new
    refused.bin   of a session after both that was refused, stopped or cut short

So of the captures that are there refused.bin is the newest and capture.bin the oldest.
"""

import os

from ..flash_files import GOOD, NEW, REFUSED, UNSAVED, remove, size


def move(source, target):
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
    move(root + NEW, root + REFUSED)


def refuse_first(root):
    """A session that a Ctrl-C ended: where there is another one's capture already, the next
    power-up decides between the two (cut_short.py), there is no room for it now."""
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
