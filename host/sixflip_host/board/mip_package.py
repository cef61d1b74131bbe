"""package.json for `mip install`: every file of sixflip and sixflip_device, as on a board.

`make package.json` writes it; a test holds it against the tree. main.py is not in it: mip
installs below /lib, where a board does not look for it; `sixflip provision` copies it.
"""

import json
import sys

from sixflip import __version__

from .board_files import board_files, tree


def package():
    """The object mip reads: urls are [name on the board, path beside package.json]."""
    root = tree()
    urls = [[name, path.relative_to(root).as_posix()]
            for name, path in board_files().items() if name != "main.py"]
    return {"urls": urls, "deps": [], "version": __version__}


def text():
    rows = ",\n".join("    " + json.dumps(pair) for pair in package()["urls"])
    return '{\n  "version": %s,\n  "deps": [],\n  "urls": [\n%s\n  ]\n}\n' % (
        json.dumps(__version__), rows)


if __name__ == "__main__":
    sys.stdout.write(text())
