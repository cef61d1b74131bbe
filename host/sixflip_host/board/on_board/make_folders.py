"""Runs on the board: the folders of `folders`, parents first, where they are missing."""

import os

for folder in folders:  # noqa: F821  put in front by the host
    try:
        os.stat(folder)
    except OSError:
        os.mkdir(folder)
