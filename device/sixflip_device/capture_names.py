"""A session's capture finds its name when it is known what became of the session."""

import os

from .flash_files import GOOD, NEW, REFUSED, remove, size


def move(source, target):
    remove(target)
    os.rename(source, target)


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


def keep(root):
    """The session's record is saved: its capture takes the place of the one before, and of
    one that was refused earlier."""
    remove(root + REFUSED)
    move(root + NEW, root + GOOD)  # last: until then finish_interrupted() does it all again


def refuse(root):
    move(root + NEW, root + REFUSED)


def refuse_first(root):
    """A session that a Ctrl-C ended: where there is another one's capture already, the next
    power-up decides between the two (cut_short.py), there is no room for it now."""
    if not size(root + REFUSED):
        refuse(root)
