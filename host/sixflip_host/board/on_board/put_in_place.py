"""Runs on the board, at once or at the next power-up: every NAME.new of `names`, put in front by
the host, takes the place of NAME, and then the files of `stale` go, which would be imported in
its place; however often it is cut off, in the end all have.

littlefs replaces in one step; FAT refuses to rename onto a file, so there it is removed first.
"""

import os

for name in names:  # noqa: F821
    try:
        os.stat(name + ".new")
    except OSError:
        continue  # it has been done already
    try:
        os.rename(name + ".new", name)
    except OSError:
        os.remove(name)
        os.rename(name + ".new", name)
for name in stale:  # noqa: F821
    try:  # noqa: SIM105 - MicroPython has no contextlib
        os.remove(name)
    except OSError:
        pass  # it has gone already
os.remove("sixflip_update.py")
