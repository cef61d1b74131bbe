"""Runs on the board, at once or at the next power-up: every file of `names`, put in front by the
host, comes out of the folder `staged` into its place, and then the files of `stale` go, which the
new firmware no longer has; however often it is cut off, in the end all of it is done.

littlefs replaces in one step; FAT refuses to rename onto a file, so there it is removed first.
"""

import os


def attempt(action, *arguments):
    """False where it fails: it was done already, or it is for another file system."""
    try:
        action(*arguments)
        return True
    except OSError:
        return False


def folders(name):
    """The folders above a name, the outermost first."""
    return [name[:i] for i in range(len(name)) if name[i] == "/"]


for name in names:  # noqa: F821
    waiting = staged + name  # noqa: F821
    if not attempt(os.stat, waiting):
        continue
    for folder in folders(name):
        attempt(os.mkdir, folder)
    if not attempt(os.rename, waiting, name):
        os.remove(name)
        os.rename(waiting, name)
for name in stale:  # noqa: F821
    attempt(os.remove, name)
emptied = {folder for name in names for folder in folders(staged + name)}  # noqa: F821
for folder in sorted(emptied, key=len, reverse=True):
    attempt(os.rmdir, folder)
os.remove("sixflip_update.py")
